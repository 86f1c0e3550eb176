//! The trait that every body implements.

use narukom::Timestamp;

use crate::{Actuators, Anatomy, Announcement, Heard, Sensors, Sightings};

/// Percepts of a body since the last call. Reused from cycle to cycle.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Percepts {
    /// Proprioceptive sensors; always present.
    pub sensors: Sensors,
    /// Sightings, if an image was taken.
    pub sightings: Option<Sightings>,
    /// The referee's announcement, if it has changed.
    pub announcement: Option<Announcement>,
    /// Radio messages of team mates, in the order of reception.
    pub heard: Vec<Heard>,
}

/// A body. The runtime owns it and calls [`sense`](Robot::sense) and [`act`](Robot::act), in this
/// order, once per cycle of the body.
///
/// Neither call blocks: a body behind a connection uses its own thread and returns the newest data.
pub trait Robot: Send {
    /// The properties and capabilities of the body.
    fn anatomy(&self) -> &Anatomy;

    /// Writes the current percepts. `percepts` contains the values of the previous call, except
    /// sightings, announcement and radio messages, which are cleared.
    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error>;

    /// Sets the commands from now on. Values beyond the limits of the anatomy are clamped.
    fn act(&mut self, now: Timestamp, actuators: &Actuators) -> Result<(), Error>;

    /// Makes the body safe permanently: in any state it comes to rest, sits down, switches off the
    /// stiffness of its joints, and ignores further commands. It may be called more than once. The
    /// default implementation stands still, for bodies that cannot sit.
    ///
    /// # Errors
    /// Like [`act`](Robot::act).
    fn rest(&mut self, now: Timestamp) -> Result<(), Error> {
        self.act(now, &Actuators::default())
    }

    /// Sends a radio message of at most [`Anatomy::radio`] bytes to the team. Delivery is not
    /// guaranteed.
    ///
    /// # Errors
    /// The body has no radio (the default implementation), or the message is too long.
    fn say(&mut self, _now: Timestamp, _words: &[u8]) -> Result<(), Error> {
        let model = &self.anatomy().model;
        Err(Error::new(ErrorKind::Hardware, format!("the {model} has no radio to speak to its team")))
    }
}

/// An error of a body that is unreachable or does not execute a command.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
}

/// The kinds of [`Error`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The other end of the connection does not respond.
    Disconnected,
    /// Received data violates the protocol.
    Protocol,
    /// A part reports a fault.
    Hardware,
}

impl Error {
    /// An error of a kind, with a message that names the faulty part.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Error {
        Error { kind, message: message.into() }
    }

    /// The kind of error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
