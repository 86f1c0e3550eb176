//! `monas model compose`: deadlocks of robots, and their traces played by `monas model run`.

use std::fs;
use std::path::Path;

use crate::kit::{Answer, command, monas, root};

const CASES: &str = "methodology/aseme-verify/tests/verify/composed";

fn model(case: &str, name: &str) -> String {
    root().join(CASES).join(case).join(name).display().to_string()
}

fn in_folder(folder: &Path, arguments: &[&str]) -> Answer {
    command(arguments).current_dir(folder).output().expect("the command starts").into()
}

#[test]
fn robots_that_stand_still_are_shown_by_a_way_that_can_be_played() {
    let folder = tempfile::tempdir().expect("a folder");
    let (passer, receiver) = (model("deadlock", "passer.srm"), model("deadlock", "receiver.srm"));
    let answer = in_folder(folder.path(), &["model", "compose", &passer, &receiver, "--traces", "."]);
    assert_eq!(answer.code, Some(5), "{answer:?}");
    assert!(answer.out.contains("`Ready` passes from receiver to passer\n"), "{answer:?}");
    assert!(answer.err.contains("`passer` waits in `Wait` for `Ready` of `receiver`"), "{answer:?}");
    let trace = "composed-E0930-1.trace";
    let played = in_folder(folder.path(), &["model", "run", &passer, &receiver, trace]);
    assert_eq!((played.code, played.err.as_str()), (Some(0), ""), "{played:?}");
    assert!(
        played.out.starts_with("passer: start\n") && played.out.contains("\nreceiver: return Listen\n"),
        "{played:?}"
    );
    let swapped = [format!("receiver={passer}"), format!("passer={receiver}")];
    let played = in_folder(folder.path(), &["model", "run", &swapped[0], &swapped[1], trace]);
    assert_eq!(played.code, Some(3), "the charts of the other: {played:?}");
    assert!(played.err.contains("E0290") && played.err.contains(trace), "{played:?}");
    let alone = in_folder(folder.path(), &["model", "run", &passer, trace]);
    assert!(alone.code == Some(3) && alone.err.contains("belongs to no robot"), "{alone:?}");
}

#[test]
fn deadlocking_robots_are_reported() {
    let (passer, receiver) = (model("near", "passer.srm"), model("near", "receiver.srm"));
    let answer = monas(&["model", "compose", &passer, &receiver]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    assert!(
        answer.out.ends_with("no deadlock; all 17 states of the composition were explored\n"),
        "{answer:?}"
    );
    let lossy = monas(&["model", "compose", &passer, &receiver, "--lose"]);
    assert!(
        lossy.code == Some(5) && lossy.err.contains("# `Ready` of receiver to passer is lost"),
        "{lossy:?}"
    );
    let short = monas(&["model", "compose", &passer, &receiver, "--states", "8", "--format", "json"]);
    assert!(
        short.code == Some(5) && short.err.contains("E0933") && !short.out.contains("waits"),
        "{short:?}"
    );
    assert!(short.out.ends_with("{\"states\":8,\"finished\":false,\"one_process\":false}\n"), "{short:?}");
    let twice = monas(&["model", "compose", &passer, &passer]);
    assert!(twice.code == Some(2) && twice.err.contains("two robots are named `passer`"), "{twice:?}");
    let unknown = monas(&["model", "compose", &passer, &receiver, "--event", "whistle"]);
    assert!(unknown.code == Some(2) && unknown.out.is_empty(), "{unknown:?}");
    assert!(
        unknown.err.starts_with("error: no transition waits for the event `whistle`; there are `"),
        "{unknown:?}"
    );
}

#[test]
fn players_of_a_protocol_are_held_against_it_and_each_part_is_taken() {
    let protocol = ["models/attack.aip", "models/attack.eac"];
    let both = monas(&[
        "model",
        "compose",
        "one=models/extended_attacker.srm",
        "two=models/extended_attacker.srm",
        protocol[0],
        protocol[1],
    ]);
    assert_eq!(both.code, Some(0), "{both:?}");
    assert!(both.out.contains("`center_for` conforms") && both.out.contains("no message passes"), "{both:?}");
    let unplayed =
        monas(&["model", "compose", "models/goalie.srm", "models/attacker.srm", protocol[0], protocol[1]]);
    assert!(
        unplayed.code == Some(5)
            && unplayed.err.contains("no robot takes the part `center_for`")
            && unplayed.err.contains("models/attack.eac:"),
        "{unplayed:?}"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let role = fs::read_to_string(root().join("models/extended_attacker.srm")).expect("it is there");
    let broken = folder.path().join("broken.srm");
    fs::write(&broken, role.replace("center -> END also : [Attack.ball_is_out]\n", ""))
        .expect("the folder takes files");
    let broken = broken.display().to_string();
    let answer = monas(&["model", "compose", &broken, protocol[0], protocol[1]]);
    assert!(answer.code == Some(5) && answer.err.contains("E0864"), "{answer:?}");
}
