//! Walking: velocities in the plane become commands to the motors.

use monas_robot::Limits;
use nalgebra::Vector3;

use crate::effector::MotorCommand;
use crate::humanoid::{JOINTS, JointValues};

/// A velocity of the robot in its own frame.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct WalkVelocity {
    /// Ahead, m/s.
    pub x: f64,
    /// To the left, m/s.
    pub y: f64,
    /// Counterclockwise, rad/s.
    pub turn: f64,
}

/// The state of the robot that a walk engine uses.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Motion {
    /// Angles of the joints, rad.
    pub positions: JointValues,
    /// Angular velocities of the joints, rad/s.
    pub velocities: JointValues,
    /// Angular velocities of the torso, rad/s.
    pub gyro: [f64; 3],
    /// The unit vector that points down, in the torso frame.
    pub down: Vector3<f64>,
}

#[cfg(test)]
impl Motion {
    /// An upright robot that stands still, with all joints at zero.
    pub(crate) const STILL: Motion = Motion {
        positions: [0.0; JOINTS],
        velocities: [0.0; JOINTS],
        gyro: [0.0; 3],
        down: Vector3::new(0.0, 0.0, -1.0),
    };
}

/// Commands to all motors.
pub type Motors = [MotorCommand; JOINTS];

/// The limits of the velocities of a walk.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Gait {
    /// Ahead, m/s.
    pub x: Limits,
    /// To the left, m/s.
    pub y: Limits,
    /// Counterclockwise, rad/s.
    pub turn: Limits,
}

/// Turns velocities into commands to the motors.
pub trait WalkEngine: Send {
    /// The limits of its velocities.
    fn gait(&self) -> Gait;

    /// Advances by one cycle of 20 ms with a velocity within its gait, and commands all motors.
    fn advance(&mut self, velocity: WalkVelocity, motion: &Motion, motors: &mut Motors);

    /// Forgets the motion: the robot was placed upright with all joints at zero.
    fn reset(&mut self);
}

/// The greatest changes of velocity: m/s2 and rad/s2.
const MAX_ACCELERATIONS: (f64, f64) = (1.5, 4.0);

/// A velocity that approaches the requested one within the limits of a gait and of its
/// acceleration.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Ramp {
    velocity: WalkVelocity,
}

impl Ramp {
    /// Advances by `seconds` and returns the velocity to walk with. Components that are not finite
    /// count as zero.
    pub fn advance(&mut self, wanted: WalkVelocity, gait: &Gait, seconds: f64) -> WalkVelocity {
        let (linear, angular) = MAX_ACCELERATIONS;
        let WalkVelocity { x, y, turn } = &mut self.velocity;
        approach(x, gait.x.clamp(wanted.x), linear * seconds);
        approach(y, gait.y.clamp(wanted.y), linear * seconds);
        approach(turn, gait.turn.clamp(wanted.turn), angular * seconds);
        self.velocity
    }

    /// The velocity of the last call.
    pub fn velocity(&self) -> WalkVelocity {
        self.velocity
    }

    /// Stands at once.
    pub fn reset(&mut self) {
        self.velocity = WalkVelocity::default();
    }
}

fn approach(value: &mut f64, wanted: f64, max: f64) {
    *value += (wanted - *value).clamp(-max, max);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_keeps_the_limits_of_velocity_and_acceleration() {
        let gait =
            Gait { x: Limits::new(-0.5, 1.0), y: Limits::symmetric(0.2), turn: Limits::symmetric(1.0) };
        let (mut ramp, mut before) = (Ramp::default(), WalkVelocity::default());
        let wanted = WalkVelocity { x: 9.0, y: -9.0, turn: f64::NAN };
        for _ in 0..100 {
            let velocity = ramp.advance(wanted, &gait, 0.02);
            assert!(velocity.x - before.x <= 0.03 + 1e-12 && before.y - velocity.y <= 0.03 + 1e-12);
            before = velocity;
        }
        assert_eq!(before, WalkVelocity { x: 1.0, y: -0.2, turn: 0.0 });
    }
}
