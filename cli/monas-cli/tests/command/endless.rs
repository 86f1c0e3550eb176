//! Activities that do not return, and charts whose activities return without end.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::crashes::faulty;
use crate::kit::{Answer, monas, root};
use crate::running::{Running, ask};

/// The agents of a robot with the activities of the example `faulty`.
const FAULTY_AGENTS: &str = "<agent frequency=\"50\"><name>Head</name><activity>Faulty</activity></agent>\n";

/// Agents with a chart that loops without a wait.
const LOOPING_CHART: &str = "<agent><name>Mind</name><statechart>mind.srm</statechart></agent>\n";

/// A match in a folder: a robot of Blue with these agents, and one of Red with a list.
fn match_of(agents: &str, folder: &Path) -> PathBuf {
    let root = root();
    let game = format!(
        "<match field=\"{0}/config/fields/thesis.xml\" simulator=\"{0}/config/simulator.xml\" half=\"300s\">\n\
         <team number=\"1\" name=\"Blue\" colour=\"blue\" side=\"left\"><robot number=\"1\" role=\"blue.xml\"/></team>\n\
         <team number=\"2\" name=\"Red\" colour=\"red\" side=\"right\"><robot number=\"1\" role=\"red.xml\"/></team>\n\
         </match>\n",
        root.display()
    );
    let steady = "<agent frequency=\"50\"><name>Legs</name><activity>Steady</activity></agent>\n";
    for (file, text) in [
        ("blue.xml", format!("<agents>{agents}</agents>")),
        ("red.xml", format!("<agents>{steady}</agents>")),
        ("mind.srm", "mind = (Faulty . Steady)~\n".to_owned()),
        ("match.xml", game),
    ] {
        fs::write(folder.join(file), text).expect("a file");
    }
    folder.join("match.xml")
}

/// The example with arguments and a fault.
fn run(folder: &Path, config: &Path, more: &[&str], fault: &str) -> Command {
    let mut command = Command::new(faulty());
    command.arg("run").arg(config).args(more).env("FAULT", fault).env("XDG_RUNTIME_DIR", folder);
    command
}

#[test]
fn an_interrupted_match_whose_activity_does_not_return_ends_and_names_it() {
    for mode in [&[][..], &["--pace", "1"]] {
        let folder = tempfile::tempdir().expect("a folder");
        let config = match_of(FAULTY_AGENTS, folder.path());
        let tape = folder.path().join("hung.mcap").display().to_string();
        let more = [&["--no-control", "--record", &tape][..], mode].concat();
        let mut hung = Running::of(&mut run(folder.path(), &config, &more, "hang"), "");
        hung.await_line("the activity hangs");
        let answer = hung.interrupt();
        assert_eq!(answer.code, Some(1), "{mode:?}: {answer:?}");
        let expected =
            "activity `Faulty` of agent `Head` on `blue-1` has not returned from `execute` within 3.0 s";
        assert!(answer.err.contains(expected), "{mode:?}: {answer:?}");
        let exported = monas(&["tape", "export", &tape, "--topic", "monas/cycle", "--format", "jsonl"]);
        let cycles = exported.out.lines().filter(|line| line.contains("\"publisher\":\"Head\"")).count();
        assert_eq!((exported.code, cycles), (Some(0), 10), "{mode:?}: {exported:?}");
    }
}

#[test]
fn in_real_time_the_others_play_on_beside_an_activity_that_does_not_return() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = match_of(FAULTY_AGENTS, folder.path());
    let more = ["--realtime", "--for", "3s", "--no-control", "--format", "json"];
    let answer: Answer = run(folder.path(), &config, &more, "hang").output().expect("it starts").into();
    assert_eq!(answer.code, Some(1), "{answer:?}");
    let agents: Vec<Value> =
        answer.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let agent = |name: &str| agents.iter().find(|object| object["agent"] == name).expect("the agent");
    assert!(agent("Legs")["cycles"].as_u64() >= Some(140), "{answer:?}");
    let stopped = agent("Head")["stopped"].as_str().expect("a reason");
    assert!(stopped.contains("activity `Faulty` is stuck"), "{answer:?}");
}

#[test]
fn a_second_interrupt_ends_a_hung_match_at_once() {
    for mode in [&[][..], &["--pace", "1"]] {
        let folder = tempfile::tempdir().expect("a folder");
        let config = match_of(FAULTY_AGENTS, folder.path());
        let more = [&["--no-control"][..], mode].concat();
        let mut hung = Running::of(&mut run(folder.path(), &config, &more, "hang"), "");
        hung.await_line("the activity hangs");
        let answer = hung.interrupt_until_the_end();
        assert_eq!(answer.code, Some(130), "{mode:?}: {answer:?}");
        assert!(!answer.err.contains("has not returned from `execute` within"), "{mode:?}: {answer:?}");
    }
}

#[test]
fn a_loop_without_a_wait_is_reported_once_in_real_time() {
    let folder = tempfile::tempdir().expect("a folder");
    match_of(LOOPING_CHART, folder.path());
    let config = folder.path().join("blue.xml");
    let arguments = ["--control", "mind", "--for", "120s"];
    let mut mind = Running::of(&mut run(folder.path(), &config, &arguments, ""), "control socket: ");
    mind.await_line("`mind` loops without a wait: ");
    let shown = ask(folder.path(), &["top", "--every", "100ms"]);
    let rows = shown.out.lines().filter(|line| line.contains(" loops "));
    let names: Vec<bool> = rows.map(|row| row.contains("Faulty") || row.contains("Steady")).collect();
    assert_eq!(names, [true, true], "{shown:?}");
    let answer = mind.interrupt();
    assert_eq!(answer.code, Some(130), "{answer:?}");
    assert!(!answer.err.contains("loops without a wait"), "{answer:?}");

    let log = folder.path().join("run.log");
    let settings = folder.path().join("logger.toml").display().to_string();
    fs::write(&settings, format!("message_log_file = {:?}\n", log.display().to_string())).expect("a file");
    let arguments = ["--no-control", "--log", &settings, "--for", "3s"];
    let logged: Answer =
        run(folder.path(), &config, &arguments, "").output().expect("the command starts").into();
    assert_eq!(logged.code, Some(0), "{logged:?}");
    let log = fs::read_to_string(log).expect("a log");
    let reports: Vec<&str> = log.lines().filter(|line| line.contains("loops without a wait")).collect();
    let [report] = reports.as_slice() else { panic!("{reports:?}") };
    for part in ["/Faulty", "/Steady", "calls a second; let an activity return `Ongoing`", "Mind"] {
        assert!(report.contains(part), "{report}");
    }
}

#[test]
fn a_loop_without_a_wait_ends_its_agent_in_a_match() {
    for mode in [&[][..], &["--pace", "1"]] {
        let folder = tempfile::tempdir().expect("a folder");
        let config = match_of(LOOPING_CHART, folder.path());
        let more = [&["--no-control", "--for", "1s"][..], mode].concat();
        let answer: Answer =
            run(folder.path(), &config, &more, "").output().expect("the command starts").into();
        assert_eq!(answer.code, Some(1), "{mode:?}: {answer:?}");
        let stated = "Mind on blue-1 has stopped: `mind` loops without a wait: ";
        assert!(answer.out.contains(stated), "{mode:?}: {answer:?}");
        assert!(answer.out.contains("let an activity return `Ongoing`"), "{mode:?}: {answer:?}");
        assert_eq!(answer.err.matches("loops without a wait").count(), 1, "{mode:?}: {answer:?}");
        assert!(answer.out.contains("1.0 s of play"), "{mode:?}: {answer:?}");
    }
}
