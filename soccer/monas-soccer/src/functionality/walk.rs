//! Walks to a position.

use nalgebra::{Point2, Vector2};

use super::geometry::{angle_of, wrap};

/// The velocity of a walk in the robot's frame.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Walk {
    /// Ahead, m/s.
    pub ahead: f64,
    /// To the left, m/s.
    pub left: f64,
    /// Counterclockwise, rad/s.
    pub turn: f64,
}

impl Walk {
    /// Standing.
    pub const STILL: Walk = Walk { ahead: 0.0, left: 0.0, turn: 0.0 };

    /// Moving along a vector while turning.
    pub fn along(velocity: Vector2<f64>, turn: f64) -> Walk {
        Walk { ahead: velocity.x, left: velocity.y, turn }
    }

    /// Only turning.
    pub fn turning(turn: f64) -> Walk {
        Walk { turn, ..Walk::STILL }
    }

    /// The velocity over the ground.
    pub fn velocity(&self) -> Vector2<f64> {
        Vector2::new(self.ahead, self.left)
    }
}

/// Limits of a gait. Velocities over the ground lie in an ellipse with these half axes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GaitLimits {
    /// Fastest walk ahead, m/s.
    pub forward: f64,
    /// Fastest walk backwards, m/s.
    pub backward: f64,
    /// Fastest walk to a side, m/s.
    pub sideways: f64,
    /// Fastest turn, rad/s.
    pub turn: f64,
}

impl GaitLimits {
    /// The nearest possible walk in the same direction; values that are not finite become standing.
    pub fn limit(&self, walk: &Walk) -> Walk {
        let along = if walk.ahead >= 0.0 { self.forward } else { self.backward };
        let part = libm::hypot(walk.ahead / along, walk.left / self.sideways);
        let scale = if part > 1.0 { 1.0 / part } else { 1.0 };
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        Walk {
            ahead: finite(walk.ahead * scale),
            left: finite(walk.left * scale),
            turn: finite(walk.turn).clamp(-self.turn, self.turn),
        }
    }
}

/// Gain from remaining distance to speed, 1/s; the gait limits the result.
const APPROACH_GAIN: f64 = 1.0;
const FULL_SPEED: f64 = 0.5;
/// Gain from heading error to angular velocity, 1/s.
const TURN_GAIN: f64 = 2.0;

/// A straight walk to a position, given in the robot's frame, while turning to `facing`; `distance`
/// is the length of the remaining path in metres.
///
/// The walk slows down towards the end of the path, and while the heading error is large.
pub fn walk_to(position: Point2<f64>, distance: f64, facing: f64) -> Walk {
    let turned = (1.0 - facing.abs()).clamp(0.1, 1.0);
    let speed = (APPROACH_GAIN * distance).min(FULL_SPEED) * turned;
    let direction = position.coords.try_normalize(1e-6).unwrap_or_default();
    Walk::along(direction * speed, turn_to(facing))
}

/// The turn towards a bearing.
pub fn turn_to(bearing: f64) -> f64 {
    TURN_GAIN * wrap(bearing)
}

/// A walk to a distant position in the robot's frame: turns towards it and walks forward.
pub fn stride_to(position: Point2<f64>, distance: f64) -> Walk {
    let bearing = angle_of(&position.coords);
    let ahead = libm::cos(bearing).max(0.0);
    let speed = (APPROACH_GAIN * distance).min(FULL_SPEED) * ahead;
    Walk { ahead: speed * ahead, left: 0.0, turn: turn_to(bearing) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAIT: GaitLimits = GaitLimits { forward: 0.3, backward: 0.1, sideways: 0.1, turn: 1.0 };

    #[test]
    fn a_walk_is_limited_without_changing_its_direction() {
        let limited = GAIT.limit(&Walk { ahead: 3.0, left: 1.0, turn: -7.0 });
        assert!((limited.ahead / limited.left - 3.0).abs() < 1e-12);
        assert!((libm::hypot(limited.ahead / 0.3, limited.left / 0.1) - 1.0).abs() < 1e-12);
        assert_eq!(limited.turn, -1.0);
        assert_eq!(GAIT.limit(&Walk { ahead: -1.0, ..Walk::STILL }).ahead, -0.1);
        let slow = Walk { ahead: 0.1, left: 0.02, turn: 0.3 };
        assert_eq!(GAIT.limit(&slow), slow);
    }

    #[test]
    fn nan_is_not_walked() {
        let limited = GAIT.limit(&Walk { ahead: f64::NAN, left: f64::INFINITY, turn: f64::NAN });
        assert_eq!(limited, Walk::STILL);
    }

    #[test]
    fn the_robot_turns_before_it_walks_to_a_position_behind_it() {
        let walk = stride_to(Point2::new(-2.0, 0.1), 2.0);
        assert_eq!(walk.velocity(), Vector2::zeros());
        assert!(walk.turn > 1.0);
        let walk = stride_to(Point2::new(2.0, 0.0), 2.0);
        assert_eq!(walk, Walk { ahead: FULL_SPEED, left: 0.0, turn: 0.0 });
    }

    #[test]
    fn a_walk_slows_down_at_its_end() {
        assert_eq!(walk_to(Point2::new(0.0, 0.1), 0.1, 0.0).left, 0.1);
        assert_eq!(walk_to(Point2::origin(), 0.0, 0.0), Walk::STILL);
    }
}
