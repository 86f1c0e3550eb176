//! Narukom between processes and hosts.
//!
//! A link joins the hub of one process to those of others. Topics that the settings name are sent, others' are received, and readers
//! find them where they look for other hosts: `blackboard.from(host).read(BALL)`. All three ways of keeping stay what they are.
//!
//! # Two halves
//!
//! The *protocol* ([`Node`]) is a state machine in the manner of smoltcp: it is told what is published here, what packets have come
//! and what time it is, and says what packets are to be sent. It knows no sockets, threads or clocks, so all that it promises is
//! tested in simulated time, on a network that loses, delays, doubles, overtakes and falls apart.
//!
//! A *transport* ([`Transport`]) carries packets and may lose them: sockets of one computer (feature `local`), or sessions of zenoh
//! between computers (feature `zenoh`). Between the two, a [`Bridge`] takes messages from a hub and brings them in, and a [`Link`] is
//! the thread that drives it; what comes is taken in by the transport's own thread if the link's is not at work.
//!
//! # The protocol
//!
//! Packets go to all. There are two kinds: a message of a topic, as its own protobuf encoding with a small stamp beside it, so that a
//! program that knows only the messages can read and send them; and controls, `proto/link.proto`.
//!
//! - **Hello** introduces a link: its protocol version, and each topic that it sends with its way of keeping, its message type and
//!   a hash of its schema. A reader that has another idea of a topic does not read it, and both sides tell what differs, field by field.
//! - **Numbers.** The messages of a topic of a host are numbered in the order of publication, over all publishers; so each
//!   publisher's come in order, and the last value of a state is the last one on all sides.
//! - **Beat** is said every 200 ms, or as the settings say: how far each topic is, what the sender misses of others, and what time it
//!   is. What is missing is sent again, to the one who misses it, as long as it is kept: as many messages as the hub keeps.
//! - **Clocks** are compared as NTP does, with the moments in the beats.
//!
//! # The promise
//!
//! - On a reliable topic every reader gets every message once, in order, from the moment it has got the Hello; or a gap, which is
//!   counted. A late reader begins with the last value of a state, and with what is said from then on of all else.
//! - On a topic that is sent with the best effort a message that comes is delivered at once, unless a newer one was before.
//! - States are equal on all sides within two beats and two ways there and back after the network is whole, if nothing more is lost;
//!   with a budget, within four beats and two ways, since then nothing is said out of turn, if what there is to say fits into it. A process that
//!   is started again may be taken for an earlier one for three beats more, if something that one said comes late.
//! - In no window does a link with a budget send more packets than it allows, and none is larger. Controls count like messages. A link
//!   does not know what it has sent before it was started, so it is silent for the first window.
//! - Nothing grows without bound. Of each topic that is sent as many messages are kept as it is deep and at most 8 MiB besides the last; of
//!   each that is received at most 1024 messages and 4 MiB wait for earlier ones, and 64 MiB in all; 64 other hosts are remembered,
//!   with at most 1024 topics each.
//! - [`Counters`] add up, as [`Sent`] and [`Received`] say.
//!
//! # Example
//!
//! Two hubs of one process, and a network between them that is a pair of lines:
//!
//! ```
//! use monas_link::{Bridge, LinkSettings};
//! use monas_link::example::Ball;
//! use narukom::{Moment, Narukom, State, topic};
//!
//! topic! {
//!     /// Where the ball is.
//!     pub BALL: State<Ball> = "soccer/ball";
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let hubs = [Narukom::with_linked_topics("robot_1")?, Narukom::with_linked_topics("robot_2")?];
//! let settings = LinkSettings::default().sending("soccer/ball").receiving("soccer/ball");
//! let mut first = Bridge::new(&hubs[0], settings.clone(), 1)?;
//! let mut second = Bridge::new(&hubs[1], settings, 2)?;
//!
//! hubs[0].publisher(BALL, "vision")?.publish(Ball { distance: 1.5, bearing: 0.2 }, Moment::ZERO);
//! for millis in (0..1000).step_by(100) {
//!     let now = Moment::from_nanos(millis * 1_000_000);
//!     while let Some(packet) = first.poll(now) {
//!         second.handle(&packet, now);
//!     }
//!     while let Some(packet) = second.poll(now) {
//!         first.handle(&packet, now);
//!     }
//! }
//!
//! let mut mate = hubs[1].blackboard("mate");
//! mate.process_messages(Moment::ZERO);
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
mod protocol;
mod settings;
mod transport;

/// The messages of the examples.
#[doc(hidden)]
#[allow(missing_docs)]
pub mod example {
    narukom::include_messages!("monas.link.example");
}

pub use bridge::Bridge;
pub use error::{Error, ErrorKind};
pub use inbox::Inbox;
pub use link::{Link, Report, Transport};
pub use protocol::{
    AccessError, AccessList, Budget, ClockOffset, Counters, Delivery, LinkTopic, MessageBytes, Mismatch,
    Node, NodeSettings, Packet, Publication, Received, Reliability, Schema, Sent, Spent, VERSION,
    differences,
};
pub use settings::{LinkSettings, Place, ReceiveRule, SendRule};
#[cfg(all(unix, feature = "local"))]
pub use transport::{Local, default_folder};
#[cfg(feature = "zenoh")]
pub use transport::{Tls, Zenoh, ZenohSettings};
