//! Alignment with the ball before a kick.
//!
//! A kick sends the ball in the direction of the robot's heading if the ball lies at the kick point
//! in front of one of the feet. So the robot first turns round the ball at a distance until it
//! faces the target, and then closes in. The controller is stateless; near the ball it accepts a
//! larger error of the heading, so that it does not oscillate between the two.

use nalgebra::{Point2, Vector2};

use super::geometry::{angle_of, wrap};
use super::walk::Walk;

/// Position of the ball for a kick, and parameters of the alignment.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Alignment {
    /// Best position of the ball for a kick: ahead, metres.
    pub kick_x: f64,
    /// The same to the side, metres; left for the left foot.
    pub kick_y: f64,
    /// Distance ahead at which the ball is kept while the robot turns round it, metres: out of
    /// reach of a kick.
    pub turn_x: f64,
    /// Error of the heading below which the robot closes in, radians.
    pub tolerance: f64,
    /// Factor on the tolerance near the ball.
    pub patience: f64,
    /// Fastest turn round the ball, rad/s.
    pub turn_speed: f64,
}

impl Default for Alignment {
    fn default() -> Alignment {
        Alignment {
            kick_x: 0.15,
            kick_y: 0.05,
            turn_x: 0.205,
            tolerance: 0.12,
            patience: 2.0,
            turn_speed: 0.6,
        }
    }
}

/// Accepted distance of the ball from the kick point, metres.
const AT_FOOT: f64 = 0.025;
/// Gain from position error to velocity, 1/s.
const GAIN: f64 = 1.5;
/// Gain from heading error to angular velocity, 1/s.
const TURN_GAIN: f64 = 1.5;

impl Alignment {
    /// The walk that brings the ball in front of a foot while facing `target`; both in the robot's
    /// frame.
    pub fn walk(&self, ball: Point2<f64>, target: Point2<f64>) -> Walk {
        let off = wrap(angle_of(&(target - ball)));
        if self.may_close_in(ball, off) { self.close_in(ball, off) } else { self.turn_round(ball, off) }
    }

    /// The kick point nearest to the ball.
    pub fn kick_point(&self, ball: Point2<f64>) -> Point2<f64> {
        Point2::new(self.kick_x, if ball.y >= 0.0 { self.kick_y } else { -self.kick_y })
    }

    /// Whether the ball lies at a kick point.
    pub fn is_at_foot(&self, ball: Point2<f64>) -> bool {
        let off = ball - self.kick_point(ball);
        off.x.abs() <= AT_FOOT && off.y.abs() <= AT_FOOT
    }

    fn may_close_in(&self, ball: Point2<f64>, off: f64) -> bool {
        let near = ball.x < (self.kick_x + self.turn_x) / 2.0;
        off.abs() <= if near { self.tolerance * self.patience } else { self.tolerance }
    }

    fn close_in(&self, ball: Point2<f64>, off: f64) -> Walk {
        Walk::along((ball - self.kick_point(ball)) * GAIN, (TURN_GAIN * off).clamp(-0.2, 0.2))
    }

    /// Turning at ω while the ball stays at b in the robot's frame requires the velocity -ω × b; a
    /// correction of its position is added.
    fn turn_round(&self, ball: Point2<f64>, off: f64) -> Walk {
        let turn = (TURN_GAIN * off).clamp(-self.turn_speed, self.turn_speed);
        let position = Point2::new(self.turn_x, self.kick_point(ball).y);
        let around = Vector2::new(turn * ball.y, -turn * ball.x);
        Walk::along(around + (ball - position) * GAIN, turn)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Isometry2;
    use proptest::prelude::*;

    use super::*;
    use crate::functionality::geometry::{heading, pose};
    use crate::functionality::walk::GaitLimits;

    const GAIT: GaitLimits = GaitLimits { forward: 0.25, backward: 0.12, sideways: 0.12, turn: 1.0 };

    /// Whether the attacker's chart would kick.
    fn at_kick_point(ball: Point2<f64>) -> bool {
        (ball.x - 0.15).abs() <= 0.025 && (ball.y.abs() - 0.05).abs() <= 0.025
    }

    fn align(
        mut field_from_robot: Isometry2<f64>,
        ball: Point2<f64>,
        target: Point2<f64>,
    ) -> (f64, Isometry2<f64>) {
        let mut seconds = 0.0;
        while seconds < 60.0 {
            let robot_from_field = field_from_robot.inverse();
            if at_kick_point(robot_from_field * ball) {
                break;
            }
            let walk =
                GAIT.limit(&Alignment::default().walk(robot_from_field * ball, robot_from_field * target));
            field_from_robot *= pose(walk.ahead * 0.1, walk.left * 0.1, walk.turn * 0.1);
            seconds += 0.1;
        }
        (seconds, field_from_robot)
    }

    proptest! {
        #[test]
        fn the_ball_is_at_a_foot_with_the_robot_facing_the_target(
            x in 0.18..0.24f64, y in -0.06..0.06f64, start in -1.2..1.2f64
        ) {
            let start = pose(0.0, 0.0, start);
            let ball = start * Point2::new(x, y);
            let target = Point2::new(3.0, 0.0);
            let (seconds, end) = align(start, ball, target);
            let wanted = angle_of(&(target - ball));
            prop_assert!(seconds < 12.0, "took {seconds}");
            prop_assert!((heading(&end) - wanted).abs() < 0.3, "faces {} instead of {wanted}", heading(&end));
        }
    }

    #[test]
    fn the_foot_is_the_one_on_the_balls_side() {
        let alignment = Alignment::default();
        assert_eq!(alignment.kick_point(Point2::new(0.2, 0.0)).y, 0.05);
        assert_eq!(alignment.kick_point(Point2::new(0.2, -0.01)).y, -0.05);
    }

    #[test]
    fn turning_round_the_ball_keeps_it_where_it_is_seen() {
        let ball = Point2::new(0.205, 0.05);
        let walk = Alignment::default().walk(ball, Point2::new(0.0, 3.0));
        let drift = walk.velocity() + Vector2::new(-walk.turn * ball.y, walk.turn * ball.x);
        assert!(walk.turn > 0.5 && drift.norm() < 1e-12, "{walk:?}");
    }
}
