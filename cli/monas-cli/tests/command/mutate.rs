//! `monas model mutate`: the quality of the project's scenarios. `MONAS_BLESS=1` updates the list
//! of survivors; reasons are kept, new survivors need one.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use crate::kit::{Answer, monas, root};
use crate::scenario::{beside_the_models, write};

/// The survivors by name, each with the reason why no scenario can detect it.
fn reasons(role: &str) -> Vec<(String, String)> {
    let path = root().join("tests/golden/mutants").join(format!("{role}.txt"));
    let text = fs::read_to_string(path).unwrap_or_default();
    let mut found: Vec<(String, String)> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        match (line.strip_prefix("  "), found.last_mut()) {
            (Some(reason), Some((_, said))) => said.push_str(reason),
            _ => found.push((line.to_owned(), String::new())),
        }
    }
    found
}

fn bless(role: &str, survivors: &[String]) {
    let known: BTreeMap<String, String> = reasons(role).into_iter().collect();
    let mut text = format!(
        "# The mutants of models/{role}.srm that no scenario detects, in the order of `monas model mutate`, each with the reason why none can.\n"
    );
    for name in survivors {
        let reason = known.get(name).map_or("", String::as_str);
        text += &format!("{name}\n  {reason}\n");
    }
    let path = root().join("tests/golden/mutants").join(format!("{role}.txt"));
    fs::write(path, text).expect("the folder takes files");
}

fn is_well_tested(role: &str, min: usize) {
    let model = format!("models/{role}.srm");
    let command =
        ["model", "mutate", &model, "--scenarios", "tests/scenarios", "--least", "80", "--format", "json"];
    let Answer { code, out, err } = monas(&command);
    assert_eq!(code, Some(0), "{err}");
    let lines: Vec<Value> =
        out.lines().map(|line| serde_json::from_str(line).expect("an object a line")).collect();
    let (all, mutants) = lines.split_last().expect("all of them");
    assert!(mutants.len() >= min && all["made"] == mutants.len(), "{all}");
    for mutant in mutants {
        assert!(mutant["line"].as_u64().is_some_and(|line| line > 1), "{mutant}");
    }
    let survived = mutants.iter().filter(|mutant| mutant["verdict"] == "survived");
    let survivors: Vec<String> =
        survived.map(|mutant| mutant["name"].as_str().unwrap_or_default().to_owned()).collect();
    if std::env::var_os("MONAS_BLESS").is_some() {
        bless(role, &survivors);
    }
    let known = reasons(role);
    assert_eq!(survivors, known.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>());
    for (name, reason) in known {
        assert!(!reason.trim().is_empty(), "the list has no reason why no scenario can detect `{name}`");
    }
}

#[test]
fn scenarios_detect_mutants_of_the_goalie() {
    is_well_tested("goalie", 150);
}

#[test]
fn scenarios_detect_mutants_of_the_attacker() {
    is_well_tested("attacker", 150);
}

#[test]
fn scenarios_detect_mutants_of_the_extended_attacker() {
    is_well_tested("extended_attacker", 250);
}

const LAMP: &str = "Role: lamp
Liveness:
lamp = Look . (On | Off)
Transitions:
CONDITION -> On : [Ball.distance < 3]
CONDITION -> Off : [Ball.distance >= 3]
";

/// The report on a lamp with one scenario.
fn lamp(scenario: &str, more: &[&str]) -> Answer {
    let folder = beside_the_models(scenario);
    write(folder.path(), "lamp.srm", LAMP);
    let model = folder.path().join("lamp.srm");
    let (model, here) = (model.to_string_lossy(), folder.path().to_string_lossy());
    monas(&[&["model", "mutate", &*model, "--scenarios", &*here], more].concat())
}

const DARK: &str = "model lamp.srm\nstart\nreturn Look\n  Ball.distance = 1\n  starts On\n";

#[test]
fn survivors_are_reported_with_a_distinguishing_case() {
    let Answer { code, out, err } = lamp(DARK, &[]);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    let first = out.lines().next().unwrap_or_default();
    assert!(first.contains("lamp.srm: 1 scenario notices ") && first.ends_with(" %)"), "{out}");
    let survivor = "lamp.srm:5: CONDITION -> On: the guard `[Ball.distance < 3]` becomes `[Ball.distance <= 3]`\n    a scenario would have to show a case in which `Ball.distance` equals `3`\n";
    assert!(out.contains(survivor), "{out}");
    assert!(!out.contains("CONDITION -> On: it is never taken"), "that is noticed\n{out}");
}

#[test]
fn invalid_mutants_are_reported_separately() {
    let folder = beside_the_models(DARK);
    let model = folder.path().join("lamp.srm").to_string_lossy().into_owned();
    let states = "On -> END : [over]\nStates:\nOn : entry = StartTimeout(over, 1s)\n";
    write(folder.path(), "lamp.srm", &(LAMP.to_owned() + states));
    let here = folder.path().to_string_lossy();
    let Answer { code, out, err } = monas(&["model", "mutate", &model, "--scenarios", &here]);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    assert!(out.lines().next().is_some_and(|line| line.ends_with("; 1 more cannot run")), "{out}");
    let refused = "On entry: `over` is never started\n    there is no `over` here";
    assert!(out.contains("cannot run:\n") && out.contains(refused), "{out}");
}

#[test]
fn too_few_that_are_noticed_end_with_5() {
    let all = |percent: &str| lamp(DARK, &["--least", percent]).code;
    assert_eq!((all("0"), all("20"), all("100")), (Some(0), Some(0), Some(5)));
    assert_eq!(all("101"), Some(2));
}

#[test]
fn a_scenario_that_fails_on_the_model_itself_is_an_error() {
    let Answer { code, out, err } = lamp(&DARK.replace("starts On", "starts Off"), &[]);
    assert_eq!((code, out.as_str()), (Some(3), ""));
    assert!(err.contains("E0898") && err.contains("expected `starts Off`, but started are: On"), "{err}");
    assert!(err.contains("a.scenario:5:3"), "{err}");
}

#[test]
fn a_folder_without_scenarios_of_the_model_is_no_proof() {
    let Answer { code, err, .. } = lamp("model models/goalie.srm\nstart\n", &[]);
    assert_eq!(code, Some(1));
    assert!(err.contains("no scenario in") && err.contains("belongs to"), "{err}");
    let Answer { code, err, .. } = monas(&["model", "mutate", "models/goalie.srm", "--scenarios", "nowhere"]);
    assert_eq!(code, Some(1));
    assert!(err.contains("cannot read nowhere"), "{err}");
}
