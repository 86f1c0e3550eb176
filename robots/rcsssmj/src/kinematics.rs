//! Forward kinematics of the camera and the feet of a robot.
//!
//! Frames: the torso frame has x ahead, y to the left and z up, along the axes of the torso. The
//! level frame has the same origin and heading, but its z axis is vertical. The robot frame has its
//! origin on the ground below the middle between the hips.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use crate::humanoid::{Humanoid, JOINTS, JointValues};
use crate::percept::Polar;

/// Rounds in which the place of a sole is approached: the axes of hip and ankle do not meet.
const ITERATIONS: usize = 5;

/// A foot.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Foot {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

impl Humanoid {
    /// The first joint of a leg.
    pub(crate) fn leg(&self, foot: Foot) -> usize {
        match foot {
            Foot::Left => self.left_leg,
            Foot::Right => self.right_leg,
        }
    }

    /// The last joint of a leg.
    fn ankle(&self, foot: Foot) -> usize {
        self.leg(foot) + 5
    }

    /// A point in the frame of a joint, in the torso frame.
    fn in_torso(&self, point: Point3<f64>, joint: usize, angles: &JointValues) -> Point3<f64> {
        self.links.in_torso(Humanoid::link(joint), point, angles)
    }

    /// The point at which the axis of a joint is fixed to the link before it, in the torso frame.
    ///
    /// # Panics
    /// There is no such joint.
    pub fn joint_origin(&self, joint: usize, angles: &JointValues) -> Point3<f64> {
        self.in_torso(Point3::origin(), joint, angles)
    }

    /// The camera in the torso frame.
    pub fn camera(&self, angles: &JointValues) -> Point3<f64> {
        self.links.in_torso(self.camera_link(), Point3::origin(), angles)
    }

    /// The camera's link.
    fn camera_link(&self) -> usize {
        self.anatomy.cameras.first().and_then(|camera| camera.link).unwrap_or_default()
    }

    /// The middle of a sole, below the ankle, in the torso frame.
    pub fn sole(&self, foot: Foot, angles: &JointValues) -> Point3<f64> {
        self.in_torso(Point3::new(0.0, 0.0, -self.sole), self.ankle(foot), angles)
    }

    /// The pose of a sole in the torso frame.
    pub fn sole_pose(&self, foot: Foot, angles: &JointValues) -> Isometry3<f64> {
        let sole = Isometry3::translation(0.0, 0.0, -self.sole);
        self.links.pose_in_torso(Humanoid::link(self.ankle(foot)), sole, angles)
    }

    /// The angles of the six joints of a leg that bring its sole to a pose in the torso frame, with
    /// the waist at zero. A sole that is farther away than the leg is long is approached with a
    /// straight knee.
    ///
    /// The closed form is that of a leg whose axes meet in hip and ankle (Kajita, Hirukawa, Harada,
    /// Yokoi, *Introduction to Humanoid Robotics*, 2014, section 2.5.3); what the axes of these
    /// robots are apart is made up for in further rounds.
    pub fn leg_angles(&self, foot: Foot, sole: &Isometry3<f64>) -> [f64; 6] {
        let first = self.leg(foot);
        let mut angles = [0.0; JOINTS];
        let mut target = *sole;
        for round in 0..ITERATIONS {
            angles[first..first + 6].copy_from_slice(&self.closed_form(foot, &target));
            if round + 1 < ITERATIONS {
                let missed = sole.translation.vector - self.sole_pose(foot, &angles).translation.vector;
                target.translation.vector += missed;
            }
        }
        std::array::from_fn(|joint| angles[first + joint])
    }

    fn closed_form(&self, foot: Foot, sole: &Isometry3<f64>) -> [f64; 6] {
        let (thigh, shank) = (self.thigh, self.shank);
        let side = if foot == Foot::Left { 1.0 } else { -1.0 };
        let hip = self.hips + Vector3::new(0.0, side * self.beside, 0.0);
        let ankle = sole * Point3::new(0.0, 0.0, self.sole);
        // From the ankle to the hip, in the frame of the foot.
        let leg = sole.rotation.inverse() * (hip - ankle);
        let bend = (leg.norm_squared() - thigh * thigh - shank * shank) / (2.0 * thigh * shank);
        let bend = libm::acos(bend.clamp(-1.0, 1.0));
        let (sin, cos) = libm::sincos(bend);
        let knee = bend + self.knee_at_straight;
        let ankle_roll = libm::atan2(leg.y, leg.z);
        let ankle_pitch =
            -libm::atan2(thigh * sin, shank + thigh * cos) - libm::atan2(leg.x, libm::hypot(leg.y, leg.z));
        let hip = sole.rotation
            * UnitQuaternion::new(Vector3::new(-ankle_roll, 0.0, 0.0))
            * UnitQuaternion::new(Vector3::new(0.0, -ankle_pitch - knee, 0.0));
        let hip = hip.to_rotation_matrix();
        let hip_roll = libm::asin((-hip[(1, 2)]).clamp(-1.0, 1.0));
        let hip_pitch = libm::atan2(hip[(0, 2)], hip[(2, 2)]);
        let hip_yaw = libm::atan2(hip[(1, 0)], hip[(1, 1)]);
        [hip_pitch, hip_roll, hip_yaw, knee, ankle_pitch, ankle_roll]
    }

    /// A point in the direction that the camera sees it, in the torso frame.
    pub fn seen_in_torso(&self, seen: &Polar, angles: &JointValues) -> Point3<f64> {
        let (sin_elevation, cos_elevation) = libm::sincos(seen.elevation);
        let (sin_azimuth, cos_azimuth) = libm::sincos(seen.azimuth);
        let ray = Vector3::new(cos_elevation * cos_azimuth, cos_elevation * sin_azimuth, sin_elevation);
        self.links.in_torso(self.camera_link(), Point3::from(ray * seen.distance), angles)
    }
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
    /// Of a robot, from its joints and the unit vector that points down, in the torso frame.
    pub fn new(robot: &Humanoid, angles: &JointValues, down: &Vector3<f64>) -> Stance {
        let level_from_torso = level_from_torso(down);
        let mut corners = [Point3::origin(); 8];
        for (index, corner) in corners.iter_mut().enumerate() {
            let foot = if index < robot.corners.len() { Foot::Left } else { Foot::Right };
            let below_foot = robot.corners[index % robot.corners.len()];
            *corner = level_from_torso * robot.in_torso(below_foot, robot.ankle(foot), angles);
        }
        Stance { level_from_torso, hips: level_from_torso * robot.hips, corners }
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
    use crate::humanoid::{HEAD_PITCH, HEAD_YAW};
    use crate::{K1, T1};

    const STRAIGHT: JointValues = [0.0; JOINTS];

    fn near(one: &Point3<f64>, other: [f64; 3]) -> bool {
        (one - Point3::from(other)).norm() < 1e-3
    }

    #[test]
    fn straight_legs_reach_the_ground_below_the_hips() {
        for (robot, x, y) in [(&T1, 0.0485, 0.10625), (&K1, -0.0018, 0.0962)] {
            let down = -robot.straight_height;
            assert!(near(&robot.sole(Foot::Left, &STRAIGHT), [x, y, down]), "{}", robot.name());
            assert!(near(&robot.sole(Foot::Right, &STRAIGHT), [x, -y, down]), "{}", robot.name());
        }
    }

    #[test]
    fn a_bent_knee_lifts_its_foot() {
        for robot in Humanoid::ALL {
            let mut angles = STRAIGHT;
            angles[robot.left_leg + 3] = FRAC_PI_2;
            let lifted = robot.sole(Foot::Left, &angles);
            let shank = robot.shank + robot.sole;
            let up = lifted.z + robot.straight_height;
            assert!((up - shank).abs() < 0.02 && lifted.x < -shank / 2.0, "{lifted}");
            assert!(Stance::new(robot, &angles, &-Vector3::z()).contact() >= 4, "the right foot stands");
        }
    }

    #[test]
    fn the_lengths_of_the_legs_are_those_between_their_joints() {
        for robot in Humanoid::ALL {
            for foot in [Foot::Left, Foot::Right] {
                let at = |joint| robot.joint_origin(robot.leg(foot) + joint, &STRAIGHT);
                let (hip, knee, ankle) = (at(0), at(3), at(4));
                let flat = |link: Vector3<f64>| libm::hypot(link.x, link.z);
                assert!((flat(knee - hip) - robot.thigh).abs() < 1e-6);
                assert!((flat(ankle - knee) - robot.shank).abs() < 1e-6);
                let lean = |link: Vector3<f64>| libm::atan2(link.x, -link.z);
                let bend = lean(ankle - knee) - lean(knee - hip);
                assert!((bend - robot.knee_at_straight).abs() < 1e-6, "{bend}");
                let aside = (hip - robot.hips).y.abs();
                assert_eq!((aside, (hip - robot.hips).x, (hip - robot.hips).z), (robot.beside, 0.0, 0.0));
            }
        }
    }

    proptest! {
        #[test]
        fn the_angles_of_a_leg_lead_to_the_pose_of_its_sole(
            ahead in -0.12..0.12, left in -0.08..0.08, down in 0.79..0.95_f64,
            roll in -0.15..0.15, pitch in -0.2..0.2, yaw in -0.5..0.5,
        ) {
            for robot in Humanoid::ALL {
                let size = robot.thigh + robot.shank + robot.sole;
                for (foot, side) in [(Foot::Left, 1.0), (Foot::Right, -1.0)] {
                    let position = Vector3::new(ahead, side * robot.beside + left, -down * size);
                    let turned = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
                    let sole = Isometry3::from_parts((robot.hips + position).into(), turned);
                    let mut angles = STRAIGHT;
                    let first = robot.leg(foot);
                    angles[first..first + 6].copy_from_slice(&robot.leg_angles(foot, &sole));
                    let reached = robot.sole_pose(foot, &angles);
                    let missed = reached.translation.vector - sole.translation.vector;
                    prop_assert!(missed.norm() < 1e-4, "{} {missed}", robot.name());
                    prop_assert!(reached.rotation.angle_to(&sole.rotation) < 1e-9);
                    let point = robot.sole(foot, &angles).coords;
                    prop_assert!((reached.translation.vector - point).norm() < 1e-12);
                }
            }
        }
    }

    /// The ball of the server's own example: 5 m ahead of a straight stand, on the ground.
    #[test]
    fn a_ball_is_where_the_camera_sees_it() {
        let seen = Polar { distance: 4.98, azimuth: 0.0, elevation: -0.19914 };
        let stance = Stance::new(&T1, &STRAIGHT, &-Vector3::z());
        let ball = stance.on_ground(&T1.seen_in_torso(&seen, &STRAIGHT));
        assert!((ball.x - (5.0 - 0.0625)).abs() < 0.01 && ball.y.abs() < 1e-9, "{ball}");
        assert!((ball.z - 0.11).abs() < 0.01, "the middle of the ball is {} m high", ball.z);
    }

    #[test]
    fn the_head_turns_the_camera() {
        for (robot, seen_at, eye) in [(&T1, [0.0625, 1.05, 0.42485], 0.7), (&K1, [0.0056, 1.06, 0.3279], 0.7)]
        {
            let mut angles = STRAIGHT;
            angles[HEAD_YAW] = FRAC_PI_2;
            let ahead = Polar { distance: 1.0, azimuth: 0.0, elevation: 0.0 };
            let seen = robot.seen_in_torso(&ahead, &angles);
            assert!(near(&seen, seen_at), "{seen}");
            angles[HEAD_PITCH] = eye;
            assert!(robot.seen_in_torso(&ahead, &angles).z < 0.0, "a positive pitch looks down");
        }
    }

    #[test]
    fn a_torso_that_leans_forwards_and_to_the_right_has_positive_angles() {
        let down = UnitQuaternion::from_euler_angles(0.2, 0.3, 1.0).inverse() * -Vector3::z();
        let (roll, pitch) = inclination(&down);
        assert!((roll - 0.2).abs() < 1e-9 && (pitch - 0.3).abs() < 1e-9);
        let stance = Stance::new(&T1, &STRAIGHT, &down);
        let vertical = stance.level_from_torso * down;
        assert!((vertical + Vector3::z()).norm() < 1e-9, "{vertical}");
    }
}
