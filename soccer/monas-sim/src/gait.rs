//! Walking: turns a desired velocity into motion.

use crate::pose::{Velocity, shortened};
use crate::rng::RandomStream;
use crate::{Physics, STEP, Side};

/// An omnidirectional walk with limits on speed and acceleration, and with noise drawn for each
/// step of the feet.
#[derive(Debug, Clone, Default)]
pub(crate) struct WalkModel {
    /// The intended velocity of the legs.
    intended: Velocity,
    /// Deviation of the current step from the intention.
    slip: GaitNoise,
    /// Progress of the stride, from 0 to 1; the left foot supports during the first half.
    stride: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct GaitNoise {
    /// Relative errors of the speed.
    forward: f64,
    left: f64,
    /// Unwanted turn at full speed, rad/s.
    turn: f64,
    /// Relative error of odometry.
    odometry: f64,
}

impl WalkModel {
    /// Advances by one step, accelerating towards the desired velocity.
    pub(crate) fn advance(&mut self, wanted: Velocity, physics: &Physics, stream: &mut RandomStream) {
        self.accelerate(limited(wanted, physics), physics);
        if !self.is_moving() {
            self.stop();
            return;
        }
        let half = |stride: f64| (stride * 2.0) as u32;
        let before = self.stride;
        self.stride = (before + STEP / physics.stride_duration).fract();
        if before == 0.0 || half(before) != half(self.stride) {
            self.slip = GaitNoise::draw(physics, stream);
        }
    }

    /// Stops at once.
    pub(crate) fn stop(&mut self) {
        *self = Self::default();
    }

    pub(crate) fn is_moving(&self) -> bool {
        self.intended != Velocity::default()
    }

    /// The velocity that the feet produce without obstacles.
    pub(crate) fn produced(&self, physics: &Physics) -> Velocity {
        let effort = effort(self.intended, physics);
        Velocity {
            forward: self.intended.forward * (1.0 + self.slip.forward),
            left: self.intended.left * (1.0 + self.slip.left),
            turn: self.intended.turn * (1.0 + self.slip.forward) + self.slip.turn * effort,
        }
    }

    /// The velocity measured by odometry.
    pub(crate) fn felt(&self) -> Velocity {
        self.intended.scaled(1.0 + self.slip.odometry)
    }

    /// The desired velocity after limits on acceleration.
    pub(crate) fn intended(&self) -> Velocity {
        self.intended
    }

    /// The supporting foot, while walking.
    pub(crate) fn support(&self) -> Option<Side> {
        self.is_moving().then_some(if self.stride < 0.5 { Side::Left } else { Side::Right })
    }

    /// Progress of the stride, from 0 to 1.
    pub(crate) fn stride(&self) -> f64 {
        self.stride
    }

    fn accelerate(&mut self, wanted: Velocity, physics: &Physics) {
        let change = shortened(wanted.linear() - self.intended.linear(), physics.walk_acceleration * STEP);
        let turn_limit = physics.turn_acceleration * STEP;
        self.intended.forward += change.x;
        self.intended.left += change.y;
        self.intended.turn += (wanted.turn - self.intended.turn).clamp(-turn_limit, turn_limit);
    }
}

impl GaitNoise {
    fn draw(physics: &Physics, stream: &mut RandomStream) -> Self {
        Self {
            forward: stream.normal(physics.gait_noise),
            left: stream.normal(physics.gait_noise),
            turn: stream.normal(physics.gait_turn_noise),
            odometry: stream.normal(physics.odometry_noise),
        }
    }
}

/// Effort of a velocity relative to the fastest possible one in its direction.
///
/// The possible velocities form an ellipsoid, so a robot that walks sideways or turns is slower
/// forward.
pub(crate) fn effort(velocity: Velocity, physics: &Physics) -> f64 {
    let along = if velocity.forward >= 0.0 { physics.walk_forward } else { physics.walk_backward };
    let forward = velocity.forward / along;
    let left = velocity.left / physics.walk_sideways;
    let turn = velocity.turn / physics.walk_turn;
    (forward * forward + left * left + turn * turn).sqrt()
}

fn limited(wanted: Velocity, physics: &Physics) -> Velocity {
    let effort = effort(wanted, physics);
    if effort > 1.0 { wanted.scaled(1.0 / effort) } else { wanted }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quiet() -> Physics {
        Physics { gait_noise: 0.0, gait_turn_noise: 0.0, odometry_noise: 0.0, ..Physics::default() }
    }

    fn after(steps: usize, wanted: Velocity, physics: &Physics) -> WalkModel {
        let mut gait = WalkModel::default();
        let mut stream = RandomStream::new(1, "gait");
        (0..steps).for_each(|_| gait.advance(wanted, physics, &mut stream));
        gait
    }

    #[test]
    fn speed_is_limited_in_every_direction() {
        let physics = quiet();
        let top = |forward, left, turn| after(300, Velocity::new(forward, left, turn), &physics).intended();
        assert!((top(9.0, 0.0, 0.0).forward - physics.walk_forward).abs() < 1e-9);
        assert!((top(-9.0, 0.0, 0.0).forward + physics.walk_backward).abs() < 1e-9);
        assert!((top(0.0, 9.0, 0.0).left - physics.walk_sideways).abs() < 1e-9);
        assert!((top(0.0, 0.0, -9.0).turn + physics.walk_turn).abs() < 1e-9);
        assert!(effort(top(9.0, 9.0, 9.0), &physics) <= 1.0 + 1e-9);
    }

    #[test]
    fn acceleration_is_limited() {
        let physics = quiet();
        let gait = after(10, Velocity::new(1.0, 0.0, 0.0), &physics);
        assert!((gait.intended().forward - physics.walk_acceleration * 0.1).abs() < 1e-9);
    }

    #[test]
    fn stopping_takes_time_and_ends_in_rest() {
        let physics = quiet();
        let mut gait = after(100, Velocity::new(1.0, 0.0, 0.0), &physics);
        let mut stream = RandomStream::new(1, "gait");
        gait.advance(Velocity::default(), &physics, &mut stream);
        assert!(gait.is_moving());
        (0..100).for_each(|_| gait.advance(Velocity::default(), &physics, &mut stream));
        assert!(!gait.is_moving() && gait.support().is_none());
    }

    #[test]
    fn feet_alternate() {
        let physics = quiet();
        let wanted = Velocity::new(0.2, 0.0, 0.0);
        assert_eq!(after(10, wanted, &physics).support(), Some(Side::Left));
        assert_eq!(after(30, wanted, &physics).support(), Some(Side::Right));
        assert_eq!(after(60, wanted, &physics).support(), Some(Side::Left));
    }

    #[test]
    fn noise_scatters_around_the_intended_velocity() {
        let physics = Physics::default();
        let mut gait = WalkModel::default();
        let mut stream = RandomStream::new(2, "gait");
        let mut speeds = Vec::new();
        for _ in 0..50_000 {
            gait.advance(Velocity::new(0.2, 0.0, 0.0), &physics, &mut stream);
            speeds.push(gait.produced(&physics).forward);
        }
        let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
        assert!((mean - 0.2).abs() < 0.003, "{mean}");
        assert!(speeds.iter().any(|s| *s > 0.21) && speeds.iter().any(|s| *s < 0.19));
    }
}
