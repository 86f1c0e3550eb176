//! Commands to a body.

use crate::{Error, ErrorKind, Side, Velocity};

/// A command to a body. It holds until the next one. A skill (every motion except standing, walking
/// and freezing) begins once and runs to its end; a skill requested while another is running is
/// dropped.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// Desired head yaw, radians, positive to the left; limited by the joint.
    pub head_yaw: f64,
    /// Desired head pitch, radians, positive downwards; limited by the joint.
    pub head_pitch: f64,
    /// Desired motion of the rest of the body.
    pub motion: Motion,
    /// Desired speed of the ball after a kick, m/s; zero: as fast as the body kicks it.
    pub ball_speed: f64,
}

/// Desired motion of the legs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Motion {
    /// Stop and stand.
    #[default]
    Stand,
    /// Walk with this velocity, as far as the body can.
    Walk(Velocity),
    /// Kick straight ahead with a foot.
    Kick(Side),
    /// Fall from the knees to a side, to block near the body.
    Fall(Side),
    /// Dive to a side, to block far from the body.
    Dive(Side),
    /// Stand up, when lying or sitting.
    StandUp,
    /// Sit down, when standing or walking.
    Sit,
    /// Stop every joint at once, the head too.
    Freeze,
}

impl Command {
    /// A command for the legs with the head straight ahead.
    pub fn new(motion: Motion) -> Self {
        Self { motion, ..Self::default() }
    }

    /// Walks with this velocity, the head straight ahead.
    pub fn walk(forward: f64, left: f64, turn: f64) -> Self {
        Self::new(Motion::Walk(Velocity::new(forward, left, turn)))
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let finite_walk = match self.motion {
            Motion::Walk(velocity) => velocity.is_finite(),
            _ => true,
        };
        if finite_walk
            && self.ball_speed.is_finite()
            && self.head_yaw.is_finite()
            && self.head_pitch.is_finite()
        {
            return Ok(());
        }
        Err(Error::new(ErrorKind::OutOfRange, "a command holds a number that is not finite"))
    }
}
