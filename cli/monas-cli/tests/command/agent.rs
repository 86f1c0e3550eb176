//! `monas agent` on a run.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::kit::{Answer, command, monas, root};
use crate::running::{Running, ask, objects};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Agents in real time, which run until an interrupt.
const AGENTS: &str = "<!-- kept -->\n<agent frequency=\"50\">\n  <name>Lights</name>\n  <activity>LedHandler</activity>\n</agent>\n\
    <agent><name>Mind</name><statechart>models/goalie.srm</statechart></agent>\n";

fn start(folder: &Path) -> Running {
    let file = folder.join("agents.xml");
    fs::write(&file, AGENTS.replace("models", &root().join("models").display().to_string())).expect("a file");
    let file = file.display().to_string();
    Running::start(folder, &["run", &file, "--control", "lab"], "control socket: ")
}

#[test]
fn a_session_with_a_run_in_real_time() {
    let folder = folder();
    let run = start(folder.path());
    let ask = |arguments: &[&str]| ask(folder.path(), &[&["agent"], arguments].concat());
    let done = |arguments: &[&str]| {
        let answer = ask(arguments);
        assert_eq!(answer.code, Some(0), "{arguments:?}: {}{}", answer.out, answer.err);
        answer.out
    };
    let list = done(&["list"]);
    for word in ["Lights", "Mind", "runs", "50"] {
        assert!(list.contains(word), "{list}");
    }
    assert!(done(&["pause", "Lights"]).starts_with("`Lights` pauses after its cycle "));
    assert!(done(&["step", "Lights"]).starts_with("`Lights` has completed its cycle "));
    assert!(done(&["resume", "Lights"]).starts_with("`Lights` resumes after its cycle "));
    done(&["add-activity", "Lights", "MotionController", "--at", "1"]);
    done(&["set", "Lights", "frequency=100", "on_failure=skip"]);
    done(&["stop", "Mind"]);
    done(&["start", "Mind"]);
    // The same role from another file: only the path says whether it was exchanged.
    let model = folder.path().join("goalie.srm").display().to_string();
    fs::copy(root().join("models/goalie.srm"), &model).expect("a copy");
    let model_of_mind =
        || objects(&done(&["list", "Mind", "--format", "json"]))[0]["charts"][0]["model"].clone();
    assert!(done(&["swap", "Mind", &model, "--dry-run"]).contains("could be changed"));
    assert_ne!(model_of_mind(), *model, "a dry run changes nothing");
    assert!(done(&["swap", "Mind", &model]).contains("is changed"));
    assert_eq!(model_of_mind(), *model);

    let lights = objects(&done(&["list", "Lights", "--format", "json"]));
    let names: Vec<&Value> =
        lights[0]["activities"].as_array().expect("a list").iter().map(|one| &one["name"]).collect();
    assert_eq!(names, ["MotionController", "LedHandler"]);
    assert_eq!((&lights[0]["frequency"], &lights[0]["on_failure"]), (&100.0.into(), &"skip".into()));

    let saved = folder.path().join("saved.xml").display().to_string();
    assert_eq!(done(&["save", &saved]), format!("saved to {saved}\n"));
    let text = fs::read_to_string(&saved).expect("it was written");
    let begin = "<!-- kept -->\n<agent frequency=\"100\" on_failure=\"skip\">\n  <name>Lights</name>\n  \
        <activity>MotionController</activity>\n  <activity>LedHandler</activity>\n</agent>\n";
    assert!(text.starts_with(begin), "{text}");
    assert_eq!(monas(&["config", "check", &saved]).code, Some(0));
    assert_eq!(run.interrupt().code, Some(130));
}

#[test]
fn a_swap_that_is_refused_says_how_states_are_mapped_and_a_signal_is_reported_in_the_exit_code() {
    let folder = folder();
    let run = start(folder.path());
    // Both answers are about the same moment.
    assert_eq!(ask(folder.path(), &["agent", "pause", "Mind"]).code, Some(0));
    let other = folder.path().join("other.srm").display().to_string();
    fs::write(&other, "Role: other\nLiveness:\nother = (SearchBall)~\n").expect("a file");
    let answer = ask(folder.path(), &["agent", "swap", "Mind", &other]);
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    assert!(answer.err.contains("E0356") && answer.err.contains("--state OLD=NEW"), "{}", answer.err);
    assert_eq!(answer.err.matches("--state").count(), 1, "{}", answer.err);
    let dry = ask(folder.path(), &["agent", "swap", "Mind", &other, "--dry-run"]);
    assert_eq!((dry.code, &dry.err), (answer.code, &answer.err), "a dry run gives the same reasons");
    assert_eq!(run.terminate().code, Some(143));
}

#[test]
fn without_a_folder_of_the_system_the_run_names_its_own_which_has_to_be_private() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let file = folder.path().join("agents.xml");
    fs::write(&file, AGENTS.replace("models", &root().join("models").display().to_string())).expect("a file");
    let file = file.display().to_string();
    let prepared = |arguments: &[&str]| {
        let mut command = command(arguments);
        command.env_remove("XDG_RUNTIME_DIR").env("TMPDIR", folder.path());
        command
    };
    let run = Running::of(&mut prepared(&["run", &file]), "control socket: ");
    // A relative path counts as none: other folders would have other runs.
    let mut relative = prepared(&["agent", "list"]);
    let list: Answer = relative.env("XDG_RUNTIME_DIR", "here").output().expect("it starts").into();
    assert_eq!(list.code, Some(0), "{}", list.err);
    assert!(list.out.contains("Lights"), "{}", list.out);
    assert_eq!(run.interrupt().code, Some(130));
    let entries = fs::read_dir(folder.path()).expect("it is there").flatten();
    let mut own = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with("monas-"));
    let own = own.next().expect("the folder of the sockets").path();
    fs::set_permissions(&own, fs::Permissions::from_mode(0o755)).expect("it is changed");
    let refused: Answer =
        prepared(&["run", &file, "--control", "lab", "--for", "1s"]).output().expect("it starts").into();
    assert_eq!(refused.code, Some(1), "{}", refused.err);
    assert!(refused.err.contains("open to other users (mode 755)"), "{}", refused.err);
}

#[test]
fn mistakes_are_answered_with_what_would_be_right() {
    let folder = folder();
    let _run = start(folder.path());
    let snippet = folder.path().join("extra.xml").display().to_string();
    fs::write(&snippet, "<agent frequency=\"10\">\n<name>x</name><activity>LedHandlr</activity></agent>")
        .expect("a file");
    let ask = |arguments: &[&str]| ask(folder.path(), &[&["agent"], arguments].concat());
    let cases: [(&[&str], i32, &str); 11] = [
        (&["stop", "Light"], 1, "no agent of `local` is named `Light`\n  help: did you mean `Lights`?"),
        (&["start", "Lights"], 1, "`Lights` has not stopped"),
        (&["set", "Lights", "frequency=1", "frequency=2"], 2, "`frequency` is given twice"),
        (&["set", "Lights", "frequency=fast"], 1, "`frequency` is `fast`, expected a number from"),
        (&["set", "Lights", "frequency"], 2, "`frequency` is not KEY=VALUE"),
        (
            &["add", &snippet],
            3,
            "extra.xml:2:25: error[E0312]: unknown activity `LedHandlr`\n  help: did you mean `LedHandler`?",
        ),
        (&["swap", "Mind", "nowhere", "--state", "A"], 2, "`A` is not OLD=NEW"),
        (&["swap", "Mind", "nowhere"], 1, "no generated statechart `nowhere` is registered"),
        (&["swap", "Mind", "models/golie.srm"], 3, "did you mean `models/goalie.srm`?"),
        (&["list", "Mnd"], 1, "no agent is named `Mnd`; did you mean `Mind`?"),
        (&["save", "there.toml"], 2, "the file must end with .xml"),
    ];
    for (arguments, code, part) in cases {
        let answer = ask(arguments);
        assert_eq!((answer.code, answer.out.as_str()), (Some(code), ""), "{arguments:?}: {}", answer.err);
        assert!(answer.err.contains(part), "{arguments:?}: {}", answer.err);
    }
}

#[test]
fn a_match_in_simulated_time_is_changed_by_host_and_looking_on_changes_nothing() {
    let folder = folder();
    let arguments = ["run", "config/match.xml", "--pace", "1", "--control", "game"];
    let run = Running::start(folder.path(), &arguments, "control socket: ");
    let ask = |arguments: &[&str]| ask(folder.path(), &[&["agent"], arguments].concat());
    let agents = objects(&ask(&["list", "--format", "json"]).out);
    assert!(agents.len() >= 6, "{agents:?}");
    let (host, agent) =
        (agents[0]["host"].as_str().expect("a name"), agents[0]["agent"].as_str().expect("a name"));
    let which = ask(&["pause", agent]);
    assert_eq!(which.code, Some(1));
    assert!(which.err.contains("there are several hosts: name one of "), "{}", which.err);
    assert_eq!(ask(&["pause", agent, "--host", host]).code, Some(0));
    let paused = objects(&ask(&["list", agent, "--host", host, "--format", "json"]).out);
    assert_eq!(paused[0]["state"], "pauses");
    let saved = ask(&["save", "--host", host]);
    let role = fs::read_to_string(root().join("config/roles/goalie.xml")).expect("it is there");
    assert!(saved.out == role || saved.out.contains("<statechart"), "{}", saved.out);
    assert_eq!(run.interrupt().code, Some(130));
}

#[test]
fn pause_step_and_resume_in_a_match_are_replayed() {
    for mode in [&["--realtime"][..], &["--pace", "1"], &[]] {
        let folder = folder();
        let tape = folder.path().join("live.mcap").display().to_string();
        let arguments = ["run", "config/match.xml", "--record", &tape, "--control", "game"];
        let run = Running::start(folder.path(), &[&arguments[..], mode].concat(), "control socket: ");
        let ask_host = |host: &str, command: &str, more: &[&str]| {
            let agent = ["agent", command, "Attacker", "--host", host];
            let answer = ask(folder.path(), &[&agent[..], more].concat());
            assert_eq!(answer.code, Some(0), "{mode:?}: {answer:?}");
            answer.out
        };
        let ask = |command: &str| ask_host("blue-2", command, &[]);
        let cycles_of = |host: &str| {
            let listed = ask_host(host, "list", &["--format", "json"]);
            objects(&listed)[0]["cycles"].as_u64().expect("a number")
        };
        let await_cycles = |host: &str, count: u64| {
            let before = cycles_of(host);
            let made = |_| cycles_of(host) >= before + count;
            assert!((0..1000).any(made), "{mode:?}: {host} makes no progress");
        };
        await_cycles("blue-2", 1);
        ask("pause");
        let paused = cycles_of("blue-2");
        // A step is made if one is due, so time passes first: a robot that is not paused shows it.
        for step in 0..3 {
            await_cycles("blue-3", 20);
            assert_eq!(cycles_of("blue-2"), paused + step, "{mode:?}");
            ask("step");
            assert_eq!(cycles_of("blue-2"), paused + step + 1, "{mode:?}: no step was made");
        }
        ask("resume");
        await_cycles("blue-2", 1);
        assert_eq!(run.interrupt().code, Some(130), "{mode:?}");
        let verified = monas(&["tape", "verify", &tape]);
        assert_eq!(verified.code, Some(0), "{mode:?}: {verified:?}");
        assert!(verified.out.contains(" 0 differences"), "{mode:?}: {verified:?}");
    }
}

#[test]
fn each_command_shows_an_example() {
    for command in [
        "list",
        "start",
        "stop",
        "pause",
        "resume",
        "step",
        "add",
        "remove",
        "add-activity",
        "remove-activity",
        "move-activity",
        "replace-activity",
        "set",
        "swap",
        "save",
    ] {
        let help = monas(&["agent", command, "--help"]);
        assert!(help.out.contains(&format!("Example: monas agent {command}")), "{}", help.out);
    }
}
