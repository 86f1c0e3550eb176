//! The masses of a T1 and their centre.
//!
//! Masses and their places are those of the file `resources/robots/T1/robot.xml` of rcsssmj 0.2.1.

use nalgebra::{Point3, Vector3};

use crate::anatomy::{JOINTS, JointValues};
use crate::kinematics::in_torso;

/// The mass of a link, kg, and its centre in the frame of the joint that moves it, m.
type Link = (f64, [f64; 3]);

const TORSO: Link = (11.7, [0.055_136_5, -1.4e-6, 0.105_062]);

/// The links in the order of their joints.
#[rustfmt::skip]
const LINKS: [Link; JOINTS] = [
    (0.44391, [-0.000508, -0.001403, 0.057432]),
    (0.631019, [0.007802, 0.001262, 0.098631]),
    (0.53, [-0.000677, 0.044974, 0.0]),
    (0.16, [0.003862, 0.037976, 0.0]),
    (1.02, [0.0, 0.085353, -9.9e-05]),
    (0.327214, [-0.000108, 0.109573, 0.000591]),
    (0.53, [-0.000677, -0.044974, 0.0]),
    (0.16, [0.003862, -0.037976, 0.0]),
    (1.02, [0.0, -0.085353, -9.9e-05]),
    (0.327214, [-0.000108, -0.109573, 0.000591]),
    (2.581, [0.002284, 3e-06, 0.007301]),
    (1.021, [0.000534, -0.007296, -0.018083]),
    (0.385, [0.001101, 2.4e-05, -0.05375]),
    (2.166, [-0.007233, 0.000206, -0.089184]),
    (1.73, [-0.006012, 0.000259, -0.124318]),
    (0.073, [-0.003722, 0.0, -0.007981]),
    (0.685, [-0.000249, 0.0, -0.00914]),
    (1.021, [0.000534, 0.007514, -0.018082]),
    (0.385, [0.001099, 2.4e-05, -0.053748]),
    (2.17, [-0.007191, -0.000149, -0.08922]),
    (1.79, [-0.005741, -0.000541, -0.122602]),
    (0.073, [-0.003722, 0.0, -0.007981]),
    (0.685, [-0.000248, 0.0, -0.00914]),
];

/// The mass of the whole robot, kg.
pub fn mass() -> f64 {
    TORSO.0 + LINKS.iter().map(|(mass, _)| mass).sum::<f64>()
}

/// The centre of mass in the torso frame.
pub fn centre_of_mass(angles: &JointValues) -> Point3<f64> {
    let mut sum = Vector3::from(TORSO.1) * TORSO.0;
    for (joint, (mass, centre)) in LINKS.iter().enumerate() {
        sum += in_torso(Point3::from(*centre), joint, angles).coords * *mass;
    }
    Point3::from(sum / mass())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy::LEFT_LEG;

    #[test]
    fn a_leg_that_is_lifted_ahead_moves_the_centre_ahead() {
        let mut angles = [0.0; JOINTS];
        let straight = centre_of_mass(&angles);
        assert!((mass() - 31.614).abs() < 1e-3 && straight.y.abs() < 1e-3, "{straight}");
        angles[LEFT_LEG] = -0.5;
        let lifted = centre_of_mass(&angles) - straight;
        assert!(lifted.x > 0.02 && lifted.z > 0.0, "{lifted}");
    }
}
