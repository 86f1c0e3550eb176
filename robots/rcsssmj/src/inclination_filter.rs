//! The inclination of the torso from its gyroscope and accelerometer.

use nalgebra::Vector3;

/// The fraction of the error against the accelerometer that is corrected per second. It is small:
/// steps shake the torso, so the accelerometer does not measure gravity alone.
const CORRECTION_RATE: f64 = 0.4;
/// Range of the acceleration, m/s2, in which the accelerometer is taken to measure gravity.
const TRUSTED_ACCELERATIONS: std::ops::Range<f64> = 8.0..12.0;

/// A complementary filter of the direction of gravity (Mahony, Hamel, Pflimlin, *Nonlinear
/// Complementary Filters on the Special Orthogonal Group*, IEEE TAC 2008, section IV, without the
/// estimate of the gyroscope's bias, since the server's has none).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct InclinationFilter {
    down: Vector3<f64>,
}

impl Default for InclinationFilter {
    /// Upright.
    fn default() -> InclinationFilter {
        InclinationFilter { down: -Vector3::z() }
    }
}

impl InclinationFilter {
    /// Advances by `seconds` with the measured angular velocity, rad/s, and acceleration, m/s2.
    pub fn advance(&mut self, gyro: [f64; 3], acceleration: [f64; 3], seconds: f64) {
        let (gyro, acceleration) = (Vector3::from(gyro), Vector3::from(acceleration));
        // A direction that is fixed in the world turns the other way in the torso.
        let turned = self.down - gyro.cross(&self.down) * seconds;
        let size = acceleration.norm();
        let corrected = if TRUSTED_ACCELERATIONS.contains(&size) {
            turned + (-acceleration / size - turned) * (CORRECTION_RATE * seconds)
        } else {
            turned
        };
        self.down = corrected.try_normalize(1e-9).unwrap_or(self.down);
    }

    /// The unit vector that points down, in the torso frame.
    pub fn down(&self) -> Vector3<f64> {
        self.down
    }

    /// The rate at which the robot turns about the vertical, rad/s, counterclockwise.
    pub fn turn(&self, gyro: [f64; 3]) -> f64 {
        -self.down.dot(&Vector3::from(gyro))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::inclination;

    #[test]
    fn a_turn_of_the_torso_is_followed_at_once() {
        let mut filter = InclinationFilter::default();
        for step in 0..50 {
            // Falling forwards with 1 rad/s: gravity moves from z towards the torso's x.
            let angle = f64::from(step) * 0.02;
            let felt = [-9.81 * libm::sin(angle), 0.0, 9.81 * libm::cos(angle)];
            filter.advance([0.0, 1.0, 0.0], felt, 0.02);
        }
        let (roll, pitch) = inclination(&filter.down());
        assert!((pitch - 1.0).abs() < 0.02 && roll.abs() < 1e-9, "{roll} {pitch}");
        assert!((filter.turn([0.0, 0.0, 1.0]) - libm::cos(pitch)).abs() < 1e-9);
    }

    #[test]
    fn a_wrong_inclination_is_corrected_and_shocks_are_not_believed() {
        let mut filter = InclinationFilter { down: Vector3::new(0.3, 0.0, -0.95).normalize() };
        for _ in 0..1000 {
            filter.advance([0.0; 3], [0.0, 0.0, 9.81], 0.02);
        }
        assert!((filter.down() + Vector3::z()).norm() < 1e-3);
        filter.advance([0.0; 3], [60.0, 0.0, 9.81], 0.02);
        assert!((filter.down() + Vector3::z()).norm() < 1e-3);
        filter.advance([0.0; 3], [0.0; 3], 0.02);
        assert!(filter.down().norm() > 0.99);
    }
}
