//! The studio of a run, over real sockets: who is answered, and what a viewer gets.

use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use monas::records::{self, AgentEntry, Agents, ChartEntry, ChartState, Inquiry, Reply, foxglove::Log};
use monas_link::control::{ControlServer, ControlTarget};
use monas_studio::{Pace, Studio, StudioSettings};
use narukom::{Hub, Timestamp};
use prost::Message as _;
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::{Message, WebSocket};
use yase::Statechart;

use crate::kit::{NOTE, Notes, TIMEOUT, Viewer, address, exchange, lamp};

/// A run of one host with one agent, with its time in nanoseconds.
struct OneHub([Hub; 1], Arc<AtomicU64>);

impl ControlTarget for OneHub {
    fn hubs(&self) -> &[Hub] {
        &self.0
    }

    fn now(&self) -> Timestamp {
        Timestamp::from_nanos(self.1.load(Ordering::SeqCst))
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn publish(&self, _: &str, _: &str, _: &[u8]) -> Result<(), String> {
        Err("a viewer publishes nothing".into())
    }

    fn manage(&self, inquiry: &[u8]) -> Result<Vec<u8>, String> {
        let inquiry = Inquiry::decode(inquiry).map_err(|error| error.to_string())?;
        assert!(inquiry.change.is_none(), "a viewer changes nothing");
        let mut reply = Reply::default();
        if inquiry.agents {
            let charts =
                vec![ChartEntry { model: "lamp.srm".into(), state: "runs".into(), ..ChartEntry::default() }];
            let agent =
                AgentEntry { host: "robot".into(), name: "Lamp".into(), charts, ..AgentEntry::default() };
            reply.agents = Some(Agents { agents: vec![agent] });
        }
        if inquiry.chart.is_some() {
            let picture = yase_export::to_picture(&lamp(), &[Statechart::ROOT, yase::NodeId(2)]);
            reply.chart = Some(ChartState { model: "lamp.srm".into(), picture, ..ChartState::default() });
        }
        Ok(reply.encode_to_vec())
    }
}

struct Run {
    folder: tempfile::TempDir,
    hub: Hub,
    now: Arc<AtomicU64>,
    server: Option<ControlServer>,
}

impl Run {
    fn start() -> Run {
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run {
            hub: Hub::with_linked_topics("robot").unwrap(),
            now: Arc::new(1_500_000_000.into()),
            folder,
            server: None,
        };
        run.serve();
        run
    }

    fn serve(&mut self) {
        let target = Arc::new(OneHub([self.hub.clone()], self.now.clone()));
        self.server = Some(ControlServer::start(&self.folder.path().join("monas"), "run", target).unwrap());
    }

    fn socket(&self) -> PathBuf {
        self.folder.path().join("monas/run.sock")
    }

    fn note(&self, text: &str) {
        let log = Log { message: text.into(), ..Log::default() };
        self.hub.publisher(NOTE, "tester").unwrap().publish(log, Timestamp::from_nanos(1_000_000));
    }
}

fn studio(socket: &Path, listen: &str, pace: Option<Pace>) -> Studio {
    let listen = Some(listen.parse().unwrap());
    Studio::of_run(
        socket,
        StudioSettings { listen, scene: Some(Arc::new(Notes)), pace, ..StudioSettings::default() },
    )
    .unwrap()
}

#[test]
fn the_page_is_served_to_its_own_name_only() {
    let run = Run::start();
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    let host = format!("Host: {}", address(&studio));
    let gzip = "Accept-Encoding: gzip";
    let page = exchange(&studio, "GET /", &[&host, gzip]);
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n"), "{page}");
    for header in ["Content-Encoding: gzip", "frame-ancestors 'none'", "nosniff", "Cache-Control: no-store"] {
        assert!(page.contains(header), "{header}");
    }
    assert!(!page.contains("Access-Control-Allow"));
    let status = |request: &str, lines: &[&str]| exchange(&studio, request, lines)[9..12].to_owned();
    assert_eq!(status("GET /", &["Host: rebound.example", gzip]), "403");
    assert_eq!(status("GET /", &[gzip]), "403");
    assert_eq!(status("GET /", &[&host, gzip, "Origin: http://evil.example"]), "403");
    assert_eq!(status("POST /", &[&host, gzip]), "405");
    assert_eq!(status("GET /../Cargo.toml", &[&host, gzip]), "404");
    assert_eq!(status("GET /", &[&host]), "406");
    assert_eq!(status("GET /socket", &[&host]), "426");
    assert_eq!(status("nonsense", &["x"]), "400");
    let upgrade = [
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
    ];
    let foreign = [&[host.as_str(), "Origin: http://evil.example"][..], &upgrade].concat();
    assert_eq!(status("GET /socket", &foreign), "403");
}

#[test]
fn other_addresses_than_loopback_need_the_printed_token() {
    let run = Run::start();
    let studio = studio(&run.socket(), "0.0.0.0:0", None);
    let host = format!("Host: {}", address(&studio));
    let gzip = "Accept-Encoding: gzip";
    assert!(exchange(&studio, "GET /", &[&host, gzip]).contains("a token is needed"));
    assert!(exchange(&studio, "GET /?token=0", &[&host, gzip]).contains("the token is wrong"));
    let (_, token) = studio.url().split_once("?token=").unwrap();
    let page = exchange(&studio, &format!("GET /?token={token}"), &[&host, gzip]);
    assert!(page.starts_with("HTTP/1.1 200 OK"), "{page}");
    assert!(page.contains(&format!("Set-Cookie: monas_studio={token}; HttpOnly; SameSite=Strict")));
    let cookie = format!("Cookie: monas_studio={token}");
    assert!(exchange(&studio, "GET /studio.js", &[&host, gzip, &cookie]).starts_with("HTTP/1.1 200 OK"));
    assert!(Viewer::open(&studio).is_err());
}

#[test]
fn a_viewer_sees_the_run_its_chart_and_each_step() {
    let run = Run::start();
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    let mut viewer = Viewer::open(&studio).unwrap();
    let facts = viewer.wait_for_link("live");
    assert_eq!(
        (&facts["name"], &facts["simulated"], &facts["hosts"]),
        (&json!("run"), &json!(true), &json!(["robot"]))
    );
    let chart = viewer
        .wait(|message| message["charts"].as_array()?.iter().find(|chart| chart["drawing"] == 1).cloned());
    assert_eq!((&chart["key"], &chart["active"]), (&json!("robot/Lamp/0"), &json!([0, 2])));
    viewer.send(json!({"type": "picture", "key": "robot/Lamp/0"}));
    let picture = viewer.wait(|message| message.get("picture").cloned());
    assert_eq!(picture["nodes"][3]["name"], "on");
    assert_eq!(picture["transitions"][1]["text"], "[A.x == 1]");
    assert!(picture["nodes"][3]["shape"]["w"].as_f64().unwrap() > 10.0);

    let step =
        records::Chart { time: 7, selected: vec![1], exits: vec![2], entries: vec![3], ..Default::default() };
    run.hub.publisher(records::CHART, "Lamp").unwrap().publish(step, Timestamp::from_nanos(2_500_000_000));
    let news = viewer.wait(|message| Some(message["charts"][0].clone()).filter(|chart| !chart.is_null()));
    assert_eq!(news["active"], json!([0, 3]));
    assert_eq!(
        news["steps"][0],
        json!({"t": 2.5, "number": 0, "event": null, "fired": [1], "held": [], "exits": [2], "entries": [3]})
    );
    // one who comes later sees the same
    let mut late = Viewer::open(&studio).unwrap();
    assert_eq!(late.wait(|message| message.get("charts").cloned())[0]["steps"], news["steps"]);
}

#[test]
fn scenes_and_watched_topics_show_the_newest_message() {
    let run = Run::start();
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    let mut viewer = Viewer::open(&studio).unwrap();
    run.note("one");
    let is_label =
        |message: &Value, label: &str| (message["scene"]["bodies"][0]["label"] == label).then_some(());
    viewer.wait(|message| is_label(message, "one"));
    viewer.send(json!({"type": "watch", "host": "robot", "topic": "test/note"}));
    let sample = viewer.wait(|message| message.get("sample").cloned());
    assert_eq!((&sample["message"]["message"], &sample["publisher"]), (&json!("one"), &json!("tester")));
    run.note("two");
    viewer.wait(|message| (message["sample"]["message"]["message"] == "two").then_some(()));
    viewer.send(json!({"type": "watch", "host": "robot", "topic": "no/such"}));
    let refused = viewer.wait(|message| (message["type"] == "refused").then(|| message.clone()));
    assert!(refused["reason"].as_str().unwrap().contains("no/such"), "{refused}");
}

#[test]
fn a_run_that_ends_is_looked_for_until_it_comes_back() {
    let mut run = Run::start();
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    let mut viewer = Viewer::open(&studio).unwrap();
    let first = viewer.wait_for_link("live");
    run.server = None;
    let lost = viewer.wait_for_link("lost");
    assert!(!lost["reason"].as_str().unwrap().is_empty());
    run.serve();
    let second = viewer.wait_for_link("live");
    assert!(second["epoch"].as_u64() > first["epoch"].as_u64());
}

#[test]
fn the_end_of_the_studio_reaches_viewers_with_requests_under_way() {
    let run = Run::start();
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    let mut viewer = Viewer::open(&studio).unwrap();
    viewer.wait_for_link("live");
    let end = std::thread::Builder::new().spawn(move || drop(studio)).unwrap();
    let code = loop {
        // A request that the studio has not read when it ends.
        let _ = viewer.0.send(Message::text(r#"{"type": "unwatch"}"#));
        match viewer.0.read() {
            Ok(Message::Close(reason)) => break reason.map(|reason| u16::from(reason.code)),
            Ok(_) => {}
            Err(error) => panic!("{error}"),
        }
    };
    assert_eq!(code, Some(1001));
    end.join().unwrap();
}

#[test]
fn the_pace_is_set_only_where_a_run_gives_it() {
    let run = Run::start();
    let pace = Pace::new(1.0);
    let paced = studio(&run.socket(), "127.0.0.1:0", Some(pace.clone()));
    let mut viewer = Viewer::open(&paced).unwrap();
    assert_eq!(
        viewer.wait(|message| message.get("pace").cloned()),
        json!({"is_set_here": true, "factor": 1.0})
    );
    viewer.send(json!({"type": "pace", "factor": -3}));
    viewer.send(json!({"type": "pace", "factor": 4}));
    // A frame under way still has the pace of before; one below zero is never taken.
    let paces = |message: &Value| message.get("pace").map(|pace| pace["factor"].clone());
    let mut next = || viewer.wait(paces);
    let now = std::iter::repeat_with(&mut next).find(|factor| *factor != json!(1.0));
    assert_eq!(now, Some(json!(4.0)));
    assert_eq!(pace.factor(), 4.0);
    let own = studio(&run.socket(), "127.0.0.1:0", None);
    let mut viewer = Viewer::open(&own).unwrap();
    assert_eq!(viewer.wait(|message| message.get("pace").cloned())["is_set_here"], json!(false));
}

#[test]
fn viewers_that_do_not_read_block_no_others_and_their_number_is_limited() {
    let run = Run::start();
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    let idle: Vec<Viewer> = (0..7).map(|_| Viewer::open(&studio).unwrap()).collect();
    let mut viewer = Viewer::open(&studio).unwrap();
    for number in 0..50 {
        let text = format!("{number}{}", "x".repeat(100_000));
        run.note(&text);
        viewer.wait(|message| (message["scene"]["bodies"][0]["label"] == text.as_str()).then_some(()));
    }
    // A browser gives a page no reason of a refused handshake.
    let mut refused = Viewer::open(&studio).unwrap();
    let Message::Close(Some(close)) = refused.0.read().unwrap() else { panic!("it is not served") };
    assert_eq!((close.code, close.reason.as_str()), (CloseCode::Again, "8 pages are open already"));
    drop((idle, refused));
}

#[test]
fn a_run_is_looked_back_at_while_it_goes_on() {
    let run = Run::start();
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    let mut viewer = Viewer::open(&studio).unwrap();
    let begin = viewer.wait(|message| Some(message["tape"].clone()).filter(|tape| tape["live"] == true));
    assert_eq!(begin["begin"], 1.5);
    let mut charts = run.hub.publisher(records::CHART, "Lamp").unwrap();
    for (second, exit, entry) in [(3, 2, 3), (5, 3, 2), (7, 2, 3)] {
        let time = second * 1_000_000_000;
        run.now.store(time, Ordering::SeqCst);
        let step = records::Chart {
            time,
            exits: vec![exit],
            entries: vec![entry],
            selected: vec![entry],
            ..Default::default()
        };
        charts.publish(step, Timestamp::from_nanos(time));
    }
    viewer.wait(|message| {
        (message["charts"][0]["active"] == json!([0, 3]) && message["now"] == 7.0).then_some(())
    });
    let moment = |viewer: &mut Viewer, request: Value| {
        viewer.send(request);
        viewer.wait(|message| {
            let is_past = message["elsewhere"] == true;
            is_past.then(|| {
                (
                    message["now"].clone(),
                    message["charts"][0]["active"].clone(),
                    message["tape"]["live"].clone(),
                )
            })
        })
    };
    let seek = |seconds: f64| json!({"type": "seek", "seconds": seconds});
    assert_eq!(moment(&mut viewer, seek(4.0)), (json!(4.0), json!([0, 3]), json!(false)));
    assert_eq!(moment(&mut viewer, seek(2.0)), (json!(2.0), json!([0, 2]), json!(false)));
    let step = |back: bool| json!({"type": "step", "key": "robot/Lamp/0", "back": back});
    assert_eq!(moment(&mut viewer, step(false)), (json!(3.0), json!([0, 3]), json!(false)));
    assert_eq!(moment(&mut viewer, step(false)), (json!(5.0), json!([0, 2]), json!(false)));
    let jump = json!({"type": "jump", "key": "robot/Lamp/0", "transition": 3, "back": false});
    assert_eq!(moment(&mut viewer, jump), (json!(7.0), json!([0, 3]), json!(true)));
    assert_eq!(moment(&mut viewer, seek(6.0)), (json!(6.0), json!([0, 2]), json!(false)));
    assert_eq!(moment(&mut viewer, json!({"type": "live"})), (json!(7.0), json!([0, 3]), json!(true)));
    // what is played arrives at the present moment
    moment(&mut viewer, seek(2.0));
    assert_eq!(
        moment(&mut viewer, json!({"type": "pace", "factor": 1000})),
        (json!(7.0), json!([0, 3]), json!(true))
    );
}

/// A client of Foxglove's protocol.
struct FoxgloveClient(WebSocket<TcpStream>);

impl FoxgloveClient {
    /// Opens the protocol, with an origin if one is given.
    fn open(studio: &Studio, protocol: &str, origin: Option<&str>) -> Result<FoxgloveClient, String> {
        let stream = TcpStream::connect(address(studio)).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        let mut request = format!("ws://{}/", address(studio)).into_client_request().unwrap();
        request.headers_mut().insert("Sec-WebSocket-Protocol", protocol.parse().unwrap());
        if let Some(origin) = origin {
            request.headers_mut().insert("Origin", origin.parse().unwrap());
        }
        let (socket, reply) = tungstenite::client(request, stream).map_err(|error| error.to_string())?;
        let chosen = reply.headers().get("Sec-WebSocket-Protocol").unwrap();
        assert!(protocol.split(", ").any(|offered| chosen == offered), "{chosen:?}");
        Ok(FoxgloveClient(socket))
    }

    fn object(&mut self, operation: &str) -> Value {
        loop {
            if let Message::Text(text) = self.0.read().unwrap() {
                let object: Value = serde_json::from_str(text.as_str()).unwrap();
                if object["op"] == operation {
                    return object;
                }
            }
        }
    }

    fn send(&mut self, object: &Value) {
        self.0.send(Message::text(object.to_string())).unwrap();
    }
}

fn from_base64(text: &str) -> Vec<u8> {
    const DIGITS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bits: Vec<u32> =
        text.chars().filter_map(|digit| DIGITS.find(digit)).map(|digit| digit as u32).collect();
    let bytes = bits.chunks(4).flat_map(|chunk| {
        let all = chunk.iter().fold(0, |all, bits| all << 6 | bits) << (6 * (4 - chunk.len()));
        all.to_be_bytes()[1..chunk.len()].to_vec()
    });
    bytes.collect()
}

#[test]
fn clients_of_the_foxglove_protocol_list_topics_and_decode_their_messages() {
    let run = Run::start();
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    for protocol in ["foxglove.websocket.v1", "foxglove.sdk.v1", "other, foxglove.sdk.v1"] {
        let mut client = FoxgloveClient::open(&studio, protocol, None).unwrap();
        let info = client.object("serverInfo");
        assert_eq!((&info["name"], &info["capabilities"]), (&json!("monas: run"), &json!([])));
        let channels = client.object("advertise")["channels"].clone();
        let channel =
            channels.as_array().unwrap().iter().find(|one| one["topic"] == "/robot/test/note").unwrap();
        assert_eq!(
            (&channel["encoding"], &channel["schemaName"]),
            (&json!("protobuf"), &json!("foxglove.Log"))
        );
        let schema = from_base64(channel["schema"].as_str().unwrap());
        let pool = monas_tape::descriptor_pool(&schema).unwrap();
        let log = pool.get_message_by_name("foxglove.Log").unwrap();
        client.send(&json!({"op": "subscribe", "subscriptions": [{"id": 7, "channelId": channel["id"]}]}));
        let frame = loop {
            // The subscription has begun once a message arrives.
            run.note("for others");
            match client.0.read().unwrap() {
                Message::Binary(frame) => break frame,
                other => assert!(other.is_text(), "{other:?}"),
            }
        };
        assert_eq!(
            (frame[0], &frame[1..5], &frame[5..13]),
            (1, &7_u32.to_le_bytes()[..], &1_000_000_u64.to_le_bytes()[..])
        );
        let message = monas_studio::message_json(&log, &frame[13..]).unwrap();
        assert_eq!(message["message"], "for others");
        client.send(&json!({"op": "advertise", "channels": []}));
        assert!(client.object("status")["message"].as_str().unwrap().contains("clients can only subscribe"));
    }
}

/// The first frame of a subscription that is decoded to what is looked for.
fn decoded<T>(
    client: &mut FoxgloveClient,
    channel: &Value,
    id: u32,
    mut find: impl FnMut(&Value) -> Option<T>,
) -> T {
    let pool = monas_tape::descriptor_pool(&from_base64(channel["schema"].as_str().unwrap())).unwrap();
    let message_type = pool.get_message_by_name(channel["schemaName"].as_str().unwrap()).unwrap();
    client.send(&json!({"op": "subscribe", "subscriptions": [{"id": id, "channelId": channel["id"]}]}));
    loop {
        if let Message::Binary(frame) = client.0.read().unwrap()
            && frame[1..5] == id.to_le_bytes()
            && let Some(found) = find(&monas_studio::message_json(&message_type, &frame[13..]).unwrap())
        {
            return found;
        }
    }
}

#[test]
fn clients_of_the_foxglove_protocol_get_the_scene_and_the_states_of_charts() {
    let run = Run::start();
    run.note("seen from above");
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    // a page that has the chart: then it is a channel
    let mut viewer = Viewer::open(&studio).unwrap();
    viewer.wait(|message| message["charts"].as_array()?.iter().find(|chart| chart["drawing"] == 1).cloned());
    let mut client = FoxgloveClient::open(&studio, "foxglove.sdk.v1", None).unwrap();
    let channels = client.object("advertise")["channels"].clone();
    let channel =
        |topic: &str| channels.as_array().unwrap().iter().find(|one| one["topic"] == topic).unwrap();
    let scene = channel("/scene");
    assert_eq!(scene["schemaName"], "foxglove.SceneUpdate");
    let entities = decoded(&mut client, scene, 3, |update| update["entities"].as_array().cloned());
    assert_eq!(
        (&entities[0]["id"], &entities[1]["id"]),
        (&json!("body 0 seen from above"), &json!("ground"))
    );
    assert_eq!(entities[0]["texts"][0]["text"], "seen from above");
    assert_eq!(entities[0]["frame_id"], "world");

    let states = channel("/robot/chart/Lamp");
    assert_eq!(states["schemaName"], "monas.studio.ActiveState");
    let mut seen = Vec::new();
    let mut publisher = run.hub.publisher(records::CHART, "Lamp").unwrap();
    let step = |exit: u32, entry: u32, time: u64| records::Chart {
        time,
        exits: vec![exit],
        entries: vec![entry],
        ..Default::default()
    };
    decoded(&mut client, states, 4, |message| {
        seen.push(message["state"].as_str().unwrap().to_owned());
        if seen.len() == 1 {
            // Both steps are sent, although the second follows at once.
            publisher.publish(step(2, 3, 1), Timestamp::from_nanos(2_000_000_000));
            publisher.publish(step(3, 2, 2), Timestamp::from_nanos(2_000_000_001));
        }
        (seen.len() == 3).then_some(())
    });
    assert_eq!(seen, ["off", "on", "off"]);
}

#[test]
fn images_go_to_pages_that_ask_for_them_and_to_clients_of_the_foxglove_protocol() {
    let run = Run::start();
    run.note("first");
    let studio = studio(&run.socket(), "127.0.0.1:0", None);
    let mut viewer = Viewer::open(&studio).unwrap();
    assert_eq!(viewer.wait_for_link("live")["camera_topic"], "test/note");
    viewer.send(json!({"type": "camera", "host": "robot"}));
    // A note may come before the studio watches, so that notes are repeated until one is seen.
    let seen = viewer.wait(|message| {
        run.note("an image");
        let camera = message["camera"].as_object()?;
        (camera["images"][0]["url"] != from("first")).then(|| message["camera"].clone())
    });
    assert_eq!((&seen["host"], &seen["images"][0]["name"]), (&json!("robot"), &json!("eye")));
    assert_eq!(seen["images"][0]["url"], from("an image"));

    let mut client = FoxgloveClient::open(&studio, "foxglove.sdk.v1", None).unwrap();
    let channels = client.object("advertise")["channels"].clone();
    let camera = channels.as_array().unwrap().iter().find(|one| one["topic"] == "/robot/camera/eye").unwrap();
    assert_eq!(camera["schemaName"], "foxglove.CompressedImage");
    let image = decoded(&mut client, camera, 5, |image| Some(image.clone()));
    assert_eq!((&image["format"], &image["frame_id"]), (&json!("png"), &json!("robot/eye")));
}

/// The address with the bytes of a text.
fn from(text: &str) -> String {
    let known = [("first", "Zmlyc3Q="), ("an image", "YW4gaW1hZ2U=")];
    let (_, encoded) = known.iter().find(|(known, _)| *known == text).unwrap();
    format!("data:image/png;base64,{encoded}")
}

#[test]
fn pages_of_others_need_an_allowed_origin() {
    let run = Run::start();
    let listen = Some("127.0.0.1:0".parse().unwrap());
    let origins = vec!["https://viewer.example".to_owned()];
    let settings = StudioSettings { listen, origins, ..StudioSettings::default() };
    let studio = Studio::of_run(&run.socket(), settings).unwrap();
    let open = |origin| FoxgloveClient::open(&studio, "foxglove.sdk.v1", origin).map(drop);
    assert_eq!(open(Some("https://viewer.example")), Ok(()));
    assert!(open(Some("https://evil.example")).unwrap_err().contains("403"));
    // the page's own socket stays closed to them
    let host = format!("Host: {}", address(&studio));
    let reply = exchange(&studio, "GET /socket", &[&host, "Origin: https://viewer.example"]);
    assert!(reply.starts_with("HTTP/1.1 403"), "{reply}");
}
