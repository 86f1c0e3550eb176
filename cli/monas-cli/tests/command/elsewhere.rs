//! One robot's Vision in a separate process, by configuration alone.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::copying::copy;
use crate::kit::{Answer, monas, root};
use crate::running::{Running, ask, objects};

/// The number of checks of a condition.
const CHECKS: usize = 100;

/// The project's configuration and models in a folder, with a referee that skips the phases before
/// play.
pub(crate) fn project(folder: &Path) {
    for part in ["config", "models"] {
        copy(&root().join(part), &folder.join(part));
    }
    let simulator = folder.join("config/simulator.xml");
    let mut text = fs::read_to_string(&simulator).expect("it is there");
    for phase in ["initial_duration", "ready_duration", "set_duration"] {
        let begin = text.find(&format!("<{phase}>")).expect("the referee has such a phase");
        let end = begin + text[begin..].find('\n').expect("a line ends");
        text.replace_range(begin..end, &format!("<{phase}>0.2</{phase}>"));
    }
    fs::write(simulator, text).expect("the folder takes files");
}

/// The first message of a topic of the robot for which a condition holds.
pub(crate) fn await_message(folder: &Path, topic: &str, holds: impl Fn(&Value) -> bool) -> Value {
    for _ in 0..CHECKS {
        let echo = [
            "topic", "echo", topic, "--run", "game", "--host", "blue-2", "--for", "300ms", "--format", "json",
        ];
        let answer = ask(folder, &echo);
        let heard = objects(&answer.out).into_iter().find(|heard| holds(&heard["message"]));
        if let Some(heard) = heard {
            return heard;
        }
    }
    panic!("it never came about on {topic}");
}

fn received<'a>(objects: &'a [Value], topic: &str) -> &'a Value {
    let found = objects.iter().find(|object| object["kind"] == "link_received" && object["topic"] == topic);
    found.unwrap_or_else(|| panic!("nothing of {topic} in {objects:?}"))
}

fn figures(answer: &Answer, topic: &str) -> Vec<u64> {
    let objects = objects(&answer.out);
    let received = received(&objects, topic);
    let names = ["arrived", "delivered", "duplicates", "late", "refused", "held", "gaps"];
    names.map(|name| received[name].as_u64().expect("a number")).to_vec()
}

#[test]
fn the_vision_of_a_robot_runs_in_a_second_process() {
    let folder = tempfile::tempdir().expect("a folder");
    project(folder.path());
    let config = |name: &str| folder.path().join("config/elsewhere").join(name).display().to_string();
    let (game, vision) = (config("match.xml"), config("vision.xml"));
    let ready = "control socket: ";
    let game = Running::start(
        folder.path(),
        &["run", &game, "--realtime", "--control", "game", "--format", "json"],
        ready,
    );
    let list = ["topic", "list", "soccer/ball", "--run", "game", "--host", "blue-2", "--format", "json"];
    assert_eq!(
        objects(&ask(folder.path(), &list).out)[0]["last"],
        Value::Null,
        "no robot sees the ball here"
    );

    let vision =
        Running::start(folder.path(), &["run", &vision, "--control", "vision", "--format", "json"], ready);
    let ball = await_message(folder.path(), "soccer/ball", |ball| ball["found"] == true);
    assert_eq!(ball["publisher"], "Attacker", "it is as if the robot's own agent had seen it");
    let motion = await_message(folder.path(), "soccer/motion", |motion| {
        motion["vx"].as_f64().is_some_and(|speed| speed > 0.05)
    });
    assert_eq!(motion["publisher"], "Attacker", "the player walks to the ball");

    let (vision, game) = (vision.interrupt(), game.interrupt());
    assert_eq!((vision.code, game.code), (Some(130), Some(130)), "{vision:?} {game:?}");
    for (answer, topic) in [(&game, "soccer/ball"), (&game, "soccer/robots"), (&vision, "body/sensors")] {
        assert_counted(answer, topic);
    }
}

#[test]
fn topics_are_inspected_and_published_over_a_link() {
    let folder = tempfile::tempdir().expect("a folder");
    project(folder.path());
    let game = folder.path().join("config/elsewhere/match.xml").display().to_string();
    let looker = folder.path().join("looker.xml");
    let text =
        "<agents><link name='looker'><receive topics='body/*'/><send topics='soccer/ball'/></link></agents>";
    fs::write(&looker, text).expect("the folder takes files");
    let looker = looker.display().to_string();
    let game =
        Running::start(folder.path(), &["run", &game, "--realtime", "--control", "game"], "control socket: ");
    let over =
        |arguments: &[&str]| ask(folder.path(), &[&["topic"], arguments, &["--link", &looker]].concat());

    let echo = over(&["echo", "body/sensors", "--count", "2", "--format", "json"]);
    let heard = objects(&echo.out);
    assert_eq!((echo.code, heard.len()), (Some(0), 2), "{}", echo.err);
    assert!(heard.iter().all(|seen| seen["from"] == "blue-2" && seen["message"].is_object()), "{heard:?}");
    // The list is of the moment: the first message may come after the peer.
    let mut lists = (0..CHECKS).map(|_| over(&["list", "body/sensors"]).out);
    assert!(lists.any(|list| list.contains("from blue-2")), "no message arrived in {CHECKS} lists");
    let mut details = (0..CHECKS).map(|_| over(&["info", "body/sensors"]).out);
    let received = details.find(|info| info.contains("received from other hosts: blue-2"));
    let received = received.expect("a message arrives in so many looks");
    assert!(!received.contains("nothing was published"), "{received}");

    let published = over(&["pub", "soccer/ball", "{\"found\": true}"]);
    assert_eq!(published.code, Some(0), "{}", published.err);
    let ball = await_message(folder.path(), "soccer/ball", |ball| ball["found"] == true);
    assert_eq!(ball["host"], "blue-2", "what the link brings is the robot's own");

    let unsent = over(&["pub", "soccer/pose", "{}"]);
    assert_eq!(unsent.code, Some(2));
    assert!(unsent.err.contains("`<send topics=\"soccer/pose\"/>`"), "{}", unsent.err);
    let both = over(&["list", "--run", "game"]);
    assert_eq!(both.code, Some(2), "{both:?}");
    let none = ask(folder.path(), &["topic", "list", "--link", "config/roles/goalie.xml"]);
    assert!(none.code == Some(2) && none.err.contains("has no `<link>`"), "{none:?}");
    assert_eq!(game.interrupt().code, Some(130));
}

/// Properties of messages that arrive over a link are checked on arrival.
#[test]
fn a_property_is_monitored_with_messages_of_another_process() {
    let folder = tempfile::tempdir().expect("a folder");
    project(folder.path());
    let role = folder.path().join("config/elsewhere/attacker.xml");
    let text = fs::read_to_string(&role).expect("it is there");
    let chart = "models/attacker.srm</statechart>";
    assert!(text.contains(chart));
    fs::write(
        &role,
        text.replace(chart, &format!("{chart}\n    <monitor>models/blind.properties</monitor>")),
    )
    .expect("the folder takes files");
    let blind = "property \"it is blind\": always not [Ball.found]\n";
    fs::write(folder.path().join("models/blind.properties"), blind).expect("the folder takes files");
    let config = |name: &str| folder.path().join("config/elsewhere").join(name).display().to_string();
    let (game, vision) = (config("match.xml"), config("vision.xml"));
    let ready = "control socket: ";
    let game = Running::start(
        folder.path(),
        &["run", &game, "--realtime", "--control", "game", "--format", "json"],
        ready,
    );
    let vision =
        Running::start(folder.path(), &["run", &vision, "--control", "vision", "--format", "json"], ready);
    let broken = |cycle: &Value| cycle["violations"].as_array().is_some_and(|it| !it.is_empty());
    let cycle = await_message(folder.path(), "monas/cycle", broken);
    assert_eq!(cycle["message"]["violations"][0]["property"], "it is blind", "{cycle}");
    assert_eq!((vision.interrupt().code, game.interrupt().code), (Some(130), Some(130)));
}

/// Messages of the topic have arrived, and the counters are consistent.
pub(crate) fn assert_counted(answer: &Answer, topic: &str) {
    let figures = figures(answer, topic);
    let [arrived, delivered, duplicates, late, refused, held, _gaps] = figures[..] else { panic!() };
    assert!(delivered > 0, "{topic}: {figures:?}");
    assert_eq!(arrived, delivered + duplicates + late + refused + held, "{topic}: {figures:?}");
    assert_eq!(refused, 0, "{topic}: {figures:?}");
}

#[test]
fn a_match_with_links_wants_real_time_and_a_process_wants_the_other() {
    let answer = monas(&["run", "config/elsewhere/match.xml", "--for", "1s"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.err.contains("add --realtime"), "{}", answer.err);
    for config in ["config/elsewhere/match.xml", "config/elsewhere/vision.xml"] {
        assert_eq!(monas(&["config", "check", config]).code, Some(0), "{config}");
    }
}
