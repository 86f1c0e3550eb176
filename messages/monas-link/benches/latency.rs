//! Latency added by a link: `cargo bench -p monas-link --features zenoh`.
//!
//! Two hosts in one process, connected over TCP on loopback, and for comparison two plain zenoh
//! sessions that encode and decode the same messages. The contestants take turns in one run; the
//! table shows the median over the rounds, with the smallest and the largest. A number after `--`
//! sets the number of rounds.
#![allow(clippy::disallowed_methods, reason = "a benchmark reads the clock")]
#![allow(clippy::unwrap_used, reason = "a benchmark that cannot go on stops")]

use std::net::TcpListener;
use std::sync::{Arc, Mutex, mpsc};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use monas_link::example::{Ball, Picture};
use monas_link::{
    HubBridge, Link, LinkSettings, LocalTransport, PacketInbox, Transport, Zenoh, ZenohSettings,
};
use narukom::{HostId, Hub, Retention, State, Timestamp, Topic, TopicSlot, topic};
use prost::Message;
use zenoh::qos::CongestionControl;
use zenoh::{Session, Wait};

topic! {
    BALL: State<Ball> = "bench/ball";
    // The last one only, since plain zenoh retains none.
    PICTURE: State<Picture, 1> = "bench/picture";
}

const LARGE_SIZE: usize = 1 << 20;

/// Timeout of a receiver: plain zenoh drops messages when a line is full, and does not retransmit
/// them.
const TIMEOUT: Duration = Duration::from_secs(1);

/// A path for messages: the first function sends a message with its time of sending, the second
/// waits for the next and returns that time, or `None` after the timeout.
struct MessagePath {
    name: &'static str,
    send: Box<dyn FnMut(u64)>,
    receive: Box<dyn FnMut() -> Option<u64>>,
    lost: u64,
}

fn main() {
    let rounds = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(9);
    let folder = tempfile::tempdir().unwrap();
    let local = |_: usize, bridge: &HubBridge, inbox| -> Box<dyn Transport> {
        Box::new(LocalTransport::new(&folder.path().join("links"), bridge.node().host(), inbox).unwrap())
    };
    let small = vec![
        MessagePath::bare("zenoh", true, false, ball, when_ball),
        MessagePath::bare("zenoh, by a thread of its own", true, true, ball, when_ball),
        MessagePath::link("link on zenoh", BALL, Pair::on_zenoh(true), ball, when_ball),
        MessagePath::link("link on local sockets", BALL, Pair::over(local), ball, when_ball),
    ];
    table("A ball, from host to host", rounds, 500, small);
    let large = vec![
        MessagePath::bare("zenoh", false, false, picture, when_picture),
        MessagePath::link("link on zenoh", PICTURE, Pair::on_zenoh(false), picture, when_picture),
        MessagePath::bare("zenoh, shared memory", true, false, picture, when_picture),
        MessagePath::bare("zenoh, shared memory, by a thread of its own", true, true, picture, when_picture),
        MessagePath::link(
            "link on zenoh, shared memory",
            PICTURE,
            Pair::on_zenoh(true),
            picture,
            when_picture,
        ),
    ];
    table("A picture of 1 MiB, from host to host", rounds, 60, large);
}

fn table(title: &str, rounds: usize, count: usize, mut paths: Vec<MessagePath>) {
    let mut figures = vec![Vec::new(); paths.len()];
    for round in 0..=rounds {
        for (path, figures) in paths.iter_mut().zip(&mut figures) {
            let figure = path.round(count);
            // The first round is a warm-up.
            figures.extend((round > 0).then_some(figure));
        }
    }
    println!("\n{title} ({rounds} rounds of {count}; median, smallest to largest)\n");
    println!("| | p50 µs | p99 µs | lost |\n|---|---:|---:|---:|");
    for (path, figures) in paths.iter().zip(&figures) {
        println!("| {} | {} | {} | {} |", path.name, cell(figures, 0), cell(figures, 1), path.lost);
    }
}

fn cell(figures: &[[f64; 2]], column: usize) -> String {
    let mut sorted: Vec<f64> = figures.iter().map(|figure| figure[column]).collect();
    sorted.sort_by(f64::total_cmp);
    format!("{:.0} ({:.0} to {:.0})", sorted[sorted.len() / 2], sorted[0], sorted[sorted.len() - 1])
}

/// Nanoseconds since the clock was first read, never 0.
fn now() -> u64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_nanos() as u64 + 1
}

impl MessagePath {
    /// The median and the 99th percentile of the latencies of messages that are sent one at a time,
    /// in microseconds.
    fn round(&mut self, count: usize) -> [f64; 2] {
        let mut latencies: Vec<u64> = (0..count).map(|_| self.latency()).collect();
        latencies.sort_unstable();
        [50, 99].map(|share| latencies[count * share / 100] as f64 / 1000.0)
    }

    fn latency(&mut self) -> u64 {
        loop {
            // So that a blocking receiver is asleep.
            thread::park_timeout(Duration::from_micros(200));
            let sent = now();
            (self.send)(sent);
            if self.comes(sent) {
                return now() - sent;
            }
            self.lost += 1;
        }
    }

    fn comes(&mut self, sent: u64) -> bool {
        std::iter::from_fn(|| (self.receive)()).any(|said| said == sent)
    }

    /// Two plain zenoh sessions. With a separate thread the sender hands encoding and sending over
    /// and continues, as a publisher with a link does, since agents do not wait for a network.
    fn bare<M: Message + Default + 'static>(
        name: &'static str,
        is_shared: bool,
        has_thread: bool,
        make: fn(u64) -> M,
        when: fn(&M) -> u64,
    ) -> MessagePath {
        let port = port();
        let listener = session("listen", port, is_shared);
        let subscriber = listener.declare_subscriber("bench/bare").wait().unwrap();
        let connector = session("connect", port, is_shared);
        let publisher = connector.declare_publisher("bench/bare");
        let publisher = publisher.congestion_control(CongestionControl::Drop).wait().unwrap();
        while !publisher.matching_status().wait().unwrap().matching() {
            thread::park_timeout(Duration::from_millis(1));
        }
        let mut put = move |message: M| publisher.put(message.encode_to_vec()).wait().unwrap();
        let (hand, given) = mpsc::channel();
        let send: Box<dyn FnMut(u64)> = match has_thread {
            true => {
                thread::spawn(move || given.iter().for_each(&mut put));
                Box::new(move |sent| hand.send(make(sent)).unwrap())
            }
            false => Box::new(move |sent| put(make(sent))),
        };
        MessagePath {
            name,
            send,
            receive: Box::new(move || {
                let _open = (&listener, &connector);
                let sample = subscriber.recv_timeout(TIMEOUT).unwrap()?;
                Some(when(&M::decode(&*sample.payload().to_bytes()).unwrap()))
            }),
            lost: 0,
        }
    }

    /// From the hub of one host to a blackboard of another.
    fn link<K: Retention>(
        name: &'static str,
        topic: Topic<K>,
        pair: Pair,
        make: fn(u64) -> K::Message,
        when: fn(&K::Message) -> u64,
    ) -> MessagePath
    where
        Topic<K>: Copy + 'static,
    {
        let mut publisher = pair.hubs[0].publisher(topic, "bench").unwrap();
        let mut reader = pair.hubs[1].blackboard("reader");
        let (mut last, sleeper) = (0, pair.sleeper.clone());
        MessagePath {
            name,
            send: Box::new(move |sent| publisher.publish(make(sent), Timestamp::from_nanos(sent))),
            receive: Box::new(move || {
                let pair = &pair;
                *sleeper.lock().unwrap() = Some(thread::current());
                let begun = now();
                loop {
                    reader.process_messages(Timestamp::from_nanos(now()));
                    match reader.from(pair.host).read(topic).map(when) {
                        Some(sent) if sent != last => {
                            last = sent;
                            return Some(sent);
                        }
                        _ if now() - begun > TIMEOUT.as_nanos() as u64 => return None,
                        // It may have arrived in between: then do not wait.
                        _ => thread::park_timeout(Duration::from_millis(100)),
                    }
                }
            }),
            lost: 0,
        }
    }
}

/// Two connected hosts.
struct Pair {
    hubs: [Hub; 2],
    host: HostId,
    sleeper: Arc<Mutex<Option<Thread>>>,
    _links: Vec<Link>,
}

impl Pair {
    fn on_zenoh(is_shared: bool) -> Pair {
        let endpoint = vec![format!("tcp/127.0.0.1:{}", port())];
        let settings = ZenohSettings { shared_memory: is_shared, ..ZenohSettings::default() };
        let listening = ZenohSettings { listen: endpoint.clone(), ..settings.clone() };
        let connecting = ZenohSettings { connect: endpoint, ..settings };
        Pair::over(|number, bridge, inbox| {
            let settings = [&connecting, &listening][number];
            Box::new(Zenoh::open(settings, bridge.node(), inbox).unwrap())
        })
    }

    fn over(connect: impl Fn(usize, &HubBridge, Arc<PacketInbox>) -> Box<dyn Transport>) -> Pair {
        let hubs = ["sender", "reader"].map(|name| Hub::with_linked_topics(name).unwrap());
        let clock = || Timestamp::from_nanos(now());
        let start = |number: usize, settings: LinkSettings| {
            let connect = |bridge: &HubBridge, inbox| Ok(connect(number, bridge, inbox));
            Link::start(&hubs[number], settings, connect, clock).unwrap()
        };
        let settings = LinkSettings::default();
        let links =
            vec![start(0, settings.clone().sending("bench/*")), start(1, settings.receiving("bench/*"))];
        hubs[0].set_waker(links[0].waker());
        let sleeper = Arc::new(Mutex::new(None::<Thread>));
        let woken = sleeper.clone();
        hubs[1].set_waker(Arc::new(move |_: TopicSlot, _: HostId| {
            woken.lock().unwrap().iter().for_each(Thread::unpark)
        }));
        while links.iter().any(|link| link.report().peers.is_empty()) {
            thread::park_timeout(Duration::from_millis(1));
        }
        let host = hubs[1].host_id("sender").unwrap();
        Pair { hubs, host, sleeper, _links: links }
    }
}

fn session(direction: &str, port: u16, is_shared: bool) -> Session {
    let mut config = zenoh::Config::default();
    let mut set = |key: &str, value: &str| config.insert_json5(key, value).unwrap();
    set("listen/endpoints", "[]");
    set(&format!("{direction}/endpoints"), &format!("[\"tcp/127.0.0.1:{port}\"]"));
    set("scouting/multicast/enabled", "false");
    set("scouting/gossip/enabled", "false");
    set("transport/shared_memory/enabled", &is_shared.to_string());
    zenoh::open(config).wait().unwrap()
}

fn port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

fn ball(sent: u64) -> Ball {
    Ball { distance: f64::from_bits(sent), bearing: 0.5 }
}

fn when_ball(ball: &Ball) -> u64 {
    ball.distance.to_bits()
}

fn picture(sent: u64) -> Picture {
    let mut pixels = vec![sent as u8; LARGE_SIZE];
    pixels[..8].copy_from_slice(&sent.to_le_bytes());
    Picture { pixels }
}

fn when_picture(picture: &Picture) -> u64 {
    picture.pixels.first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes))
}
