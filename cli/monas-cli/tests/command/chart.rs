//! `monas chart` on a run.

use std::fs;

use crate::kit::monas;
use crate::running::{Running, ask, objects};

/// A lamp that a button switches on and a timer switches off after a minute.
const LAMP: &str = "Role: lamp\nLiveness:\nlamp = (LedHandler . MotionController)~\nTransitions:\n\
    LedHandler -> MotionController : button / StartTimeout(enough, 60s)\nMotionController -> END : enough\n";

#[test]
fn a_chart_is_inspected_and_a_raised_event_is_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    fs::write(folder.path().join("lamp.srm"), LAMP).expect("a file");
    let agents = "<agent><name>Light</name><statechart>lamp.srm</statechart></agent>";
    fs::write(folder.path().join("agents.xml"), agents).expect("a file");
    let (file, tape) = (path("agents.xml"), path("run.mcap"));
    let run = Running::start(
        folder.path(),
        &["run", &file, "--control", "lab", "--record", &tape],
        "control socket: ",
    );
    let chart = |arguments: &[&str]| ask(folder.path(), &[&["chart"], arguments].concat());
    let shown = || {
        let answer = chart(&["show", "Light"]);
        assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
        answer.out
    };
    // On a busy machine the agent may not have run yet.
    let is_on = |word: &str| (0..200).map(|_| shown()).find(|shown| shown.contains(word));
    assert!(is_on("LedHandler: LedHandler is done").is_some(), "{}", shown());
    let answer = chart(&["raise", "Light", "buton"]);
    assert_eq!(answer.code, Some(1));
    assert!(
        answer.err.contains("error[E0366]") && answer.err.contains("did you mean `button`?"),
        "{}",
        answer.err
    );
    let answer = chart(&["raise", "Light", "button"]);
    assert_eq!((answer.code, answer.out.as_str()), (Some(0), "`button` is raised in `Light`\n"));
    let on = is_on("MotionController: MotionController").expect("it is lit");
    assert!(on.starts_with("lamp (lamp.srm) of Light on local: runs, last step at "), "{on}");
    assert!(on.contains("  timer enough of "), "{on}");
    let drawing = path("light.svg");
    let answer = chart(&["show", "Light", "--chart", "1", "-o", &drawing, "--format", "json"]);
    let object = objects(&answer.out).remove(0);
    assert_eq!((&object["agent"], &object["state"]), (&"Light".into(), &"runs".into()));
    assert_eq!(object["snapshot"]["timers"][0]["timer"]["name"], "enough");
    let drawn = fs::read_to_string(&drawing).expect("it was drawn");
    assert!(drawn.starts_with("<svg") && drawn.contains("active"), "{drawn}");
    let answer = chart(&["show", "Light", "-o", "-"]);
    assert!(answer.code == Some(2) && answer.err.contains("name a file"), "{answer:?}");
    let answer = chart(&["show", "Dark"]);
    assert_eq!(answer.code, Some(1));
    assert!(answer.err.contains("no agent is named `Dark`"), "{}", answer.err);
    let answer = chart(&["show", "Dark", "--host", "local"]);
    assert!(answer.err.contains("no agent is named `Dark` on `local`"), "{}", answer.err);
    let answer = chart(&["show", "Ligth"]);
    assert!(answer.err.contains("no agent is named `Ligth`; did you mean `Light`?"), "{}", answer.err);
    assert_eq!(run.interrupt().code, Some(130));
    // The event is on the tape, and the replay is equal.
    let answer = monas(&["tape", "verify", &tape]);
    assert_eq!(answer.code, Some(0), "{}{}", answer.out, answer.err);
    let changes = monas(&["tape", "export", &tape, "--topic", "monas/change"]);
    assert!(changes.out.contains("\"button\""), "{}", changes.out);
}
