//! The same second process over zenoh, by configuration alone.

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};

use crate::elsewhere::{assert_counted, await_message, project};
use crate::kit::{monas, root};
use crate::running::{Running, ask, objects};

const TOLD: &str = "control socket: ";

/// The project, in which the link of the match has this instead of its name, and that of the vision.
fn linked(folder: &Path, game: &str, vision: &str) {
    project(folder);
    for (file, old, new) in [
        ("attacker.xml", "<link name=\"blue-2\">", game),
        ("vision.xml", "<link name=\"blue-2-vision\" clock=\"blue-2\">", vision),
    ] {
        let file = config(folder, file);
        let text = fs::read_to_string(&file).expect("it is there");
        assert!(text.contains(old), "{} has no {old}", file.display());
        fs::write(file, text.replace(old, new)).expect("the folder takes files");
    }
}

fn config(folder: &Path, file: &str) -> PathBuf {
    folder.join("config/elsewhere").join(file)
}

/// A free port of this computer.
fn port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("there is a free port");
    listener.local_addr().expect("it has an address").port()
}

fn start(folder: &Path, name: &str, file: &str, more: &[&str]) -> Running {
    let file = config(folder, file).display().to_string();
    let arguments = [&["run", &file, "--control", name, "--format", "json"], more].concat();
    Running::start(folder, &arguments, TOLD)
}

/// The number of the last message of a topic on the robot in a run, none if there is none.
fn last(folder: &Path, run: &str, topic: &str) -> Option<u64> {
    let host = if run == "game" { "blue-2" } else { "local" };
    let list = ["topic", "list", topic, "--run", run, "--host", host, "--format", "json"];
    let topics = objects(&ask(folder, &list).out);
    topics.iter().filter_map(|topic| topic["last"]["sequence"].as_u64()).max()
}

#[test]
fn the_vision_of_a_robot_is_reached_over_zenoh_and_comes_back_after_it_was_killed() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let port = port();
    linked(
        folder,
        &format!("<link name=\"blue-2\" transport=\"zenoh\"><listen>{port}</listen>"),
        &format!(
            "<link name=\"blue-2-vision\" clock=\"blue-2\" transport=\"zenoh\"><connect>tcp/127.0.0.1:{port}</connect>"
        ),
    );
    let game = start(folder, "game", "match.xml", &["--realtime"]);
    await_message(folder, "soccer/calibration", |_| true);
    assert_eq!(last(folder, "game", "soccer/ball"), None, "nobody sees the ball here");
    let mut got_what_was_said_before = false;
    for _ in 0..3 {
        let (calibrated, seen) =
            (last(folder, "game", "soccer/calibration"), last(folder, "game", "soccer/ball"));
        let vision = start(folder, "vision", "vision.xml", &[]);
        let ball = await_message(folder, "soccer/ball", |ball| {
            ball["found"] == true && last(folder, "game", "soccer/ball") > seen
        });
        assert_eq!(ball["publisher"], "Attacker");
        let state = last(folder, "vision", "soccer/calibration");
        // Unless the robot calibrates just now: who comes late gets the state.
        if last(folder, "game", "soccer/calibration") == calibrated {
            assert!(state.is_some(), "the state is not there");
            got_what_was_said_before = true;
        }
        vision.kill();
    }
    assert!(got_what_was_said_before, "the robot calibrates all the time");
    let vision = start(folder, "vision", "vision.xml", &[]);
    let seen = last(folder, "game", "soccer/ball");
    await_message(folder, "soccer/ball", |_| last(folder, "game", "soccer/ball") > seen);
    let (vision, game) = (vision.interrupt(), game.interrupt());
    assert_eq!((vision.code, game.code), (Some(130), Some(130)), "{vision:?} {game:?}");
    for (answer, topic) in
        [(&game, "soccer/ball"), (&vision, "body/sensors"), (&vision, "soccer/calibration")]
    {
        assert_counted(answer, topic);
    }
}

#[test]
fn certificates_and_an_access_list_are_those_of_the_configuration() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let port = port();
    let link = |name: &str, other: &str| {
        let tls = root().join("crates/monas-link/tests/zenoh/tls");
        let file = |name: &str| tls.join(name).display().to_string();
        let [authority, certificate, key] =
            [file("team.pem"), file(&format!("{name}.pem")), file(&format!("{name}.key"))];
        format!(
            "<link name=\"{name}\" transport=\"zenoh\" access=\"access.txt\"{other}
             <certificates authority=\"{authority}\" certificate=\"{certificate}\" key=\"{key}\"/>"
        )
    };
    linked(
        folder,
        &link("robot_1", &format!("><listen>tls/127.0.0.1:{port}</listen>")),
        &link("robot_2", &format!(" clock=\"robot_1\"><connect>tls/127.0.0.1:{port}</connect>")),
    );
    let access = "robot_1 publish **\nrobot_2 publish soccer/ball\nrobot_2 publish soccer/pose\n";
    fs::write(config(folder, "access.txt"), access).expect("the folder takes files");

    let game = start(folder, "game", "match.xml", &["--realtime"]);
    let vision = start(folder, "vision", "vision.xml", &[]);
    await_message(folder, "soccer/ball", |ball| ball["found"] == true);
    assert_eq!(
        last(folder, "game", "soccer/robots"),
        None,
        "the list does not let the vision say who is there"
    );
    let (vision, game) = (vision.interrupt(), game.interrupt());
    assert_counted(&game, "soccer/ball");
    assert_counted(&vision, "body/sensors");
}

#[test]
fn what_zenoh_cannot_use_is_said_before_it_is_opened() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let certificates =
        "<certificates authority=\"access.txt\" certificate=\"access.txt\" key=\"access.txt\"/>";
    linked(
        folder,
        &format!(
            "<link name=\"robot_1\" transport=\"zenoh\"><listen>tls/127.0.0.1:7447</listen>{certificates}"
        ),
        "<link name=\"robot_2\" clock=\"robot_1\" transport=\"zenoh\">",
    );
    fs::write(config(folder, "access.txt"), "").expect("the folder takes files");
    for (file, part) in
        [("match.xml", "holds no certificate in PEM"), ("vision.xml", "neither listens nor connects")]
    {
        let file = config(folder, file).display().to_string();
        for arguments in [&["config", "check", &file][..], &["run", &file]] {
            let answer = monas(arguments);
            assert_eq!(answer.code, Some(3), "{arguments:?}: {answer:?}");
            assert!(answer.err.contains(part), "{arguments:?}: no {part} in\n{}", answer.err);
        }
    }
}
