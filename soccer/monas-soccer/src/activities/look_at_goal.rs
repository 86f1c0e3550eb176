//! Looks up at a goal, to find out where the robot is.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use narukom::Timestamp;

use super::motion_requests::request_gaze;
use super::shot::ground;
use crate::functionality::field::Goal;
use crate::functionality::head::{Gaze, HeadController};
use crate::topics;

/// Looks for a moment at the goal that is nearer to the direction of the ball. The body does not
/// move.
#[derive(Clone, Copy, Debug, Default)]
pub struct LookAtGoal {
    head: HeadController,
    since: Option<Timestamp>,
}

/// How long the look lasts: shorter than a request to walk holds.
const LOOK: Duration = Duration::from_millis(400);

impl Activity for LookAtGoal {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let now = blackboard.now();
        let looked = now.since(*self.since.get_or_insert(now));
        let gaze = self.gaze(blackboard).filter(|_| looked < LOOK);
        let Some(gaze) = gaze else {
            self.since = None;
            return Ok(Progress::Done);
        };
        request_gaze(blackboard, gaze)?;
        Ok(Progress::after(LOOK.saturating_sub(looked)))
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
                .publish(topics::POSE, Pose { y: 1e-3, ..Pose::default() });
            stage.publish(topics::BALL, Ball { bearing, ..Ball::default() });
            let mut activity = LookAtGoal::default();
            assert!(!stage.run(&mut activity));
            assert!((stage.latest(topics::HEAD).unwrap().yaw - yaw).abs() < 0.01);
            assert_eq!(stage.latest(topics::MOTION), None);
            assert!(stage.wait(LOOK).run(&mut activity));
        }
    }
}
