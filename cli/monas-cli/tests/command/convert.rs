//! `monas model convert` and `monas model transform --to`, from file to file.

use std::fs;
use std::path::Path;

use crate::kit::monas;

const CHART: &str = "IAC: tiny\n\nStates:\n  r OR\n    START\n    Scan BASIC\n\nTransitions:\n  START -> Scan\n  Scan -> Scan : [x]\n";

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("the folder takes files");
    path.display().to_string()
}

fn golden(name: &str) -> String {
    format!("methodology/aseme-models/tests/golden/{name}")
}

#[test]
fn a_chart_goes_through_every_format_and_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let mut last = file(folder.path(), "0.txt", CHART);
    for name in ["1.model", "2.iac", "3.stct", "4.xmi", "5.txt"] {
        let word = if name == "2.iac" { vec!["--as", "xmi-flat"] } else { Vec::new() };
        let next = path(name);
        let answer = monas(&[&["model", "convert", &last, &next], word.as_slice()].concat());
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""), "{name}");
        last = next;
    }
    assert_eq!(fs::read_to_string(last).expect("written"), CHART);
}

#[test]
fn a_model_is_not_converted_or_transformed_onto_itself() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = file(folder.path(), "a.iac", CHART);
    let same = format!("{}/./a.iac", folder.path().display());
    for words in [&["convert", &input, &same][..], &["transform", &input, "-o", &same]] {
        let refused = monas(&[&["model"], words].concat());
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.err.contains("is the model itself: name another file"), "{}", refused.err);
        assert_eq!(fs::read_to_string(&input).expect("it is there"), CHART);
    }
    let text = monas(&["model", "transform", &input, "-o", "-"]);
    assert_eq!((text.code, &text.out), (Some(0), &monas(&["model", "transform", &input]).out));
}

#[test]
fn no_output_replaces_a_model_that_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = CHART.replace("[x]", "[Ball.x > 0]");
    let (role, chart) = (golden("merged/in.srm"), file(folder.path(), "a.iac", &text));
    let plain = file(folder.path(), "plain", &text);
    for (words, kept) in [
        (&["ontology", &chart, "-o", &chart][..], &chart),
        (&["draw", &plain, "-o", &plain], &plain),
        (&["transform", &role, "--to", "iac", "--with", &chart, "-o", &chart], &chart),
        (&["regenerate", &role, "--from", &chart, "-o", &chart], &chart),
    ] {
        let refused = monas(&[&["model"], words].concat());
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.err.contains("itself: name another file"), "{}", refused.err);
        assert_eq!(fs::read_to_string(kept).expect("it is there"), text);
    }
}

#[test]
fn losses_are_listed_and_need_confirmation() {
    let folder = tempfile::tempdir().expect("a folder");
    let input =
        file(folder.path(), "a.txt", &CHART.replace("Scan BASIC\n", "Scan BASIC\n      priority = 5\n"));
    let output = folder.path().join("a.stct").display().to_string();
    let refused = monas(&["model", "convert", &input, &output]);
    assert_eq!(refused.code, Some(1));
    assert!(
        refused.err.contains("the priority of `Scan`") && refused.err.contains("--lossy"),
        "{}",
        refused.err
    );
    assert!(!Path::new(&output).exists());
    let written = monas(&["model", "convert", &input, &output, "--lossy"]);
    assert_eq!(written.code, Some(0));
    assert!(written.err.contains("the priority of `Scan`"), "{}", written.err);
    assert!(fs::read_to_string(output).expect("written").contains("statechart:Model"));
}

const DOOR: &str = r#"<scxml xmlns="http://www.w3.org/2005/07/scxml" version="1.0" name="door" initial="shut">
  <state id="shut"><transition event="push" target="open"/></state>
  <state id="open"><onentry><raise event="creak"/></onentry><transition event="creak" target="broken"/></state>
  <final id="broken"/>
</scxml>
"#;

#[test]
fn a_chart_of_events_goes_to_rust_and_others_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = file(folder.path(), "door.scxml", DOOR);
    let output = folder.path().join("door.rs").display().to_string();
    let answer = monas(&["model", "convert", &input, &output]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    let code = fs::read_to_string(output).expect("written");
    assert!(
        code.contains("(State::Shut, Event::Push) => *self = State::Over,"),
        "it creaks and breaks at once: {code}"
    );

    let input = file(folder.path(), "a.txt", CHART);
    let output = folder.path().join("a.rs").display().to_string();
    let refused = monas(&["model", "convert", &input, &output]);
    assert_eq!(refused.code, Some(3));
    let why = "`r/Scan` has an activity: a flat chart has events and conditions only";
    assert!(refused.err.contains("E0160") && refused.err.contains(why), "{}", refused.err);
    assert!(!Path::new(&output).exists());
}

#[test]
fn charts_go_to_scxml_and_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "IAC: door\n\nStates:\n  door OR\n    START\n    closed BASIC\n      activity = \"\"\n    open BASIC\n      activity = \"\"\n\nTransitions:\n  START -> closed\n  closed -> open : push\n  open -> closed : pull\n";
    let input = file(folder.path(), "door.txt", text);
    let (scxml, back) = (folder.path().join("door.scxml"), folder.path().join("back.txt"));
    for (from, to) in [(input.as_str(), &scxml), (&scxml.display().to_string(), &back)] {
        let answer = monas(&["model", "convert", from, &to.display().to_string()]);
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    }
    assert_eq!(fs::read_to_string(back).expect("written"), text);
    let tiny = file(folder.path(), "tiny.txt", CHART);
    let answer = monas(&["model", "convert", &tiny, &scxml.display().to_string()]);
    assert_eq!(answer.code, Some(1), "an activity cannot be said");
    let answer = monas(&["model", "convert", &tiny, &scxml.display().to_string(), "--lossy"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
}

#[test]
fn formats_and_endings_that_are_not_known_are_answered() {
    let answer = monas(&["model", "convert", &golden("goals/in.sag"), "-", "--as", "yaml"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.err.contains("there is no format `yaml`; formats are text, role"), "{}", answer.err);
    let answer = monas(&["model", "convert", &golden("goals/in.sag"), "goals.doc"]);
    assert_eq!(answer.code, Some(2), "{}", answer.err);
    let answer = monas(&["model", "convert", &golden("goals/in.sag"), "-", "--as", "scxml"]);
    assert_eq!(answer.code, Some(3));
    assert!(answer.err.contains("E0851"), "{}", answer.err);
}

#[test]
fn models_are_transformed_along_the_method() {
    for (input, kind, more, output) in [
        ("goals/in.sag", "suc", vec![], "goals/out.suc"),
        ("protocols/in.suc", "aip", vec![], "protocols/out.aip"),
        ("roles/in.suc", "srm", vec![], "roles/out.srm"),
        ("protocol_chart/in.aip", "eac", vec![], "protocol_chart/out.eac"),
        ("role_charts/in.srm", "iac", vec!["--name", "watcher"], "role_charts/watcher.iac"),
        ("table/in.srm", "ft", vec![], "table/out.txt"),
        ("table/in.srm", "ft", vec!["--as", "html"], "table/out.html"),
        ("table/in.srm", "ft", vec!["--as", "text"], "table/out.ft"),
    ] {
        let input = golden(input);
        let answer = monas(&[&["model", "transform", &input, "--to", kind], more.as_slice()].concat());
        assert_eq!(answer.code, Some(0), "{}", answer.err);
        let expected = fs::read_to_string(crate::kit::root().join(golden(output))).expect("a golden file");
        assert_eq!(answer.out, expected, "{input} to {kind}");
    }
    let (role, protocol) = (golden("merged/in.srm"), golden("merged/in.eac"));
    let answer = monas(&["model", "transform", &role, "--to", "iac", "--with", &protocol]);
    let expected =
        fs::read_to_string(crate::kit::root().join(golden("merged/out.iac"))).expect("a golden file");
    assert_eq!((answer.code, answer.out), (Some(0), expected), "{}", answer.err);
}

#[test]
fn a_way_that_there_is_not_is_answered() {
    let answer = monas(&["model", "transform", &golden("goals/in.sag"), "--to", "iac"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.err.contains("it can be transformed to suc"), "{}", answer.err);
    let answer = monas(&["model", "transform", &golden("role_charts/in.srm"), "--to", "iac", "-o", "x.iac"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.err.contains("`player`, `watcher`"), "{}", answer.err);
}

#[test]
fn an_option_of_another_transformation_is_refused() {
    let role = golden("merged/in.srm");
    for (words, option) in [
        (&[&role, "--name", "nobody"][..], "--name"),
        (&[&role, "--keep", "nowhere.iac"], "--keep"),
        (&[&role, "--with", "nowhere.eac"], "--with"),
        (&[&role, "--to", "ft", "--name", "nobody"], "--name"),
        (&[&golden("protocol_chart/in.aip"), "--to", "eac", "--with", "nowhere.eac"], "--with"),
    ] {
        let refused = monas(&[&["model", "transform"], words].concat());
        assert_eq!((refused.code, refused.out.as_str()), (Some(2), ""), "{refused:?}");
        assert!(refused.err.contains(&format!("`{option}` has no effect here")), "{}", refused.err);
    }
}

#[test]
fn losses_that_are_accepted_are_warnings() {
    let folder = tempfile::tempdir().expect("a folder");
    let (input, output) = (file(folder.path(), "a.txt", CHART), folder.path().join("a.scxml"));
    let output = output.display().to_string();
    let refused = monas(&["model", "convert", &input, &output]);
    assert_eq!(refused.code, Some(1));
    assert!(refused.err.contains("error[E0620]"), "{}", refused.err);
    let written = monas(&["model", "convert", &input, &output, "--lossy"]);
    assert_eq!(written.code, Some(0));
    assert!(written.err.contains("warning[E0620]"), "{}", written.err);
    assert!(!written.err.contains("error"), "{}", written.err);
}

#[test]
fn every_kind_of_model_is_checked() {
    let answer = monas(&[
        "model",
        "check",
        "--unlinked",
        &golden("goals/in.sag"),
        &golden("merged/in.eac"),
        &golden("merged/in.srm"),
    ]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.out.contains("in.sag: a model of the kind SAG, no errors"), "{}", answer.out);
    assert!(answer.out.contains("in.eac: 36 nodes"), "{}", answer.out);
}

/// The example of the help; what SCXML cannot say is never taken, instead of always.
#[test]
fn a_role_goes_to_scxml_without_guards_that_would_be_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("goalie.scxml").display().to_string();
    let answer = monas(&["model", "convert", "models/goalie.srm", &output]);
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    let help = monas(&["model", "convert", "--help"]);
    assert!(help.out.contains("Example: monas model convert models/goalie.srm goalie.scxml --lossy"));
    let answer = monas(&["model", "convert", "models/goalie.srm", &output, "--lossy"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.err.contains("the guard `!Ball.found` cannot be said in SCXML"), "{}", answer.err);
    let is_refused = |line: &str| line.contains("/END` cannot be the target");
    assert!(!answer.err.lines().any(is_refused), "END is `<final>`: {}", answer.err);
    let text = fs::read_to_string(&output).expect("written");
    assert!(text.contains("<transition cond=\"false\" target=\"search\""), "{text}");
    assert!(text.contains("<transition cond=\"false\" target=\"Vision\""), "{text}");
    assert!(text.contains("<final id=\"END_"), "{text}");
    let answer = monas(&["model", "check", &output]);
    assert_eq!(answer.code, Some(0), "it reads back: {}", answer.err);
}

/// A chart written for tools is read back as the same model.
#[test]
fn a_chart_in_a_file_of_models_can_be_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let role = file(folder.path(), "r.srm", "r = A . (B | C)");
    let first = monas(&["model", "transform", &role]).out;
    for name in ["r.stct", "r.model", "r.iac", "r.xmi"] {
        let output = folder.path().join(name).display().to_string();
        let answer = monas(&["model", "transform", &role, "-o", &output]);
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""), "{name}");
        let again = monas(&["model", "transform", &output]);
        assert_eq!((again.code, again.out.as_str()), (Some(0), first.as_str()), "{name}: {}", again.err);
    }
}

#[test]
fn the_functionality_table_knows_the_activities_of_the_program() {
    let answer = monas(&["model", "transform", "models/goalie.srm", "--to", "ft"]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    let rows: Vec<Vec<&str>> = answer.out.lines().map(|line| line.split_whitespace().collect()).collect();
    for (activity, functionality, module) in [
        ("RobotController", "hardware abstraction layer, Narukom", "robot_controller"),
        ("KeepGoal", "Narukom", "keep_goal"),
        ("LeftDive", "Narukom", "skills"),
    ] {
        let row = rows.iter().find(|row| row.contains(&activity)).expect("a row of each activity").join(" ");
        let module = format!(" {functionality} monas_soccer::activities::{module}");
        assert!(row.ends_with(&module), "{module} is not in {row}");
    }
}
