//! Readings of a body's sensors and cameras.

use crate::{BodyPhase, Pose, Side, Sighting};

/// All readings of a body. A value is reused, so that reading does not allocate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Senses {
    /// Time of the readings since the world began, s.
    pub time: f64,
    /// Displacement since the last reading, measured by odometry: the current pose in the frame of
    /// the previous one. Being carried or pushed is not measured.
    pub odometry: Pose,
    /// Head yaw, rad, to the left.
    pub head_yaw: f64,
    /// Head pitch, rad, positive looks down.
    pub head_pitch: f64,
    /// Tilt of the torso to the right, rad.
    pub torso_roll: f64,
    /// Tilt of the torso to the front, rad.
    pub torso_pitch: f64,
    /// Turning speed of the torso about its x, y and z axes, rad/s.
    pub gyro: [f64; 3],
    /// The phase of the body's motion.
    pub phase: BodyPhase,
    /// Progress of the phase (of the stride, while walking), from 0 to 1.
    pub progress: f64,
    /// The supporting foot, while walking.
    pub support: Option<Side>,
    /// Whether the feet carry nothing: a person has lifted the body, or taken it off the field.
    pub is_lifted: bool,
    /// The buttons and bumpers that are pressed.
    pub buttons: Buttons,
    /// Whether `sightings` is a picture taken since the last reading.
    pub new_picture: bool,
    /// The objects in the newest picture; empty if there is no new one.
    pub sightings: Vec<Sighting>,
}

impl Senses {
    /// Whether the body lies on the ground.
    pub fn is_fallen(&self) -> bool {
        self.phase.is_fallen()
    }
}

/// Buttons of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Buttons {
    /// The button on the chest.
    pub chest: bool,
    /// The bumper on the left foot.
    pub left_bumper: bool,
    /// The bumper on the right foot.
    pub right_bumper: bool,
}

/// Roll and pitch of the torso, without noise, in a phase.
pub(crate) fn torso_tilt(phase: BodyPhase, progress: f64, sway: f64) -> (f64, f64) {
    use std::f64::consts::{FRAC_PI_2, TAU};
    let toward = |direction: crate::Direction, part: f64| {
        let down = direction.vector() * (FRAC_PI_2 * part);
        (-down.y, down.x)
    };
    match phase {
        BodyPhase::Standing | BodyPhase::SittingDown | BodyPhase::Sitting => (0.0, 0.0),
        BodyPhase::Walking => (sway * libm::sin(TAU * progress), 0.0),
        BodyPhase::Kicking(foot) => (foot.sign() * sway, 0.0),
        BodyPhase::SideFalling(side) | BodyPhase::Diving(side) => toward(side.into(), progress),
        BodyPhase::Falling(direction) => toward(direction, progress),
        BodyPhase::Fallen(direction) => toward(direction, 1.0),
        BodyPhase::StandingUp => toward(crate::Direction::Front, 1.0 - progress),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Direction;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn the_torso_tilts_where_the_body_lies() {
        assert_eq!(torso_tilt(BodyPhase::Fallen(Direction::Front), 0.0, 0.1), (0.0, FRAC_PI_2));
        assert_eq!(torso_tilt(BodyPhase::Fallen(Direction::Back), 0.0, 0.1).1, -FRAC_PI_2);
        assert_eq!(torso_tilt(BodyPhase::Fallen(Direction::Left), 0.0, 0.1).0, -FRAC_PI_2);
        assert_eq!(torso_tilt(BodyPhase::Diving(Side::Right), 1.0, 0.1).0, FRAC_PI_2);
        assert_eq!(torso_tilt(BodyPhase::Standing, 0.0, 0.1), (0.0, 0.0));
    }
}
