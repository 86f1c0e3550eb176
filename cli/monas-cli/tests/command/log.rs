//! `monas run --log`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::kit::{Answer, command, monas, root};
#[cfg(unix)]
use crate::running::{Running, ask};

/// Plays a second with these log settings, in a folder.
fn run(folder: &Path, settings: &str) -> Answer {
    let file = folder.join("logger.xml");
    fs::write(&file, settings).expect("a file");
    let config = root().join("config/match.xml").display().to_string();
    let mut command = command(&["run", &config, "--for", "1s", "--log", &file.display().to_string()]);
    command.current_dir(folder).output().expect("the command starts").into()
}

#[test]
fn a_run_is_logged_as_configured() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = "<MessageLogFile>a.log</MessageLogFile><LogFileVerbosityLevel>4</LogFileVerbosityLevel>";
    let answer = run(folder.path(), settings);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let log = || fs::read_to_string(folder.path().join("a.log")).expect("a log");
    let first = log();
    for line in [
        "    0.500000 s DEBUG [blue-1 Goalie] no outgoing transition",
        "    1.000000 s INFO  [red-1 Goalie] stopped: the run has ended",
    ] {
        assert!(first.contains(line), "{first}");
    }
    assert_eq!(run(folder.path(), settings).code, Some(0));
    let simulated =
        |log: &str| log.lines().filter(|line| line.contains(" s ")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(simulated(&log()), simulated(&first), "the same run has the same lines");
    let answer =
        run(folder.path(), "<MessageLogCerr>1</MessageLogCerr><MessageLogFormat>json</MessageLogFormat>");
    assert_eq!(answer.code, Some(0), "{}", answer.err);
}

/// The log lines on a tape: level, name and message of each.
fn on_tape(tape: &str) -> Vec<(Value, String, String)> {
    let exported = monas(&["tape", "export", tape, "--topic", "monas/log", "--format", "jsonl"]);
    assert_eq!(exported.code, Some(0), "{exported:?}");
    let lines = exported.out.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    let texts = |line: &Value, field: &str| line["message"][field].as_str().unwrap_or_default().to_owned();
    lines
        .map(|line| (line["message"]["level"].clone(), texts(&line, "name"), texts(&line, "message")))
        .collect()
}

#[test]
fn lines_are_on_the_tape_between_the_messages_of_their_moment_and_what_is_replayed_is_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    let settings = at("logger.toml");
    fs::write(&settings, "log_file_verbosity_level = 4\n").expect("a file");
    let played = |tape: &str| {
        let answer = monas(&["run", "config/match.xml", "--for", "2s", "--log", &settings, "--record", tape]);
        assert_eq!(answer.code, Some(0), "{answer:?}");
        answer.out
    };
    let hash = |out: &str| out.lines().find(|line| line.starts_with("hash: ")).map(str::to_owned);
    let (one, two) = (at("one.mcap"), at("two.mcap"));
    let (first, second) = (played(&one), played(&two));
    assert!(fs::read(&one).expect("a tape") == fs::read(&two).expect("a tape"), "each time the same bytes");
    let quiet = monas(&["run", "config/match.xml", "--for", "2s"]);
    assert!(hash(&first).is_some() && hash(&first) == hash(&second));
    assert_eq!(hash(&quiet.out), hash(&first), "the run is the same whatever is logged");
    let lines = on_tape(&one);
    assert!(
        lines.iter().any(|(_, name, words)| name == "Goalie" && words.starts_with("no outgoing transition")),
        "{lines:?}"
    );
    let replayed = monas(&["tape", "replay", &one, "--verify"]);
    assert_eq!(replayed.code, Some(0), "{replayed:?}");

    let (live, config) = (at("live.mcap"), at("live.xml"));
    let agent = "<agent ThreadFrequency=\"100\" StatsCycle=\"5\"><name>Eyes</name><activity>Vision</activity></agent>";
    fs::write(&config, agent).expect("a file");
    let answer = monas(&["run", &config, "--for", "300ms", "--record", &live]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    let lines = on_tape(&live);
    assert!(
        lines.iter().any(|(_, name, words)| name == "Eyes" && words.starts_with("a cycle takes")),
        "{lines:?}"
    );
    assert!(!lines.iter().any(|(.., words)| words.contains("Some(")), "durations for people: {lines:?}");
    let replayed = monas(&["tape", "replay", &live, "--verify"]);
    assert_eq!(replayed.code, Some(0), "{replayed:?}");
}

#[test]
fn the_settings_that_are_shipped_show_robot_agent_activity_and_cycle_and_leave_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |file: &str| root().join(file).display().to_string();
    let mut command =
        command(&["run", &at("config/match.xml"), "--for", "60s", "--log", &at("config/logger.xml")]);
    let answer: Answer = command.current_dir(folder.path()).output().expect("it starts").into();
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let is_whole = |line: &&str| {
        line.contains(" INFO ")
            && line.contains("[blue-2 Attacker/")
            && line.contains(" #")
            && line.contains("motion=")
    };
    assert!(answer.err.lines().any(|line| is_whole(&line)), "{}", answer.err);
    assert_eq!(fs::read_dir(folder.path()).expect("it is there").count(), 0);
}

#[test]
fn configuration_errors_are_reported_before_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let answer =
        run(folder.path(), "<MessageLogFilter>all</MessageLogFilter>\n<MessageLogFyle>a</MessageLogFyle>");
    assert_eq!((answer.code, answer.out.as_str()), (Some(3), ""));
    assert!(answer.err.contains("logger.xml:2:2"), "{}", answer.err);
    assert!(answer.err.contains("did you mean `message_log_file`?"), "{}", answer.err);
    let answer = run(folder.path(), "<MessageLogFile>no/folder/a.log</MessageLogFile>");
    assert_eq!(answer.code, Some(1));
    assert!(answer.err.contains("logger.xml: "), "{}", answer.err);
}

#[test]
#[cfg(unix)]
fn agents_that_a_run_lacks_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["run", "config/match.xml", "--realtime", "--control", "game"];
    let run = Running::start(folder.path(), &arguments, "control socket: ");
    let ask = |more: &[&str]| ask(folder.path(), &[&["log", "--for", "10ms"], more].concat());
    let unknown = ask(&["--agent", "Goalie", "--agent", "Gaolie"]);
    assert_eq!((unknown.code, unknown.out.as_str()), (Some(2), ""));
    assert_eq!(unknown.err, "error: the run has no agent `Gaolie`; did you mean `Goalie`?\n");
    let unknown = ask(&["--robot", "blue-1", "--agent", "Referee"]);
    let known = "error: the run has no agent `Referee`; it has Attacker, Goalie, recording\n";
    assert_eq!((unknown.code, unknown.err.as_str()), (Some(2), known));
    for known in [&["--agent", "Goalie", "--robot", "blue-2"][..], &["--agent", "recording"]] {
        let answer = ask(known);
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""), "{known:?}");
    }
    assert_eq!(run.interrupt().code, Some(130));
}
