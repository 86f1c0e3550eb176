//! Kinematics of a Nao: where feet and cameras are for given joint angles, and the angles that put
//! the feet there.
//!
//! Frames have x ahead, y to the left and z up. The origin of the torso's frame is the torso's;
//! that of a foot is on its sole, below the ankle. One motor turns both hips about axes inclined by
//! 45 degrees, so that the feet turn inwards or outwards together.

use monas_robot::Camera;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3};

use crate::anatomy::{NaoJoint, anatomy, links};
use crate::lola::JOINTS;

/// From the torso to the left hip, m. This and the following lengths are those of the
/// [`anatomy`](crate::anatomy()); a test compares them.
pub(crate) const HIP: Vector3<f64> = Vector3::new(0.0, 0.05, -0.085);
/// From the hip to the knee.
const THIGH: f64 = 0.1;
/// From the knee to the ankle.
const TIBIA: f64 = 0.1029;
/// From the ankle down to the sole.
const FOOT_HEIGHT: f64 = 0.045_19;
/// The axis of the left hip's yaw and pitch joint; the right one has its z reversed.
const HIP_YAW_PITCH: [f64; 3] = [0.0, std::f64::consts::FRAC_1_SQRT_2, -std::f64::consts::FRAC_1_SQRT_2];

/// The angles of all joints, rad, in the order of LoLA.
pub type JointAngles = [f64; JOINTS];

/// A side of the body.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Side {
    /// The left side.
    Left,
    /// The right side.
    Right,
}

impl Side {
    /// Both sides, left first.
    pub const BOTH: [Side; 2] = [Side::Left, Side::Right];

    /// 1 for the left side, -1 for the right.
    pub fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }

    /// The other side.
    pub fn other(self) -> Side {
        match self {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        }
    }

    /// The index of the hip's roll joint; the other joints of the leg follow.
    pub(crate) fn leg(self) -> usize {
        match self {
            Side::Left => NaoJoint::LHipRoll as usize,
            Side::Right => NaoJoint::RHipRoll as usize,
        }
    }

    /// The index of the shoulder's pitch joint; the other joints of the arm follow.
    pub(crate) fn arm(self) -> usize {
        match self {
            Side::Left => NaoJoint::LShoulderPitch as usize,
            Side::Right => NaoJoint::RShoulderPitch as usize,
        }
    }
}

/// A camera of the head.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NaoCamera {
    /// Above the eyes.
    Top,
    /// At the mouth.
    Bottom,
}

/// The pose of a foot in the torso's frame.
pub fn foot_in_torso(side: Side, angles: &JointAngles) -> Isometry3<f64> {
    let leg = side.leg();
    let hip = hip_rotation(side, angles[NaoJoint::LHipYawPitch as usize]);
    let hip_pose = Isometry3::from_parts(mirrored(HIP, side).into(), hip);
    hip_pose
        * roll(angles[leg])
        * pitch(angles[leg + 1])
        * down(THIGH)
        * pitch(angles[leg + 2])
        * down(TIBIA)
        * pitch(angles[leg + 3])
        * roll(angles[leg + 4])
        * down(FOOT_HEIGHT)
}

impl NaoCamera {
    /// The camera in the anatomy.
    pub fn description(self) -> &'static Camera {
        &anatomy().cameras[self as usize]
    }
}

/// The pose of a camera in the torso's frame; x is its line of sight.
pub fn camera_in_torso(camera: NaoCamera, angles: &JointAngles) -> Isometry3<f64> {
    let link = camera.description().link.unwrap_or_default();
    links().pose_in_torso(link, Isometry3::identity(), angles)
}

/// The angle by which a camera looks lower than the head, rad.
pub fn camera_tilt(camera: NaoCamera) -> f64 {
    let sight = camera_in_torso(camera, &[0.0; JOINTS]).rotation * Vector3::x();
    -libm::asin(sight.z)
}

/// Sets the joints of a leg, except the one that both legs share, so that the ankle and the plane
/// of the sole are those of `foot` in the torso's frame. The direction of the toes follows from the
/// shared joint. Returns whether the leg reaches as far; if not, it is stretched towards it.
pub fn place_foot(side: Side, foot: &Isometry3<f64>, hip_yaw_pitch: f64, angles: &mut JointAngles) -> bool {
    angles[NaoJoint::LHipYawPitch as usize] = hip_yaw_pitch;
    let hip = hip_rotation(side, hip_yaw_pitch);
    let ankle = foot.translation.vector + foot.rotation * Vector3::new(0.0, 0.0, FOOT_HEIGHT);
    let line = hip.inverse() * (ankle - mirrored(HIP, side));
    let reach = line.norm();
    let length = reach.clamp(0.02, THIGH + TIBIA);
    let knee = std::f64::consts::PI
        - libm::acos(
            ((THIGH * THIGH + TIBIA * TIBIA - length * length) / (2.0 * THIGH * TIBIA)).clamp(-1.0, 1.0),
        );
    let hip_roll = libm::atan2(line.y, -line.z);
    // The angle of the line from hip to ankle in the plane of the leg, and that of a leg whose
    // thigh points straight down.
    let aimed = libm::atan2(line.x, -libm::hypot(line.y, line.z));
    let straight = libm::atan2(-TIBIA * libm::sin(knee), -THIGH - TIBIA * libm::cos(knee));
    let hip_pitch = wrapped(aimed - straight);
    let tibia = hip * roll(hip_roll) * pitch(hip_pitch + knee);
    let normal = tibia.inverse() * (foot.rotation * Vector3::z());
    let leg = side.leg();
    angles[leg] = hip_roll;
    angles[leg + 1] = hip_pitch;
    angles[leg + 2] = knee;
    angles[leg + 3] = libm::atan2(normal.x, normal.z);
    angles[leg + 4] = -libm::asin(normal.y.clamp(-1.0, 1.0));
    (reach - length).abs() < 1e-9
}

/// As [`place_foot`], and searches the angle of the shared joint with which the toes point as those
/// of `foot`. Returns whether the foot is where it should be, to within 1e-6 m and rad.
pub fn place_foot_and_toes(side: Side, foot: &Isometry3<f64>, angles: &mut JointAngles) -> bool {
    let wanted = heading(foot);
    let mut error = |shared: f64| {
        let reached = place_foot(side, foot, shared, angles);
        (wrapped(heading(&foot_in_torso(side, angles)) - wanted), reached)
    };
    // The secant method; the toes turn outwards by about 0.7 of the joint's angle.
    let mut before = 0.0;
    let mut now = -side.sign() * wanted * std::f64::consts::SQRT_2;
    if now == before {
        now = 0.01;
    }
    let (mut error_before, _) = error(before);
    for _ in 0..12 {
        let (error_now, reached) = error(now);
        if error_now.abs() < 1e-9 {
            return reached;
        }
        let slope = (error_now - error_before) / (now - before);
        if slope == 0.0 || !slope.is_finite() {
            break;
        }
        (before, error_before) = (now, error_now);
        now = (now - error_now / slope).clamp(-1.5, 1.5);
    }
    let (error_now, reached) = error(now);
    reached && error_now.abs() < 1e-6
}

/// The direction of the x axis of a pose in the plane, rad.
pub fn heading(pose: &Isometry3<f64>) -> f64 {
    let ahead = pose.rotation * Vector3::x();
    libm::atan2(ahead.y, ahead.x)
}

/// The rotation of a hip by the shared joint.
fn hip_rotation(side: Side, angle: f64) -> UnitQuaternion<f64> {
    let [x, y, z] = HIP_YAW_PITCH;
    about(Vector3::new(x, y, side.sign() * z), angle)
}

/// A rotation by functions of `libm`, so that it is equal on all machines.
fn about(axis: Vector3<f64>, angle: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = libm::sincos(angle / 2.0);
    let axis = UnitVector3::new_unchecked(axis);
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_parts(cos, axis.into_inner() * sin))
}

fn roll(angle: f64) -> UnitQuaternion<f64> {
    about(Vector3::x(), angle)
}

fn pitch(angle: f64) -> UnitQuaternion<f64> {
    about(Vector3::y(), angle)
}

pub(crate) fn yaw(angle: f64) -> UnitQuaternion<f64> {
    about(Vector3::z(), angle)
}

fn down(length: f64) -> Translation3<f64> {
    Translation3::new(0.0, 0.0, -length)
}

fn mirrored(left: Vector3<f64>, side: Side) -> Vector3<f64> {
    Vector3::new(left.x, side.sign() * left.y, left.z)
}

/// The angle between -pi and pi.
pub(crate) fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turned = angle - TAU * libm::floor((angle + PI) / TAU);
    if turned > PI { turned - TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::anatomy::limits;

    /// Angles within the limits of all joints.
    fn angles() -> impl Strategy<Value = JointAngles> {
        let ranges: Vec<_> = (0..JOINTS).map(|joint| limits(joint).low..limits(joint).high).collect();
        ranges.prop_map(|angles| angles.try_into().unwrap())
    }

    #[test]
    fn a_straight_robot_is_as_tall_as_its_links() {
        let zero = [0.0; JOINTS];
        let foot = foot_in_torso(Side::Left, &zero);
        assert!((foot.translation.vector - Vector3::new(0.0, 0.05, -0.333_09)).norm() < 1e-12, "{foot}");
        let hand = anatomy().link("RFingers").unwrap();
        let hand = links().pose_in_torso(hand, Isometry3::identity(), &zero);
        assert!((hand.translation.vector - Vector3::new(0.218_7, -0.113, 0.087_69)).norm() < 1e-12, "{hand}");
        let camera = camera_in_torso(NaoCamera::Top, &zero);
        assert!((camera.translation.vector - Vector3::new(0.058_71, 0.0, 0.190_14)).norm() < 1e-12);
    }

    #[test]
    fn a_negative_shared_joint_turns_both_feet_outwards() {
        let mut angles = [0.0; JOINTS];
        angles[NaoJoint::LHipYawPitch as usize] = -0.3;
        let [left, right] = Side::BOTH.map(|side| heading(&foot_in_torso(side, &angles)));
        assert!(left > 0.15 && (left + right).abs() < 1e-12, "{left} {right}");
    }

    proptest! {
        #[test]
        fn feet_are_where_the_anatomy_has_them(angles in angles()) {
            let check = |side: &str, link: &str, pose: Isometry3<f64>| {
                let link = anatomy().link(&[side, link].concat()).unwrap();
                let other = links().pose_in_torso(link, Isometry3::identity(), &angles);
                let apart = (pose.translation.vector - other.translation.vector).norm();
                apart.max(pose.rotation.angle_to(&other.rotation)) < 1e-7 && apart < 1e-12
            };
            for (side, letter) in [(Side::Left, "L"), (Side::Right, "R")] {
                prop_assert!(check(letter, "Sole", foot_in_torso(side, &angles)));
            }
        }

        #[test]
        fn the_inverse_of_a_leg_reaches_the_foot_that_the_angles_gave(given in angles(), left: bool) {
            let side = if left { Side::Left } else { Side::Right };
            let foot = foot_in_torso(side, &given);
            let mut found = given;
            let shared = given[NaoJoint::LHipYawPitch as usize];
            prop_assert!(place_foot(side, &foot, shared, &mut found));
            let reached = foot_in_torso(side, &found);
            prop_assert!((reached.translation.vector - foot.translation.vector).norm() < 1e-9);
            prop_assert!((reached.rotation * Vector3::z() - foot.rotation * Vector3::z()).norm() < 1e-7);
        }

        #[test]
        fn a_foot_of_a_walk_is_placed_with_its_toes(
            x in -0.06..0.06, y in 0.03..0.09, z in -0.315..-0.24, toes in -0.4..0.4, left: bool,
        ) {
            let side = if left { Side::Left } else { Side::Right };
            let foot = Isometry3::from_parts(Translation3::new(x, side.sign() * y, z), yaw(toes));
            let mut found = [0.0; JOINTS];
            prop_assert!(place_foot_and_toes(side, &foot, &mut found));
            let reached = foot_in_torso(side, &found);
            prop_assert!((reached.translation.vector - foot.translation.vector).norm() < 1e-6);
            prop_assert!(reached.rotation.angle_to(&foot.rotation) < 1e-5);
        }

        #[test]
        fn a_leg_too_short_is_stretched(far in 0.34..2.0_f64) {
            let mut found = [0.0; JOINTS];
            let foot = Isometry3::translation(0.0, 0.05, -far);
            prop_assert!(!place_foot(Side::Left, &foot, 0.0, &mut found));
            prop_assert!(found[NaoJoint::LKneePitch as usize].abs() < 1e-6);
        }
    }
}
