//! Supports the team mate that goes to the ball.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::request_walk;
use super::shot::{ground, others};
use crate::Ball;
use crate::functionality::avoidance::{avoid, keep_out};
use crate::functionality::support::support_place;
use crate::functionality::walk::{Walk, stride_to, turn_to};
use crate::topics;

/// Walks to a place ahead of the ball and to its side, and stays there facing the ball. Stands
/// still while the pose is unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct SupportMate;

impl Activity for SupportMate {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let (Some(ball), Some(ground)) = (blackboard.read(topics::BALL).copied(), ground(blackboard)) else {
            return Ok(Progress::Done);
        };
        let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
        let here = Point2::from(ground.field_from_robot.translation.vector);
        let place = support_place(&ground.field, ground.field_from_robot * ball.position(), here);
        let walk = wait_at(ground.field_from_robot.inverse_transform_point(&place), &ball, &obstacles);
        request_walk(blackboard, keep_out(walk, &ground.field, &ground.field_from_robot))?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::ROBOTS).reads(topics::MOTION).publishes(topics::MOTION)
    }
}

/// Walks to a position, avoiding robots and ball, and stays there facing the ball.
pub(super) fn wait_at(place: Point2<f64>, ball: &Ball, obstacles: &[Point2<f64>]) -> Walk {
    let way = place.coords.norm();
    if way < 0.2 {
        return Walk::turning(turn_to(ball.bearing));
    }
    let obstacles: Vec<Point2<f64>> = obstacles.iter().copied().chain([ball.position()]).collect();
    stride_to(avoid(place, &obstacles), way)
}

monas::activity!(SupportMate);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, Pose};

    #[test]
    fn it_walks_ahead_of_the_ball_and_waits_there() {
        let walk = |pose: Pose, (x, y): (f64, f64)| {
            let mut stage = ActivityFixture::new();
            let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
            let ball =
                Ball { x, y, distance: libm::hypot(x, y), bearing: libm::atan2(y, x), ..Ball::default() };
            stage.publish(topics::GAME_STATE, game).publish(topics::POSE, pose).publish(topics::BALL, ball);
            assert!(stage.run(&mut SupportMate));
            stage.latest(topics::MOTION).unwrap()
        };
        assert!(walk(Pose { x: -1.0, y: 0.85, ..Pose::default() }, (1.0, -0.85)).vx > 0.2);
        let there = walk(Pose { x: 1.0, y: 0.85, ..Pose::default() }, (-1.0, -0.85));
        assert!(there.vx == 0.0 && there.wz < -0.5, "it only turns to the ball: {there:?}");
    }
}
