//! Changes of a real run by viewers that are allowed to, and refusals for others.

use std::path::PathBuf;
use std::time::Duration;

use monas::{Agent, Blackboard, Hz, RealTimeRun, Talws};
use monas_link::control::ControlServer;
use monas_studio::{Studio, StudioSettings};
use serde_json::{Value, json};

use crate::kit::{Viewer, address, chart, exchange};

fn blink(_: &mut Blackboard) {}

/// A run of a list and of a chart, in real time.
struct Lamps {
    folder: tempfile::TempDir,
    _run: RealTimeRun,
    _server: ControlServer,
}

impl Lamps {
    fn start() -> Lamps {
        let folder = tempfile::tempdir().unwrap();
        let lamp = chart("", "switch", "switch");
        let run = Talws::new()
            .agent(Agent::new("Blinker", Hz(100)).activity(blink))
            .agent(Agent::statechart("Lamp", lamp))
            .start()
            .unwrap();
        let target = std::sync::Arc::new(run.run_handle());
        let server = ControlServer::start(&folder.path().join("monas"), "run", target).unwrap();
        Lamps { folder, _run: run, _server: server }
    }

    fn socket(&self) -> PathBuf {
        self.folder.path().join("monas/run.sock")
    }

    fn studio(&self, allows_control: bool) -> Studio {
        let listen = Some("127.0.0.1:0".parse().unwrap());
        let settings = StudioSettings { listen, allows_control, ..StudioSettings::default() };
        Studio::of_run(&self.socket(), settings).unwrap()
    }
}

fn ask(viewer: &mut Viewer, mut request: Value) -> Value {
    request["id"] = json!(71);
    viewer.send(request);
    viewer.wait(|message| (message["type"] == "reply" && message["id"] == 71).then(|| message.clone()))
}

fn change(action: Value) -> Value {
    let mut request = json!({"type": "change", "host": "local", "agent": "Blinker"});
    request.as_object_mut().unwrap().extend(action.as_object().unwrap().clone());
    request
}

/// State and cycles of the agent, once its state is this.
fn cycles(viewer: &mut Viewer, state: &str) -> u64 {
    viewer.wait(|message| {
        let agents = message["agents"].as_array()?;
        let agent = agents.iter().find(|agent| agent["name"] == "Blinker" && agent["state"] == state)?;
        agent["cycles"].as_u64()
    })
}

#[test]
fn agents_are_paused_stepped_and_changed() {
    let run = Lamps::start();
    let studio = run.studio(true);
    let mut viewer = Viewer::open(&studio).unwrap();
    assert_eq!(viewer.wait_for_link("live")["control"], json!(true));
    let reply = ask(&mut viewer, change(json!({"action": "pause"})));
    assert_eq!(reply["done"], true, "{reply}");
    let before = cycles(&mut viewer, "pauses");
    let reply = ask(&mut viewer, change(json!({"action": "step"})));
    assert_eq!((&reply["done"], reply["cycle"].as_u64()), (&json!(true), Some(before + 1)), "{reply}");
    let after = viewer.wait(|message| {
        let agent = message["agents"].as_array()?.iter().find(|agent| agent["name"] == "Blinker")?.clone();
        agent["cycles"].as_u64().filter(|cycles| *cycles > before)
    });
    assert_eq!(after, before + 1);
    assert_eq!(ask(&mut viewer, change(json!({"action": "resume"})))["done"], true);
    assert!(cycles(&mut viewer, "runs") > after);
    // a setting, and one that is wrong
    assert_eq!(
        ask(&mut viewer, change(json!({"action": "set", "settings": {"frequency": "20"}})))["done"],
        true
    );
    viewer.wait(|message| {
        let agent = message["agents"].as_array()?.iter().find(|agent| agent["name"] == "Blinker")?.clone();
        (agent["frequency"] == 20.0).then_some(())
    });
    let wrong = ask(&mut viewer, change(json!({"action": "set", "settings": {"frequency": "often"}})));
    assert_eq!(wrong["done"], false);
    assert!(!wrong["findings"][0]["text"].as_str().unwrap().is_empty(), "{wrong}");
    let unknown = ask(&mut viewer, change(json!({"action": "pause", "agent": "Blinkr"})));
    assert!(unknown["findings"][0]["text"].as_str().unwrap().contains("Blinkr"), "{unknown}");
    let unread = ask(&mut viewer, change(json!({"action": "pause", "hard": true})));
    assert!(unread["reason"].as_str().unwrap().contains("`hard`"), "{unread}");
}

#[test]
fn events_are_raised_in_a_chart() {
    let run = Lamps::start();
    let studio = run.studio(true);
    let mut viewer = Viewer::open(&studio).unwrap();
    let active = |message: &Value| {
        let chart = message["charts"].as_array()?.iter().find(|chart| chart["agent"] == "Lamp")?.clone();
        chart["active"].as_array().cloned()
    };
    viewer.wait(|message| active(message).filter(|active| active.contains(&json!(2))));
    viewer.send(json!({"type": "picture", "key": "local/Lamp/0"}));
    let picture = viewer.wait(|message| message.get("picture").cloned());
    assert_eq!(picture["events"], json!(["switch"]));
    let raise = |event: &str| json!({"type": "change", "host": "local", "agent": "Lamp", "action": "raise", "event": event, "chart": "1"});
    assert_eq!(ask(&mut viewer, raise("switch"))["done"], true);
    viewer.wait(|message| active(message).filter(|active| active.contains(&json!(3))));
    let refused = ask(&mut viewer, raise("explode"));
    assert_eq!(refused["done"], false);
    assert!(refused["findings"][0]["text"].as_str().unwrap().contains("explode"), "{refused}");
}

#[test]
fn messages_are_published_by_the_form_of_their_type() {
    let run = Lamps::start();
    let studio = run.studio(true);
    let mut viewer = Viewer::open(&studio).unwrap();
    viewer.wait_for_link("live");
    let form = ask(&mut viewer, json!({"type": "form", "topic": "test/note"}));
    assert_eq!(form["message_type"], "foxglove.Log");
    let fields = form["fields"].as_array().unwrap();
    let field = |name: &str| fields.iter().find(|field| field["name"] == name).unwrap();
    assert_eq!((&field("message")["kind"], &field("line")["kind"]), (&json!("text"), &json!("integer")));
    assert_eq!(field("level")["values"][2], "INFO");
    assert_eq!(field("timestamp")["kind"], "json");

    viewer.send(json!({"type": "watch", "host": "local", "topic": "test/note"}));
    let publish = |message: Value| json!({"type": "publish", "host": "local", "topic": "test/note", "message": message});
    let reply = ask(&mut viewer, publish(json!({"message": "by hand", "level": "INFO", "line": "7"})));
    assert_eq!(reply["done"], true, "{reply}");
    let sample = viewer.wait(|message| message.get("sample").cloned());
    assert_eq!((&sample["message"]["message"], &sample["message"]["line"]), (&json!("by hand"), &json!(7)));
    assert_eq!(sample["publisher"], "outside");
    for (wrong, word) in [
        (publish(json!({"massage": "x"})), "massage"),
        (publish(json!({"line": "seven"})), "foxglove.Log"),
        (json!({"type": "publish", "host": "local", "topic": "no/such", "message": {}}), "no/such"),
        (json!({"type": "publish", "host": "mars", "topic": "test/note", "message": {}}), "mars"),
        (json!({"type": "form", "topic": "no/such"}), "no/such"),
    ] {
        let refused = ask(&mut viewer, wrong);
        assert_eq!(refused["done"], false);
        assert!(refused["reason"].as_str().unwrap().contains(word), "{refused}");
    }
}

#[test]
fn a_studio_that_only_looks_refuses_every_change() {
    let run = Lamps::start();
    let studio = run.studio(false);
    let mut viewer = Viewer::open(&studio).unwrap();
    assert_eq!(viewer.wait_for_link("live")["control"], json!(false));
    viewer.send(json!({"type": "watch", "host": "local", "topic": "test/note"}));
    for request in [
        change(json!({"action": "pause"})),
        change(json!({"action": "explode"})),
        json!({"type": "publish", "host": "local", "topic": "test/note", "message": {"message": "x"}}),
        json!({"type": "form", "topic": "test/note"}),
    ] {
        let reply = ask(&mut viewer, request);
        assert_eq!(reply["done"], false);
        assert!(reply["reason"].as_str().unwrap().contains("--allow-control"), "{reply}");
    }
    let before = cycles(&mut viewer, "runs");
    let after = viewer.wait(|message| {
        assert!(message.get("sample").is_none(), "{message}");
        let agent = message["agents"].as_array()?.iter().find(|agent| agent["name"] == "Blinker")?.clone();
        agent["cycles"].as_u64().filter(|cycles| *cycles > before)
    });
    assert!(after > before);
}

#[test]
fn pages_of_others_and_clients_without_the_token_cannot_change_a_run() {
    let run = Lamps::start();
    let origins = vec!["https://viewer.example".to_owned()];
    let open = |listen: &str| {
        let listen = Some(listen.parse().unwrap());
        let settings =
            StudioSettings { listen, origins: origins.clone(), allows_control: true, ..Default::default() };
        Studio::of_run(&run.socket(), settings).unwrap()
    };
    let upgrade = [
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
    ];
    let studio = open("127.0.0.1:0");
    let own = format!("Host: {}", address(&studio));
    for foreign in [
        &[own.as_str(), "Origin: http://evil.example"][..],
        // an origin that may read by Foxglove's protocol
        &[own.as_str(), "Origin: https://viewer.example"],
        &["Host: rebound.example"],
        &[],
    ] {
        let reply = exchange(&studio, "GET /socket", &[foreign, &upgrade].concat());
        assert!(reply.starts_with("HTTP/1.1 403"), "{foreign:?}: {reply}");
    }
    let elsewhere = open("0.0.0.0:0");
    let own = format!("Host: {}", address(&elsewhere));
    for (path, what) in [("/socket", "a token is needed"), ("/socket?token=0", "the token is wrong")] {
        let reply = exchange(&elsewhere, &format!("GET {path}"), &[&[own.as_str()][..], &upgrade].concat());
        assert!(reply.starts_with("HTTP/1.1 403") && reply.contains(what), "{reply}");
    }
}

#[test]
fn long_requests_end_the_connection() {
    let run = Lamps::start();
    for (allows_control, served, refused) in [(false, 10 << 10, 20 << 10), (true, 900 << 10, 1100 << 10)] {
        let studio = run.studio(allows_control);
        let text = |length: usize| json!({"type": "form", "topic": "x".repeat(length)});
        let mut viewer = Viewer::open(&studio).unwrap();
        assert_eq!(ask(&mut viewer, text(served))["done"], false);
        viewer.0.get_ref().set_write_timeout(Some(Duration::from_secs(20))).unwrap();
        let mut long = text(refused);
        long["id"] = json!(1);
        // The studio may close before all of it is sent.
        let _ = viewer.0.send(tungstenite::Message::text(long.to_string()));
        let ended = std::iter::repeat_with(|| viewer.0.read()).take(1000).any(|read| read.is_err());
        assert!(ended, "{refused} bytes were taken");
    }
}
