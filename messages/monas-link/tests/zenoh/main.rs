//! Links over zenoh: explicit endpoints, certificates, access, shared memory, interrupted lines,
//! hostile peers.
#![cfg(feature = "zenoh")]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "real sockets need real time; what is awaited is awaited with a limit, and never slept for"
)]

mod certificates;
mod exchange;
mod hostile;
mod line;
mod python;

use std::net::TcpListener;
use std::thread;
use std::time::{Duration, Instant};

use monas_link::example::{Ball, Command, Picture};
use monas_link::{
    HubBridge, Link, LinkReport, LinkSettings, ReceivedCounters, SentCounters, Transport, Zenoh,
    ZenohSettings,
};
use narukom::{Data, Hub, Signal, State, Timestamp, topic};
use zenoh::Wait;

topic! {
    pub(crate) BALL: State<Ball> = "soccer/ball";
    pub(crate) COMMAND: Signal<Command> = "soccer/command";
    pub(crate) PICTURE: State<Picture, 1> = "soccer/picture";
    pub(crate) TRACK: Data<Ball, 64> = "soccer/track";
}

/// Timeout for what must arrive.
const TIMEOUT: Duration = Duration::from_secs(30);

/// A free port of this computer.
fn port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

/// A host that listens, and one that connects to it.
fn pair(protocol: &str) -> (ZenohSettings, ZenohSettings) {
    let endpoint = vec![format!("{protocol}/127.0.0.1:{}", port())];
    let listening = ZenohSettings { listen: endpoint.clone(), ..ZenohSettings::default() };
    (listening, ZenohSettings { connect: endpoint, ..ZenohSettings::default() })
}

fn everything() -> LinkSettings {
    LinkSettings::default().sending("soccer/**").receiving("soccer/**")
}

/// A host with a link.
struct End {
    hub: Hub,
    link: Link,
    /// The time of its clock at `start`.
    began: Timestamp,
    start: Instant,
}

impl End {
    fn new(name: &str, zenoh: &ZenohSettings) -> End {
        End::with(name, everything(), zenoh).unwrap()
    }

    fn with(name: &str, settings: LinkSettings, zenoh: &ZenohSettings) -> Result<End, monas_link::Error> {
        End::over(name, settings, zenoh, Timestamp::ZERO, |zenoh| Box::new(zenoh))
    }

    /// Its clock starts at `began`. Packets go through the transport returned by `wrap`.
    fn over(
        name: &str,
        settings: LinkSettings,
        zenoh: &ZenohSettings,
        began: Timestamp,
        wrap: impl FnOnce(Zenoh) -> Box<dyn Transport>,
    ) -> Result<End, monas_link::Error> {
        let hub = Hub::with_linked_topics(name).unwrap();
        let start = Instant::now();
        let connect = |bridge: &HubBridge, inbox| Ok(wrap(Zenoh::open(zenoh, bridge.node(), inbox)?));
        let link = Link::start(&hub, settings, connect, move || began + start.elapsed())?;
        hub.set_waker(link.waker());
        Ok(End { hub, link, began, start })
    }

    fn now(&self) -> Timestamp {
        self.began + self.start.elapsed()
    }

    fn say_ball(&self, distance: f64) {
        self.hub.publisher(BALL, "vision").unwrap().publish(Ball { distance, bearing: 0.0 }, self.now());
    }

    fn ball_of(&self, host: &str) -> Option<f64> {
        let mut reader = self.hub.blackboard("reader");
        reader.process_messages(self.now());
        reader.from(self.hub.host_id(host).unwrap()).read(BALL).map(|ball| ball.distance)
    }

    fn knows(&self, host: &str) -> bool {
        self.link.report().peers.iter().any(|peer| peer.0 == host)
    }

    fn sent(&self, path: &str) -> SentCounters {
        let all = self.link.report().counters.sent;
        all.iter().find(|one| one.0 == path).map(|one| one.1).unwrap_or_default()
    }

    fn received(&self, host: &str, path: &str) -> ReceivedCounters {
        let all = self.link.report().counters.received;
        all.iter().find(|one| one.0 == host && one.1 == path).map(|one| one.2).unwrap_or_default()
    }

    /// Stops it; its counters add up.
    fn stop(self) -> LinkReport {
        let report = self.link.stop();
        check(&report);
        report
    }
}

/// A program that uses zenoh directly, and sends arbitrary data.
fn program(settings: &ZenohSettings) -> Result<zenoh::Session, zenoh::Error> {
    let mut config = zenoh::Config::default();
    let mut set = |key: &str, value: String| config.insert_json5(key, &value).unwrap();
    set("mode", "\"client\"".into());
    set("connect/endpoints", format!("{:?}", settings.connect));
    set("scouting/multicast/enabled", "false".into());
    if let Some(tls) = &settings.tls {
        set("transport/link/tls/root_ca_certificate", format!("{:?}", tls.authority));
        if tls.key.exists() {
            set("transport/link/tls/enable_mtls", "true".into());
            set("transport/link/tls/connect_certificate", format!("{:?}", tls.certificate));
            set("transport/link/tls/connect_private_key", format!("{:?}", tls.key));
        }
    }
    zenoh::open(config).wait()
}

/// Waits until `is_so`, and fails after the timeout.
fn await_that(what: &str, mut is_so: impl FnMut() -> bool) {
    let end = Instant::now() + TIMEOUT;
    while !is_so() {
        assert!(Instant::now() < end, "{what} did not come");
        thread::park_timeout(Duration::from_millis(5));
    }
}

/// Fails if counters do not add up.
fn check(report: &LinkReport) {
    for (path, sent) in &report.counters.sent {
        assert_eq!(sent.taken, sent.sent + sent.dropped + sent.oversize + sent.waiting, "{path}: {sent:?}");
    }
    for (host, path, got) in &report.counters.received {
        let seen = got.delivered + got.duplicates + got.late + got.refused + got.held;
        assert_eq!(got.arrived, seen, "{path} of {host}: {got:?}");
        let said = got.delivered + got.gaps + got.held + got.missing;
        assert_eq!(got.last - got.start, said, "{path} of {host}: {got:?}");
    }
}
