//! What the robots of the server differ in: joints, lengths, masses, and numbers of their motions.

use std::time::Duration;

use monas_robot::{Anatomy, Camera, Joint, Limits, Skill};
use nalgebra::{Point3, Vector3};

use crate::k1::K1;
use crate::t1::T1;

/// The greatest number of joints of a robot. Lists of joints have this length for all robots; those
/// of a robot with fewer joints end with values that stay zero.
pub const JOINTS: usize = 23;

/// A value for each joint, in the order of the anatomy.
pub type JointValues = [f64; JOINTS];

/// The period of the server: four steps of its physics.
pub(crate) const CYCLE: Duration = Duration::from_millis(20);
/// The same in seconds.
pub(crate) const CYCLE_SECONDS: f64 = 0.02;

/// The head's yaw, of each robot.
pub(crate) const HEAD_YAW: usize = 0;
/// The head's pitch.
pub(crate) const HEAD_PITCH: usize = 1;
/// The roll of the left shoulder.
pub(crate) const LEFT_SHOULDER_ROLL: usize = 3;
/// The roll of the right shoulder.
pub(crate) const RIGHT_SHOULDER_ROLL: usize = 7;

pub(crate) const ROLL: [f64; 3] = [1.0, 0.0, 0.0];
pub(crate) const PITCH: [f64; 3] = [0.0, 1.0, 0.0];
pub(crate) const YAW: [f64; 3] = [0.0, 0.0, 1.0];

/// A robot of the server: [`T1`](crate::T1) or [`K1`](crate::K1). Lengths are in metres.
///
/// The joints are in the order of the server's perceptors: head, left arm, right arm, waist if
/// there is one, left leg, right leg. Those of a leg are pitch, roll and yaw of the hip, knee,
/// pitch and roll of the ankle.
#[derive(PartialEq, Debug)]
pub struct Humanoid {
    /// With which it joins the server.
    pub(crate) name: &'static str,
    /// The name of its anatomy.
    pub(crate) full_name: &'static str,
    pub(crate) joints: &'static [JointRow],
    pub(crate) torso: Link,
    /// The links in the order of the joints that move them.
    pub(crate) links: &'static [Link],
    pub(crate) waist: Option<usize>,
    /// The first joint of a leg.
    pub(crate) left_leg: usize,
    pub(crate) right_leg: usize,
    /// The height of the torso's origin above the soles with straight knees.
    pub(crate) straight_height: f64,
    /// The height of the torso's origin above the ground where the server places the robot: a K1
    /// falls almost half a metre.
    pub(crate) placed_height: f64,
    /// From the ankle's roll joint down to the sole.
    pub(crate) sole: f64,
    /// The corners of a sole in the frame of the ankle's roll joint: those of the foot's box.
    pub(crate) corners: [Point3<f64>; 4],
    /// From the pitch joint of the head to the camera.
    pub(crate) camera: Vector3<f64>,
    /// The middle between the hips in the torso frame.
    pub(crate) hips: Point3<f64>,
    /// From the middle between the hips to the pitch joint of the left one, and to its foot in a
    /// straight stand.
    pub(crate) beside: f64,
    /// From the pitch joint of the hip to the knee, and from there to the pitch joint of the ankle.
    pub(crate) thigh: f64,
    pub(crate) shank: f64,
    /// The angle between the lines of thigh and shank when the joints are at zero, rad.
    pub(crate) knee_at_straight: f64,
    /// Torque per angle and per angular velocity of a joint of a leg, and of another one, that is
    /// commanded with a stiffness of 1.
    pub(crate) leg_gains: (f64, f64),
    pub(crate) other_gains: (f64, f64),
    /// Torque per angular velocity of all joints of a robot that rests: it sinks.
    pub(crate) slack: f64,
    /// The files of the parameters of its walk and kick.
    pub(crate) walk: &'static str,
    pub(crate) kick: &'static str,
}

/// The mass of a link, kg, and its centre in the frame of the joint that moves it, m.
pub(crate) type Link = (f64, [f64; 3]);

/// A joint: its names here and at the server, its range, rad, and where its axis is fixed to the
/// link of its parent, none for the torso.
#[derive(PartialEq, Debug)]
pub(crate) struct JointRow {
    name: &'static str,
    motor: &'static str,
    perceptor: &'static str,
    low: f64,
    high: f64,
    parent: Option<usize>,
    offset: [f64; 3],
    axis: [f64; 3],
}

#[allow(clippy::too_many_arguments)] // a row of a table
pub(crate) const fn row(
    name: &'static str,
    motor: &'static str,
    perceptor: &'static str,
    range: (f64, f64),
    parent: Option<usize>,
    offset: [f64; 3],
    axis: [f64; 3],
) -> JointRow {
    JointRow { name, motor, perceptor, low: range.0, high: range.1, parent, offset, axis }
}

impl Humanoid {
    /// All robots that can be named; the first one is the default.
    pub const ALL: [&'static Humanoid; 2] = [&T1, &K1];

    /// Their names, in the same order.
    pub(crate) const NAMES: [&'static str; 2] = [Humanoid::ALL[0].name, Humanoid::ALL[1].name];

    /// The robot with a name, such as `K1`.
    pub fn named(name: &str) -> Option<&'static Humanoid> {
        Humanoid::ALL.into_iter().find(|robot| robot.name == name)
    }

    /// The name with which it joins the server.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The number of its joints.
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// The height of the torso's origin above the ground in a stand with straight knees, m.
    pub fn straight_height(&self) -> f64 {
        self.straight_height
    }

    /// The middle between the hips in the torso frame, m.
    pub fn hips(&self) -> Point3<f64> {
        self.hips
    }

    /// The range of a joint, rad.
    ///
    /// # Panics
    /// There is no such joint.
    pub fn limits(&self, joint: usize) -> Limits {
        Limits::new(self.joints[joint].low, self.joints[joint].high)
    }

    /// Torque per angle, Nm/rad, and per angular velocity, Nm s/rad, of a joint that is commanded
    /// with a stiffness of 1.
    pub fn gains(&self, joint: usize) -> (f64, f64) {
        if joint < self.left_leg { self.other_gains } else { self.leg_gains }
    }

    /// The name of the motor of a joint.
    pub(crate) fn motor(&self, joint: usize) -> &'static str {
        self.joints[joint].motor
    }

    /// The joint of a perceptor.
    pub(crate) fn of_perceptor(&self, name: &[u8]) -> Option<usize> {
        self.joints.iter().position(|row| row.perceptor.as_bytes() == name)
    }

    /// Offset and axis of a joint, and the joint that carries it.
    pub(crate) fn link(&self, joint: usize) -> ([f64; 3], [f64; 3], Option<usize>) {
        let JointRow { offset, axis, parent, .. } = self.joints[joint];
        (offset, axis, parent)
    }

    /// The anatomy of a robot that walks within limits: ahead, to a side, turning.
    pub(crate) fn anatomy(&self, walk_x: Limits, walk_y: Limits, walk_turn: Limits) -> Anatomy {
        let joint = |row: &JointRow| Joint {
            name: row.name,
            limits: Limits::new(row.low, row.high),
            parent: row.parent,
            offset: row.offset,
            axis: row.axis,
        };
        // The server shows what lies within 60 degrees of the camera's axis, horizontally and
        // vertically.
        let view = 2.0 * std::f64::consts::FRAC_PI_3;
        let height = self.straight_height + self.camera(&[0.0; JOINTS]).z;
        Anatomy {
            head_yaw: self.limits(HEAD_YAW),
            head_pitch: self.limits(HEAD_PITCH),
            walk_x,
            walk_y,
            walk_turn,
            camera: Some(Camera { horizontal: view, vertical: view, height }),
            skills: vec![Skill::KickLeft, Skill::KickRight, Skill::StandUp],
            joints: self.joints.iter().map(joint).collect(),
            ..Anatomy::new(self.full_name, CYCLE)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_right_side_mirrors_the_left() {
        let still = Limits::symmetric(0.0);
        for robot in Humanoid::ALL {
            let anatomy = robot.anatomy(still, still, still);
            for (index, left) in
                anatomy.joints.iter().enumerate().filter(|(_, joint)| joint.name.starts_with('L'))
            {
                let right = anatomy.joint(&left.name.replacen('L', "R", 1)).unwrap();
                assert_eq!(right - index, if index < robot.left_leg { 4 } else { 6 }, "{}", left.name);
                let (joint, [x, y, z]) = (&anatomy.joints[right], left.offset);
                assert_eq!(joint.offset, [x, -y, z]);
                let Limits { low, high } = left.limits;
                let is_mirrored = left.axis != PITCH;
                assert_eq!(joint.limits, if is_mirrored { Limits::new(-high, -low) } else { left.limits });
            }
        }
    }

    #[test]
    fn every_perceptor_and_motor_has_one_joint() {
        for robot in Humanoid::ALL {
            for (index, row) in robot.joints.iter().enumerate() {
                assert_eq!(robot.of_perceptor(row.perceptor.as_bytes()), Some(index));
                assert_eq!(robot.joints.iter().filter(|other| other.motor == row.motor).count(), 1);
            }
            assert_eq!(robot.of_perceptor(b"q_l4j1"), None);
            assert_eq!(robot.joint_count(), robot.links.len());
        }
    }

    #[test]
    fn a_joint_is_where_its_names_say() {
        for robot in Humanoid::ALL {
            let at = |name| robot.joints.iter().position(|row| row.name == name);
            assert_eq!((at("HeadYaw"), at("HeadPitch")), (Some(HEAD_YAW), Some(HEAD_PITCH)));
            let shoulders = (at("LShoulderRoll"), at("RShoulderRoll"));
            assert_eq!(shoulders, (Some(LEFT_SHOULDER_ROLL), Some(RIGHT_SHOULDER_ROLL)));
            assert_eq!(at("Waist"), robot.waist);
            let legs = (at("LHipPitch"), at("RHipPitch"));
            assert_eq!(legs, (Some(robot.left_leg), Some(robot.right_leg)));
        }
        assert_eq!(T1.joint_count() - K1.joint_count(), 1, "the waist");
    }

    #[test]
    fn robots_are_found_by_their_names() {
        assert_eq!(Humanoid::named("K1").map(Humanoid::joint_count), Some(22));
        assert_eq!(Humanoid::named("k1"), None);
    }
}
