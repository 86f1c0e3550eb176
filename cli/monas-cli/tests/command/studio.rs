//! The studio of a run: what is printed, and that it is not part of the run.

use serde_json::Value;

use crate::kit::{Answer, command, monas};
#[cfg(unix)]
use crate::running::{Running, in_folder};

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
fn models_to_edit_are_files_that_exist_and_need_a_studio() {
    let none = monas(&["studio", "--edit", "nowhere.srm"]);
    assert!(none.code == Some(1) && none.err.contains("nowhere.srm"), "{}", none.err);
    let folder = tempfile::tempdir().expect("a folder");
    let empty = monas(&["studio", "--edit", folder.path().to_str().expect("a path in UTF-8")]);
    assert!(empty.code == Some(1) && empty.err.contains("no model to edit"), "{}", empty.err);
    let run = monas(&["run", "config/match.xml", "--edit", "models"]);
    assert!(run.code == Some(2) && run.err.contains("add --studio"), "{}", run.err);
}

#[test]
fn why_names_the_transitions_and_the_messages_that_their_conditions_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("match.mcap");
    let tape = tape.to_str().expect("a path in UTF-8");
    let run =
        monas(&["run", "config/match.xml", "--for", "17s", "--seed", "1", "--no-control", "--record", tape]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    // the entry of a state that was chosen by its condition
    let charts = monas(&["tape", "export", tape, "--topic", "sim/incident"]).out;
    assert!(charts.contains("kick-off"), "{charts}");
    let why = |state: &str, more: &[&str]| {
        monas(&[&["why", tape, "blue-2", "--state", state, "--at", "17"], more].concat())
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

    let not = |transition: &str, more: &[&str]| {
        monas(&[&["why", tape, "blue-2", "--transition", transition, "--at", "13.1"], more].concat())
    };
    let json = not("CONDITION -> WalkTowardsBall", &["--format", "json"]);
    assert_eq!(json.code, Some(0), "{}", json.err);
    let json: Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!((&json["verdict"], &json["guard"]), (&"instead".into(), &false.into()));
    assert_eq!(json["instead"][0], "decision/takeAction/2/CONDITION -> takeAction/kickBall");
    let held: Vec<&Value> =
        json["atoms"].as_array().expect("atoms").iter().map(|atom| &atom["value"]).collect();
    assert_eq!(held, [&Value::from(false), &true.into(), &true.into()]);
    let links = json["chains"][0]["links"].as_array().expect("links");
    assert_eq!((&links[0]["topic"], &links[0]["activity"]), (&"soccer/ball".into(), &"Vision".into()));
    let sensor = links.iter().find(|link| link["topic"] == "body/sensors").expect("a sensor reading");
    assert!(sensor["end"].as_str().is_some_and(|end| end.contains("comes from outside")), "{sensor}");
    assert!(
        not("decision -> decision", &[]).out.contains("the activity of active/decision has not returned")
    );
    assert!(not("CONDITION -> nowhere", &[]).err.contains("there is no transition"));
    assert_eq!(monas(&["why", tape, "blue-2", "--at", "1"]).code, Some(2));
    let late = monas(&["why", tape, "blue-2", "--state", "search", "--at", "17.001"]);
    assert_eq!(late.code, Some(2));
    assert!(late.err.contains("--at is 17.001 s, and the tape ends at 17.000 s"), "{}", late.err);
}

#[test]
fn the_messages_behind_a_guard_lead_over_the_radio_to_the_sensors_of_a_team_mate() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("attack.mcap");
    let tape = tape.to_str().expect("a path in UTF-8");
    let arguments =
        ["run", "config/match_attack.xml", "--for", "20s", "--seed", "1", "--no-control", "--record", tape];
    let run = monas(&arguments);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let why = monas(&[
        "why",
        tape,
        "blue-2",
        "--transition",
        "CONDITION -> SupportMate",
        "--at",
        "20",
        "--format",
        "json",
    ]);
    assert_eq!(why.code, Some(0), "{}", why.err);
    let why: Value = serde_json::from_str(&why.out).expect("JSON");
    let links = why["chains"].as_array().expect("chains").iter().flat_map(|chain| chain["links"].as_array());
    let links: Vec<&Value> = links.flatten().collect();
    let heard = links.iter().position(|link| link["topic"] == "body/heard").expect("a radio message");
    let said = links[heard + 1];
    assert_eq!((&said["topic"], &said["host"]), (&"body/said".into(), &"blue-3".into()));
    let sensors = links.iter().find(|link| link["host"] == "blue-3" && link["topic"] == "body/sensors");
    assert!(sensors.is_some(), "{links:?}");
}

#[test]
fn another_guard_from_a_moment_on_gives_another_future_and_the_same_guard_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("match.mcap");
    let tape = tape.to_str().expect("a path in UTF-8");
    let run =
        monas(&["run", "config/match.xml", "--for", "17s", "--seed", "1", "--no-control", "--record", tape]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let what_if = |more: &[&str]| monas(&[&["tape", "what-if", tape, "--at", "12.55s"], more].concat());
    let object = |more: &[&str]| -> Value {
        let answer = what_if(&[more, &["--format", "json"]].concat());
        assert_eq!(answer.code, Some(0), "{}", answer.err);
        serde_json::from_str(&answer.out).expect("JSON")
    };
    let same = object(&["--guard", "CONDITION -> search=[!Ball.found]"]);
    assert_eq!((&same["difference"], same["changes"].as_array().map(Vec::len)), (&Value::Null, Some(6)));
    assert_eq!(same["recorded"], same["what_if"]);
    // the kick of the attacker at 12.6 s
    let other = folder.path().join("other.mcap");
    let other = other.to_str().expect("a path in UTF-8");
    let arguments = ["--guard", "CONDITION -> kickBall=[false]", "--host", "blue-2", "-o", other];
    let without = object(&arguments);
    let difference = &without["difference"];
    assert_eq!((&difference["host"], &difference["topic"]), (&"blue-2".into(), &"soccer/motion".into()));
    assert_eq!(
        (difference["time"].as_f64(), &difference["first"]["kind"]),
        (Some(12.6), &"KICK_RIGHT".into())
    );
    assert_ne!(without["recorded"]["events"], without["what_if"]["events"]);
    // the file stays, and is not taken for the other future
    assert_eq!(object(&["--guard", "CONDITION -> search=[!Ball.found]", "-o", other]), same);
    assert!(folder.path().join("other-2.mcap").exists());
    // a parameter of an activity takes effect, on the robots that are named
    let slow = object(&["--set", "agent.Attacker.MotionController.walk_forward=0.05", "--host", "blue-3"]);
    assert_eq!(
        slow["changes"],
        serde_json::json!(["blue-3: agent.Attacker.MotionController.walk_forward=0.05"])
    );
    let difference = &slow["difference"];
    assert_eq!((&difference["host"], &difference["topic"]), (&"blue-3".into(), &"body/actuators".into()));
    assert!(difference["first"]["walk_x"].as_f64() > difference["second"]["walk_x"].as_f64(), "{difference}");
    assert!(difference["time"].as_f64().is_some_and(|time| (12.55..12.8).contains(&time)), "{difference}");
    let why = monas(&["why", other, "blue-2", "--transition", "CONDITION -> kickBall", "--at", "17"]);
    assert_eq!(why.code, Some(0), "{}", why.err);

    let refused = |more: &[&str], reason: &str| {
        let answer = what_if(more);
        assert!(answer.code != Some(0) && answer.err.contains(reason), "{}", answer.err);
    };
    refused(&["--guard", "CONDITION -> kickBall"], "is not `A -> B=[condition]`");
    refused(&["--guard", "CONDITION -> nowhere=[true]"], "there is no transition");
    refused(&["--set", "agent.Nobody.frequency=5"], "no robot has an agent `Nobody`");
    refused(&["--set", "agent.Attacker.Nobody.speed=5"], "has no activity `Nobody`");
    refused(&["--set", "agent.Attacker.Vision.speed=5"], "unknown parameter `speed`");
    refused(&["--set", "agent.Attacker.WalkTowardsBall.no_such=5"], "unknown parameter");
    refused(&[], "--set");
}

#[cfg(unix)]
#[test]
fn what_a_person_decides_as_the_referee_is_recorded_and_replayed() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("match.mcap");
    let tape = tape.to_str().expect("a path in UTF-8");
    let arguments = ["run", "config/match.xml", "--realtime", "--control", "called", "--record", tape];
    let run = Running::start(folder.path(), &arguments, "control socket: ");
    let call = |message: &str| {
        let arguments = ["topic", "pub", "sim/referee", message, "--host", "field"];
        let answer: Answer =
            in_folder(folder.path(), &arguments).output().expect("the command starts").into();
        assert_eq!(answer.code, Some(0), "{}", answer.err);
    };
    for message in
        [r#"{"kind": "PLAY"}"#, r#"{"kind": "READY"}"#, r#"{"kind": "PENALIZE", "team": 1, "number": 2}"#]
    {
        call(message);
    }
    // The field takes calls at its next step: it has made some when it says again where all are.
    let steps = ["topic", "echo", "sim/truth", "--host", "field", "--count", "3"];
    let seen: Answer = in_folder(folder.path(), &steps).output().expect("the command starts").into();
    assert_eq!(seen.code, Some(0), "{seen:?}");
    run.interrupt();
    let incidents = monas(&["tape", "export", tape, "--topic", "sim/incident"]).out;
    assert!(incidents.contains("refused call PLAY: play cannot follow initial"), "{incidents}");
    assert!(incidents.contains("decided by a person"), "{incidents}");
    let scores = monas(&["tape", "export", tape, "--topic", "sim/score"]).out;
    assert!(scores.contains(r#""state":"READY""#), "{scores}");
    let replay = monas(&["tape", "replay", tape, "--verify"]);
    assert_eq!(replay.code, Some(0), "{}\n{}", replay.out, replay.err);
}

#[test]
fn control_of_a_tape_or_without_a_studio_is_refused() {
    let tape = monas(&["studio", "match.mcap", "--allow-control"]);
    assert_eq!(tape.code, Some(2), "{}", tape.err);
    assert!(tape.err.contains("a tape cannot be changed"), "{}", tape.err);
    let run = monas(&["run", "config/match.xml", "--allow-control", "--for", "1s"]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(run.err.contains("add --studio"), "{}", run.err);
}
