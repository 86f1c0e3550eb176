//! A chart, a scene, and a viewer.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use monas::records::foxglove::Log;
use monas_studio::{Body, Cameras, Scene, SceneEvent, SceneMessages, ScenePicture, Studio};
use narukom::{State, topic};
use prost::Message as _;
use serde_json::Value;
use tungstenite::{Message, WebSocket, client};
use yase::{Node, NodeKind, Statechart, Transition};

topic! {
    /// The newest log line, as a message of a type that has a text.
    pub NOTE: State<Log> = "test/note";
}

pub(crate) const TIMEOUT: Duration = Duration::from_secs(20);

/// A lamp: START, off, on.
pub(crate) fn lamp() -> Statechart {
    chart("", "[A.x == 1]", "enough")
}

/// The chart of a lamp with the expressions of its start, and of its switching on and off.
pub(crate) fn chart(begin: &str, switch_on: &str, switch_off: &str) -> Statechart {
    let mut lamp = Statechart::new("lamp");
    let [start, off, on] = [(NodeKind::Start, ""), (NodeKind::Basic, "off"), (NodeKind::Basic, "on")]
        .map(|(kind, name)| lamp.add(Statechart::ROOT, Node::new(kind, name)));
    for (source, target, text) in [(start, off, begin), (off, on, switch_on), (on, off, switch_off)] {
        let expression = yase::expression::parse_transition(text).0;
        lamp.connect(Transition { expression, ..Transition::new(source, target) });
    }
    lamp
}

/// Draws one body for each note, with its text as label.
pub(crate) struct Notes;

/// The camera of a robot whose images are its notes.
impl Cameras for Notes {
    fn topic(&self) -> &'static str {
        "test/note"
    }

    fn names(&self) -> &[&'static str] {
        &["eye"]
    }

    fn images(&self, bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
        Some(vec![Log::decode(bytes).ok()?.message.into_bytes()])
    }
}

impl Scene for Notes {
    fn cameras(&self) -> Option<&dyn Cameras> {
        Some(self)
    }

    fn topics(&self) -> &[&'static str] {
        &["test/note"]
    }

    fn event_topics(&self) -> &[&'static str] {
        &["test/note"]
    }

    fn event(&self, _: &str, _: &str, bytes: &[u8]) -> Option<SceneEvent> {
        let text = Log::decode(bytes).ok()?.message;
        let kind = text.split(' ').next()?.to_owned();
        Some(SceneEvent { lasts: kind == "lasting", kind, text })
    }

    fn draw(&self, messages: &SceneMessages<'_>) -> ScenePicture {
        let bodies = messages.all("test/note").map(|(host, note)| Body {
            host: host.into(),
            label: note["message"].as_str().unwrap_or_default().into(),
            ..Body::default()
        });
        ScenePicture { bodies: bodies.collect(), ..ScenePicture::default() }
    }
}

pub(crate) fn address(studio: &Studio) -> SocketAddr {
    let rest = studio.url().strip_prefix("http://").unwrap();
    let address: SocketAddr = rest.split('/').next().unwrap().parse().unwrap();
    SocketAddr::new([127, 0, 0, 1].into(), address.port())
}

/// The reply to a request, whose head has these lines.
pub(crate) fn exchange(studio: &Studio, request: &str, lines: &[&str]) -> String {
    let mut stream = TcpStream::connect(address(studio)).unwrap();
    stream.set_read_timeout(Some(TIMEOUT)).unwrap();
    stream.write_all(format!("{request} HTTP/1.1\r\n{}\r\n\r\n", lines.join("\r\n")).as_bytes()).unwrap();
    let mut reply = Vec::new();
    stream.read_to_end(&mut reply).unwrap();
    String::from_utf8_lossy(&reply).into_owned()
}

pub(crate) struct Viewer(pub(crate) WebSocket<TcpStream>);

impl Viewer {
    pub(crate) fn open(studio: &Studio) -> Result<Viewer, String> {
        Viewer::open_at(studio, "/socket")
    }

    /// Opens it with the token of its address.
    #[cfg_attr(not(unix), allow(dead_code, reason = "only some tests use tokens"))]
    pub(crate) fn open_with_token(studio: &Studio) -> Result<Viewer, String> {
        let token = studio.url().split_once('?').map(|(_, token)| token).unwrap_or_default();
        Viewer::open_at(studio, &format!("/socket?{token}"))
    }

    fn open_at(studio: &Studio, path: &str) -> Result<Viewer, String> {
        let stream = TcpStream::connect(address(studio)).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        let url = format!("ws://{}{path}", address(studio));
        let (socket, _) = client(url, stream).map_err(|error| error.to_string())?;
        Ok(Viewer(socket))
    }

    pub(crate) fn send(&mut self, message: Value) {
        self.0.send(Message::text(message.to_string())).unwrap();
    }

    /// The first message that has what is looked for.
    pub(crate) fn wait<T>(&mut self, mut find: impl FnMut(&Value) -> Option<T>) -> T {
        loop {
            if let Message::Text(text) = self.0.read().unwrap() {
                let message = serde_json::from_str(text.as_str()).unwrap();
                if let Some(found) = find(&message) {
                    return found;
                }
            }
        }
    }

    pub(crate) fn wait_for_link(&mut self, link: &str) -> Value {
        self.wait(|message| (message["run"]["link"] == link).then(|| message["run"].clone()))
    }
}
