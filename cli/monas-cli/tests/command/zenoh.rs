//! The same second process over zenoh, by configuration alone.

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};

use crate::elsewhere::{assert_counted, await_message, project};
use crate::kit::{monas, root};
use crate::running::{Running, ask, objects};

const READY: &str = "control socket: ";

/// The project with other contents of the links of match and vision.
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
    Running::start(folder, &arguments, READY)
}

/// The sequence number of the last message of a topic on the robot in a run, if any.
fn last(folder: &Path, run: &str, topic: &str) -> Option<u64> {
    let host = if run == "game" { "blue-2" } else { "local" };
    let list = ["topic", "list", topic, "--run", run, "--host", host, "--format", "json"];
    let topics = objects(&ask(folder, &list).out);
    topics.iter().filter_map(|topic| topic["last"]["sequence"].as_u64()).max()
}

#[test]
fn the_vision_of_a_robot_is_reached_over_zenoh_and_reconnects_after_a_kill() {
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
    assert_eq!(last(folder, "game", "soccer/ball"), None, "no robot sees the ball here");
    let looker = folder.join("looker.xml");
    let link = format!("<link name='looker' transport='zenoh'><connect>tcp/127.0.0.1:{port}</connect>");
    let text = format!("<agents>{link}<receive topics='body/*'/></link></agents>");
    fs::write(&looker, text).expect("the folder takes files");
    let looker = looker.display().to_string();
    let echo = ["topic", "echo", "body/sensors", "--count", "1", "--link", &looker, "--format", "json"];
    let looked = ask(folder, &echo);
    assert_eq!(objects(&looked.out)[0]["from"], "blue-2", "{}", looked.err);
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
        // Unless the robot calibrates at this moment: a late reader gets the state.
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
        let tls = root().join("messages/monas-link/tests/zenoh/tls");
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
fn invalid_zenoh_settings_are_reported_before_opening() {
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

/// Agents with a link that presents a certificate: its topics, access list and endpoint.
fn with_certificate(folder: &Path, file: &str, name: &str, certificate: &str, link: &str) -> String {
    let tls = root().join("messages/monas-link/tests/zenoh/tls");
    let path = |name: &str| tls.join(name).display().to_string();
    let [authority, certificate, key] =
        [path("team.pem"), path(&format!("{certificate}.pem")), path(&format!("{certificate}.key"))];
    let text = format!(
        "<link name=\"{name}\" transport=\"zenoh\" access=\"access.txt\">{link}
           <certificates authority=\"{authority}\" certificate=\"{certificate}\" key=\"{key}\"/></link>
         <agent frequency=\"50\"><name>Lights</name><activity>LedHandler</activity></agent>
         <agent frequency=\"50\"><name>Mind</name><activity>LedHandler</activity></agent>"
    );
    let file = folder.join(file);
    fs::write(&file, text).expect("the folder takes files");
    file.display().to_string()
}

/// Whether an agent of a run is in a state.
fn stands(folder: &Path, run: &str, agent: &str, state: &str) -> bool {
    let agents = objects(&ask(folder, &["agent", "list", agent, "--run", run, "--format", "json"]).out);
    agents.iter().any(|one| one["state"] == state)
}

#[test]
fn agents_are_changed_over_zenoh_only_with_access_and_certificate() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let access = "robot_1 publish monas/changed\nrobot_2 publish monas/change\nrobot_2 manage\nlaptop publish soccer/**\n";
    fs::write(folder.join("access.txt"), access).expect("the folder takes files");
    let port = port();
    let taking = format!(
        "<receive topics=\"monas/change\" as=\"own\"/><send topics=\"monas/changed\"/><listen>tls/127.0.0.1:{port}</listen>"
    );
    let asking = format!(
        "<send topics=\"monas/change\"/><receive topics=\"monas/changed\"/><connect>tls/127.0.0.1:{port}</connect>"
    );
    let start = |run: &str, name: &str, certificate: &str, link: &str| {
        let file = with_certificate(folder, &format!("{run}.xml"), name, certificate, link);
        let tape = folder.join(format!("{run}.mcap")).display().to_string();
        Running::start(
            folder,
            &["run", &file, "--control", run, "--format", "json", "--record", &tape],
            READY,
        )
    };
    // A peer whose certificate lacks the right, one that uses the name of a peer with the right,
    // and one of another team.
    let robot = start("robot", "robot_1", "robot_1", &taking);
    let manager = start("manager", "robot_2", "robot_2", &asking);
    let others =
        [("laptop", "laptop", "laptop"), ("liar", "robot_2", "laptop"), ("stranger", "robot_2", "stranger")];
    let others = others.map(|(run, name, certificate)| (run, start(run, name, certificate, &asking)));
    let publish = |run: &str, number: u64, action: &str, agent: &str| {
        let change = format!("{{\"number\": {number}, \"action\": \"{action}\", \"agent\": \"{agent}\"}}");
        let answer = ask(folder, &["topic", "pub", "monas/change", &change, "--run", run]);
        assert_eq!(answer.code, Some(0), "{}", answer.err);
    };
    let has_heard = |run: &str| {
        let list = ["topic", "list", "monas/changed", "--run", run, "--format", "json"];
        objects(&ask(folder, &list).out).iter().any(|topic| topic["from"] == serde_json::json!(["robot_1"]))
    };
    let await_that = |what: &str, holds: &dyn Fn() -> bool| {
        assert!((0..400).any(|_| holds()), "{what} never came about");
    };
    await_that("that all who may listen do", &|| {
        publish("manager", 1, "PAUSE_AGENT", "Unknown");
        ["manager", "laptop", "liar"].iter().all(|run| has_heard(run))
    });
    for (run, _) in &others {
        publish(run, 66, "STOP_AGENT", "Mind");
    }
    // Their messages were sent before they ended.
    for (run, other) in others {
        let said = objects(&other.interrupt().out);
        let sent = said.iter().find(|one| one["kind"] == "link_sent").expect("it sends changes");
        assert_eq!((&sent["topic"], &sent["sent"]), (&"monas/change".into(), &1.into()), "{run}");
        let has_heard = said.iter().any(|one| one["kind"] == "link_received");
        assert_eq!(has_heard, run != "stranger", "{run}: {said:?}");
    }
    publish("manager", 7, "PAUSE_AGENT", "Lights");
    await_that("the pause", &|| stands(folder, "robot", "Lights", "pauses"));
    assert!(stands(folder, "robot", "Mind", "runs"), "an unauthorized change was made");
    publish("manager", 8, "STOP_AGENT", "Mind");
    await_that("the same of one who may", &|| stands(folder, "robot", "Mind", "stopped"));
    assert_eq!(manager.interrupt().code, Some(130));
    assert_eq!(robot.interrupt().code, Some(130));
    let tape = folder.join("robot.mcap").display().to_string();
    let exported = monas(&["tape", "export", &tape, "--topic", "monas/change"]);
    let numbers = objects(&exported.out).into_iter().map(|one| one["message"]["number"].clone());
    let asked: Vec<serde_json::Value> = numbers.filter(|number| *number != 1).collect();
    assert_eq!(asked, [7, 8], "{}", exported.out);
}
