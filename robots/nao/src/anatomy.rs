//! The anatomy of a Nao V6: joints in the order of LoLA, links, limits, cameras, masses.
//!
//! It is read from the file `nao.urdf`, which the program contains.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use monas_config::urdf;
use monas_kinematics::LinkTree;
use monas_robot::{Anatomy, Error, ErrorKind, Limits};
use yase::{Diagnostic, Source};

/// The option that names a file in place of the built-in one.
pub(crate) const ANATOMY: &str = "anatomy";

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

static NAO: LazyLock<Anatomy> = LazyLock::new(|| {
    let file = Source::new("nao.urdf", include_str!("../nao.urdf"));
    let (anatomy, _) = urdf::read(&file);
    #[allow(clippy::expect_used)] // the file is part of the program, and a test reads it
    anatomy.expect("nao.urdf has no errors")
});

/// The anatomy of a Nao V6. It sees objects only where a simulation stands in for its cameras.
pub fn anatomy() -> &'static Anatomy {
    &NAO
}

static LINKS: LazyLock<LinkTree> = LazyLock::new(|| LinkTree::new(&NAO));

/// The forward kinematics of a Nao V6.
pub fn links() -> &'static LinkTree {
    &LINKS
}

/// The anatomy of a robot: that of the file that the options of a configuration name, otherwise the
/// built-in one.
///
/// # Errors
/// The file cannot be read or has errors; the message has its first one.
pub(crate) fn anatomy_of(options: &BTreeMap<String, String>) -> Result<Anatomy, Error> {
    let Some(path) = options.get(ANATOMY) else { return Ok(anatomy().clone()) };
    let (own, diagnostics) = urdf::load_variant(Path::new(path), anatomy());
    let message = || diagnostics.iter().find(|found| found.is_error()).map(Diagnostic::to_string);
    own.ok_or_else(|| Error::new(ErrorKind::Configuration, message().unwrap_or_default()))
}

/// The limits of a joint, rad.
pub(crate) fn limits(joint: usize) -> Limits {
    anatomy().joints[joint].limits
}

/// The joint on the other side of the body and its angle in the mirror image of a pose. The head's
/// joints and that of both hips are their own images.
pub(crate) fn mirrored(joint: usize, angle: f64) -> (usize, f64) {
    let joints = &anatomy().joints;
    let name = &joints[joint].name;
    let other = match name.split_at(1) {
        ("L", rest) => format!("R{rest}"),
        ("R", rest) => format!("L{rest}"),
        _ => name.clone(),
    };
    let image = joints.iter().position(|joint| joint.name == other).unwrap_or(joint);
    // Pitch turns both sides alike, and so does the joint of both hips.
    let turns_back = name.ends_with("Roll") || name.ends_with("Yaw");
    (image, if turns_back { 0.0 - angle } else { angle })
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;

    use super::*;
    use crate::kinematics::{JointAngles, Side, foot_in_torso};
    use crate::lola::{CYCLE, JOINTS};
    use crate::motions::stand;

    /// The angles of the mirrored robot.
    fn mirror(angles: &JointAngles) -> JointAngles {
        let mut image = *angles;
        for (joint, angle) in angles.iter().enumerate() {
            let (other, angle) = mirrored(joint, *angle);
            image[other] = angle;
        }
        image
    }

    #[test]
    fn the_file_has_the_joints_of_lola() {
        let anatomy = anatomy();
        assert_eq!((anatomy.joints.len(), anatomy.cycle, &*anatomy.model), (JOINTS, CYCLE, "nao v6"));
        for (joint, name) in [(NaoJoint::HeadPitch, "HeadPitch"), (NaoJoint::RAnkleRoll, "RAnkleRoll")] {
            assert_eq!(anatomy.joint(name), Some(joint as usize));
        }
        assert_eq!(format!("{:?}", NaoJoint::LHipYawPitch), anatomy.joints[7].name);
        assert_eq!(format!("{:?}", NaoJoint::RHand), anatomy.joints[JOINTS - 1].name);
        assert_eq!((anatomy.head_yaw, anatomy.head_pitch), (limits(0), limits(1)));
    }

    #[test]
    fn the_right_side_mirrors_the_left() {
        let anatomy = anatomy();
        for (index, joint) in anatomy.joints.iter().enumerate() {
            let (image, low) = mirrored(index, joint.limits.low);
            let (_, high) = mirrored(index, joint.limits.high);
            let limits = Limits::new(low.min(high), low.max(high));
            assert_eq!(anatomy.joints[image].limits, limits, "{}", joint.name);
            assert_eq!(anatomy.joints[image].speed, joint.speed, "{}", joint.name);
            assert_eq!(mirrored(image, mirrored(index, 0.5).1), (index, 0.5));
            let is_single = ["HeadYaw", "HeadPitch", "LHipYawPitch"].contains(&&*joint.name);
            assert_eq!(image == index, is_single, "{}", joint.name);
        }
    }

    #[test]
    fn the_robot_weighs_what_is_published_and_stands_over_its_feet() {
        let mass = links().mass();
        assert!((mass - 5.305).abs() < 0.001, "{mass}");
        let angles = stand();
        let (centre, foot) = (links().centre_of_mass(&angles), foot_in_torso(Side::Left, &angles));
        // The sole reaches 10 cm ahead of the ankle and 5 cm behind it.
        let ahead = centre.x - foot.translation.x;
        assert!(centre.y.abs() < 1e-9 && (-0.05..0.1).contains(&ahead), "{centre} {ahead}");
    }

    #[test]
    fn a_turned_hand_moves_the_centre_by_the_part_of_its_mass() {
        let hanging = [0.0; JOINTS];
        let mut turned = hanging;
        turned[NaoJoint::LWristYaw as usize] = std::f64::consts::PI;
        // Half a turn of the hand mirrors its centre on the axis of the forearm.
        let moved = links().centre_of_mass(&turned) - links().centre_of_mass(&hanging);
        let expected = Vector3::new(0.0, 2.0 * 0.000_88, -2.0 * 0.003_08) * (0.185_33 / links().mass());
        assert!((moved - expected).norm() < 1e-9, "{moved} {expected}");
    }

    proptest! {
        #[test]
        fn the_mirrored_robot_has_the_mirrored_centre(
            angles in (0..JOINTS).map(|joint| limits(joint).low..limits(joint).high).collect::<Vec<_>>(),
        ) {
            let angles: JointAngles = angles.try_into().unwrap();
            let [centre, image] = [angles, mirror(&angles)].map(|angles| links().centre_of_mass(&angles));
            let expected = Point3::new(centre.x, -centre.y, centre.z);
            prop_assert!((image - expected).norm() < 1e-9, "{} {}", image, expected);
        }
    }
}
