//! The control socket, through which tools on the same computer inspect a run and publish in it.
//!
//! A run serves a socket ([`ControlServer`]) that tools connect to ([`ControlClient`]). Its path is
//! `NAME.sock` in the [default folder](crate::default_folder); it is accessible to its owner only
//! (mode 0600, in a folder that is the owner's alone), and on Linux the peer's credentials are
//! checked as well. The protocol is protobuf, `proto/control.proto`; messages of topics are
//! transferred in their own encoding, and decoded by the tool with the schema from the run.
//!
//! A tool can neither block a run nor exhaust its memory: hubs are polled as by any other reader,
//! so a tool that is too slow loses messages, which are counted, and one that does not read its
//! replies is disconnected, as is one that sends a request in very small parts. At most
//! [`CLIENT_LIMIT`] tools are served at a time, and a request has at most [`REQUEST_LIMIT`] bytes.

mod client;
pub(crate) mod frame;
mod host_watch;
mod server;

use narukom::{Hub, Timestamp};

pub use client::{ControlClient, WatchStream, control_sockets};
pub use server::{ControlServer, ControlSocket};

/// The most tools that are served at a time; further ones are rejected.
pub const CLIENT_LIMIT: usize = 16;

/// Longest request, in bytes.
pub const REQUEST_LIMIT: usize = 4 << 20;

/// Longest message that a watch transfers, in bytes; of longer ones it sends only the metadata.
pub const PAYLOAD_LIMIT: usize = 8 << 20;

/// A run that can be inspected.
pub trait ControlTarget: Send + Sync {
    /// The hubs of its hosts.
    fn hubs(&self) -> &[Hub];

    /// The current time of the run.
    fn now(&self) -> Timestamp;

    /// Whether its time is simulated.
    fn is_simulated(&self) -> bool;

    /// Conditions that endanger the run's results at present, for people: a recording cannot be
    /// written.
    fn alarms(&self) -> Vec<String> {
        Vec::new()
    }

    /// Publishes an encoded message.
    ///
    /// # Errors
    /// The reason, in lower case.
    fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String>;

    /// Handles a management request, in a format that is opaque to the socket.
    ///
    /// # Errors
    /// The reason, in lower case.
    fn manage(&self, inquiry: &[u8]) -> Result<Vec<u8>, String> {
        let _ = inquiry;
        Err("this run has no agents that could be managed".into())
    }
}

/// Requests and replies.
#[allow(missing_docs)]
pub mod messages {
    narukom::include_messages!("monas.control");
}
