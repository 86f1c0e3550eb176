//! The control socket: how tools on the same computer look at a run, and publish in it.
//!
//! A run serves a socket ([`ControlServer`]) that tools connect to ([`ControlClient`]). It lies in `$XDG_RUNTIME_DIR/monas/NAME.sock`, is
//! open to its owner alone (mode 0600), and on Linux the system is asked besides who is at the other end. What is said is protobuf,
//! `proto/control.proto`; messages of topics travel as their own encoding, and are decoded by the tool, with the schema that the run
//! gives it.
//!
//! Whoever connects can neither hold a run up nor fill its memory: hubs are read as by any reader that fetches when it likes, so a
//! tool that is too slow loses messages, which are counted, and one that does not take what it asked for is left. At most
//! [`CLIENT_LIMIT`] are served at a time, and a request has at most [`REQUEST_LIMIT`] bytes.

mod client;
pub(crate) mod frame;
mod server;
mod watch;

use narukom::{Moment, Narukom};

pub use client::{ControlClient, Watching, control_sockets};
pub use server::ControlServer;

/// So many tools are served at a time; one more is refused.
pub const CLIENT_LIMIT: usize = 16;

/// A request has at most so many bytes.
pub const REQUEST_LIMIT: usize = 4 << 20;

/// The messages of a watch that are longer than this are told of without their content.
pub const PAYLOAD_LIMIT: usize = 8 << 20;

/// A run that can be looked at.
pub trait Observed: Send + Sync {
    /// The hubs of its hosts.
    fn hubs(&self) -> &[Narukom];

    /// How far it is.
    fn now(&self) -> Moment;

    /// Whether its time is simulated.
    fn is_simulated(&self) -> bool;

    /// Publishes the message that `bytes` encode.
    ///
    /// # Errors
    /// Why not: lower case.
    fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String>;

    /// Answers what is asked of the agents: in words of their own, which the socket does not know.
    ///
    /// # Errors
    /// Why not: lower case.
    fn manage(&self, inquiry: &[u8]) -> Result<Vec<u8>, String> {
        let _ = inquiry;
        Err("this run has no agents that could be managed".into())
    }
}

/// What is asked and answered.
#[allow(missing_docs)]
pub mod messages {
    narukom::include_messages!("monas.control");
}
