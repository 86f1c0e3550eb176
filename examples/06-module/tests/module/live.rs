//! Tests of modules in a run in real time, using the commands.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::built::{blind_eyes, eyes, sharp_eyes};
use crate::copying::copy;
use crate::kit::{Answer, root};
use crate::reading::read_in;
use crate::running::{Running, ask, objects};

/// A running robot, with sockets and its module's file in a folder.
struct Robot {
    folder: tempfile::TempDir,
    run: Running,
}

impl Robot {
    fn start() -> Robot {
        let folder = tempfile::tempdir().expect("a folder");
        let settings = "<MessageLogCerr>1</MessageLogCerr>\n<MessageLogFile>log.txt</MessageLogFile>\n";
        let log = folder.path().join("log.xml");
        let file = folder.path().join("log.txt").display().to_string();
        fs::write(&log, settings.replace("log.txt", &file)).expect("the folder takes files");
        let robot = folder.path().join("robot.xml");
        fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/robot.xml"), &robot).expect("the folder takes files");
        let (robot, log) = (robot.display().to_string(), log.display().to_string());
        let run =
            Running::start(folder.path(), &["run", &robot, "--log", &log, "--control", "lab"], "running, ");
        Robot { folder, run }
    }

    /// Replaces the robot's module.
    fn put(&self, module: &Path) -> String {
        let file = self.folder.path().join("eyes.so");
        // like cargo: a new file replaces the previous one
        let new = self.folder.path().join("eyes.new");
        fs::copy(module, &new).and_then(|_| fs::rename(&new, &file)).expect("the folder takes files");
        file.display().to_string()
    }

    fn ask(&self, arguments: &[&str]) -> Answer {
        ask(self.folder.path(), arguments)
    }

    fn done(&self, arguments: &[&str]) -> String {
        let answer = self.ask(arguments);
        assert_eq!(answer.code, Some(0), "{arguments:?}: {}{}", answer.out, answer.err);
        answer.out
    }

    fn refused(&self, arguments: &[&str], part: &str) {
        let answer = self.ask(arguments);
        assert_ne!(answer.code, Some(0), "{arguments:?}: {}{}", answer.out, answer.err);
        assert!(answer.err.contains(part), "{arguments:?}: `{part}` is not in {}", answer.err);
    }

    /// The distance of the ball in future messages; the first may be from before.
    fn distance(&self) -> f64 {
        let said =
            self.done(&["topic", "echo", "soccer/ball", "--count", "3", "--for", "30s", "--format", "json"]);
        let number = objects(&said).iter().rev().find_map(distance_in);
        number.unwrap_or_else(|| panic!("no distance in {said}"))
    }

    fn modules(&self) -> Vec<Value> {
        objects(&self.done(&["module", "list", "--format", "json"]))
    }
}

/// The distance in a message, independent of the nesting of its fields.
fn distance_in(said: &Value) -> Option<f64> {
    match said {
        Value::Object(fields) => {
            fields.get("distance").and_then(Value::as_f64).or_else(|| fields.values().find_map(distance_in))
        }
        _ => None,
    }
}

#[test]
fn the_chapter_on_modules() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy(eyes(), folder.path().join("eyes.so")).expect("it was built");
    read_in(folder, "modules.md", 11);
}

#[test]
fn the_session_with_a_match() {
    let folder = tempfile::tempdir().expect("a folder");
    for part in ["config", "models"] {
        copy(&root().join(part), &folder.path().join(part));
    }
    for (module, name) in [(eyes(), "eyes.so"), (sharp_eyes(), "sharp_eyes.so")] {
        fs::copy(module, folder.path().join(name)).expect("it was built");
    }
    read_in(folder, "session.md", 14);
}

/// A run is saved with its modules and can be run again.
#[test]
fn the_set_up_is_saved_with_its_modules() {
    let robot = Robot::start();
    let file = robot.put(&eyes());
    robot.done(&["module", "load", &file, "--agent", "Head"]);
    let saved = robot.done(&["agent", "save"]);
    let begin = format!("<module>{file}</module>\n<agent frequency=\"5\">");
    assert!(saved.starts_with(&begin) && saved.contains("<activity>Eyes</activity>"), "{saved}");
    let path = robot.folder.path().join("saved.xml").display().to_string();
    robot.done(&["agent", "save", &path]);
    robot.done(&["config", "check", &path]);
    robot.done(&["module", "unload", "eyes"]);
    assert!(!robot.done(&["agent", "save"]).contains("module"));
}

#[test]
fn a_files_description_is_available_as_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = eyes().display().to_string();
    let said = ask(folder.path(), &["module", "show", &file, "--format", "json"]);
    let said = &objects(&said.out)[0];
    assert_eq!((&said["module"], &said["fits"]), (&"eyes".into(), &true.into()));
    assert_eq!(said["package"], format!("example-module {}", env!("CARGO_PKG_VERSION")));
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/robot.xml");
    let wrong = ask(folder.path(), &["module", "show", file]);
    assert_eq!(wrong.code, Some(3));
    assert!(
        wrong.err.contains("E0360") && wrong.err.contains("this is not a module of Monas"),
        "{}",
        wrong.err
    );
}

#[test]
fn a_module_comes_changes_and_goes_while_the_robot_runs() {
    let robot = Robot::start();
    let file = robot.put(&eyes());
    let loaded = robot.done(&["module", "load", &file, "--agent", "Head"]);
    assert!(
        loaded.starts_with("module `eyes` is loaded, `Head` has its activities after its cycle "),
        "{loaded}"
    );
    assert_eq!(robot.distance(), 2.0);
    let module = &robot.modules()[0];
    assert_eq!((&module["module"], &module["file"]), (&"eyes".into(), &file.as_str().into()));
    assert_eq!((&module["activities"], &module["agents"]), (&["Eyes"].into(), &["Head"].into()));

    robot.put(&sharp_eyes());
    assert_eq!(robot.done(&["module", "reload", "eyes"]), "module `eyes` is reloaded\n");
    assert_eq!(robot.distance(), 1.0);

    robot.put(&blind_eyes());
    robot.refused(&["module", "reload", "eyes"], "cannot be made: panicked: no lens");
    assert_eq!(robot.distance(), 1.0, "the old one goes on");

    robot.done(&["module", "unload", "eyes"]);
    assert_eq!(robot.modules(), [Value::Null; 0]);
    let head = objects(&robot.done(&["agent", "list", "Head", "--format", "json"]));
    assert_eq!(head[0]["activities"].as_array().map(Vec::len), Some(1), "{head:?}");
    robot.refused(&["agent", "add-activity", "Head", "Eyes"], "unknown activity `Eyes`");

    let log = robot.folder.path().join("log.txt");
    assert_eq!(robot.run.interrupt().code, Some(130));
    let log = fs::read_to_string(log).expect("a log");
    assert!(log.contains("[local Head/Eyes #") && log.contains("eyes open range=4.0"), "{log}");
    assert!(log.contains("WARN") && log.contains("sharp"), "{log}");
}

/// The tape contains changes of modules, and a replay repeats them.
#[test]
fn a_run_with_modules_is_replayed() {
    let folder = tempfile::tempdir().expect("a folder");
    let [robot, tape] = ["robot.xml", "run.mcap"].map(|name| folder.path().join(name).display().to_string());
    fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/robot.xml"), &robot).expect("the folder takes files");
    let modules = [("eyes.so", eyes()), ("sharp.so", sharp_eyes())];
    let [eyes, sharp] = modules.map(|(name, built)| {
        let file = folder.path().join(name);
        fs::copy(built, &file).expect("it was built");
        file.display().to_string()
    });
    let arguments = ["run", robot.as_str(), "--record", &tape, "--control", "lab"];
    let run = Running::start(folder.path(), &arguments, "running, ");
    let done = |arguments: &[&str]| {
        let answer = ask(folder.path(), arguments);
        assert_eq!(answer.code, Some(0), "{arguments:?}: {}{}", answer.out, answer.err);
        answer.out
    };
    done(&["module", "load", &eyes]);
    done(&["agent", "add-activity", "Head", "Eyes", "range=1.5"]);
    done(&["topic", "echo", "soccer/ball", "--count", "3", "--for", "30s"]);
    done(&["module", "reload", "eyes"]);
    done(&["module", "reload", "eyes", &sharp]);
    done(&["topic", "echo", "soccer/ball", "--count", "3", "--for", "30s"]);
    done(&["module", "unload", "eyes"]);
    assert_eq!(run.interrupt().code, Some(130));
    let replayed = ask(folder.path(), &["tape", "replay", &tape]);
    assert_eq!(replayed.code, Some(0), "{}{}", replayed.out, replayed.err);
    assert!(replayed.out.contains(" messages compared, 0 differences"), "{}", replayed.out);
    // The file of the recorded module has changed since.
    fs::copy(&sharp, &eyes).expect("the folder takes files");
    let other = ask(folder.path(), &["tape", "replay", &tape]);
    assert_ne!(other.code, Some(0), "{}", other.out);
    assert!(other.err.contains("is not the requested file"), "{}{}", other.out, other.err);
}
