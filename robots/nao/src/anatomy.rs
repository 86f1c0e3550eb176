//! The anatomy of a Nao V6: joints in the order of LoLA, links, limits, cameras.

use monas_robot::{Anatomy, Camera, Joint, Limits, Skill};
use nalgebra::Vector3;

use crate::lola::{CYCLE, JOINTS};

/// The joints, as indices in all lists of joints.
#[allow(missing_docs)] // the names of the joints
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NaoJoint {
    HeadYaw,
    HeadPitch,
    LShoulderPitch,
    LShoulderRoll,
    LElbowYaw,
    LElbowRoll,
    LWristYaw,
    /// Of both legs: one motor turns the right hip the other way.
    LHipYawPitch,
    LHipRoll,
    LHipPitch,
    LKneePitch,
    LAnklePitch,
    LAnkleRoll,
    RHipRoll,
    RHipPitch,
    RKneePitch,
    RAnklePitch,
    RAnkleRoll,
    RShoulderPitch,
    RShoulderRoll,
    RElbowYaw,
    RElbowRoll,
    RWristYaw,
    LHand,
    RHand,
}

/// From the torso up to the neck, metres.
pub(crate) const NECK_Z: f64 = 0.1265;
/// From the torso to the left shoulder.
pub(crate) const SHOULDER: Vector3<f64> = Vector3::new(0.0, 0.098, 0.1);
/// From the shoulder to the elbow.
pub(crate) const UPPER_ARM: f64 = 0.105;
/// From the shoulder to the elbow, to the side.
pub(crate) const ELBOW_Y: f64 = 0.015;
/// From the elbow to the wrist.
pub(crate) const LOWER_ARM: f64 = 0.055_95;
/// From the wrist to the hand.
pub(crate) const HAND: Vector3<f64> = Vector3::new(0.057_75, 0.0, -0.012_31);
/// From the torso to the left hip.
pub(crate) const HIP: Vector3<f64> = Vector3::new(0.0, 0.05, -0.085);
/// From the hip to the knee.
pub(crate) const THIGH: f64 = 0.1;
/// From the knee to the ankle.
pub(crate) const TIBIA: f64 = 0.1029;
/// From the ankle down to the sole.
pub(crate) const FOOT_HEIGHT: f64 = 0.045_19;
/// The axis of the left hip's yaw and pitch joint; the right one has its z reversed.
pub(crate) const HIP_YAW_PITCH: [f64; 3] =
    [0.0, std::f64::consts::FRAC_1_SQRT_2, -std::f64::consts::FRAC_1_SQRT_2];

const ROLL: [f64; 3] = [1.0, 0.0, 0.0];
const PITCH: [f64; 3] = [0.0, 1.0, 0.0];
const YAW: [f64; 3] = [0.0, 0.0, 1.0];
const NONE: [f64; 3] = [0.0, 0.0, 0.0];

/// A row of [`TABLE`].
type JointRow = (&'static str, f64, f64, Option<NaoJoint>, [f64; 3], [f64; 3]);

/// Name, least and greatest angle, carrying joint, offset and axis of each joint. The joint of the
/// left hip turns the right hip too, which a tree does not express: see
/// [`kinematics`](crate::kinematics).
#[rustfmt::skip]
const TABLE: [JointRow; JOINTS] = {
    use NaoJoint::*;
    [
        ("HeadYaw", -2.0857, 2.0857, None, [0.0, 0.0, NECK_Z], YAW),
        ("HeadPitch", -0.6720, 0.5149, Some(HeadYaw), NONE, PITCH),
        ("LShoulderPitch", -2.0857, 2.0857, None, [0.0, 0.098, 0.1], PITCH),
        ("LShoulderRoll", -0.3142, 1.3265, Some(LShoulderPitch), NONE, YAW),
        ("LElbowYaw", -2.0857, 2.0857, Some(LShoulderRoll), [UPPER_ARM, ELBOW_Y, 0.0], ROLL),
        ("LElbowRoll", -1.5446, -0.0349, Some(LElbowYaw), NONE, YAW),
        ("LWristYaw", -1.8238, 1.8238, Some(LElbowRoll), [LOWER_ARM, 0.0, 0.0], ROLL),
        ("LHipYawPitch", -1.1453, 0.7408, None, [0.0, 0.05, -0.085], HIP_YAW_PITCH),
        ("LHipRoll", -0.3794, 0.7904, Some(LHipYawPitch), NONE, ROLL),
        ("LHipPitch", -1.6232, 0.4840, Some(LHipRoll), NONE, PITCH),
        ("LKneePitch", -0.0923, 2.1125, Some(LHipPitch), [0.0, 0.0, -THIGH], PITCH),
        ("LAnklePitch", -1.1894, 0.9226, Some(LKneePitch), [0.0, 0.0, -TIBIA], PITCH),
        ("LAnkleRoll", -0.3978, 0.7690, Some(LAnklePitch), NONE, ROLL),
        ("RHipRoll", -0.7904, 0.3794, None, [0.0, -0.05, -0.085], ROLL),
        ("RHipPitch", -1.6232, 0.4840, Some(RHipRoll), NONE, PITCH),
        ("RKneePitch", -0.0923, 2.1125, Some(RHipPitch), [0.0, 0.0, -THIGH], PITCH),
        ("RAnklePitch", -1.1894, 0.9226, Some(RKneePitch), [0.0, 0.0, -TIBIA], PITCH),
        ("RAnkleRoll", -0.7690, 0.3978, Some(RAnklePitch), NONE, ROLL),
        ("RShoulderPitch", -2.0857, 2.0857, None, [0.0, -0.098, 0.1], PITCH),
        ("RShoulderRoll", -1.3265, 0.3142, Some(RShoulderPitch), NONE, YAW),
        ("RElbowYaw", -2.0857, 2.0857, Some(RShoulderRoll), [UPPER_ARM, -ELBOW_Y, 0.0], ROLL),
        ("RElbowRoll", 0.0349, 1.5446, Some(RElbowYaw), NONE, YAW),
        ("RWristYaw", -1.8238, 1.8238, Some(RElbowRoll), [LOWER_ARM, 0.0, 0.0], ROLL),
        ("LHand", 0.0, 1.0, Some(LWristYaw), [0.057_75, 0.0, -0.012_31], NONE),
        ("RHand", 0.0, 1.0, Some(RWristYaw), [0.057_75, 0.0, -0.012_31], NONE),
    ]
};

/// The limits of a joint, rad.
pub(crate) fn limits(joint: usize) -> Limits {
    Limits::new(TABLE[joint].1, TABLE[joint].2)
}

/// The angles of view of both cameras, from left to right and from top to bottom, rad.
pub(crate) const VIEW: [f64; 2] = [0.9547, 0.7418];

/// The anatomy of a Nao V6. It sees objects only where a simulation stands in for its cameras.
pub fn anatomy() -> Anatomy {
    let joint = |&(name, low, high, parent, offset, axis): &JointRow| Joint {
        name,
        limits: Limits::new(low, high),
        parent: parent.map(|parent| parent as usize),
        offset,
        axis,
    };
    Anatomy {
        head_yaw: limits(NaoJoint::HeadYaw as usize),
        head_pitch: limits(NaoJoint::HeadPitch as usize),
        walk_x: Limits::new(-0.15, 0.3),
        walk_y: Limits::symmetric(0.15),
        walk_turn: Limits::symmetric(1.2),
        camera: Some(Camera { horizontal: VIEW[0], vertical: VIEW[1], height: 0.5 }),
        skills: vec![
            Skill::KickLeft,
            Skill::KickRight,
            Skill::FallLeft,
            Skill::FallRight,
            Skill::DiveLeft,
            Skill::DiveRight,
            Skill::StandUp,
        ],
        joints: TABLE.iter().map(joint).collect(),
        has_leds: true,
        ..Anatomy::new("nao v6", CYCLE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_right_side_mirrors_the_left() {
        let anatomy = anatomy();
        assert_eq!(anatomy.joints.len(), JOINTS);
        for left in anatomy.joints.iter().filter(|joint| joint.name.starts_with('L')) {
            let name = left.name.replacen('L', "R", 1);
            let Some(right) = anatomy.joint(&name).map(|index| &anatomy.joints[index]) else {
                assert_eq!(left.name, "LHipYawPitch");
                continue;
            };
            let Limits { low, high } = left.limits;
            let mirrored = if left.name.contains("Roll") { Limits::new(-high, -low) } else { left.limits };
            assert_eq!(right.limits, mirrored, "{name}");
        }
    }
}
