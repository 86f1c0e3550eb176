//! Changes of agents while they run.
//!
//! A change is a message ([`CHANGE`](crate::records::CHANGE)) that somebody publishes on the host: a tool through the control socket, an
//! activity, or another process over a link that may. It is checked against what the agents are made of, everything it needs is made
//! ready, and only then the agent is told, between two of its cycles. The answer ([`CHANGED`](crate::records::CHANGED)) is published too,
//! so a tape has both.

mod findings;
mod modules;
mod plan;
mod roster;
mod save;
mod settings;
mod staff;

pub(super) use roster::{HOST_ITSELF, Roster};
pub(super) use staff::Staff;
