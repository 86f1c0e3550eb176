//! The studio of a run: what is printed, and that it is no part of the run.

use serde_json::Value;

use crate::kit::{Answer, command, monas};

#[test]
fn a_studio_prints_its_address_and_changes_no_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let play = |more: &[&str]| -> Answer {
        let arguments = [&["run", "config/match.xml", "--for", "2s", "--seed", "7"], more].concat();
        let answer = command(&arguments).env("XDG_RUNTIME_DIR", folder.path()).output();
        answer.expect("the command starts").into()
    };
    let (viewed, alone) = (play(&["--studio", "--pace", "50"]), play(&[]));
    assert_eq!((viewed.code, alone.code), (Some(0), Some(0)), "{}", viewed.err);
    let hash = |answer: &Answer| answer.out.lines().last().map(str::to_owned);
    assert_eq!(hash(&viewed), hash(&alone));
    assert!(viewed.err.contains("studio: http://127.0.0.1:"), "{}", viewed.err);
    assert!(!alone.err.contains("studio"), "{}", alone.err);
}

#[test]
fn why_names_the_transitions_and_the_messages_that_their_conditions_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("match.mcap");
    let tape = tape.to_str().expect("a path in UTF-8");
    let run =
        monas(&["run", "config/match.xml", "--for", "12s", "--seed", "1", "--no-control", "--record", tape]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    // the entry of a state that was chosen by its condition
    let charts = monas(&["tape", "export", tape, "--topic", "sim/incident"]).out;
    assert!(charts.contains("kick-off"), "{charts}");
    let why = |state: &str, more: &[&str]| {
        monas(&[&["why", tape, "blue-2", "--state", state, "--at", "12"], more].concat())
    };
    let json = why("search", &["--format", "json"]);
    assert_eq!(json.code, Some(0), "{}", json.err);
    let json: Value = serde_json::from_str(&json.out).expect("JSON");
    let segments = json["segments"].as_array().expect("segments");
    let chosen = segments.iter().find(|segment| segment["text"] == "[!Ball.found]").expect("the condition");
    let read = &chosen["reads"][0];
    assert_eq!(
        (&read["name"], &read["value"], &read["topic"]),
        (&"Ball.found".into(), &false.into(), &"soccer/ball".into())
    );
    // the message is the one of that number, published before the state was entered
    let published = read["published"].as_f64().expect("a time");
    assert!(published <= json["entered"].as_f64().expect("a time"));
    let balls = monas(&["tape", "export", tape, "--topic", "soccer/ball", "--host", "blue-2"]).out;
    let ball = balls.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let ball = ball.into_iter().find(|ball| ball["sequence"] == read["sequence"]).expect("the message");
    assert_eq!((&ball["message"]["found"], ball["seconds"].as_f64()), (&false.into(), Some(published)));

    let text = why("search", &[]).out;
    assert!(text.contains(" : [!Ball.found]\n    Ball.found = false  (number "), "{text}");
    assert!(why("SearchBal", &[]).err.contains("there is no state `SearchBal`"));
    assert!(monas(&["why", tape, "blue-9", "--state", "x", "--at", "1"]).err.contains("no host"));
}
