//! Links: Narukom between processes and hosts.
//!
//! A link connects the hub of one process to those of others. The settings select the topics that
//! are sent and received; readers find them under the other host:
//! `blackboard.from(host).read(BALL)`. All three retention kinds keep their semantics.
//!
//! # Protocol and transport
//!
//! The *protocol* ([`Node`]) is a state machine in the style of smoltcp: its inputs are local
//! publications, received packets and the time, its outputs are packets to send. It uses no
//! sockets, threads or clocks, so its guarantees are tested in simulated time, on a network that
//! loses, delays, duplicates and reorders packets and splits into partitions.
//!
//! A *transport* ([`Transport`]) carries packets and may lose them: sockets on one computer
//! (feature `local`), or zenoh sessions between computers (feature `zenoh`). In between, a
//! [`HubBridge`] forwards messages from and to a hub, and a [`Link`] is the thread that drives it;
//! received packets are handled by the transport's own thread if the link's thread is idle.
//!
//! # The protocol
//!
//! Packets go to all links. There are two kinds: a message of a topic, in its own protobuf encoding
//! with a small stamp beside it, so that a program that knows only the messages can read and send
//! them; and controls, `proto/link.proto`.
//!
//! - **Hello** introduces a link: its protocol version, and each topic that it sends with its
//!   retention kind, its message type and a hash of its schema. A reader with a different
//!   declaration of a topic does not read it, and both sides report the difference, field by field.
//! - **Sequence numbers.** The messages of a topic of a host are numbered in order of publication,
//!   over all publishers; so each publisher's messages arrive in order, and the last value of a
//!   state is the same on all sides.
//! - **Beat** is the heartbeat, sent every 200 ms by default: the progress of each topic, the
//!   messages that the sender lacks of others, and its time. Missing messages are retransmitted to
//!   the host that lacks them while they are retained: as many messages as the hub keeps.
//! - **Clocks** are compared as in NTP, with the timestamps in the beats.
//!
//! # Guarantees
//!
//! - On a reliable topic every reader gets every message once, in order, from the time it has
//!   received the Hello; or a gap, which is counted. A late reader begins with the last value of a
//!   state, and for the other kinds with messages published from then on.
//! - On a best-effort topic a message is delivered on arrival, unless a newer one was delivered
//!   before.
//! - States are equal on all sides within two beats and two round trips after the network is
//!   restored, if nothing more is lost; with a budget, within four beats and two round trips, since
//!   then no extra beats are sent, if the traffic fits into the budget. A restarted process may be
//!   mistaken for an earlier incarnation for three more beats, if a packet of that one arrives
//!   late.
//! - In no window does a link with a budget send more packets than it allows, and none is larger.
//!   Controls count like messages. A link does not know what was sent before it was started, so it
//!   is silent for the first window.
//! - All memory is bounded. Per sent topic, as many messages are retained as its depth and at most
//!   8 MiB besides the last; per received topic at most 1024 messages and 4 MiB wait for earlier
//!   ones, and 64 MiB in all; 64 other hosts are remembered, with at most 1024 topics each.
//! - [`Counters`] add up, as documented in [`SentCounters`] and [`ReceivedCounters`].
//!
//! # Example
//!
//! Two hubs of one process, connected by a network of two queues:
//!
//! ```
//! use monas_link::{HubBridge, LinkSettings};
//! use monas_link::example::Ball;
//! use narukom::{Hub, State, Timestamp, topic};
//!
//! topic! {
//!     /// Position of the ball.
//!     pub BALL: State<Ball> = "soccer/ball";
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let hubs = [Hub::with_linked_topics("robot_1")?, Hub::with_linked_topics("robot_2")?];
//! let settings = LinkSettings::default().sending("soccer/ball").receiving("soccer/ball");
//! let mut first = HubBridge::new(&hubs[0], settings.clone(), 1)?;
//! let mut second = HubBridge::new(&hubs[1], settings, 2)?;
//!
//! hubs[0].publisher(BALL, "vision")?.publish(Ball { distance: 1.5, bearing: 0.2 }, Timestamp::ZERO);
//! for millis in (0..1000).step_by(100) {
//!     let now = Timestamp::from_nanos(millis * 1_000_000);
//!     while let Some(packet) = first.poll(now) {
//!         second.handle(&packet, now);
//!     }
//!     while let Some(packet) = second.poll(now) {
//!         first.handle(&packet, now);
//!     }
//! }
//!
//! let mut mate = hubs[1].blackboard("mate");
//! mate.process_messages(Timestamp::ZERO);
//! let host = hubs[1].host_id("robot_1")?;
//! assert_eq!(mate.from(host).read(BALL).map(|ball| ball.distance), Some(1.5));
//! # Ok(())
//! # }
//! ```

mod bridge;
#[cfg(all(unix, feature = "local"))]
pub mod control;
mod error;
#[cfg(all(unix, feature = "local"))]
#[doc(hidden)]
pub mod fuzzed;
mod inbox;
mod link;
mod link_config;
mod protocol;
mod settings;
#[cfg(all(unix, feature = "local"))]
mod socket_folder;
mod transport;

/// The messages of the examples.
#[doc(hidden)]
#[allow(missing_docs)]
pub mod example {
    narukom::include_messages!("monas.link.example");
}

pub use bridge::HubBridge;
pub use error::{Error, ErrorKind};
pub use inbox::PacketInbox;
pub use link::{Link, LinkReport, Transport};
pub use link_config::{Certificates, LinkConfig, LinkStatistics, LinkTransport, ZenohEndpoints};
pub use protocol::{
    AccessError, AccessList, BudgetUsage, ClockOffset, Counters, LinkTopic, MessageBytes, Mismatch, Node,
    NodeSettings, OutgoingPublication, Packet, ReceivedCounters, ReceivedMessage, Reliability, Schema,
    SendBudget, SentCounters, VERSION, differences,
};
pub use settings::{LinkSettings, PublishAs, ReceiveRule, SendRule};
#[cfg(all(unix, feature = "local"))]
pub use transport::{LocalTransport, default_folder, runtime_folder};
#[cfg(feature = "zenoh")]
pub use transport::{Tls, Zenoh, ZenohSettings};
