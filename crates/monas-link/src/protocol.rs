//! What links say to each other, and when: without sockets, threads and clocks.

mod access;
mod budget;
mod clock;
mod counters;
mod incoming;
mod node;
mod outgoing;
mod payload;
mod peers;
mod schema;

pub use access::{AccessError, AccessList};
pub use budget::{Budget, Spent};
pub use clock::ClockOffset;
pub use counters::{Counters, Received, Sent};
pub use node::{Delivery, LinkTopic, Mismatch, Node, NodeSettings, Packet, Publication, Reliability};
pub use payload::MessageBytes;
pub use schema::{Schema, differences};

/// The messages of the protocol.
#[allow(missing_docs)]
// datagrams are for local sockets
#[cfg_attr(not(all(unix, feature = "local")), allow(dead_code))]
pub(crate) mod wire {
    narukom::include_messages!("monas.link");
}

/// The version of the protocol; links of other versions do not talk to each other.
pub const VERSION: u32 = 1;
