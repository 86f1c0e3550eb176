//! `monas top` on a run.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::kit::in_terminal;
use crate::running::{Running, ask, objects};

/// A run with one agent, whose files are in a folder.
fn lights(folder: &Path) -> Running {
    let file = folder.join("agents.xml");
    fs::write(&file, "<agent frequency=\"50\"><name>Lights</name><activity>LedHandler</activity></agent>")
        .expect("a file");
    let file = file.display().to_string();
    Running::start(folder, &["run", &file, "--control", "lab"], "control socket: ")
}

#[test]
fn top_reports_agents_and_their_rates() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = lights(folder.path());
    let look = || {
        let answer = ask(folder.path(), &["top", "--every", "300ms", "--format", "json"]);
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
        objects(&answer.out).into_iter().find(|object| object["agent"] == "Lights").expect("the agent")
    };
    // On a busy machine the agent may not have run yet.
    let runs = |lights: &Value| lights["hz"].as_f64().is_some_and(|hz| hz > 0.0);
    let lights = (0..50).map(|_| look()).find(runs).expect("it runs");
    assert_eq!((&lights["frequency"], &lights["state"]), (&50.0.into(), &"runs".into()));
    assert!(lights["core"].as_f64().is_some_and(|core| core > 0.0), "{lights}");
    assert_eq!(lights["activities"][0]["name"], "LedHandler");
    let answer = ask(folder.path(), &["top", "--every", "10ms"]);
    for word in ["Lights", "LedHandler", "calls/s", "overruns"] {
        assert!(answer.out.contains(word), "{}", answer.out);
    }
    assert_eq!(ask(folder.path(), &["top", "--run", "other"]).code, Some(4));
    assert_eq!(run.interrupt().code, Some(130));
}

#[test]
fn a_match_at_the_pace_of_real_time_is_measured_and_stays_the_same_match() {
    let folder = tempfile::tempdir().expect("a folder");
    let game = ["run", "config/match.xml", "--pace", "1", "--control", "game"];
    let run = Running::start(folder.path(), &game, "control socket: ");
    let look = |more: &[&str]| {
        let top = ["top", "--every", "300ms", "--host", "blue-2"];
        let answer = ask(folder.path(), &[&top[..], more].concat());
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
        answer.out
    };
    let attacker = || {
        let shown = objects(&look(&["--format", "json"]));
        shown.into_iter().find(|object| object["agent"] == "Attacker").expect("the agent")
    };
    let is_busy = |agent: &Value| agent["core"].as_f64().is_some_and(|core| core > 0.0);
    let attacker = (0..50).map(|_| attacker()).find(is_busy).expect("it is measured");
    let activities = attacker["activities"].as_array().expect("a list");
    let is_measured = |one: &&Value| one["core"].is_number() && one["held_bytes"].is_number();
    assert!(activities.iter().any(|one| is_measured(&one)), "{attacker}");
    let text = look(&[]);
    let row = text.lines().find(|line| line.starts_with("blue-2") && line.contains("Attacker"));
    let row = row.unwrap_or_else(|| panic!("{text}"));
    assert!(row.contains(" %") && row.matches(" ms").count() == 2, "{text}");
    assert_eq!(run.interrupt().code, Some(130));

    let hash = |mode: &[&str]| {
        let answer = ask(folder.path(), &[&["run", "config/match.xml", "--for", "500ms"], mode].concat());
        answer.out.lines().find(|line| line.starts_with("hash: ")).expect("a hash").to_owned()
    };
    assert_eq!(hash(&["--pace", "1"]), hash(&[]));
}

#[test]
fn a_signal_ends_top_and_restores_the_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = lights(folder.path());
    assert_eq!(ask(folder.path(), &["agent", "list"]).code, Some(0));
    let mut python = in_terminal("\u{1b}[?1049h", "send SIGTERM");
    python.args(["top", "--every", "1h"]).env("XDG_RUNTIME_DIR", folder.path()).env("TERM", "xterm");
    let Ok(output) = python.output() else {
        println!("SKIPPED: Python is not there, so that there is no terminal");
        return;
    };
    let (text, problems) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(text.starts_with("0 True\n") && text.contains("\u{1b}[?1049l"), "{text}{problems}");
    assert_eq!(run.interrupt().code, Some(130));
}
