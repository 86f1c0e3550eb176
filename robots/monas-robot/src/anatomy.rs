//! The properties and capabilities of a body, and where its links are.

use std::time::Duration;

use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, UnitVector3, Vector3};

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
    /// Its pose in the frame of that link with all angles zero; metres.
    pub placement: Isometry3<f64>,
    /// How a joint moves it there; none if it is fixed.
    pub motion: Option<LinkMotion>,
    /// Its mass, kg.
    pub mass: f64,
    /// Its centre of mass in its own frame, metres.
    pub centre: Point3<f64>,
}

/// How a joint turns or shifts a link. One joint may move several links: a motor of the Nao turns
/// both hips.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LinkMotion {
    /// The index of the joint.
    pub joint: usize,
    /// The axis in the frame of the link.
    pub axis: UnitVector3<f64>,
    /// Whether it shifts the link along the axis, metres, and does not turn it about the axis.
    pub is_shift: bool,
    /// The angle or shift is `factor` times the joint's angle plus `offset`.
    pub factor: f64,
    /// See `factor`.
    pub offset: f64,
}

impl LinkMotion {
    /// The rotation about an axis by a joint's angle.
    pub const fn turn(joint: usize, axis: UnitVector3<f64>) -> LinkMotion {
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

    /// A point in the frame of a link, in that of the torso, with the joints at `angles`; metres.
    ///
    /// # Panics
    /// There is no such link, or an angle is missing.
    pub fn in_torso(&self, link: usize, point: Point3<f64>, angles: &[f64]) -> Point3<f64> {
        self.carriers(link).fold(point, |point, Link { placement, motion, .. }| {
            placement * motion.map_or(point, |motion| motion.move_point(point, angles))
        })
    }

    /// A pose in the frame of a link, in that of the torso, with the joints at `angles`.
    ///
    /// # Panics
    /// There is no such link, or an angle is missing.
    pub fn pose_in_torso(&self, link: usize, pose: Isometry3<f64>, angles: &[f64]) -> Isometry3<f64> {
        self.carriers(link).fold(pose, |pose, Link { placement, motion, .. }| {
            motion.map_or(*placement, |motion| placement * motion.isometry(angles)) * pose
        })
    }

    /// A link, the one that carries it, and so on up to the torso.
    fn carriers(&self, link: usize) -> impl Iterator<Item = &Link> {
        let parent = |link: &&Link| link.parent.map(|parent| &self.links[parent]);
        std::iter::successors(Some(&self.links[link]), parent)
    }

    /// The mass of all links, kg.
    pub fn mass(&self) -> f64 {
        self.links.iter().map(|link| link.mass).sum()
    }

    /// The centre of mass in the frame of the torso, with the joints at `angles`; metres. It is not
    /// finite for a body without mass.
    ///
    /// # Panics
    /// An angle is missing.
    pub fn centre_of_mass(&self, angles: &[f64]) -> Point3<f64> {
        let moment =
            |(index, link): (usize, &Link)| self.in_torso(index, link.centre, angles).coords * link.mass;
        let sum: Vector3<f64> = self.links.iter().enumerate().map(moment).sum();
        Point3::from(sum / self.mass())
    }
}

impl LinkMotion {
    /// The angle, radians, or the shift, metres.
    fn by(&self, angles: &[f64]) -> f64 {
        self.factor * angles[self.joint] + self.offset
    }

    fn isometry(&self, angles: &[f64]) -> Isometry3<f64> {
        let by = self.axis.into_inner() * self.by(angles);
        match self.is_shift {
            true => Translation3::from(by).into(),
            false => Isometry3::from_parts(Translation3::identity(), UnitQuaternion::new(by)),
        }
    }

    fn move_point(&self, point: Point3<f64>, angles: &[f64]) -> Point3<f64> {
        match self.is_shift {
            true => point + self.axis.into_inner() * self.by(angles),
            false => Rotation3::from_axis_angle(&self.axis, self.by(angles)) * point,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pole on the torso that turns about z, a slide along it, and a link that turns half as far
    /// the other way.
    fn crane() -> Anatomy {
        let joint = |name: &str| Joint { name: name.to_owned(), limits: Limits::symmetric(2.0), speed: None };
        let link = |name: &str, parent, [x, y, z]: [f64; 3], motion, mass| Link {
            name: name.to_owned(),
            parent,
            placement: Isometry3::translation(x, y, z),
            motion,
            mass,
            centre: Point3::new(0.5, 0.0, 0.0),
        };
        let pole = LinkMotion::turn(0, Vector3::z_axis());
        let slide = LinkMotion { is_shift: true, ..LinkMotion::turn(1, Vector3::x_axis()) };
        let counter = LinkMotion { factor: -0.5, offset: 0.1, ..pole };
        Anatomy {
            joints: vec![joint("pole"), joint("slide")],
            links: vec![
                link("torso", None, [0.0; 3], None, 2.0),
                link("pole", Some(0), [0.0, 0.0, 1.0], Some(pole), 0.0),
                link("slide", Some(1), [1.0, 0.0, 0.0], Some(slide), 2.0),
                link("counter", Some(0), [0.0, 0.0, 1.0], Some(counter), 0.0),
            ],
            ..Anatomy::new("crane", Duration::from_millis(10))
        }
    }

    #[test]
    fn links_are_where_the_joints_move_them() {
        let crane = crane();
        let angles = [std::f64::consts::FRAC_PI_2, 0.25];
        let slide = crane.link("slide").unwrap();
        let tip = crane.in_torso(slide, Point3::new(0.0, 0.1, 0.0), &angles);
        assert!((tip - Point3::new(-0.1, 1.25, 1.0)).norm() < 1e-12, "{tip}");
        let pose = crane.pose_in_torso(slide, Isometry3::identity(), &angles);
        assert!((tip - pose * Point3::new(0.0, 0.1, 0.0)).norm() < 1e-12, "{pose}");
        let counter = crane.link("counter").unwrap();
        let counter = crane.pose_in_torso(counter, Isometry3::identity(), &[0.6, 0.0]);
        assert!((counter.rotation.euler_angles().2 + 0.2).abs() < 1e-12, "{counter}");
        assert_eq!((crane.mass(), crane.joint("slide"), crane.link("hook")), (4.0, Some(1), None));
        let centre = crane.centre_of_mass(&angles);
        assert!((centre - Point3::new(0.25, 0.875, 0.5)).norm() < 1e-12, "{centre}");
    }

    #[test]
    fn limits_hold_what_is_no_number() {
        assert_eq!(Limits::symmetric(1.0).clamp(f64::NAN), 0.0);
        assert_eq!(Limits::new(0.5, 1.0).clamp(f64::NAN), 0.5);
        assert_eq!(Limits::symmetric(1.0).clamp(f64::INFINITY), 1.0);
        assert!(Limits::symmetric(1.0).contains(-1.0));
    }
}
