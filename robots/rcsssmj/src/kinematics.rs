//! Where the camera and the feet of a T1 are, from its joints.
//!
//! Frames: the torso frame has x ahead, y to the left and z up, along the axes of the torso. The
//! level frame has the same origin and heading, but its z axis is vertical. The robot frame has its
//! origin on the ground below the middle between the hips.

use nalgebra::{Isometry3, Point3, Rotation3, Unit, UnitQuaternion, Vector3};

use crate::anatomy::{HEAD_PITCH, HEAD_YAW, JOINTS, JointValues, LEFT_LEG, RIGHT_LEG, SOLE, link};
use crate::percept::Polar;

/// From the pitch joint of the head to the camera, m.
const CAMERA: Vector3<f64> = Vector3::new(0.05, 0.0, 0.12);
/// The middle between the hips in the torso frame, m.
pub(crate) const HIPS: Point3<f64> = Point3::new(0.0625, 0.0, -0.1155);

/// A foot.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Foot {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

impl Foot {
    /// The last joint of its leg.
    fn last_joint(self) -> usize {
        match self {
            Foot::Left => LEFT_LEG + 5,
            Foot::Right => RIGHT_LEG + 5,
        }
    }
}

/// A point in the frame of a joint, in the torso frame.
pub(crate) fn in_torso(point: Point3<f64>, joint: usize, angles: &JointValues) -> Point3<f64> {
    let (offset, axis, parent) = link(joint);
    let axis = Unit::new_unchecked(Vector3::from(axis));
    let turned = Rotation3::from_axis_angle(&axis, angles[joint]) * point + Vector3::from(offset);
    match parent {
        Some(parent) => in_torso(turned, parent, angles),
        None => turned,
    }
}

/// Where the axis of a joint is fixed to the link before it, in the torso frame.
pub fn joint_origin(joint: usize, angles: &JointValues) -> Point3<f64> {
    in_torso(Point3::origin(), joint, angles)
}

/// The camera in the torso frame.
pub fn camera(angles: &JointValues) -> Point3<f64> {
    in_torso(Point3::from(CAMERA), HEAD_PITCH, angles)
}

/// The middle of a sole in the torso frame.
pub fn sole(foot: Foot, angles: &JointValues) -> Point3<f64> {
    in_torso(Point3::new(0.0, 0.0, -SOLE), foot.last_joint(), angles)
}

/// From the middle between the hips to the pitch joint of the left one, and to its foot in a
/// straight stand, m.
pub(crate) const BESIDE: f64 = 0.106;
/// From the pitch joint of the hip to the knee, and from there to the pitch joint of the ankle, m.
const THIGH: f64 = 0.236_269_1;
const SHANK: f64 = 0.28;
/// The angle by which the line from the hip to the knee leans back when the joints are at zero,
/// rad.
const THIGH_ANGLE: f64 = 0.059_289_2;
/// Rounds in which the place of a sole is approached: the axes of hip and ankle do not meet.
const ROUNDS: usize = 5;

/// The pose of a sole in the torso frame.
pub fn sole_pose(foot: Foot, angles: &JointValues) -> Isometry3<f64> {
    let mut pose = Isometry3::translation(0.0, 0.0, -SOLE);
    let mut joint = Some(foot.last_joint());
    while let Some(index) = joint {
        let (offset, axis, parent) = link(index);
        let turned = UnitQuaternion::new(Vector3::from(axis) * angles[index]);
        pose = Isometry3::from_parts(Vector3::from(offset).into(), turned) * pose;
        joint = parent;
    }
    pose
}

/// The angles of the six joints of a leg that bring its sole to a pose in the torso frame, with the
/// waist at zero. A sole that is farther away than the leg is long is approached with a straight
/// knee.
///
/// The closed form is that of a leg whose axes meet in hip and ankle (Kajita, Hirukawa, Harada,
/// Yokoi, *Introduction to Humanoid Robotics*, 2014, section 2.5.3); what the axes of this robot
/// are apart is made up for in further rounds.
pub fn leg_angles(foot: Foot, sole: &Isometry3<f64>) -> [f64; 6] {
    let first = foot.last_joint() - 5;
    let mut angles = [0.0; JOINTS];
    let mut target = *sole;
    for round in 0..ROUNDS {
        angles[first..first + 6].copy_from_slice(&closed_form(foot, &target));
        if round + 1 < ROUNDS {
            let missed = sole.translation.vector - sole_pose(foot, &angles).translation.vector;
            target.translation.vector += missed;
        }
    }
    std::array::from_fn(|joint| angles[first + joint])
}

fn closed_form(foot: Foot, sole: &Isometry3<f64>) -> [f64; 6] {
    let side = if foot == Foot::Left { 1.0 } else { -1.0 };
    let hip = HIPS + Vector3::new(0.0, side * BESIDE, 0.0);
    let ankle = sole * Point3::new(0.0, 0.0, SOLE);
    // From the ankle to the hip, in the frame of the foot.
    let leg = sole.rotation.inverse() * (hip - ankle);
    let bend = (leg.norm_squared() - THIGH * THIGH - SHANK * SHANK) / (2.0 * THIGH * SHANK);
    let bend = libm::acos(bend.clamp(-1.0, 1.0));
    let (sin, cos) = libm::sincos(bend);
    let knee = bend + THIGH_ANGLE;
    let ankle_roll = libm::atan2(leg.y, leg.z);
    let ankle_pitch =
        -libm::atan2(THIGH * sin, SHANK + THIGH * cos) - libm::atan2(leg.x, libm::hypot(leg.y, leg.z));
    let hip = sole.rotation
        * UnitQuaternion::new(Vector3::new(-ankle_roll, 0.0, 0.0))
        * UnitQuaternion::new(Vector3::new(0.0, -ankle_pitch - knee, 0.0));
    let hip = hip.to_rotation_matrix();
    let hip_roll = libm::asin((-hip[(1, 2)]).clamp(-1.0, 1.0));
    let hip_pitch = libm::atan2(hip[(0, 2)], hip[(2, 2)]);
    let hip_yaw = libm::atan2(hip[(1, 0)], hip[(1, 1)]);
    [hip_pitch, hip_roll, hip_yaw, knee, ankle_pitch, ankle_roll]
}

/// The corners of a sole below the last joint of the leg, m: those of the foot's box.
const CORNERS: [Point3<f64>; 4] = [
    Point3::new(0.1215, 0.05, -SOLE),
    Point3::new(0.1215, -0.05, -SOLE),
    Point3::new(-0.1015, 0.05, -SOLE),
    Point3::new(-0.1015, -0.05, -SOLE),
];

/// A point in the direction that the camera sees it, in the torso frame.
pub fn seen_in_torso(seen: &Polar, angles: &JointValues) -> Point3<f64> {
    let (sin_elevation, cos_elevation) = libm::sincos(seen.elevation);
    let (sin_azimuth, cos_azimuth) = libm::sincos(seen.azimuth);
    let ray = Vector3::new(cos_elevation * cos_azimuth, cos_elevation * sin_azimuth, sin_elevation);
    // The camera has the axes of the head's pitch joint.
    debug_assert_eq!(link(HEAD_PITCH).2, Some(HEAD_YAW));
    in_torso(Point3::from(CAMERA + ray * seen.distance), HEAD_PITCH, angles)
}

/// The posture of the robot over the ground: all points in its level frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Stance {
    level_from_torso: UnitQuaternion<f64>,
    /// The middle between the hips.
    hips: Point3<f64>,
    /// The corners of the soles, those of the left one first.
    corners: [Point3<f64>; 8],
}

impl Stance {
    /// From the joints and the unit vector that points down, in the torso frame.
    pub fn new(angles: &JointValues, down: &Vector3<f64>) -> Stance {
        let level_from_torso = level_from_torso(down);
        let mut corners = [Point3::origin(); 8];
        for (index, corner) in corners.iter_mut().enumerate() {
            let foot = if index < CORNERS.len() { Foot::Left } else { Foot::Right };
            let below_foot = CORNERS[index % CORNERS.len()];
            *corner = level_from_torso * in_torso(below_foot, foot.last_joint(), angles);
        }
        Stance { level_from_torso, hips: level_from_torso * HIPS, corners }
    }

    /// The corner of a sole that is lowest: it stands on the ground. Feet roll over their edges, so
    /// that the middle of a sole does not stand still.
    pub fn contact(&self) -> usize {
        let lower = |one: usize, other: usize| match self.corners[other].z < self.corners[one].z {
            true => other,
            false => one,
        };
        (1..self.corners.len()).fold(0, lower)
    }

    /// From a corner to the middle between the hips.
    pub fn hips_from(&self, corner: usize) -> Vector3<f64> {
        self.hips - self.corners[corner]
    }

    /// A point of the torso frame in the robot frame.
    pub fn on_ground(&self, in_torso: &Point3<f64>) -> Point3<f64> {
        let ground = self.corners[self.contact()].z;
        let in_level = self.level_from_torso * in_torso;
        Point3::new(in_level.x - self.hips.x, in_level.y - self.hips.y, in_level.z - ground)
    }
}

/// The rotation that makes a direction of the torso frame vertical and keeps the heading.
fn level_from_torso(down: &Vector3<f64>) -> UnitQuaternion<f64> {
    let (roll, pitch) = inclination(down);
    UnitQuaternion::from_euler_angles(roll, pitch, 0.0)
}

/// Roll, positive to the right, and pitch, positive forwards, of a torso in which a unit vector
/// points down; rad.
pub fn inclination(down: &Vector3<f64>) -> (f64, f64) {
    let roll = libm::atan2(-down.y, -down.z);
    let pitch = libm::atan2(down.x, libm::hypot(down.y, down.z));
    (roll, pitch)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;
    use crate::anatomy::STRAIGHT_HEIGHT;

    const STRAIGHT: JointValues = [0.0; JOINTS];

    fn near(one: &Point3<f64>, other: [f64; 3]) -> bool {
        (one - Point3::from(other)).norm() < 1e-3
    }

    #[test]
    fn straight_legs_reach_the_ground_below_the_hips() {
        assert!(near(&sole(Foot::Left, &STRAIGHT), [0.0485, 0.10625, -STRAIGHT_HEIGHT]));
        assert!(near(&sole(Foot::Right, &STRAIGHT), [0.0485, -0.10625, -STRAIGHT_HEIGHT]));
    }

    #[test]
    fn a_bent_knee_lifts_its_foot() {
        let mut angles = STRAIGHT;
        angles[LEFT_LEG + 3] = FRAC_PI_2;
        let lifted = sole(Foot::Left, &angles);
        assert!((lifted.z - (-STRAIGHT_HEIGHT + 0.322)).abs() < 1e-3 && lifted.x < -0.25, "{lifted}");
        assert!(Stance::new(&angles, &-Vector3::z()).contact() >= 4, "the right foot stands");
    }

    proptest! {
        #[test]
        fn the_angles_of_a_leg_lead_to_the_pose_of_its_sole(
            ahead in -0.12..0.12, left in -0.08..0.08, down in 0.44..0.53_f64,
            roll in -0.15..0.15, pitch in -0.2..0.2, yaw in -0.5..0.5,
        ) {
            for (foot, side) in [(Foot::Left, 1.0), (Foot::Right, -1.0)] {
                let place = HIPS + Vector3::new(ahead, side * BESIDE + left, -down);
                let turned = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
                let sole = Isometry3::from_parts(place.into(), turned);
                let mut angles = STRAIGHT;
                let first = foot.last_joint() - 5;
                angles[first..first + 6].copy_from_slice(&leg_angles(foot, &sole));
                let reached = sole_pose(foot, &angles);
                prop_assert!((reached.translation.vector - sole.translation.vector).norm() < 1e-4);
                prop_assert!(reached.rotation.angle_to(&sole.rotation) < 1e-9);
                prop_assert!((sole_pose(foot, &angles).translation.vector - super::sole(foot, &angles).coords).norm() < 1e-12);
            }
        }
    }

    /// The ball of the server's own example: 5 m ahead of a straight stand, on the ground.
    #[test]
    fn a_ball_is_where_the_camera_sees_it() {
        let seen = Polar { distance: 4.98, azimuth: 0.0, elevation: -0.19914 };
        let stance = Stance::new(&STRAIGHT, &-Vector3::z());
        let ball = stance.on_ground(&seen_in_torso(&seen, &STRAIGHT));
        assert!((ball.x - (5.0 - 0.0625)).abs() < 0.01 && ball.y.abs() < 1e-9, "{ball}");
        assert!((ball.z - 0.11).abs() < 0.01, "the middle of the ball is {} m high", ball.z);
    }

    #[test]
    fn the_head_turns_the_camera() {
        let mut angles = STRAIGHT;
        angles[HEAD_YAW] = FRAC_PI_2;
        let ahead = Polar { distance: 1.0, azimuth: 0.0, elevation: 0.0 };
        let seen = seen_in_torso(&ahead, &angles);
        assert!(near(&seen, [0.0625, 1.05, 0.42485]), "{seen}");
        angles[HEAD_PITCH] = 0.5;
        assert!(seen_in_torso(&ahead, &angles).z < 0.0, "a positive pitch looks down");
    }

    #[test]
    fn a_torso_that_leans_forwards_and_to_the_right_has_positive_angles() {
        let down = UnitQuaternion::from_euler_angles(0.2, 0.3, 1.0).inverse() * -Vector3::z();
        let (roll, pitch) = inclination(&down);
        assert!((roll - 0.2).abs() < 1e-9 && (pitch - 0.3).abs() < 1e-9);
        let stance = Stance::new(&STRAIGHT, &down);
        let vertical = stance.level_from_torso * down;
        assert!((vertical + Vector3::z()).norm() < 1e-9, "{vertical}");
    }
}
