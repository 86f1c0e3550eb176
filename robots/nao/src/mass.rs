//! Masses of the links of a Nao, and its centre of mass.
//!
//! The figures are those that the manufacturer publishes for the right side of the body (Nao V5 and
//! V6, "Masses" of the technical overview); the left side mirrors them.

use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use crate::anatomy::{ELBOW_Y, HIP, LOWER_ARM, NECK_Z, NaoJoint, SHOULDER, THIGH, TIBIA, UPPER_ARM};
use crate::kinematics::{JointAngles, Side, down, hip_rotation, mirrored, pitch, roll, yaw};

/// A link: its mass in kg, and its centre in the frame of the joint that turns it, m.
struct Link {
    mass: f64,
    centre: [f64; 3],
}

const fn link(mass: f64, centre: [f64; 3]) -> Link {
    Link { mass, centre }
}

const TORSO: Link = link(1.0496, [-0.004_13, 0.0, 0.043_42]);
const NECK: Link = link(0.078_42, [-0.000_01, 0.0, -0.027_42]);
const HEAD: Link = link(0.605_33, [-0.001_12, 0.0, 0.052_58]);
const SHOULDER_LINK: Link = link(0.093_04, [-0.001_65, 0.026_63, 0.000_14]);
const BICEPS: Link = link(0.157_77, [0.024_55, -0.005_63, 0.003_3]);
const ELBOW: Link = link(0.064_83, [-0.027_44, 0.0, -0.000_14]);
const FOREARM: Link = link(0.077_61, [0.025_56, -0.002_81, 0.000_76]);
const HAND: Link = link(0.185_33, [0.034_34, 0.000_88, 0.003_08]);
const PELVIS: Link = link(0.069_81, [-0.007_81, 0.011_14, 0.026_61]);
const HIP_LINK: Link = link(0.140_53, [-0.015_49, -0.000_29, -0.005_15]);
const THIGH_LINK: Link = link(0.389_68, [0.001_38, -0.002_21, -0.053_73]);
const TIBIA_LINK: Link = link(0.301_42, [0.004_53, -0.002_25, -0.049_36]);
const ANKLE: Link = link(0.134_16, [0.000_45, -0.000_29, 0.006_85]);
const FOOT: Link = link(0.171_84, [0.025_42, -0.003_3, -0.032_39]);

/// The mass of the robot, kg.
pub fn mass() -> f64 {
    Sum::of(&[0.0; crate::lola::JOINTS]).mass
}

/// The centre of mass in the torso's frame, m.
pub fn centre_of_mass(angles: &JointAngles) -> Point3<f64> {
    let Sum { mass, moment } = Sum::of(angles);
    Point3::from(moment / mass)
}

/// The links so far: their mass, and the sum of masses times centres.
#[derive(Default)]
struct Sum {
    mass: f64,
    moment: Vector3<f64>,
}

impl Sum {
    fn of(angles: &JointAngles) -> Sum {
        let mut sum = Sum::default();
        sum.add(&TORSO, &Isometry3::identity(), Side::Right);
        let neck = Translation3::new(0.0, 0.0, NECK_Z) * yaw(angles[NaoJoint::HeadYaw as usize]);
        sum.add(&NECK, &neck, Side::Right);
        sum.add(&HEAD, &(neck * pitch(angles[NaoJoint::HeadPitch as usize])), Side::Right);
        for side in Side::BOTH {
            sum.add_arm(side, angles);
            sum.add_leg(side, angles);
        }
        sum
    }

    fn add_arm(&mut self, side: Side, angles: &JointAngles) {
        let arm = side.arm();
        let shoulder = Translation3::from(mirrored(SHOULDER, side)) * pitch(angles[arm]);
        let biceps = shoulder * yaw(angles[arm + 1]);
        let elbow = biceps * Translation3::new(UPPER_ARM, side.sign() * ELBOW_Y, 0.0) * roll(angles[arm + 2]);
        let forearm = elbow * yaw(angles[arm + 3]);
        let hand = forearm * Translation3::new(LOWER_ARM, 0.0, 0.0) * roll(angles[arm + 4]);
        let links = [SHOULDER_LINK, BICEPS, ELBOW, FOREARM, HAND];
        for (link, pose) in links.iter().zip([shoulder, biceps, elbow, forearm, hand]) {
            self.add(link, &pose, side);
        }
    }

    fn add_leg(&mut self, side: Side, angles: &JointAngles) {
        let leg = side.leg();
        let shared = hip_rotation(side, angles[NaoJoint::LHipYawPitch as usize]);
        let pelvis = Isometry3::from_parts(mirrored(HIP, side).into(), shared);
        let hip = pelvis * roll(angles[leg]);
        let thigh = hip * pitch(angles[leg + 1]);
        let tibia = thigh * down(THIGH) * pitch(angles[leg + 2]);
        let ankle = tibia * down(TIBIA) * pitch(angles[leg + 3]);
        let foot = ankle * roll(angles[leg + 4]);
        let links = [PELVIS, HIP_LINK, THIGH_LINK, TIBIA_LINK, ANKLE, FOOT];
        for (link, pose) in links.iter().zip([pelvis, hip, thigh, tibia, ankle, foot]) {
            self.add(link, &pose, side);
        }
    }

    fn add(&mut self, link: &Link, pose: &Isometry3<f64>, side: Side) {
        let [x, y, z] = link.centre;
        let centre = pose * Point3::new(x, -side.sign() * y, z);
        self.mass += link.mass;
        self.moment += link.mass * centre.coords;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::anatomy::{anatomy, limits};
    use crate::kinematics::foot_in_torso;
    use crate::lola::JOINTS;
    use crate::motions::stand;

    /// The angles of the mirrored robot.
    fn mirror(angles: &JointAngles) -> JointAngles {
        let anatomy = anatomy();
        let mut mirrored = *angles;
        for (joint, described) in anatomy.joints.iter().enumerate() {
            let name = described.name;
            let other = match name.split_at(1) {
                _ if name == "LHipYawPitch" => name.to_owned(),
                ("L", rest) => format!("R{rest}"),
                ("R", rest) => format!("L{rest}"),
                _ => name.to_owned(),
            };
            let turns_back = name.contains("Roll")
                || name == "HeadYaw"
                || name.contains("ElbowYaw")
                || name.contains("WristYaw");
            let angle = angles[anatomy.joint(&other).unwrap()];
            mirrored[joint] = if turns_back { -angle } else { angle };
        }
        mirrored
    }

    #[test]
    fn the_robot_weighs_what_is_published_and_stands_over_its_feet() {
        assert!((mass() - 5.305).abs() < 0.001, "{}", mass());
        let angles = stand();
        let (centre, foot) = (centre_of_mass(&angles), foot_in_torso(Side::Left, &angles));
        // The sole reaches 10 cm ahead of the ankle and 5 cm behind it.
        let ahead = centre.x - foot.translation.x;
        assert!(centre.y.abs() < 1e-9 && (-0.05..0.1).contains(&ahead), "{centre} {ahead}");
    }

    #[test]
    fn a_raised_arm_moves_the_centre_by_the_part_of_its_mass() {
        let hanging = [0.0; JOINTS];
        let mut turned = hanging;
        turned[NaoJoint::LWristYaw as usize] = std::f64::consts::PI;
        // Half a turn of the hand mirrors its centre on the axis of the forearm.
        let moved = centre_of_mass(&turned) - centre_of_mass(&hanging);
        let expected = Vector3::new(0.0, 2.0 * 0.000_88, -2.0 * 0.003_08) * (HAND.mass / mass());
        assert!((moved - expected).norm() < 1e-9, "{moved} {expected}");
    }

    proptest! {
        #[test]
        fn the_mirrored_robot_has_the_mirrored_centre(
            angles in (0..JOINTS).map(|joint| limits(joint).low..limits(joint).high).collect::<Vec<_>>(),
        ) {
            let angles: JointAngles = angles.try_into().unwrap();
            let (centre, mirrored) = (centre_of_mass(&angles), centre_of_mass(&mirror(&angles)));
            let expected = Point3::new(centre.x, -centre.y, centre.z);
            prop_assert!((mirrored - expected).norm() < 1e-9, "{} {}", mirrored, expected);
        }
    }
}
