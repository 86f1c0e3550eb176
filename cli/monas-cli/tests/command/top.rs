//! `monas top` on a run.

use std::fs;

use serde_json::Value;

use crate::running::{Running, ask, objects};

#[test]
fn top_reports_agents_and_their_rates() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("agents.xml");
    fs::write(&file, "<agent frequency=\"50\"><name>Lights</name><activity>LedHandler</activity></agent>")
        .expect("a file");
    let file = file.display().to_string();
    let run = Running::start(folder.path(), &["run", &file, "--control", "lab"], "control socket: ");
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
