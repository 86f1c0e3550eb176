//! `monas model` on the project's own roles, and on mistakes in models.

use std::fs;
use std::path::Path;

use crate::kit::monas;
use serde_json::Value;

const ROLES: [&str; 2] = ["models/goalie.srm", "models/attacker.srm"];

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("the folder takes files");
    path.display().to_string()
}

#[test]
fn the_projects_roles_are_without_findings() {
    let answer = monas(&["model", "check", ROLES[0], ROLES[1], "--states", "2000"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert_eq!(answer.err, "");
    assert_eq!(answer.out.lines().count(), 2);
    assert!(answer.out.starts_with("models/goalie.srm: "));
}

#[test]
fn transform_prints_one_json_object_with_nodes_and_transitions() {
    for role in ROLES {
        let answer = monas(&["model", "transform", role, "--format", "json"]);
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""), "{role}");
        assert_eq!(answer.out.lines().count(), 1, "{role}");
        let chart: Value = serde_json::from_str(&answer.out).expect("it is JSON");
        let nodes = chart["nodes"].as_array().expect("there are nodes");
        let transitions = chart["transitions"].as_array().expect("there are transitions");
        assert!(chart["model"].is_string());
        assert_eq!((&nodes[0]["label"], &nodes[0]["parent"]), (&Value::from("0"), &Value::Null));
        let labels: Vec<&Value> = nodes.iter().map(|node| &node["label"]).collect();
        for node in &nodes[1..] {
            assert!(labels.contains(&&node["parent"]), "{node}");
        }
        for transition in transitions {
            assert!(transition["name"].is_string(), "{transition}");
            assert!(transition["te"].is_null() || transition["te"].is_string(), "{transition}");
            assert!(
                labels.contains(&&transition["source"]) && labels.contains(&&transition["target"]),
                "{transition}"
            );
        }
    }
}

#[test]
fn transform_prints_a_tree() {
    let folder = tempfile::tempdir().expect("a folder");
    let formulas = file(folder.path(), "two.txt", "day = wake . work~\nwork = read | write\n");
    let answer = monas(&["model", "transform", &formulas]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    for name in ["day", "wake", "work", "read", "write"] {
        assert!(answer.out.contains(name), "{name} is not in\n{}", answer.out);
    }
    assert!(answer.out.lines().any(|line| line.starts_with("  ")));
}

#[test]
fn draw_writes_a_drawing() {
    let folder = tempfile::tempdir().expect("a folder");
    let drawing = folder.path().join("attacker.svg");
    let answer = monas(&["model", "draw", ROLES[1], "-o", &drawing.display().to_string()]);
    assert_eq!((answer.code, answer.out.as_str(), answer.err.as_str()), (Some(0), "", ""));
    let written = fs::read_to_string(&drawing).expect("it was written");
    assert!(
        written.contains("<svg") && written.contains("TrackBall") && written.trim_end().ends_with("</svg>")
    );
    assert_eq!(monas(&["model", "draw", ROLES[1]]).out, written);
    let image = folder.path().join("attacker.png");
    let answer = monas(&["model", "draw", ROLES[1], "-o", &image.display().to_string()]);
    assert!(answer.code == Some(2) && answer.err.contains("the file must end in .svg"), "{answer:?}");
    assert!(!image.exists());
}

#[test]
fn a_drawing_that_cannot_be_written_is_a_failure() {
    let answer = monas(&["model", "draw", ROLES[1], "-o", "nowhere/attacker.svg"]);
    assert_eq!(answer.code, Some(1));
    assert!(answer.err.starts_with("error: cannot write nowhere/attacker.svg"), "{}", answer.err);
}

#[test]
fn a_formula_that_cannot_be_read_ends_with_3_and_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(folder.path(), "broken.srm", "Role: broken\nLiveness:\nday = wake . ( work\n");
    let answer = monas(&["model", "transform", &path, "--format", "text"]);
    assert_eq!((answer.code, answer.out.as_str()), (Some(3), ""));
    assert!(answer.err.contains("broken.srm:3:14"), "{}", answer.err);
    assert!(answer.err.contains("day = wake . ( work"), "{}", answer.err);
    assert!(answer.err.contains("help:"), "{}", answer.err);
}

#[test]
fn two_mistakes_are_two_objects() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(folder.path(), "broken.srm", "Liveness:\nday = wake . ( work\nnight = sleep ..\n");
    let answer = monas(&["model", "check", "--unlinked", &path, "--format", "json"]);
    assert_eq!((answer.code, answer.out.as_str()), (Some(3), ""));
    let found: Vec<Value> =
        answer.err.lines().map(|line| serde_json::from_str(line).expect("each line is JSON")).collect();
    let lines: Vec<u64> = found.iter().filter_map(|finding| finding["line"].as_u64()).collect();
    assert!(lines.contains(&2) && lines.contains(&3), "{}", answer.err);
    for finding in found {
        let keys: Vec<&str> = finding.as_object().expect("an object").keys().map(String::as_str).collect();
        assert_eq!(keys, ["code", "severity", "message", "file", "line", "column", "hint"]);
        assert_eq!(finding["file"], path);
    }
}

#[test]
fn an_exploration_that_is_not_finished_is_not_silent_in_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(folder.path(), "short.srm", "Role: short\nLiveness:\nshort = Walk . Look . Report\n");
    let check = |limit: &[&str]| -> Value {
        let words = ["model", "check", "--unlinked", &path, "--format", "json"];
        let answer = monas(&[&words, limit].concat());
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
        serde_json::from_str(&answer.out).expect("one object")
    };
    assert_eq!(check(&[]), serde_json::json!({"model": path, "states": 4, "finished": true}));
    assert_eq!(check(&["--states", "2"])["finished"], false);
}

#[test]
fn a_missing_file_is_answered_with_the_one_that_is_there() {
    let answer = monas(&["model", "transform", "models/golie.srm"]);
    assert_eq!(answer.code, Some(3));
    assert!(answer.err.contains("models/golie.srm") && answer.err.contains("goalie.srm`?"), "{}", answer.err);
}

#[test]
fn findings_exit_with_5_and_warnings_with_0() {
    let folder = tempfile::tempdir().expect("a folder");
    let roles = "Role: r\nLiveness:\nr = look . (turn | walk)\nTransitions:\n";
    let weights = file(
        folder.path(),
        "weights.srm",
        &format!("{roles}CONDITION -> turn %0.2\nCONDITION -> walk %0.2\n"),
    );
    let answer = monas(&["model", "check", "--unlinked", &weights]);
    assert_eq!((answer.code, answer.out.as_str()), (Some(5), ""), "{}", answer.err);
    assert!(answer.err.contains("M23") && answer.err.contains("weights.srm:3:13"), "{}", answer.err);
    let warned = file(folder.path(), "warned.srm", roles);
    let answer = monas(&["model", "check", "--unlinked", &warned]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.err.contains("M07"), "{}", answer.err);
    let unreadable = file(folder.path(), "broken.srm", "Liveness:\nr = (\n");
    assert_eq!(monas(&["model", "check", "--unlinked", &weights, &unreadable]).code, Some(3));
    assert_eq!(monas(&["model", "check", "nowhere.srm"]).code, Some(3));
}

#[test]
fn findings_are_written_as_sarif() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(folder.path(), "warned.srm", "Role: r\nLiveness:\nr = look . (turn | walk)\n");
    let answer = monas(&["model", "check", "--unlinked", &path, "--format", "sarif"]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    let document: Value = serde_json::from_str(&answer.out).expect("it is JSON");
    assert_eq!(document["version"], "2.1.0");
    let run = &document["runs"][0];
    let result = &run["results"][0];
    assert_eq!((&result["ruleId"], &result["level"]), (&Value::from("M07"), &Value::from("warning")));
    assert_eq!(result["locations"][0]["physicalLocation"]["region"]["startLine"], 3);
    let rules = run["tool"]["driver"]["rules"].as_array().expect("there are rules");
    assert!(rules.iter().any(|rule| rule["id"] == "M07"));
}

#[test]
fn information_is_printed_on_request() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "Role: r\nLiveness:\nr = look . walk\nTransitions:\nSTART -> look : [Ball.found]\n";
    let path = file(folder.path(), "waits.srm", text);
    assert!(!monas(&["model", "check", "--unlinked", &path]).err.contains("M25"));
    assert!(monas(&["model", "check", "--unlinked", &path, "--all"]).err.contains("M25"));
}

#[test]
fn a_way_to_a_finding_is_written_and_played() {
    let folder = tempfile::tempdir().expect("a folder");
    let text =
        "Role: r\nLiveness:\nr = look . walk\nTransitions:\nlook -> walk : kick\nwalk -> END : [In(look)]\n";
    let model = file(folder.path(), "stuck.srm", text);
    let traces = folder.path().join("found/ways");
    let answer = monas(&[
        "model",
        "check",
        "--unlinked",
        &model,
        "--event",
        "kick",
        "--traces",
        &traces.display().to_string(),
    ]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.err.contains("M14") && answer.err.contains("    event kick\n"), "{}", answer.err);
    assert!(answer.out.contains("states explored"), "{}", answer.out);
    let misspelt = monas(&["model", "check", "--unlinked", &model, "--event", "kick", "--event", "kcik"]);
    let refusal = "error: no transition waits for the event `kcik`; did you mean `kick`?\n";
    assert_eq!((misspelt.code, misspelt.err.as_str()), (Some(2), refusal));
    let trace = traces.join("stuck-M14-1.trace").display().to_string();
    let played = monas(&["model", "run", &model, &trace]);
    assert_eq!((played.code, played.err.as_str()), (Some(0), ""));
    assert!(played.out.contains("kick: look -> walk"), "{}", played.out);
    assert!(played.out.ends_with("  active: r, walk\n"), "{}", played.out);
    let wrong = file(folder.path(), "wrong.trace", "start\nreturn unknown\n");
    let refused = monas(&["model", "run", &model, &wrong]);
    assert_eq!(refused.code, Some(3));
    assert!(refused.err.contains("wrong.trace:2:1"), "{}", refused.err);
}

#[test]
fn an_incomplete_exploration_is_reported() {
    let answer = monas(&["model", "check", ROLES[0], "--states", "50"]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    assert!(answer.out.contains("exploration not finished: 50 states"), "{}", answer.out);
}

#[test]
fn names_are_checked_against_the_program_unless_the_model_is_of_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "Role: r\nLiveness:\nr = TrakBall . (Stand | Vision)\nTransitions:\nVision -> END : [!Ball.fuond]\n\
                CONDITION -> Stand : [GameState.player_state == PLAYNG]\nCONDITION -> Vision : [Ball.distance < \"near\"]\n";
    let path = file(folder.path(), "names.srm", text);
    let answer = monas(&["model", "check", &path]);
    assert_eq!(answer.code, Some(5), "{}", answer.err);
    for hint in [
        "did you mean `found`?",
        "did you mean `PLAYING`?",
        "did you mean `TrackBall`?",
        "cannot be compared",
    ] {
        assert!(answer.err.contains(hint), "no {hint} in\n{}", answer.err);
    }
    assert_eq!(answer.err.matches("M17").count(), 3, "{}", answer.err);
    assert_eq!(answer.err.matches("M21").count(), 1, "{}", answer.err);
    let answer = monas(&["model", "check", &path, "--unlinked"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(!answer.err.contains("M17") && !answer.err.contains("M21"), "{}", answer.err);
}

#[test]
fn the_messages_of_a_chart_are_written_and_can_be_built() {
    let answer = monas(&["model", "ontology", "models/extended_attacker.iac", "--package", "team"]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    let attack = "
message Attack {
  // The values of `part`.
  enum Part {
    CENTER = 0;
    CENTER_FOR = 1;
  }
  bool mate_sees_ball = 1;
";
    assert!(answer.out.contains(attack), "{}", answer.out);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("team.proto");
    fs::write(&path, &answer.out).expect("written");
    protox::compile([&path], [folder.path()]).expect("it is in order");
    let role = monas(&["model", "ontology", "models/goalie.srm", "-o", &path.display().to_string()]);
    assert_eq!((role.code, role.out.as_str()), (Some(0), ""));
    assert!(fs::read_to_string(&path).expect("read").contains("message Ball {"));
}

#[test]
fn invalid_variables_and_conflicting_retentions_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = |guard: &str, kind: &str| {
        format!(
            "IAC: tiny\n\nVariable: v\n  type = {kind}\n\nStates:\n  r OR\n    START\n    a BASIC\n      variables = v\n    END\n\n\
                 Transitions:\n  START -> a\n  a -> END : [{guard}]\n"
        )
    };
    let odd = file(folder.path(), "odd.iac", &text("Ball.x > 0", "bool"));
    let answer = monas(&["model", "check", "--unlinked", &odd]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.err.contains("E0880") && answer.err.contains("odd.iac:3:"), "{}", answer.err);
    let double = file(folder.path(), "double.iac", &text("a.Data.Ball.x > 0", "a.State.Ball"));
    let answer = monas(&["model", "check", "--unlinked", &double]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.err.contains("E0884"), "{}", answer.err);
    let unknown = file(folder.path(), "unknown.iac", &text("Ball.x > 0", "ball.State.Bal"));
    let answer = monas(&["model", "check", &unknown]);
    assert!(answer.err.contains("E0881") && answer.err.contains("did you mean `Ball`?"), "{}", answer.err);
    let none = file(folder.path(), "none.iac", &text("In(a)", "bool"));
    let answer = monas(&["model", "ontology", &none]);
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    assert!(answer.err.contains("refers to no messages"), "{}", answer.err);
}

#[test]
fn the_coverage_of_tapes_is_summed_reported_and_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = |seed: &str| folder.path().join(format!("{seed}.mcap")).display().to_string();
    let (one, two) = (tape("1"), tape("2"));
    for (seed, file) in [("1", &one), ("2", &two)] {
        let run =
            ["run", "config/match_attack.xml", "--seed", seed, "--for", "12s", "--record", file.as_str()];
        assert_eq!(monas(&run).code, Some(0));
    }
    let drawings = folder.path().join("drawings").display().to_string();
    let answer = monas(&["model", "coverage", &one, &two, "--draw", &drawings]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let charts: Vec<&str> = answer.out.lines().filter(|line| !line.starts_with(' ')).collect();
    assert_eq!(charts.len(), 3, "{charts:?}");
    assert!(charts[0].starts_with("goalie (blue-1 Goalie, red-1 Goalie): "), "{}", charts[0]);
    assert!(charts[1].starts_with("player (blue-2 Attacker, blue-3 Attacker): "), "{}", charts[1]);
    assert!(
        answer
            .out
            .lines()
            .any(|line| line.starts_with("  never fired: center -> decision/takeAction/3/END : [Attack.")),
        "{}",
        answer.out
    );
    for name in ["goalie.svg", "player.svg", "player-2.svg"] {
        let drawing = fs::read_to_string(folder.path().join("drawings").join(name)).expect("it is drawn");
        assert!(drawing.contains("<g class=\"added\">"), "{name}");
        assert!(drawing.contains("<g class=\"missed\">"), "{name}");
        assert!(!drawing.contains("<g class=\"removed\">"), "{name}: nothing is struck out");
    }

    let counts = |tapes: &[&str]| -> Vec<(usize, usize)> {
        let answer = monas(&[&["model", "coverage", "--format", "json"], tapes].concat());
        assert_eq!(answer.code, Some(0), "{}", answer.err);
        let objects = answer.out.lines().map(|line| serde_json::from_str(line).expect("an object"));
        let missed = |it: Value, key: &str| it[key].as_array().expect("names").len();
        objects
            .map(|it: Value| (missed(it.clone(), "transitions_missed"), missed(it, "guards_never_refused")))
            .collect()
    };
    let (first, second, both) = (counts(&[&one]), counts(&[&two]), counts(&[&one, &two]));
    for ((first, second), both) in first.iter().zip(&second).zip(&both) {
        assert!(
            both.0 <= first.0.min(second.0) && both.1 <= first.1.min(second.1),
            "{first:?} {second:?} {both:?}"
        );
    }
    assert_eq!(first.len(), 3);

    let answer = monas(&["model", "coverage", "config/match.xml"]);
    assert!(answer.code != Some(0) && !answer.err.is_empty(), "{}", answer.err);
}
