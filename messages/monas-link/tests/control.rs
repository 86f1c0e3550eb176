//! The control socket, with a hub and without a run: the view of tools, and the handling of slow,
//! too many or disconnected ones.
#![cfg(all(unix, feature = "local"))]
#![allow(clippy::unwrap_used, clippy::panic)] // a test may fail

use std::io::{Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use monas_link::control::{
    CLIENT_LIMIT, ControlClient, ControlServer, ControlSocket, ControlTarget, control_sockets,
};
use monas_link::example::Ball;
use monas_link::{ErrorKind, LocalTransport, PacketInbox};
use narukom::{Data, Hub, State, Timestamp, topic};
use prost::Message as _;

topic! {
    /// Position of the ball.
    pub BALL: State<Ball> = "soccer/ball";
    /// Past positions.
    pub PATH: Data<Ball, 16> = "soccer/path";
}

/// A hub with constant time.
struct OneHub([Hub; 1]);

impl ControlTarget for OneHub {
    fn hubs(&self) -> &[Hub] {
        &self.0
    }
    fn now(&self) -> Timestamp {
        Timestamp::from_nanos(7)
    }
    fn is_simulated(&self) -> bool {
        true
    }
    fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String> {
        assert_eq!(host, self.0[0].host());
        let mut publisher = self.0[0].publisher_by_name(path, "tool").map_err(|error| error.to_string())?;
        publisher.publish_bytes(bytes, self.now()).map_err(|error| error.to_string())
    }
}

struct Served {
    folder: tempfile::TempDir,
    hub: Hub,
    server: ControlServer,
}

fn served() -> Served {
    let folder = tempfile::tempdir().unwrap();
    let hub = Hub::with_linked_topics("robot_1").unwrap();
    let server =
        ControlServer::start(&folder.path().join("monas"), "run", Arc::new(OneHub([hub.clone()]))).unwrap();
    Served { folder, hub, server }
}

impl Served {
    fn client(&self) -> ControlClient {
        ControlClient::connect(self.server.path()).unwrap()
    }
}

const TIMEOUT: Duration = Duration::from_secs(20);

#[test]
fn a_tool_learns_what_there_is_and_publishes() {
    let served = served();
    let mut client = served.client();
    let run = client.describe().unwrap();
    assert_eq!(
        (run.name.as_str(), run.simulated, run.now, run.hosts),
        ("run", true, 7, vec!["robot_1".into()])
    );
    let ball = Ball { distance: 1.5, bearing: 0.5 };
    client.publish("robot_1", "soccer/ball", ball.encode_to_vec()).unwrap();
    assert_eq!(served.hub.blackboard("b").read(BALL), None, "nothing is delivered by itself");
    let topics = client.topics("", "soccer/*").unwrap();
    let paths: Vec<&str> = topics.iter().map(|topic| topic.path.as_str()).collect();
    assert_eq!(paths[..2], ["soccer/ball", "soccer/path"]);
    let last = topics[0].last.as_ref().unwrap();
    assert_eq!((last.publisher.as_str(), last.sequence, last.published), ("tool", 1, 7));
    assert_eq!(client.schema("soccer/ball").unwrap().r#type, "monas.link.example.Ball");

    let refused = |error: monas_link::Error| {
        assert_eq!(error.kind(), ErrorKind::Refused);
        error.to_string()
    };
    assert!(refused(client.topics("", "soccer/bal").unwrap_err()).contains("did you mean `soccer/ball`?"));
    let error = refused(client.topics("robot_2", "").unwrap_err());
    assert_eq!(error, "no host is named `robot_2`; there are `robot_1`");
    assert!(
        refused(client.publish("robot_1", "soccer/ball", vec![0xff]).unwrap_err()).contains("soccer/ball")
    );

    let mut watching = client.watch("robot_1", "soccer/ball", true).unwrap();
    let seen = watching.wait(TIMEOUT).unwrap().unwrap();
    assert_eq!(
        (seen.sequence, seen.size, seen.lost),
        (1, 18, 0),
        "late readers get the last value of a state"
    );
    assert_eq!(Ball::decode(seen.payload.as_slice()).unwrap(), ball);
    assert_eq!(watching.wait(Duration::ZERO).unwrap(), None);
}

#[test]
fn a_slow_tool_loses_counted_messages_and_delays_no_other() {
    let served = served();
    let mut publisher = served.hub.publisher(PATH, "vision").unwrap();
    let mut watching = served.client().watch("", "soccer/path", true).unwrap();
    publisher.publish(Ball::default(), Timestamp::ZERO);
    // Its watch has started once it receives a message.
    let mut published = 1;
    while watching.wait(Duration::from_millis(10)).unwrap().is_none() {
        publisher.publish(Ball::default(), Timestamp::ZERO);
        published += 1;
    }
    // More than all buffers on the path hold.
    for _ in 0..100_000 {
        publisher.publish(Ball::default(), Timestamp::ZERO);
        published += 1;
    }
    let (mut newest, mut heard, mut lost) = (0, 1, 0);
    while newest < published {
        let seen = watching.wait(TIMEOUT).unwrap().unwrap();
        assert!(seen.sequence > newest, "in order, each once");
        (newest, lost) = (seen.sequence, seen.lost);
        heard += 1;
    }
    assert!(lost > 0 && heard < published, "{heard} heard, {lost} lost, {published} published");
}

#[test]
fn so_many_tools_are_served_and_no_more_until_one_leaves() {
    let served = served();
    let mut tools: Vec<ControlClient> = (0..CLIENT_LIMIT).map(|_| served.client()).collect();
    tools.iter_mut().for_each(|tool| drop(tool.describe().unwrap()));
    let refused = served.client().describe().unwrap_err();
    assert!(refused.to_string().contains("look at this run already"), "{refused}");
    tools.pop();
    while served.client().describe().is_err() {}
}

#[test]
fn a_tool_that_sends_a_byte_at_a_time_loses_its_connection() {
    let served = served();
    let mut stream = UnixStream::connect(served.server.path()).unwrap();
    stream.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
    // A request of 64 KiB is announced. The timeout of reading is the pause between two bytes.
    let mut request = (1_u32 << 16).to_le_bytes().to_vec();
    request.resize(1 << 16, 0);
    let mut sent = 0;
    let is_closed = request.iter().any(|byte| {
        sent += 1;
        stream.write_all(&[*byte]).is_err() || matches!(stream.read(&mut [0]), Ok(0))
    });
    assert!(is_closed && sent < 10_000, "{sent} bytes were taken one by one");
}

#[test]
fn a_bound_socket_holds_its_name_before_its_run_exists() {
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("monas");
    let socket = ControlSocket::bind(&folder, "run").unwrap();
    assert_eq!(ControlSocket::bind(&folder, "run").unwrap_err().kind(), ErrorKind::NameTaken);
    let mut early = ControlClient::connect(socket.path()).unwrap();
    let hub = Hub::with_linked_topics("robot_1").unwrap();
    let server = socket.serve(Arc::new(OneHub([hub]))).unwrap();
    assert_eq!(early.describe().unwrap().name, "run");
    drop(server);
    assert_eq!(control_sockets(&folder), []);
    drop(ControlSocket::bind(&folder, "run").unwrap());
    assert_eq!(control_sockets(&folder), []);
}

#[test]
fn a_folder_that_is_open_to_others_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("trap.sock"), "").unwrap();
    std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o755)).unwrap();
    let refused = ControlSocket::bind(folder.path(), "run").unwrap_err();
    assert!(refused.to_string().contains("is open to other users"), "{refused}");
    assert_eq!(control_sockets(folder.path()), []);
    let inbox = Arc::new(PacketInbox::default());
    let refused = LocalTransport::new(folder.path(), "robot", inbox).unwrap_err();
    assert!(refused.to_string().contains("chmod 700"), "{refused}");
}

#[test]
fn a_socket_is_the_owners_alone_and_is_gone_when_its_run_is() {
    let served = served();
    let folder = served.folder.path().join("monas");
    let mode = |path: &PathBuf| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!((mode(&folder), mode(&folder.join("run.sock"))), (0o700, 0o600));
    assert_eq!(control_sockets(&folder), [("run".to_owned(), folder.join("run.sock"))]);
    let again = ControlServer::start(&folder, "run", Arc::new(OneHub([served.hub.clone()]))).unwrap_err();
    assert_eq!(again.kind(), ErrorKind::NameTaken);
    let mut client = served.client();
    let watching = served.client().watch("", "", false).unwrap();
    drop(served.server);
    assert_eq!(control_sockets(&folder), []);
    assert_eq!(client.describe().unwrap_err().kind(), ErrorKind::Connection);
    drop(watching);
    let nameless = ControlServer::start(&folder, "a/b", Arc::new(OneHub([served.hub.clone()]))).unwrap_err();
    assert_eq!(nameless.kind(), ErrorKind::Settings);
}

#[test]
fn several_patterns_are_watched_on_one_connection() {
    let served = served();
    let mut ball = served.hub.publisher(BALL, "vision").unwrap();
    let mut path = served.hub.publisher(PATH, "vision").unwrap();
    let mut watch =
        served.client().watch_all("", &["soccer/ball", "other/topic", "soccer/path"], true).unwrap();
    // The stream is set up when the retained message arrives.
    ball.publish(Ball::default(), Timestamp::from_nanos(1));
    let first = watch.wait(TIMEOUT).unwrap().unwrap();
    path.publish(Ball::default(), Timestamp::from_nanos(2));
    let second = watch.wait(TIMEOUT).unwrap().unwrap();
    assert_eq!([first.path, second.path], ["soccer/ball", "soccer/path"]);

    let mut refused = served.client().watch_all("", &["other/topic", "none/at_all"], true).unwrap();
    assert!(refused.wait(TIMEOUT).unwrap_err().to_string().contains("none of the patterns"));
}
