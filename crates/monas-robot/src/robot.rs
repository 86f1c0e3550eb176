//! The trait that every body implements.

use narukom::Moment;

use crate::{Actuators, Anatomy, Announcement, Heard, Sensors, Sightings};

/// What a body has sensed since it was last asked. Reused from cycle to cycle.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Percepts {
    /// What it feels; always there.
    pub sensors: Sensors,
    /// What it sees, if an image was taken.
    pub sightings: Option<Sightings>,
    /// What the referee says, if something has changed.
    pub announcement: Option<Announcement>,
    /// What others of the team have said since, in the order in which it came.
    pub heard: Vec<Heard>,
}

/// A body. The runtime owns it, asks it what it senses and tells it what to do, in this order, once a cycle of the body.
///
/// Neither call waits: a body that talks over a wire keeps its own thread and answers with the newest it has.
pub trait Robot: Send {
    /// What the body is made of and can do.
    fn anatomy(&self) -> &Anatomy;

    /// Writes what is sensed now. `percepts` holds what the previous call left there, with sightings, announcement and all
    /// that was heard taken out.
    fn sense(&mut self, now: Moment, percepts: &mut Percepts) -> Result<(), Error>;

    /// Takes what is to be done from now on. Values beyond the limits of the anatomy are brought within them.
    fn act(&mut self, now: Moment, actuators: &Actuators) -> Result<(), Error>;

    /// Makes the body safe, for good: whatever it does, it comes to rest, sits down and takes the stiffness off its joints, and takes no more commands. It may be told so more than once. A
    /// body that cannot sit stands still, which is what this does if a body does not say otherwise.
    ///
    /// # Errors
    /// As of [`act`](Robot::act).
    fn rest(&mut self, now: Moment) -> Result<(), Error> {
        self.act(now, &Actuators::default())
    }

    /// Says something to the others of the team, over the air: at most [`Anatomy::radio`] bytes, and none of it may arrive.
    ///
    /// # Errors
    /// The body has no radio, which is what this does if a body does not say otherwise, or these are more bytes than it sends.
    fn say(&mut self, _now: Moment, _words: &[u8]) -> Result<(), Error> {
        let model = &self.anatomy().model;
        Err(Error::new(ErrorKind::Hardware, format!("the {model} has no radio to speak to its team")))
    }
}

/// A body that cannot be reached or does not do what it was asked.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
}

/// What has gone wrong with a body.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// Nobody answers at the other end.
    Disconnected,
    /// What came is not what the protocol says.
    Protocol,
    /// A part reports a fault.
    Hardware,
}

impl Error {
    /// An error of a kind, with a message that names the thing at fault.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Error {
        Error { kind, message: message.into() }
    }

    /// What has gone wrong.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
