//! `monas model conform`: the attack protocol and its players, from the table to the chart.

use std::fs;

use crate::kit::{monas, root};

const AIP: &str = "models/attack.aip";
const EAC: &str = "models/attack.eac";
const PLAYER: &str = "models/extended_attacker.iac";

#[test]
fn the_player_is_made_from_role_and_protocol_and_conforms() {
    let made = monas(&["model", "transform", "models/extended_attacker.srm", "--to", "iac", "--with", EAC]);
    assert_eq!((made.code, made.err.as_str()), (Some(0), ""));
    assert_eq!(
        made.out,
        fs::read_to_string(root().join(PLAYER)).expect("it is there"),
        "{PLAYER} is up to date"
    );
    let answer = monas(&["model", "conform", PLAYER, EAC, AIP]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    assert_eq!(
        answer.out,
        "models/attack.eac: `Attack` conforms; all of its 30 states were explored\n\
         models/extended_attacker.iac: `center` conforms; all of its 4 states were explored\n\
         models/extended_attacker.iac: `center within player` conforms; all of its 111 states were explored\n\
         models/extended_attacker.iac: `center_for` conforms; all of its 5 states were explored\n\
         models/extended_attacker.iac: `center_for within player` conforms; all of its 111 states were explored\n"
    );
}

#[test]
fn nonconformance_is_reported_with_positions() {
    let folder = tempfile::tempdir().expect("a folder");
    let chart = fs::read_to_string(root().join(EAC)).expect("it is there");
    let unguarded = folder.path().join("unguarded.eac");
    fs::write(&unguarded, chart.replace(" : [Attack.pass_is_open]", "")).expect("the folder takes files");
    let unguarded = unguarded.display().to_string();
    let answer = monas(&["model", "conform", &unguarded, AIP]);
    assert_eq!((answer.code, answer.out.as_str()), (Some(5), ""));
    assert!(answer.err.contains("E0866") && answer.err.contains("unguarded.eac:"), "{}", answer.err);
    let answer = monas(&["model", "conform", "models/attacker.srm", EAC, AIP]);
    assert_eq!(answer.code, Some(5));
    assert!(answer.err.contains("takes no part in the protocol `Attack`"), "{}", answer.err);
    assert_eq!(
        monas(&["model", "conform", PLAYER, EAC]).code,
        Some(2),
        "there is nothing to be held against"
    );
    assert_eq!(monas(&["model", "conform", AIP]).code, Some(5), "what may be left out is not guarded yet");
}
