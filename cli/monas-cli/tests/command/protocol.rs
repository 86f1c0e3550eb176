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

#[test]
fn findings_about_a_role_point_into_the_role_and_use_its_words() {
    let answer = monas(&["model", "conform", AIP, "models/extended_attacker.srm"]);
    assert_eq!(answer.code, Some(5));
    for expected in [
        "the protocol has `[passBall]/CONDITION -> passBall`, but the player does not",
        "the player has `[passBall]/CONDITION -> passBall : [Attack.pass_is_open]`, but the protocol does not",
        " --> models/extended_attacker.srm:20:43\n",
        "center = WalkTowardsBall . AssessAttack . [passBall]",
        " --> models/attack.aip:9:5\n",
    ] {
        assert!(answer.err.contains(expected), "{expected}: {}", answer.err);
    }
    assert!(!answer.err.contains("`0."), "labels: {}", answer.err);
    let other = monas(&["model", "conform", AIP, EAC, "models/attacker.srm"]);
    assert!(other.err.contains(" --> models/attacker.srm:6:1\n"), "{}", other.err);
}
