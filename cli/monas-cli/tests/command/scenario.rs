//! `monas model run` with the scenarios of the project, with failing and with invalid ones.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::copying::copy;
use crate::kit::{Answer, monas, root};

/// Every scenario of the project for a role.
fn scenarios(role: &str) -> Vec<PathBuf> {
    let folder = root().join("tests/scenarios").join(role);
    let entries = fs::read_dir(folder).expect("the folder is there");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    files
}

fn all_hold(role: &str, min: usize) {
    let files = scenarios(role);
    assert!(files.len() >= min, "{role} has {} scenarios", files.len());
    for file in files {
        let model = format!("models/{role}.srm");
        let Answer { code, out, err } = monas(&["model", "run", &model, &file.to_string_lossy()]);
        assert_eq!((code, err.as_str()), (Some(0), ""), "{}\n{out}", file.display());
    }
}

#[test]
fn a_wait_beyond_the_last_moment_of_time_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let (model, scenario) = (folder.path().join("m.srm"), folder.path().join("long.scenario"));
    fs::write(&model, "m = Wait\n").expect("a file");
    fs::write(&scenario, "model m.srm\nstart\nwait 18446744073709ms\nwait 1ms\n").expect("a file");
    let answer = monas(&["model", "run", &model.to_string_lossy(), &scenario.to_string_lossy()]);
    assert!(matches!(answer.code, Some(0 | 5)), "{answer:?}");
}

#[test]
fn the_goalie_does_what_its_scenarios_say() {
    all_hold("goalie", 20);
}

#[test]
fn the_attacker_does_what_its_scenarios_say() {
    all_hold("attacker", 20);
}

#[test]
fn the_extended_attacker_does_what_its_scenarios_say() {
    all_hold("extended_attacker", 40);
}

/// A folder with the models and a scenario of the goalie beside them.
pub(crate) fn beside_the_models(scenario: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    copy(&root().join("models"), &folder.path().join("models"));
    write(folder.path(), "a.scenario", scenario);
    folder
}

pub(crate) fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).expect("the folder takes files");
}

fn run(folder: &Path, more: &[&str]) -> Answer {
    let at = |name: &str| folder.join(name).to_string_lossy().into_owned();
    monas(&[&["model", "run", &at("models/goalie.srm"), &at("a.scenario")], more].concat())
}

#[test]
fn each_step_is_shown_with_what_differs_from_it() {
    let text = "model models/goalie.srm\nstart\nreturn Stand\n  starts Stand\n  in SendCalibration\nwait 1s\n  in Stand\n";
    let folder = beside_the_models(text);
    let Answer { code, out, .. } = run(folder.path(), &[]);
    assert_eq!(code, Some(5), "{out}");
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(
        lines.iter().filter(|line| !line.starts_with(' ')).collect::<Vec<_>>(),
        [&"start", &"return Stand", &"wait 1s"]
    );
    let differs = |line: usize, text: &str| {
        let position = format!("a.scenario:{line}: {text}");
        assert!(lines.iter().any(|line| line.trim().ends_with(&position)), "{position} is not in\n{out}");
    };
    differs(4, "expected `starts Stand`, but started are: SendCalibration");
    assert!(out.contains("a.scenario:7: expected `in Stand`, but active are: RobotController, LedHandler, MotionController, SendCalibration"), "{out}");
    assert!(!out.contains("a.scenario:5"), "{out}");
}

#[test]
fn json_output_has_one_object_per_step() {
    let folder = beside_the_models("model models/goalie.srm\nstart\n  in active\n");
    let Answer { code, out, .. } = run(folder.path(), &["--format", "json"]);
    assert_eq!(code, Some(5));
    let step: Value = serde_json::from_str(out.trim()).expect("an object a line");
    assert_eq!(step["step"], "start");
    assert_eq!(step["differences"][0]["line"], 3);
    assert_eq!(step["differences"][0]["expected"], "`in active`");
}

#[test]
fn unknown_names_are_reported_with_positions() {
    let text = "model models/goalie.srm\nstart\n  Bal.found = true\n  Ball.fond = true\n  in RightDve\n";
    let folder = beside_the_models(text);
    let Answer { code, err, .. } = run(folder.path(), &["--format", "json"]);
    assert_eq!(code, Some(3), "{err}");
    let found: Vec<Value> =
        err.lines().map(|line| serde_json::from_str(line).expect("an object a line")).collect();
    let positions: Vec<(u64, u64)> = found
        .iter()
        .map(|it| (it["line"].as_u64().unwrap_or_default(), it["column"].as_u64().unwrap_or_default()))
        .collect();
    assert_eq!(positions, [(3, 3), (4, 8), (5, 6)], "{err}");
    for (found, near) in found.iter().zip(["Ball", "found", "RightDive"]) {
        assert!(found["hint"].as_str().is_some_and(|hint| hint.contains(near)), "{found}");
    }
}

#[test]
fn a_scenario_may_come_after_another_but_not_after_itself() {
    let folder = beside_the_models("model models/goalie.srm\nafter b.scenario\nwait 1s\n  in active\n");
    write(
        folder.path(),
        "b.scenario",
        "model models/goalie.srm\nstart\nreturn Stand\nreturn SendCalibration\n",
    );
    let Answer { code, out, err } = run(folder.path(), &[]);
    assert_eq!(code, Some(0), "{out}{err}");
    assert!(out.starts_with("start\n"), "{out}");
    write(folder.path(), "b.scenario", "model models/goalie.srm\nafter a.scenario\nwait 1s\n");
    let Answer { code, err, .. } = run(folder.path(), &[]);
    assert_eq!(code, Some(3));
    assert!(err.contains("E0897") && err.contains("continues itself"), "{err}");
    write(folder.path(), "b.scenario", "model models/attacker.srm\nstart\n");
    assert!(run(folder.path(), &[]).err.contains("has another model"));
}

#[test]
fn a_scenario_of_another_model_is_played_with_a_warning() {
    let folder = beside_the_models("model models/attacker.srm\nstart\n  starts nothing\n");
    let Answer { code, err, .. } = run(folder.path(), &[]);
    assert_eq!(code, Some(5));
    assert!(err.contains("E0897") && err.contains("the scenario belongs to"), "{err}");
    write(folder.path(), "a.scenario", "model models/gaolie.srm\nstart\n");
    let Answer { code, err, .. } = run(folder.path(), &[]);
    assert_eq!(code, Some(3));
    assert!(err.contains("there is no file"), "{err}");
}
