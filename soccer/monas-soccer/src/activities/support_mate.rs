//! Supports the team mate that goes to the ball.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::{request_stand, request_walk};
use super::shot::{RobotAndField, ground, others};
use crate::Ball;
use crate::functionality::avoidance::{avoid, keep_out};
use crate::functionality::support::{DISTANCE_AHEAD, support_position};
use crate::functionality::walk::{Walk, stride_to, turn_to};
use crate::topics;

/// Walks to a place ahead of the ball and to its side, and stays there facing the ball. Stands
/// still while the pose is unknown.
///
/// Parameter `ahead` (m): how far before the ball that place is.
#[derive(Clone, Copy, Debug)]
pub struct SupportMate {
    ahead: f64,
}

impl Default for SupportMate {
    fn default() -> SupportMate {
        SupportMate { ahead: DISTANCE_AHEAD }
    }
}

impl Activity for SupportMate {
    fn configure(&mut self, parameters: &Parameters) {
        self.ahead = parameters.number("ahead").unwrap_or(self.ahead);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        wait_at(blackboard, |ground, ball| {
            let here = Point2::from(ground.field_from_robot.translation.vector);
            support_position(&ground.field, ball, here, self.ahead)
        })
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::ROBOTS).reads(topics::MOTION).publishes(topics::MOTION)
    }
}

/// Walks to a place that depends on the ball's, both in the field frame, and stays there facing the
/// ball. Stands still while the pose is unknown.
pub(super) fn wait_at(
    blackboard: &mut Blackboard,
    position: impl FnOnce(&RobotAndField, Point2<f64>) -> Point2<f64>,
) -> Result<Progress, BoxError> {
    let (Some(ball), Some(ground)) = (blackboard.read(topics::BALL).copied(), ground(blackboard)) else {
        request_stand(blackboard)?;
        return Ok(Progress::Done);
    };
    let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
    let position = position(&ground, ground.field_from_robot * ball.position());
    let walk = walk_to(ground.field_from_robot.inverse_transform_point(&position), &ball, &obstacles);
    request_walk(blackboard, keep_out(walk, &ground.field, &ground.field_from_robot))?;
    Ok(Progress::Done)
}

/// The walk to a position in the robot's frame, which avoids robots and ball; there it turns to the
/// ball.
pub(super) fn walk_to(position: Point2<f64>, ball: &Ball, obstacles: &[Point2<f64>]) -> Walk {
    let distance = position.coords.norm();
    if distance < 0.2 {
        return Walk::turning(turn_to(ball.bearing));
    }
    let obstacles: Vec<Point2<f64>> = obstacles.iter().copied().chain([ball.position()]).collect();
    stride_to(avoid(position, &obstacles), distance)
}

monas::activity!(SupportMate);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, MotionKind, Pose};

    #[test]
    fn it_stands_while_its_pose_is_unknown() {
        let mut stage = ActivityFixture::new();
        stage.publish(topics::BALL, Ball { x: 1.0, distance: 1.0, ..Ball::default() });
        assert!(stage.run(&mut SupportMate::default()));
        assert_eq!(stage.latest(topics::MOTION).unwrap().kind(), MotionKind::Stand);
    }

    #[test]
    fn it_walks_ahead_of_the_ball_and_waits_there() {
        let walk = |pose: Pose, (x, y): (f64, f64)| {
            let mut stage = ActivityFixture::new();
            let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
            let ball =
                Ball { x, y, distance: libm::hypot(x, y), bearing: libm::atan2(y, x), ..Ball::default() };
            stage.publish(topics::GAME_STATE, game).publish(topics::POSE, pose).publish(topics::BALL, ball);
            assert!(stage.run(&mut SupportMate::default()));
            stage.latest(topics::MOTION).unwrap()
        };
        assert!(walk(Pose { x: -1.0, y: 0.85, ..Pose::default() }, (1.0, -0.85)).vx > 0.2);
        let there = walk(Pose { x: 1.0, y: 0.85, ..Pose::default() }, (-1.0, -0.85));
        assert!(there.vx == 0.0 && there.wz < -0.5, "it only turns to the ball: {there:?}");
    }
}
