//! The link protocol, without sockets, threads and clocks.

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
pub use budget::{BudgetUsage, SendBudget};
pub use clock::ClockOffset;
pub use counters::{Counters, ReceivedCounters, SentCounters};
pub use node::{
    LinkTopic, Mismatch, Node, NodeSettings, OutgoingPublication, Packet, ReceivedMessage, Reliability,
};
pub use payload::MessageBytes;
pub use schema::{Schema, differences};

/// The messages of the protocol.
#[allow(missing_docs)]
// Only the local transport uses datagrams.
#[cfg_attr(not(all(unix, feature = "local")), allow(dead_code))]
pub(crate) mod wire {
    narukom::include_messages!("monas.link");
}

/// The version of the protocol; links of different versions do not communicate.
pub const VERSION: u32 = 1;
