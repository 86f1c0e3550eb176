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

/// The greatest speeds of the motors with their gears, rad/s, as the description of the Nao V5 for
/// ROS has them.
const ARM: f64 = 8.267_97;
const ARM_ROLL: f64 = 7.194_07;
const WRIST: f64 = 24.6229;
const FINGERS: f64 = 8.33;
const LEG: f64 = 6.402_39;
const LEG_ROLL: f64 = 4.161_74;

/// A row of [`TABLE`].
type JointRow = (&'static str, f64, f64, f64, Option<NaoJoint>, [f64; 3], [f64; 3]);

/// Name, least and greatest angle, greatest speed, carrying joint, offset and axis of each joint.
/// The joint of the left hip turns the right hip too, which a tree does not express: see
/// [`kinematics`](crate::kinematics).
#[rustfmt::skip]
const TABLE: [JointRow; JOINTS] = {
    use NaoJoint::*;
    [
        ("HeadYaw", -2.0857, 2.0857, ARM, None, [0.0, 0.0, NECK_Z], YAW),
        ("HeadPitch", -0.6720, 0.5149, ARM_ROLL, Some(HeadYaw), NONE, PITCH),
        ("LShoulderPitch", -2.0857, 2.0857, ARM, None, [0.0, 0.098, 0.1], PITCH),
        ("LShoulderRoll", -0.3142, 1.3265, ARM_ROLL, Some(LShoulderPitch), NONE, YAW),
        ("LElbowYaw", -2.0857, 2.0857, ARM, Some(LShoulderRoll), [UPPER_ARM, ELBOW_Y, 0.0], ROLL),
        ("LElbowRoll", -1.5446, -0.0349, ARM_ROLL, Some(LElbowYaw), NONE, YAW),
        ("LWristYaw", -1.8238, 1.8238, WRIST, Some(LElbowRoll), [LOWER_ARM, 0.0, 0.0], ROLL),
        ("LHipYawPitch", -1.1453, 0.7408, LEG_ROLL, None, [0.0, 0.05, -0.085], HIP_YAW_PITCH),
        ("LHipRoll", -0.3794, 0.7904, LEG_ROLL, Some(LHipYawPitch), NONE, ROLL),
        ("LHipPitch", -1.6232, 0.4840, LEG, Some(LHipRoll), NONE, PITCH),
        ("LKneePitch", -0.0923, 2.1125, LEG, Some(LHipPitch), [0.0, 0.0, -THIGH], PITCH),
        ("LAnklePitch", -1.1894, 0.9226, LEG, Some(LKneePitch), [0.0, 0.0, -TIBIA], PITCH),
        ("LAnkleRoll", -0.3978, 0.7690, LEG_ROLL, Some(LAnklePitch), NONE, ROLL),
        ("RHipRoll", -0.7904, 0.3794, LEG_ROLL, None, [0.0, -0.05, -0.085], ROLL),
        ("RHipPitch", -1.6232, 0.4840, LEG, Some(RHipRoll), NONE, PITCH),
        ("RKneePitch", -0.0923, 2.1125, LEG, Some(RHipPitch), [0.0, 0.0, -THIGH], PITCH),
        ("RAnklePitch", -1.1894, 0.9226, LEG, Some(RKneePitch), [0.0, 0.0, -TIBIA], PITCH),
        ("RAnkleRoll", -0.7690, 0.3978, LEG_ROLL, Some(RAnklePitch), NONE, ROLL),
        ("RShoulderPitch", -2.0857, 2.0857, ARM, None, [0.0, -0.098, 0.1], PITCH),
        ("RShoulderRoll", -1.3265, 0.3142, ARM_ROLL, Some(RShoulderPitch), NONE, YAW),
        ("RElbowYaw", -2.0857, 2.0857, ARM, Some(RShoulderRoll), [UPPER_ARM, -ELBOW_Y, 0.0], ROLL),
        ("RElbowRoll", 0.0349, 1.5446, ARM_ROLL, Some(RElbowYaw), NONE, YAW),
        ("RWristYaw", -1.8238, 1.8238, WRIST, Some(RElbowRoll), [LOWER_ARM, 0.0, 0.0], ROLL),
        ("LHand", 0.0, 1.0, FINGERS, Some(LWristYaw), [0.057_75, 0.0, -0.012_31], NONE),
        ("RHand", 0.0, 1.0, FINGERS, Some(RWristYaw), [0.057_75, 0.0, -0.012_31], NONE),
    ]
};

/// The limits of a joint, rad.
pub(crate) fn limits(joint: usize) -> Limits {
    Limits::new(TABLE[joint].1, TABLE[joint].2)
}

/// The joint on the other side of the body and its angle in the mirror image of a pose. The head's
/// joints and that of both hips are their own images.
pub(crate) fn mirrored(joint: usize, angle: f64) -> (usize, f64) {
    let name = TABLE[joint].0;
    let other = match name.split_at(1) {
        ("L", rest) => format!("R{rest}"),
        ("R", rest) => format!("L{rest}"),
        _ => name.to_owned(),
    };
    let image = TABLE.iter().position(|row| row.0 == other).unwrap_or(joint);
    // Pitch turns both sides alike, and so does the joint of both hips.
    let turns_back = name.ends_with("Roll") || name.ends_with("Yaw");
    (image, if turns_back { 0.0 - angle } else { angle })
}

/// The angles of view of both cameras, from left to right and from top to bottom, rad.
pub(crate) const VIEW: [f64; 2] = [0.9547, 0.7418];

/// The anatomy of a Nao V6. It sees objects only where a simulation stands in for its cameras.
pub fn anatomy() -> Anatomy {
    let joint = |&(name, low, high, _, parent, offset, axis): &JointRow| Joint {
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
        joint_speeds: TABLE.iter().map(|row| row.3).collect(),
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
        for (index, joint) in anatomy.joints.iter().enumerate() {
            let (image, low) = mirrored(index, joint.limits.low);
            let (_, high) = mirrored(index, joint.limits.high);
            let limits = Limits::new(low.min(high), low.max(high));
            assert_eq!(anatomy.joints[image].limits, limits, "{}", joint.name);
            assert_eq!(anatomy.joint_speeds[image], anatomy.joint_speeds[index], "{}", joint.name);
            assert_eq!(mirrored(image, mirrored(index, 0.5).1), (index, 0.5));
            let is_single = ["HeadYaw", "HeadPitch", "LHipYawPitch"].contains(&joint.name);
            assert_eq!(image == index, is_single, "{}", joint.name);
        }
    }
}
