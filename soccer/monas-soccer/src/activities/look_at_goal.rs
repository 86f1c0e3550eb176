//! Looks up at a goal, to find out where the robot is.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use narukom::Timestamp;

use super::motion_requests::request_gaze;
use super::shot::ground;
use crate::functionality::field::Goal;
use crate::functionality::head::{Gaze, HeadController};
use crate::topics;

/// Looks for a moment at the goal that is nearer to the direction of the ball. A robot that does
/// not know where the goals are looks to its left and right instead, in turn, past the directions
/// in between. The body does not move.
#[derive(Clone, Copy, Debug, Default)]
pub struct LookAtGoal {
    head: HeadController,
    since: Option<Timestamp>,
    /// The side of the last look to a side.
    side: Option<f64>,
}

/// Duration of the look, shorter than the validity of a request to walk.
const LOOK_TIME: Duration = Duration::from_millis(400);
/// Duration of the look to a side: long enough for the head to turn, and short enough to keep the
/// estimate of the ball.
const LOOK_ASIDE: Duration = Duration::from_millis(700);
/// Confidence of the pose below which a robot does not know where the goals are.
const LOST_CONFIDENCE: f64 = 0.5;
/// The direction of a look to a side, and its height, radians.
const SIDE_GAZE: Gaze = Gaze { yaw: 1.8, pitch: -0.1 };

impl Activity for LookAtGoal {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let now = blackboard.now();
        let begins = self.since.is_none();
        let looked = now.since(*self.since.get_or_insert(now));
        if begins {
            let is_lost = blackboard.read(topics::POSE).is_some_and(|pose| pose.confidence < LOST_CONFIDENCE);
            self.side = is_lost.then(|| self.side.map_or(1.0, |side| -side));
        }
        let length = if self.side.is_some() { LOOK_ASIDE } else { LOOK_TIME };
        let gaze = self.gaze(blackboard).filter(|_| looked < length);
        let Some(gaze) = gaze else {
            self.since = None;
            return Ok(Progress::Done);
        };
        request_gaze(blackboard, gaze)?;
        Ok(Progress::after(length.saturating_sub(looked)))
    }

    fn stop(&mut self, _: &mut Blackboard) {
        self.since = None;
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.publishes(topics::HEAD)
    }
}

impl LookAtGoal {
    /// None while the pose or the ball is unknown.
    fn gaze(&self, blackboard: &Blackboard) -> Option<Gaze> {
        let ground = ground(blackboard)?;
        let bearing = blackboard.read(topics::BALL)?.bearing;
        if let Some(side) = self.side {
            return Some(Gaze { yaw: SIDE_GAZE.yaw * side, ..SIDE_GAZE });
        }
        let gazes = [Goal::Opponent, Goal::Own].map(|goal| {
            let goal_in_robot = ground.field_from_robot.inverse_transform_point(&ground.field.goal(goal));
            self.head.look_at(goal_in_robot)
        });
        let off = |gaze: &Gaze| (gaze.yaw - bearing).abs();
        gazes.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))
    }
}

monas::activity!(LookAtGoal);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Ball, GameState, Pose};

    #[test]
    fn it_looks_at_the_goal_nearer_to_the_ball_for_a_moment() {
        for (bearing, yaw) in [(0.8, 0.0), (-2.0, -2.0)] {
            let mut stage = ActivityFixture::new();
            let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
            stage
                .publish(topics::GAME_STATE, game)
                .publish(topics::POSE, Pose { y: 1e-3, confidence: 0.8, ..Pose::default() });
            stage.publish(topics::BALL, Ball { bearing, ..Ball::default() });
            let mut activity = LookAtGoal::default();
            assert!(!stage.run(&mut activity));
            assert!((stage.latest(topics::HEAD).unwrap().yaw - yaw).abs() < 0.01);
            assert_eq!(stage.latest(topics::MOTION), None);
            assert!(stage.wait(LOOK_TIME).run(&mut activity));
        }
    }

    #[test]
    fn a_robot_that_is_lost_looks_to_one_side_and_then_to_the_other() {
        let (mut stage, mut activity) = (ActivityFixture::new(), LookAtGoal::default());
        let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game).publish(topics::BALL, Ball::default());
        stage.publish(topics::POSE, Pose { confidence: 0.3, ..Pose::default() });
        for yaw in [SIDE_GAZE.yaw, -SIDE_GAZE.yaw, SIDE_GAZE.yaw] {
            assert!(!stage.run(&mut activity));
            assert_eq!(stage.latest(topics::HEAD).unwrap().yaw, yaw);
            assert!(!stage.wait(LOOK_TIME).run(&mut activity), "it takes longer");
            assert!(stage.wait(LOOK_TIME).run(&mut activity));
        }
    }
}
