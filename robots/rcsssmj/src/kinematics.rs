//! Where the camera and the feet of a T1 are, from its joints.
//!
//! Frames: the torso frame has x ahead, y to the left and z up, along the axes of the torso. The
//! level frame has the same origin and heading, but its z axis is vertical. The robot frame has its
//! origin on the ground below the middle between the hips.

use nalgebra::{Point3, Rotation3, Unit, UnitQuaternion, Vector3};

use crate::anatomy::{HEAD_PITCH, HEAD_YAW, JointValues, LEFT_LEG, RIGHT_LEG, SOLE, link};
use crate::percept::Polar;

/// From the pitch joint of the head to the camera, m.
const CAMERA: Vector3<f64> = Vector3::new(0.05, 0.0, 0.12);
/// The middle between the hips in the torso frame, m.
const HIPS: Point3<f64> = Point3::new(0.0625, 0.0, -0.1155);

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
fn in_torso(point: Point3<f64>, joint: usize, angles: &JointValues) -> Point3<f64> {
    let (offset, axis, parent) = link(joint);
    let axis = Unit::new_unchecked(Vector3::from(axis));
    let turned = Rotation3::from_axis_angle(&axis, angles[joint]) * point + Vector3::from(offset);
    match parent {
        Some(parent) => in_torso(turned, parent, angles),
        None => turned,
    }
}

/// The middle of a sole in the torso frame.
pub fn sole(foot: Foot, angles: &JointValues) -> Point3<f64> {
    in_torso(Point3::new(0.0, 0.0, -SOLE), foot.last_joint(), angles)
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

    use super::*;
    use crate::anatomy::{JOINTS, STRAIGHT_HEIGHT};

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
