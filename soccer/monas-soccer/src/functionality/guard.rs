//! Positions of the goalkeeper, and the walk to them.

use nalgebra::{Isometry2, Point2};

use super::field::{FieldModel, Goal};
use super::geometry::{angle_of, heading, pose, wrap};
use super::walk::{Walk, stride_to, walk_to};

/// Parameters of goalkeeping.
///
/// The keeper stands on the line from the middle of the goal to the ball. The nearer the ball, the
/// farther it comes out, which increases the angle that it covers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GoalPositioning {
    /// Least and greatest distance from the goal line, metres: not behind the posts, and not
    /// outside the goal area.
    pub before_line: (f64, f64),
    /// Least distance from the posts, metres.
    pub from_post: f64,
    /// Distance from the middle of the goal while the ball is far, metres.
    pub radius: f64,
    /// Least distance from the ball, metres.
    pub from_ball: f64,
    /// Fraction of the ball's direction to which the keeper turns; its lateral axis stays roughly
    /// parallel to the goal line.
    pub turn: f64,
    /// Errors of position, metres, and heading, radians, below which the keeper does not move.
    pub content: (f64, f64),
}

/// A ball that crosses nearer than this hits the keeper's centre, metres.
const STEP_DEAD_BAND: f64 = 0.03;
/// Gain from lateral distance to velocity, 1/s; high because there is little time.
const STEP_GAIN: f64 = 4.0;

impl Default for GoalPositioning {
    fn default() -> GoalPositioning {
        GoalPositioning {
            before_line: (0.15, 0.5),
            from_post: 0.15,
            radius: 0.35,
            from_ball: 0.2,
            turn: 0.5,
            content: (0.04, 0.15),
        }
    }
}

impl GoalPositioning {
    /// The keeper's pose in the field for a ball in the field; without a ball, in front of the
    /// middle of the goal.
    pub fn keeper_pose(&self, field: &FieldModel, ball: Option<Point2<f64>>) -> Isometry2<f64> {
        let goal = field.goal(Goal::Own);
        let Some(ball) = ball else { return pose(goal.x + self.before_line.0.max(self.radius), 0.0, 0.0) };
        let to_ball = ball - goal;
        let direction = to_ball.try_normalize(1e-6).unwrap_or(nalgebra::Vector2::x());
        let out = (to_ball.norm() - self.from_ball).min(self.far_out(to_ball.norm())).max(0.0);
        let reach = (field.goal_width / 2.0 - self.from_post).max(0.0);
        let x = (out * direction.x).clamp(self.before_line.0, self.before_line.1);
        let y = (out * direction.y).clamp(-reach, reach);
        pose(goal.x + x, y, self.turn * angle_of(&direction))
    }

    /// Distance of the keeper from the middle of the goal: large for a near ball, small for a far
    /// one.
    fn far_out(&self, distance: f64) -> f64 {
        let near = 1.0;
        if distance < near { distance } else { self.radius.max(2.0 * near - distance) }
    }

    /// The side step towards a ball that crosses the keeper's lateral axis `crossing_y` metres to
    /// its left.
    pub fn step_before(&self, crossing_y: f64) -> Walk {
        if crossing_y.abs() < STEP_DEAD_BAND {
            Walk::STILL
        } else {
            Walk { left: STEP_GAIN * crossing_y, ..Walk::STILL }
        }
    }

    /// The walk to a pose in the field frame.
    pub fn walk(&self, field_from_robot: &Isometry2<f64>, field_from_target: &Isometry2<f64>) -> Walk {
        let robot_from_target = field_from_robot.inverse() * field_from_target;
        let position = Point2::from(robot_from_target.translation.vector);
        let (distance, off) = (position.coords.norm(), wrap(heading(&robot_from_target)));
        if distance > 0.6 {
            return stride_to(position, distance);
        }
        if distance <= self.content.0 && off.abs() <= self.content.1 {
            return Walk::STILL;
        }
        walk_to(position, distance, off)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use proptest::prelude::*;

    use super::*;
    use crate::functionality::walk::GaitLimits;

    const FIELD: FieldModel = FieldModel::LEAGUE_2010;

    fn keeper_position(x: f64, y: f64) -> (f64, f64, f64) {
        let wanted = GoalPositioning::default().keeper_pose(&FIELD, Some(Point2::new(x, y)));
        (wanted.translation.x, wanted.translation.y, heading(&wanted))
    }

    #[test]
    fn without_a_ball_it_stands_at_the_centre_of_the_goal() {
        assert_eq!(GoalPositioning::default().keeper_pose(&FIELD, None), pose(-2.65, 0.0, 0.0));
    }

    #[test]
    fn it_comes_out_to_a_near_ball_on_its_side() {
        let (far, near) = (keeper_position(0.0, 1.0), keeper_position(-2.3, 0.3));
        assert!((-2.7..-2.6).contains(&far.0) && (0.05..0.2).contains(&far.1), "{far:?}");
        assert!(near.0 > far.0 + 0.05 && near.1 > 0.1 && near.2 > 0.1, "{near:?}");
        let corner = keeper_position(-2.95, 1.5);
        assert!((corner.0 + 2.85).abs() < 1e-9 && corner.1 > 0.3, "{corner:?}");
    }

    #[test]
    fn it_steps_to_the_side_of_the_shot() {
        let guard = GoalPositioning::default();
        assert!(guard.step_before(0.1).left > 0.2 && guard.step_before(-0.1).left < -0.2);
        assert_eq!(guard.step_before(0.02), Walk::STILL);
    }

    proptest! {
        #[test]
        fn its_place_is_between_the_posts_and_in_its_area(x in -3.2..3.0f64, y in -2.0..2.0f64) {
            let (x, y, heading) = keeper_position(x, y);
            prop_assert!((-2.86..=-2.49).contains(&x) && y.abs() <= 0.56, "{x} {y}");
            prop_assert!(heading.abs() <= PI / 2.0 + 1e-9);
        }
    }

    #[test]
    fn it_returns_between_the_posts_and_stands() {
        let gait = GaitLimits { forward: 0.25, backward: 0.12, sideways: 0.12, turn: 1.0 };
        let guard = GoalPositioning::default();
        let wanted = guard.keeper_pose(&FIELD, None);
        for start in [pose(-1.0, 1.5, PI), pose(-2.7, -0.6, -1.5), pose(-3.2, 0.3, 3.0)] {
            let mut field_from_robot = start;
            for _ in 0..300 {
                let walk = gait.limit(&guard.walk(&field_from_robot, &wanted));
                field_from_robot *= pose(walk.ahead * 0.1, walk.left * 0.1, walk.turn * 0.1);
            }
            assert_eq!(guard.walk(&field_from_robot, &wanted), Walk::STILL);
            assert!((field_from_robot.translation.vector - wanted.translation.vector).norm() < 0.07);
        }
    }
}
