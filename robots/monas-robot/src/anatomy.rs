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

/// A camera and its field of view.
#[derive(Clone, PartialEq, Debug)]
pub struct Camera {
    /// Its name: `top`.
    pub name: String,
    /// The index of the link whose x axis is its line of sight, with y to the left in the image;
    /// none for a body without links.
    pub link: Option<usize>,
    /// Angle of view from left to right, radians.
    pub horizontal: f64,
    /// Angle of view from top to bottom, radians.
    pub vertical: f64,
}

/// A joint with one axis: a motor with its encoder.
#[derive(Clone, PartialEq, Debug)]
pub struct Joint {
    /// Its name: `HeadYaw`.
    pub name: String,
    /// The range of its angle, radians.
    pub limits: Limits,
    /// The greatest angular speed, rad/s, if it is known.
    pub speed: Option<f64>,
}

/// A rigid part of a body. Its frame is at the joint that moves it.
#[derive(Clone, PartialEq, Debug)]
pub struct Link {
    /// Its name: `torso`.
    pub name: String,
    /// The index of the link that carries it, which is smaller than its own; none for the torso,
    /// which is the first one.
    pub parent: Option<usize>,
    /// Its position in the frame of that link with all angles zero; metres.
    pub offset: [f64; 3],
    /// Its orientation there: rotations about the fixed axes x, y and z, in this order; radians.
    pub rotation: [f64; 3],
    /// The joint that moves it, and the kind of motion; none if it is fixed.
    pub motion: Option<LinkMotion>,
    /// Its mass, kg.
    pub mass: f64,
    /// Its centre of mass in its own frame, metres.
    pub centre: [f64; 3],
}

/// The motion of a link by a joint. One joint may move several links: a motor of the Nao turns
/// both hips.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LinkMotion {
    /// The index of the joint.
    pub joint: usize,
    /// The unit vector of the axis, in the frame of the link.
    pub axis: [f64; 3],
    /// Whether it shifts the link along the axis, metres, and does not turn it about the axis.
    pub is_shift: bool,
    /// The angle or shift is `factor` times the joint's angle plus `offset`.
    pub factor: f64,
    /// See `factor`.
    pub offset: f64,
}

impl LinkMotion {
    /// The rotation about an axis by a joint's angle.
    pub const fn turn(joint: usize, axis: [f64; 3]) -> LinkMotion {
        LinkMotion { joint, axis, is_shift: false, factor: 1.0, offset: 0.0 }
    }
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
    /// The cameras.
    pub cameras: Vec<Camera>,
    /// The named skills of the body.
    pub skills: Vec<Skill>,
    /// Largest radio message in bytes; zero for a body without a radio.
    pub radio: usize,
    /// The joints, in the order of all messages about joints; none for a body without.
    pub joints: Vec<Joint>,
    /// The links, each after the one that carries it; none for a body whose links are not known.
    pub links: Vec<Link>,
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
            cameras: Vec::new(),
            skills: Vec::new(),
            radio: 0,
            joints: Vec::new(),
            links: Vec::new(),
            has_leds: false,
        }
    }

    /// The index of a joint.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// The index of a link.
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
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
