//! The masses of a robot and their centre.

use nalgebra::Point3;

use crate::humanoid::{Humanoid, JointValues};

impl Humanoid {
    /// The mass of the whole robot, kg.
    pub fn mass(&self) -> f64 {
        self.links.mass()
    }

    /// The centre of mass in the torso frame.
    pub fn centre_of_mass(&self, angles: &JointValues) -> Point3<f64> {
        self.links.centre_of_mass(angles)
    }
}

#[cfg(test)]
mod tests {
    use crate::humanoid::JOINTS;
    use crate::{K1, T1};

    #[test]
    fn a_leg_that_is_lifted_ahead_moves_the_centre_ahead() {
        for (robot, mass) in [(&T1, 31.614), (&K1, 19.666)] {
            let mut angles = [0.0; JOINTS];
            let straight = robot.centre_of_mass(&angles);
            assert!((robot.mass() - mass).abs() < 1e-3 && straight.y.abs() < 1e-3, "{straight}");
            angles[robot.left_leg] = -0.5;
            let lifted = robot.centre_of_mass(&angles) - straight;
            assert!(lifted.x > 0.02 && lifted.z > 0.0, "{lifted}");
        }
    }
}
