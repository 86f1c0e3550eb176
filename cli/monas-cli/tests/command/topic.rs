//! `monas topic` on a run, and the run's robustness against its clients.

use std::fs;
use std::io::{Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixStream;
use std::path::Path;

use monas_link::control::CLIENT_LIMIT;
use serde_json::Value;

use crate::kit::monas;
use crate::running::{Running, ask, in_folder, objects};

const MATCH: &str = "config/match.xml";

/// A match that runs until an interrupt.
fn play(folder: &Path) -> Running {
    Running::start(folder, &["run", MATCH, "--realtime", "--control", "game"], "control socket: ")
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

#[test]
fn a_running_match_is_inspected() {
    let folder = folder();
    let run = play(folder.path());
    let ask = |arguments: &[&str]| ask(folder.path(), arguments);

    let socket = folder.path().join("monas/game.sock");
    assert_eq!(fs::metadata(&socket).expect("it is there").permissions().mode() & 0o777, 0o600);

    let list = ask(&["topic", "list", "body/*", "--host", "blue-2"]);
    assert_eq!(list.code, Some(0), "{}", list.err);
    for word in ["body/sensors", "data 64", "monas.robot.Sensors", "blue-2"] {
        assert!(list.out.contains(word), "{word} is not in\n{}", list.out);
    }
    let list = objects(&ask(&["topic", "list", "body/sensors", "--format", "json"]).out);
    let hosts: Vec<&Value> = list.iter().map(|topic| &topic["host"]).collect();
    assert_eq!(hosts.len(), 7, "six robots and the field: {hosts:?}");

    let info = ask(&["topic", "info", "soccer/ball", "--host", "blue-2"]);
    assert!(info.out.starts_with("soccer/ball on blue-2: state of monas.soccer.Ball\n"), "{}", info.out);
    assert!(info.out.contains("  bool found\n") && info.out.contains("  double distance\n"), "{}", info.out);
    let each = ask(&["topic", "info", "sim/*", "--host", "field"]);
    let of_topics =
        ["sim/incident on field: ", "  string text\n", "sim/referee on field: ", "  uint32 number\n"];
    let positions = of_topics.map(|part| each.out.find(part));
    assert!(positions.iter().all(Option::is_some) && positions.is_sorted(), "{}", each.out);
    let each = objects(&ask(&["topic", "info", "sim/*", "--host", "field", "--format", "json"]).out);
    let fields =
        |topic| each.iter().find(|entry| entry["topic"] == topic).map(|entry| &entry["fields"][0]["name"]);
    assert_eq!((fields("sim/incident"), fields("sim/referee")), (Some(&"text".into()), Some(&"kind".into())));

    let echo =
        ask(&["topic", "echo", "body/sensors", "--host", "blue-2", "--count", "3", "--format", "json"]);
    let heard = objects(&echo.out);
    assert_eq!((echo.code, heard.len()), (Some(0), 3), "{}", echo.err);
    let numbers: Vec<u64> = heard.iter().filter_map(|message| message["sequence"].as_u64()).collect();
    assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "{numbers:?}");
    assert_eq!(heard[0]["topic"], "body/sensors");
    assert!(heard[0]["message"]["head_yaw"].is_number(), "{}", heard[0]);

    let hz = objects(
        &ask(&["topic", "hz", "body/sensors", "--host", "blue-2", "--for", "500ms", "--format", "json"]).out,
    );
    let rate = hz.last().and_then(|figure| figure["hz"].as_f64()).expect("a rate");
    assert!((rate - 50.0).abs() < 1.0, "a body is sensed fifty times a second of simulated time: {rate}");

    let bw = objects(
        &ask(&["topic", "bw", "body/sensors", "--host", "blue-2", "--for", "300ms", "--format", "json"]).out,
    );
    let (bytes, size) = (&bw[bw.len() - 1]["bytes_per_second"], &bw[bw.len() - 1]["mean_bytes"]);
    assert!(size.as_f64().is_some_and(|size| size > 10.0), "{size}");
    assert!(bytes.as_f64().zip(size.as_f64()).is_some_and(|(bytes, size)| (bytes / size - 50.0).abs() < 1.0));

    let delay = ask(&["topic", "delay", "body/sensors", "--host", "blue-2", "--for", "300ms"]);
    assert!(
        delay.out.contains("body/sensors on blue-2 by body: ") && delay.out.contains(" ms ("),
        "{}",
        delay.out
    );

    let ask_json = |arguments: &[&str]| {
        let answer = ask(&[arguments, &["--host", "blue-2", "--format", "json"]].concat());
        assert_eq!(answer.code, Some(0), "{arguments:?}: {}", answer.err);
        objects(&answer.out).pop().expect("an object")
    };
    let info = ask_json(&["topic", "info", "soccer/ball"]);
    assert_eq!(
        (&info["topic"], &info["type"]),
        (&"soccer/ball".into(), &"monas.soccer.Ball".into()),
        "{info}"
    );
    let delay = ask_json(&["topic", "delay", "body/sensors", "--for", "300ms"]);
    assert!(delay["seen"].as_u64().is_some_and(|seen| seen > 0), "{delay}");
    let published = ask_json(&["topic", "pub", "soccer/calibration", r#"{"number": 6}"#]);
    assert_eq!(published["topic"], "soccer/calibration", "{published}");

    let json = r#"{"number": 7}"#;
    let nowhere = ask(&["topic", "pub", "soccer/calibration", json, "--host", "blue-9"]);
    assert!(nowhere.err.contains("no host is named `blue-9`; there are `"), "{nowhere:?}");
    let published = ask(&["topic", "pub", "soccer/calibration", json, "--host", "blue-2"]);
    assert_eq!(published.out, "published on soccer/calibration of blue-2\n", "{}", published.err);
    let echo =
        ask(&["topic", "echo", "soccer/calibration", "--host", "blue-2", "--count", "1", "--format", "json"]);
    let heard = &objects(&echo.out)[0];
    assert_eq!((&heard["publisher"], &heard["message"]["number"]), (&"outside".into(), &7.into()));

    assert_eq!(run.interrupt().code, Some(130));
    assert!(!socket.exists(), "its socket is gone with it");
}

/// Each command is a new process, as from a shell; the fastest counts, since other tests run at the
/// same time.
#[test]
#[allow(clippy::disallowed_methods, reason = "how long a person waits is measured")]
fn answers_come_in_less_than_a_tenth_of_a_second() {
    let folder = folder();
    let run = play(folder.path());
    for question in [&["topic", "list"][..], &["topic", "info", "soccer/ball", "--host", "blue-2"]] {
        let quickest = (0..10).map(|_| {
            let start = std::time::Instant::now();
            assert_eq!(ask(folder.path(), question).code, Some(0));
            start.elapsed()
        });
        let quickest = quickest.min().expect("ten times");
        assert!(quickest < std::time::Duration::from_millis(100), "{question:?}: {quickest:?}");
    }
    assert_eq!(run.interrupt().code, Some(130));
}

#[test]
fn mistakes_are_answered_with_what_would_be_right() {
    let folder = folder();
    let ask = |arguments: &[&str]| ask(folder.path(), arguments);
    let no_run = ask(&["topic", "list"]);
    assert_eq!(no_run.code, Some(4));
    assert!(no_run.err.contains("start a run with `monas run`"), "{}", no_run.err);

    let _run = play(folder.path());
    let cases: [(&[&str], i32, &str); 7] = [
        (&["topic", "echo", "soccer/bal"], 1, "did you mean `soccer/ball`?"),
        (&["topic", "list", "--host", "blue-9"], 1, "there are `blue-1`"),
        (&["topic", "list", "--run", "gmae"], 4, "no run is named `gmae`; there are `game`"),
        (&["topic", "pub", "soccer/calibration", "{}"], 2, "select one with --host NAME"),
        (&["topic", "pub", "soccer/calibration", "{\"nubmer\": 1}", "--host", "blue-2"], 2, "nubmer"),
        (
            &["topic", "pub", "soccer/calibration", "{", "--host", "blue-2"],
            2,
            "is not a `monas.soccer.Calibration`",
        ),
        (&["topic", "info", "soccer/bal"], 1, "did you mean `soccer/ball`?"),
    ];
    for (arguments, code, part) in cases {
        let answer = ask(arguments);
        assert_eq!((answer.code, answer.out.as_str()), (Some(code), ""), "{arguments:?}: {}", answer.err);
        assert!(answer.err.contains(part), "{arguments:?}: {}", answer.err);
    }
}

#[test]
fn each_command_shows_an_example() {
    for command in ["list", "info", "echo", "hz", "bw", "delay", "pub"] {
        let help = monas(&["topic", command, "--help"]);
        assert!(help.out.contains(&format!("Example: monas topic {command}")), "{}", help.out);
    }
}

#[test]
fn the_shell_completes_topics_hosts_and_runs_that_are_there() {
    let folder = folder();
    let _run = play(folder.path());
    let complete = |words: &[&str]| {
        let line = [&["--", "monas"], words].concat();
        let answer = in_folder(folder.path(), &line).env("COMPLETE", "fish").output().expect("it starts");
        String::from_utf8(answer.stdout).expect("UTF-8")
    };
    let topics = complete(&["topic", "echo", "soccer/b"]);
    assert_eq!(topics.lines().collect::<Vec<_>>(), ["soccer/ball"]);
    assert!(complete(&["topic", "echo", "soccer/ball", "--host", "red"]).lines().any(|line| line == "red-3"));
    assert_eq!(complete(&["topic", "list", "--run", ""]), "game\n");
}

fn hash_of(text: &str) -> String {
    text.lines().find_map(|line| line.strip_prefix("hash: ")).expect("there is a hash").to_owned()
}

#[test]
fn looking_on_changes_nothing_and_what_is_published_is_recorded() {
    let folder = folder();
    let tape = folder.path().join("run.mcap").display().to_string();
    let recorded = ["--record", tape.as_str(), "--overwrite"];
    let arguments =
        [&["run", MATCH, "--for", "30s", "--seed", "7", "--control", "game"], &recorded[..]].concat();
    let alone = ask(folder.path(), &arguments);
    let mut watched = Running::start(folder.path(), &arguments, "control socket: ");
    let echo = ask(folder.path(), &["topic", "echo", "**", "--count", "500", "--format", "json"]);
    assert_eq!(objects(&echo.out).len(), 500, "{}", echo.err);
    let watched = watched.wait();
    assert_eq!(hash_of(&watched.out), hash_of(&alone.out), "watching a run changes nothing");

    let mut running = Running::start(folder.path(), &arguments, "control socket: ");
    let published =
        ask(folder.path(), &["topic", "pub", "soccer/calibration", "{\"number\": 77}", "--host", "red-1"]);
    assert_eq!(published.code, Some(0), "{}", published.err);
    let published = running.wait();
    assert_ne!(hash_of(&published.out), hash_of(&alone.out));
    let recording = monas_tape::read(&tape).expect("it was written");
    let messages = recording.messages().expect("it is a tape").map(|message| message.expect("it is whole"));
    let from_outside: Vec<_> = messages.filter(|message| message.channel.publisher == "outside").collect();
    assert_eq!(from_outside.len(), 1);
    assert_eq!((from_outside[0].channel.host.as_str(), from_outside[0].bytes), ("red-1", &[8, 77][..]));
}

#[test]
fn a_hostile_tool_does_no_harm() {
    let folder = folder();
    let _run = play(folder.path());
    let socket = folder.path().join("monas/game.sock");
    let connect = || UnixStream::connect(&socket).expect("the server accepts");

    // Malformed messages, and lengths beyond all limits.
    for bytes in [&[0xff; 64][..], &[4, 0, 0, 0, 1, 2, 3, 4], &u32::MAX.to_le_bytes(), &[0, 0, 0, 0]] {
        let mut tool = connect();
        tool.write_all(bytes).expect("it listens");
        tool.shutdown(std::net::Shutdown::Write).expect("it is there");
        let mut answer = Vec::new();
        tool.read_to_end(&mut answer).expect("it answers and leaves");
        assert!(!answer.is_empty(), "{bytes:?} is refused with a word");
    }

    // One client requests everything and reads nothing, others send nothing.
    let everything = [8, 0, 0, 0, 0x22, 6, 0x12, 2, b'*', b'*', 0x18, 1];
    let mut greedy = connect();
    greedy.write_all(&everything).expect("it listens");
    let _idle: Vec<UnixStream> = (0..10).map(|_| connect()).collect();
    let list = ["topic", "list", "soccer/ball", "--host", "blue-2"];
    let answer = ask(folder.path(), &list);
    assert_eq!(answer.code, Some(0), "{}", answer.err);

    // More clients than the limit: the last is refused at once.
    let mut many: Vec<UnixStream> = (0..=CLIENT_LIMIT).map(|_| connect()).collect();
    let mut answer = Vec::new();
    many[CLIENT_LIMIT].read_to_end(&mut answer).expect("it is answered and left");
    assert!(String::from_utf8_lossy(&answer).contains("look at this run already"), "{answer:?}");
}

#[test]
fn a_second_run_of_a_name_is_refused_one_that_was_killed_is_not_in_the_way() {
    let folder = folder();
    let arguments = ["run", MATCH, "--realtime", "--control", "game"];
    let first = play(folder.path());
    let second = ask(folder.path(), &arguments);
    assert_eq!(second.code, Some(1));
    let hint = "another run has this name; choose another one with --control, or stop that run";
    assert!(second.err.contains(hint), "{}", second.err);
    first.kill();
    assert!(folder.path().join("monas/game.sock").exists());
    assert_eq!(play(folder.path()).interrupt().code, Some(130));
}
