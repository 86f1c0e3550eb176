//! Covers the own goal.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use super::support_mate::wait_at;
use crate::functionality::support::cover_position;
use crate::topics;

/// Walks to a place between the ball and the own goal, and stays there facing the ball. Stands
/// still while the pose is unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct CoverGoal;

impl Activity for CoverGoal {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        wait_at(blackboard, |ground, ball| cover_position(&ground.field, ball))
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::ROBOTS).reads(topics::MOTION).publishes(topics::MOTION)
    }
}

monas::activity!(CoverGoal);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Ball, GameState, Pose};

    #[test]
    fn it_walks_back_between_ball_and_goal() {
        let mut stage = ActivityFixture::new();
        let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
        let pose = Pose { x: 1.0, y: 1.0, heading: std::f64::consts::PI, ..Pose::default() };
        stage.publish(topics::GAME_STATE, game).publish(topics::POSE, pose);
        stage.publish(topics::BALL, Ball { x: 1.0, y: 1.0, distance: 1.4, ..Ball::default() });
        assert!(stage.run(&mut CoverGoal));
        assert!(stage.latest(topics::MOTION).unwrap().vx > 0.1);
    }
}
