//! The trait that every body implements.

use narukom::Timestamp;

use crate::{
    Actuators, Anatomy, Announcement, Battery, Contacts, Heard, Images, Inertial, JointCommands, Joints,
    Leds, Sensors, Sightings, Sonar,
};

/// Percepts of a body since the last call. Reused from cycle to cycle.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Percepts {
    /// Proprioceptive sensors; always present.
    pub sensors: Sensors,
    /// Sightings, if an image was taken.
    pub sightings: Option<Sightings>,
    /// Images, if they were taken by a body that delivers them in place of sightings.
    pub images: Option<Images>,
    /// The referee's announcement, if it has changed.
    pub announcement: Option<Announcement>,
    /// Radio messages of team mates, in the order of reception.
    pub heard: Vec<Heard>,
    /// The joints, for a body whose anatomy has joints. This and the following values are kept from
    /// call to call and overwritten in place.
    pub joints: Option<Joints>,
    /// The inertial unit, if the body has one.
    pub inertial: Option<Inertial>,
    /// Contacts of the body, if it has sensors for them.
    pub contacts: Option<Contacts>,
    /// Distances by sound, if the body measures them.
    pub sonar: Option<Sonar>,
    /// The battery, if the body reports more than its charge.
    pub battery: Option<Battery>,
}

impl Percepts {
    /// Clears what is present only when it is new: sightings, images, announcement and radio
    /// messages.
    pub fn clear_news(&mut self) {
        self.sightings = None;
        self.images = None;
        self.announcement = None;
        self.heard.clear();
    }
}

/// A body. The runtime owns it and calls [`sense`](Robot::sense) and [`act`](Robot::act), in this
/// order, once per cycle of the body.
///
/// Neither call blocks: a body behind a connection uses its own thread and returns the newest data.
/// Only a body with a time of its own ([`BodyKind::has_own_time`](crate::BodyKind)) waits in
/// `sense` for the simulation that makes a cycle.
pub trait Robot: Send {
    /// The properties and capabilities of the body.
    fn anatomy(&self) -> &Anatomy;

    /// Writes the current percepts. `percepts` contains the values of the previous call, except
    /// sightings, announcement and radio messages, which are cleared.
    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error>;

    /// Sets the commands from now on. Values beyond the limits of the anatomy are clamped.
    fn act(&mut self, now: Timestamp, actuators: &Actuators) -> Result<(), Error>;

    /// Sets the commands to single joints from now on, see [`JointCommands`].
    ///
    /// # Errors
    /// The body has no joints to command (the default implementation), a value is not finite, or
    /// the commands do not fit the anatomy; the previous commands then hold.
    fn command_joints(&mut self, _now: Timestamp, _commands: &JointCommands) -> Result<(), Error> {
        let model = &self.anatomy().model;
        Err(Error::new(ErrorKind::Hardware, format!("the {model} has no joints to command")))
    }

    /// Sets the LEDs, see [`Leds`].
    ///
    /// # Errors
    /// The body has no LEDs of its own (the default implementation).
    fn light(&mut self, _now: Timestamp, _leds: &Leds) -> Result<(), Error> {
        let model = &self.anatomy().model;
        Err(Error::new(ErrorKind::Hardware, format!("the {model} has no LEDs to set")))
    }

    /// Delivers images in place of sightings from now on, see [`Images`]: of this width in pixels
    /// and three quarters as high, or of the usual size of the body.
    ///
    /// # Errors
    /// The body has no images to deliver (the default implementation), or none of this width.
    fn deliver_images(&mut self, _width: Option<u32>) -> Result<(), Error> {
        let model = &self.anatomy().model;
        Err(Error::new(ErrorKind::Configuration, format!("the {model} delivers no images")))
    }

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
    /// A command has no meaning for the body: a value is not finite, or there is no such joint.
    Command,
    /// There is no such kind of body, or it cannot be opened as configured.
    Configuration,
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
