//! A robot that publishes its ball position and receives commands, or a coach that receives the
//! ball position and sends commands: two processes.
//!
//! ```text
//! player robot local FOLDER          player coach local FOLDER
//! player robot listen tcp/127.0.0.1:7447      player coach connect tcp/127.0.0.1:7447      (with --features zenoh)
//! ```
//!
//! It ends at the end of its standard input, and then prints its counters.

use std::error::Error;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use monas_link::example::{Ball, Command};
use monas_link::{HubBridge, Link, LinkReport, LinkSettings, PacketInbox, Transport};
use narukom::{Hub, Signal, State, Timestamp, topic};

topic! {
    /// Position of the ball.
    pub BALL: State<Ball> = "soccer/ball";
    /// The command for the robot.
    pub COMMAND: Signal<Command> = "soccer/command";
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let [role, transport_name, address] = words[..] else {
        return Err("usage: player robot|coach local|listen|connect PLACE".into());
    };
    let is_robot = match role {
        "robot" => true,
        "coach" => false,
        other => return Err(format!("`{other}` is neither robot nor coach").into()),
    };
    let hub = Hub::with_linked_topics(role)?;
    let settings = LinkSettings::default();
    let settings = if is_robot {
        LinkSettings { accepts_unlinked: true, ..settings }.sending("soccer/ball").receiving("soccer/command")
    } else {
        settings.sending("soccer/command").receiving("soccer/ball")
    };
    let start = now();
    let connect = |bridge: &HubBridge, inbox| transport(transport_name, address, bridge, inbox);
    let link = Link::start(&hub, settings, connect, move || now_since(start))?;
    hub.set_waker(link.waker());
    let (holder, ended) = channel();
    std::thread::Builder::new().spawn(move || {
        let _ = std::io::stdin().read_to_end(&mut Vec::new());
        drop(holder);
    })?;
    play(&hub, is_robot, start, &ended)?;
    print(&link.stop());
    Ok(())
}

#[allow(clippy::disallowed_methods, reason = "a program of its own reads the clock")]
fn now() -> Instant {
    Instant::now()
}

fn now_since(start: Instant) -> Timestamp {
    Timestamp::ZERO + now().duration_since(start)
}

/// Ten cycles a second, until the other end of `ended` is dropped.
fn play(hub: &Hub, is_robot: bool, start: Instant, ended: &Receiver<()>) -> Result<(), Box<dyn Error>> {
    let mut blackboard = hub.blackboard("player");
    let mut last_seen = None;
    for cycle in 0_u64.. {
        let now = now_since(start);
        blackboard.process_messages(now);
        for host in (1..).zip(hub.hosts().iter().skip(1)) {
            let id = hub.host_id(host.1)?;
            let view = blackboard.from(id);
            if let Some(sample) = view.sample(BALL).filter(|sample| last_seen != Some(sample.header.sequence))
            {
                last_seen = Some(sample.header.sequence);
                let age = now.since(sample.header.local);
                println!(
                    "ball {} of {}: {} m, {} ms ago",
                    sample.header.sequence,
                    host.1,
                    sample.distance,
                    age.as_millis()
                );
            }
            for command in view.signals(COMMAND) {
                println!("command of {}: {}", host.1, command.text);
            }
        }
        if is_robot {
            blackboard.publish(BALL, Ball { distance: cycle as f64 / 10.0, bearing: 0.0 })?;
        } else if cycle % 10 == 0 {
            blackboard.publish(COMMAND, Command { text: format!("kick {cycle}") })?;
        }
        blackboard.publish_all(now_since(start));
        if ended.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Disconnected) {
            break;
        }
    }
    Ok(())
}

fn print(report: &LinkReport) {
    for (path, sent) in &report.counters.sent {
        println!("sent {path}: {sent:?}");
    }
    for (host, path, received) in &report.counters.received {
        println!("received {path} of {host}: {received:?}");
    }
    for mismatch in &report.mismatches {
        println!("differs: {mismatch:?}");
    }
    for (host, _, offset) in &report.peers {
        println!("clock of {host}: {offset:?}");
    }
}

fn transport(
    transport_name: &str,
    address: &str,
    bridge: &HubBridge,
    inbox: Arc<PacketInbox>,
) -> Result<Box<dyn Transport>, monas_link::Error> {
    match transport_name {
        #[cfg(all(unix, feature = "local"))]
        "local" => {
            let local = monas_link::LocalTransport::new(Path::new(address), bridge.node().host(), inbox)?;
            Ok(Box::new(local))
        }
        #[cfg(feature = "zenoh")]
        "listen" | "connect" => {
            let mut settings = monas_link::ZenohSettings::default();
            let endpoints =
                if transport_name == "listen" { &mut settings.listen } else { &mut settings.connect };
            endpoints.push(address.to_owned());
            Ok(Box::new(monas_link::Zenoh::open(&settings, bridge.node(), inbox)?))
        }
        _ => Err(monas_link::Error::unknown_transport(transport_name)),
    }
}
