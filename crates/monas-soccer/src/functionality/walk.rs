//! Walking to a place.

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

/// How fast a gait can be. Its velocities over the ground lie in an ellipse whose half axes are these.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Gait {
    /// Fastest walk ahead, m/s.
    pub forward: f64,
    /// Fastest walk backwards, m/s.
    pub backward: f64,
    /// Fastest walk to a side, m/s.
    pub sideways: f64,
    /// Fastest turn, rad/s.
    pub turn: f64,
}

impl Gait {
    /// The walk in the same direction that the gait can do; what is no number becomes standing.
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

/// Gain from metres left to metres a second, and the fastest that is asked for; the gait limits it to what the body can do.
const APPROACH_GAIN: f64 = 1.0;
const FULL_SPEED: f64 = 0.5;
/// Gain from radians off to radians a second.
const TURN_GAIN: f64 = 2.0;

/// A walk straight to a place, given in the robot's frame, of which `way` metres are left in all; turning to `facing` meanwhile.
///
/// The walk slows down towards the end of the way. While the robot faces elsewhere it turns first and walks less.
pub fn walk_to(place: Point2<f64>, way: f64, facing: f64) -> Walk {
    let turned = (1.0 - facing.abs()).clamp(0.1, 1.0);
    let speed = (APPROACH_GAIN * way).min(FULL_SPEED) * turned;
    let direction = place.coords.try_normalize(1e-6).unwrap_or_default();
    Walk::along(direction * speed, turn_to(facing))
}

/// The turn towards a bearing.
pub fn turn_to(bearing: f64) -> f64 {
    TURN_GAIN * wrap(bearing)
}

/// How a place in the robot's frame is reached over a longer way: turned towards it, walking ahead as far as it lies ahead.
pub fn stride_to(place: Point2<f64>, way: f64) -> Walk {
    let bearing = angle_of(&place.coords);
    let ahead = libm::cos(bearing).max(0.0);
    let speed = (APPROACH_GAIN * way).min(FULL_SPEED) * ahead;
    Walk { ahead: speed * ahead, left: 0.0, turn: turn_to(bearing) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAIT: Gait = Gait { forward: 0.3, backward: 0.1, sideways: 0.1, turn: 1.0 };

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
    fn what_is_no_number_is_not_walked() {
        let limited = GAIT.limit(&Walk { ahead: f64::NAN, left: f64::INFINITY, turn: f64::NAN });
        assert_eq!(limited, Walk::STILL);
    }

    #[test]
    fn a_place_behind_is_turned_to_before_it_is_walked_to() {
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
