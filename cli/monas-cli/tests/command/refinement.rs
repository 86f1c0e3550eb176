//! `monas model diff` and `monas model regenerate` after a formula was edited.

use std::fs;
use std::path::Path;

use crate::kit::monas;
use serde_json::Value;

const ROLE: &str = "\
Role: player
Liveness:
player = Stand . (Search | act)
act = Track . Kick
Transitions:
CONDITION -> Search : [!Ball.found]
CONDITION -> act : [Ball.found]
Track -> Kick : [Ball.distance < 0.25]
";

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("the folder takes files");
    path.display().to_string()
}

#[test]
fn differences_are_reported_drawn_and_exit_with_5() {
    let folder = tempfile::tempdir().expect("a folder");
    let before = file(folder.path(), "before.srm", ROLE);
    let after = file(folder.path(), "after.srm", &ROLE.replace("[Ball.found]", "[Ball.found && up]"));
    let answer = monas(&["model", "diff", &before, &before]);
    assert_eq!((answer.code, answer.out.as_str(), answer.err.as_str()), (Some(0), "no difference\n", ""));

    let drawing = folder.path().join("difference.svg").display().to_string();
    let answer = monas(&["model", "diff", &before, &after, "-o", &drawing]);
    let expected =
        "~ transition `CONDITION -> act`: `[Ball.found]`, now `[Ball.found && up]`\n1 difference\n";
    assert_eq!((answer.code, answer.out.as_str(), answer.err.as_str()), (Some(5), expected, ""));
    assert!(fs::read_to_string(&drawing).expect("it was drawn").contains("<g class=\"changed\">"));

    let answer = monas(&["model", "diff", &before, &after, "--format", "json"]);
    let change: Value = serde_json::from_str(&answer.out).expect("one object");
    assert_eq!((&change["change"], &change["part"]), (&Value::from("changed"), &Value::from("transition")));
    assert_eq!(
        (&change["before"], &change["after"]),
        (&Value::from("[Ball.found]"), &Value::from("[Ball.found && up]"))
    );

    assert_eq!(monas(&["model", "diff", &before, &after, "-o", "difference.png"]).code, Some(2));
    assert_eq!(monas(&["model", "diff", &before, "nowhere.srm"]).code, Some(3));
}

#[test]
fn after_an_edit_what_fits_stays_and_the_rest_is_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    let edited = file(folder.path(), "role.srm", &ROLE.replace("Track . Kick", "Track . [Align] . Kick"));
    assert_eq!(monas(&["model", "check", &edited]).code, Some(3), "an entry that fits nowhere is an error");
    let answer = monas(&["model", "regenerate", &edited, "-o", &edited]);
    assert_eq!((answer.code, answer.out.as_str()), (Some(0), "2 kept, 1 lost\n"), "{}", answer.err);
    assert!(
        answer.err.contains("lost: `Track -> Kick : [Ball.distance < 0.25]` names no transition"),
        "{}",
        answer.err
    );
    let text = fs::read_to_string(&edited).expect("it was written");
    assert!(text.contains("# Track -> Kick : [Ball.distance < 0.25]\n"), "{text}");
    assert_eq!(monas(&["model", "transform", &edited]).code, Some(0), "what is left is in order");
}

#[test]
fn a_layout_is_drawn_converted_and_survives_an_edit() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!("{ROLE}Layout:\nStand : at = 300 5\nTrack : at = 0 0, size = 200 50\n");
    let role = file(folder.path(), "role.srm", &text);
    let plain = file(folder.path(), "plain.srm", ROLE);
    let drawn = |arguments: &[&str]| monas(&[&["model", "draw"], arguments].concat()).out;
    assert_ne!(drawn(&[&role]), drawn(&[&plain]));
    assert!(drawn(&[&role]).contains("width=\"200.0\" height=\"50.0\""));
    assert_eq!(drawn(&[&role, "--no-layout"]), drawn(&[&plain]));
    assert_eq!(monas(&["model", "diff", &role, &plain]).out, "no difference\n", "it means nothing else");

    let chart = folder.path().join("chart.txt").display().to_string();
    assert_eq!(monas(&["model", "transform", &role, "--to", "iac", "-o", &chart]).code, Some(0));
    let said = fs::read_to_string(&chart).expect("it was written");
    assert!(said.contains("at = 0 0\n") && said.contains("size = 200 50\n"), "{said}");
    assert_eq!(drawn(&[&chart]), drawn(&[&role]));
    let old = folder.path().join("chart.stct").display().to_string();
    let refused = monas(&["model", "convert", &chart, &old]);
    assert_eq!(refused.code, Some(1));
    assert!(refused.err.contains("the layout of `Track`, `size = 200 50`"), "{}", refused.err);

    let edited = file(folder.path(), "role.srm", &text.replace("Track . Kick", "Follow . Kick"));
    let answer = monas(&["model", "regenerate", &edited, "-o", &edited]);
    assert_eq!((answer.code, answer.out.as_str()), (Some(0), "3 kept, 2 lost\n"), "{}", answer.err);
    let left = fs::read_to_string(&edited).expect("it was written");
    assert!(
        left.contains("\nStand : at = 300 5\n") && left.contains("\n# Track : at = 0 0, size = 200 50\n")
    );
}

#[test]
fn refinements_of_a_chart_are_applied_to_a_role_and_to_a_newer_chart() {
    let folder = tempfile::tempdir().expect("a folder");
    let role = file(folder.path(), "role.srm", ROLE);
    let chart = folder.path().join("chart.stct").display().to_string();
    let plain = file(folder.path(), "plain.srm", &ROLE[..ROLE.find("Transitions:").expect("it is there")]);
    let made = monas(&["model", "transform", &role, "--to", "iac", "--as", "xmi", "-o", &chart]);
    assert_eq!((made.code, made.err.as_str()), (Some(0), ""));
    let answer = monas(&["model", "regenerate", &plain, "--from", &chart]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""), "{}", answer.out);
    let taken = file(folder.path(), "taken.srm", &answer.out);
    assert_eq!(monas(&["model", "diff", &role, &taken]).out, "no difference\n");
    let newer = file(
        folder.path(),
        "newer.srm",
        &ROLE[..ROLE.find("Transitions:").expect("it is there")].replace("Stand .", "Boot . Stand ."),
    );
    let answer = monas(&["model", "transform", &newer, "--to", "iac", "--keep", &chart]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    assert!(answer.out.contains("Track -> Kick : [Ball.distance < 0.25]"), "{}", answer.out);
    assert_eq!(monas(&["model", "regenerate", &chart]).code, Some(2), "a chart is not a role");
}
