//! The properties and capabilities of a body.

use std::time::Duration;

use crate::Skill;

/// The range of a joint or velocity; radians, metres, or these per second.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Limits {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
}

impl Limits {
    /// From `low` to `high`.
    pub const fn new(low: f64, high: f64) -> Limits {
        Limits { low, high }
    }

    /// From `-size` to `size`.
    pub const fn symmetric(size: f64) -> Limits {
        Limits::new(-size, size)
    }

    /// The nearest value within the range; NaN becomes the value nearest zero.
    pub fn clamp(self, value: f64) -> f64 {
        let value = if value.is_nan() { 0.0 } else { value };
        value.max(self.low).min(self.high)
    }

    /// Whether a value lies within the range.
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

/// The field of view of a camera.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Camera {
    /// Angle of view from left to right, radians.
    pub horizontal: f64,
    /// Angle of view from top to bottom, radians.
    pub vertical: f64,
    /// Height above the ground while standing, metres.
    pub height: f64,
}

/// A joint with one axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Joint {
    /// Its name: `HeadYaw`.
    pub name: &'static str,
    /// The range of its angle, radians.
    pub limits: Limits,
    /// The index of the joint that carries it; none for a joint at the torso.
    pub parent: Option<usize>,
    /// Where it is in the frame of that joint, or of the torso, with all angles zero; metres.
    pub offset: [f64; 3],
    /// The unit vector about which it turns, in its own frame. It is zero for a joint that does not
    /// move the links after it, such as the fingers of a hand.
    pub axis: [f64; 3],
}

/// The properties and capabilities of a body, known before it moves.
#[derive(Clone, PartialEq, Debug)]
pub struct Anatomy {
    /// The model: `field robot`, `nao v6`.
    pub model: String,
    /// The period with which the body senses and acts.
    pub cycle: Duration,
    /// Range of the head, positive to the left.
    pub head_yaw: Limits,
    /// Range of the head, positive downwards.
    pub head_pitch: Limits,
    /// Range of the forward velocity, m/s; zero for a body without its own walk engine.
    pub walk_x: Limits,
    /// Range of the lateral velocity, m/s, positive to the left.
    pub walk_y: Limits,
    /// Range of the angular velocity, rad/s.
    pub walk_turn: Limits,
    /// The camera, for bodies that report sightings.
    pub camera: Option<Camera>,
    /// The named skills of the body.
    pub skills: Vec<Skill>,
    /// Largest radio message in bytes; zero for a body without a radio.
    pub radio: usize,
    /// The joints, in the order of all messages about joints; none for a body without.
    pub joints: Vec<Joint>,
    /// The greatest angular speed of each joint, rad/s, in the same order; none if it is not known.
    pub joint_speeds: Vec<f64>,
    /// Whether the body has LEDs beyond those in [`Actuators`](crate::Actuators).
    pub has_leds: bool,
}

impl Anatomy {
    /// A body with a period and the head ranges of a Nao, without other capabilities.
    pub fn new(model: impl Into<String>, cycle: Duration) -> Anatomy {
        Anatomy {
            model: model.into(),
            cycle,
            head_yaw: Limits::symmetric(2.0857),
            head_pitch: Limits::new(-0.6720, 0.5149),
            walk_x: Limits::symmetric(0.0),
            walk_y: Limits::symmetric(0.0),
            walk_turn: Limits::symmetric(0.0),
            camera: None,
            skills: Vec::new(),
            radio: 0,
            joints: Vec::new(),
            joint_speeds: Vec::new(),
            has_leds: false,
        }
    }

    /// The index of a joint.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_hold_what_is_no_number() {
        assert_eq!(Limits::symmetric(1.0).clamp(f64::NAN), 0.0);
        assert_eq!(Limits::new(0.5, 1.0).clamp(f64::NAN), 0.5);
        assert_eq!(Limits::symmetric(1.0).clamp(f64::INFINITY), 1.0);
        assert!(Limits::symmetric(1.0).contains(-1.0));
    }
}
