//! What a body feels and sees.

use crate::{Phase, Pose, Side, Sighting};

/// Everything that a body reports. One value is filled again and again, so that reading it allocates nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Senses {
    /// Time of the readings since the world began, s.
    pub time: f64,
    /// The way since the last reading, as odometry believes: the pose now in the frame of the pose then. A body
    /// that is carried or pushed does not feel it.
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
    /// What the body is doing.
    pub phase: Phase,
    /// Part of that (of the stride, while walking) that is done, from 0 to 1.
    pub progress: f64,
    /// The foot that carries the body, while walking.
    pub support: Option<Side>,
    /// The buttons and bumpers that are pressed.
    pub buttons: Buttons,
    /// True when `sightings` is a picture taken since the last reading.
    pub new_picture: bool,
    /// What the newest picture shows; empty when there is no new one.
    pub sightings: Vec<Sighting>,
}

impl Senses {
    /// Answers whether the body lies on the ground.
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
pub(crate) fn torso_tilt(phase: Phase, progress: f64, sway: f64) -> (f64, f64) {
    use std::f64::consts::{FRAC_PI_2, TAU};
    let toward = |direction: crate::Direction, part: f64| {
        let down = direction.vector() * (FRAC_PI_2 * part);
        (-down.y, down.x)
    };
    match phase {
        Phase::Standing | Phase::SittingDown | Phase::Sitting => (0.0, 0.0),
        Phase::Walking => (sway * libm::sin(TAU * progress), 0.0),
        Phase::Kicking(foot) => (foot.sign() * sway, 0.0),
        Phase::SideFalling(side) | Phase::Diving(side) => toward(side.into(), progress),
        Phase::Falling(direction) => toward(direction, progress),
        Phase::Fallen(direction) => toward(direction, 1.0),
        Phase::StandingUp => toward(crate::Direction::Front, 1.0 - progress),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Direction;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn the_torso_tilts_where_the_body_lies() {
        assert_eq!(torso_tilt(Phase::Fallen(Direction::Front), 0.0, 0.1), (0.0, FRAC_PI_2));
        assert_eq!(torso_tilt(Phase::Fallen(Direction::Back), 0.0, 0.1).1, -FRAC_PI_2);
        assert_eq!(torso_tilt(Phase::Fallen(Direction::Left), 0.0, 0.1).0, -FRAC_PI_2);
        assert_eq!(torso_tilt(Phase::Diving(Side::Right), 1.0, 0.1).0, FRAC_PI_2);
        assert_eq!(torso_tilt(Phase::Standing, 0.0, 0.1), (0.0, 0.0));
    }
}
