//! The differences between the robots of the server: the anatomy, which is read from a file, and
//! parameters of their motions.

use std::sync::LazyLock;

use monas_config::urdf;
use monas_kinematics::LinkTree;
use monas_robot::{Anatomy, Limits};
use nalgebra::Point3;
use yase::Source;

use crate::k1::K1;
use crate::t1::T1;

/// The greatest number of joints of a robot. Lists of joints have this length for all robots; those
/// of a robot with fewer joints end with values that stay zero.
pub const JOINTS: usize = 23;

/// A value for each joint, in the order of the anatomy.
pub type JointValues = [f64; JOINTS];

/// The period of the server, s: four steps of its physics.
pub(crate) const CYCLE_SECONDS: f64 = 0.02;

/// The head's yaw, of each robot.
pub(crate) const HEAD_YAW: usize = 0;
/// The head's pitch.
pub(crate) const HEAD_PITCH: usize = 1;
/// The roll of the left shoulder.
pub(crate) const LEFT_SHOULDER_ROLL: usize = 3;
/// The roll of the right shoulder.
pub(crate) const RIGHT_SHOULDER_ROLL: usize = 7;

/// The joint that some robots lack.
const WAIST_JOINT: usize = 10;

/// The names of the joints, and of their motors and perceptors at the server.
const CHANNELS: [(&str, &str, &str); JOINTS] = [
    ("HeadYaw", "he1", "q_hj1"),
    ("HeadPitch", "he2", "q_hj2"),
    ("LShoulderPitch", "lae1", "q_laj1"),
    ("LShoulderRoll", "lae2", "q_laj2"),
    ("LElbowPitch", "lae3", "q_laj3"),
    ("LElbowYaw", "lae4", "q_laj4"),
    ("RShoulderPitch", "rae1", "q_raj1"),
    ("RShoulderRoll", "rae2", "q_raj2"),
    ("RElbowPitch", "rae3", "q_raj3"),
    ("RElbowYaw", "rae4", "q_raj4"),
    ("Waist", "te1", "q_tj1"),
    ("LHipPitch", "lle1", "q_llj1"),
    ("LHipRoll", "lle2", "q_llj2"),
    ("LHipYaw", "lle3", "q_llj3"),
    ("LKneePitch", "lle4", "q_llj4"),
    ("LAnklePitch", "lle5", "q_llj5"),
    ("LAnkleRoll", "lle6", "q_llj6"),
    ("RHipPitch", "rle1", "q_rlj1"),
    ("RHipRoll", "rle2", "q_rlj2"),
    ("RHipYaw", "rle3", "q_rlj3"),
    ("RKneePitch", "rle4", "q_rlj4"),
    ("RAnklePitch", "rle5", "q_rlj5"),
    ("RAnkleRoll", "rle6", "q_rlj6"),
];

/// A robot of the server: [`T1`](crate::T1) or [`K1`](crate::K1). Lengths are in metres.
///
/// The joints are in the order of the server's perceptors: head, left arm, right arm, waist if
/// there is one, left leg, right leg. Those of a leg are pitch, roll and yaw of the hip, knee,
/// pitch and roll of the ankle.
#[derive(Debug)]
pub struct Humanoid {
    /// The name with which it joins the server.
    pub(crate) name: &'static str,
    /// Joints, links, masses and camera, from a file. The link that a joint moves has the joint's
    /// index plus one.
    pub(crate) anatomy: LazyLock<Anatomy>,
    pub(crate) links: LazyLock<LinkTree>,
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

/// Reads the file of a robot.
pub(crate) fn read(name: &str, text: &str) -> Anatomy {
    let (anatomy, _) = urdf::read(&Source::new(name, text));
    #[allow(clippy::expect_used)] // the file is part of the program, and a test reads it
    anatomy.expect("the file has no errors")
}

impl PartialEq for Humanoid {
    fn eq(&self, other: &Humanoid) -> bool {
        self.name == other.name
    }
}

impl Humanoid {
    /// All robots that can be named; the first one is the default.
    pub const ALL: [&'static Humanoid; 2] = [&T1, &K1];

    /// Their names, in the same order.
    pub(crate) const NAMES: [&'static str; 2] = ["T1", "K1"];

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
        self.anatomy.joints.len()
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
        self.anatomy.joints[joint].limits
    }

    /// Torque per angle, Nm/rad, and per angular velocity, Nm s/rad, of a joint that is commanded
    /// with a stiffness of 1.
    pub fn gains(&self, joint: usize) -> (f64, f64) {
        if joint < self.left_leg { self.other_gains } else { self.leg_gains }
    }

    /// The name of the motor of a joint.
    pub(crate) fn motor(&self, joint: usize) -> &'static str {
        let is_after_gap = self.waist.is_none() && joint >= WAIST_JOINT;
        CHANNELS[joint + usize::from(is_after_gap)].1
    }

    /// The joint of a perceptor.
    pub(crate) fn of_perceptor(&self, name: &[u8]) -> Option<usize> {
        let channel = CHANNELS.iter().position(|(_, _, perceptor)| perceptor.as_bytes() == name)?;
        match (self.waist, channel) {
            (None, WAIST_JOINT) => None,
            (None, after) if after > WAIST_JOINT => Some(after - 1),
            _ => Some(channel),
        }
    }

    /// The link that a joint moves.
    pub(crate) fn link(joint: usize) -> usize {
        joint + 1
    }

    /// The anatomy of a robot that walks within limits: ahead, to a side, turning.
    pub(crate) fn anatomy(&self, walk_x: Limits, walk_y: Limits, walk_turn: Limits) -> Anatomy {
        Anatomy { walk_x, walk_y, walk_turn, ..self.anatomy.clone() }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn the_right_side_mirrors_the_left() {
        for robot in Humanoid::ALL {
            let anatomy = &robot.anatomy;
            for (index, left) in
                anatomy.joints.iter().enumerate().filter(|(_, joint)| joint.name.starts_with('L'))
            {
                let right = anatomy.joint(&left.name.replacen('L', "R", 1)).unwrap();
                assert_eq!(right - index, if index < robot.left_leg { 4 } else { 6 }, "{}", left.name);
                let [here, there] = [index, right].map(|joint| &anatomy.links[Humanoid::link(joint)]);
                let [x, y, z] = here.offset;
                assert_eq!((there.offset, there.rotation), ([x, -y, z], here.rotation));
                let Limits { low, high } = left.limits;
                let is_mirrored = here.motion.unwrap().axis != [0.0, 1.0, 0.0];
                let image = if is_mirrored { Limits::new(-high, -low) } else { left.limits };
                assert_eq!(anatomy.joints[right].limits, image);
            }
        }
    }

    #[test]
    fn each_joint_has_its_channels_and_moves_the_link_after_it() {
        for robot in Humanoid::ALL {
            for (index, joint) in robot.anatomy.joints.iter().enumerate() {
                let channel = CHANNELS.iter().find(|(name, ..)| *name == joint.name).unwrap();
                assert_eq!(robot.of_perceptor(channel.2.as_bytes()), Some(index));
                assert_eq!(robot.motor(index), channel.1);
                let link = &robot.anatomy.links[Humanoid::link(index)];
                assert_eq!(link.motion.map(|motion| motion.joint), Some(index), "{}", link.name);
            }
            assert_eq!(robot.of_perceptor(b"q_l4j1"), None);
        }
        assert_eq!((T1.of_perceptor(b"q_tj1"), K1.of_perceptor(b"q_tj1")), (Some(WAIST_JOINT), None));
    }

    #[test]
    fn lengths_of_the_legs_are_those_of_the_anatomy() {
        for robot in Humanoid::ALL {
            let zero = [0.0; JOINTS];
            let at = |name| robot.joint_origin(robot.anatomy.joint(name).unwrap(), &zero);
            let (hip, knee, ankle) = (at("LHipPitch"), at("LKneePitch"), at("LAnklePitch"));
            let middle = nalgebra::center(&hip, &at("RHipPitch"));
            let [thigh, shank] = [knee - hip, ankle - knee].map(|bone| Vector3::new(bone.x, 0.0, bone.z));
            let bend = libm::atan2(thigh.x, -thigh.z) - libm::atan2(shank.x, -shank.z);
            for (length, expected) in [
                (robot.beside, hip.y - middle.y),
                (robot.thigh, thigh.norm()),
                (robot.shank, shank.norm()),
                (robot.knee_at_straight, -bend),
                (robot.straight_height, robot.sole - at("LAnkleRoll").z),
                (robot.hips.x, middle.x),
                (robot.hips.z, middle.z),
            ] {
                assert!((length - expected).abs() < 2e-4, "{}: {length}, not {expected}", robot.name);
            }
        }
    }

    #[test]
    fn a_joint_is_where_its_names_say() {
        for robot in Humanoid::ALL {
            let at = |name| robot.anatomy.joint(name);
            assert_eq!((at("HeadYaw"), at("HeadPitch")), (Some(HEAD_YAW), Some(HEAD_PITCH)));
            let shoulders = (at("LShoulderRoll"), at("RShoulderRoll"));
            assert_eq!(shoulders, (Some(LEFT_SHOULDER_ROLL), Some(RIGHT_SHOULDER_ROLL)));
            assert_eq!(at("Waist"), robot.waist);
            let legs = (at("LHipPitch"), at("RHipPitch"));
            assert_eq!(legs, (Some(robot.left_leg), Some(robot.right_leg)));
        }
        assert_eq!(T1.joint_count() - K1.joint_count(), 1, "the waist");
        assert_eq!(Humanoid::ALL.map(Humanoid::name), Humanoid::NAMES);
    }

    #[test]
    fn robots_are_found_by_their_names() {
        assert_eq!(Humanoid::named("K1").map(Humanoid::joint_count), Some(22));
        assert_eq!(Humanoid::named("k1"), None);
    }
}
