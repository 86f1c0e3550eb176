//! Turns to a ball that a team mate sees.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::request_walk;
use super::shot::ground;
use crate::functionality::geometry::angle_of;
use crate::functionality::walk::{Walk, turn_to};
use crate::topics;

/// Turns on the spot towards the ball of the newest report of a team mate. Does nothing without a
/// report or pose.
#[derive(Clone, Copy, Debug, Default)]
pub struct TurnToReport;

impl Activity for TurnToReport {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let (Some(ground), Some(team)) = (ground(blackboard), blackboard.read(topics::TEAM)) else {
            return Ok(Progress::Done);
        };
        let seeing = team.mates.iter().filter(|mate| mate.ball_found);
        if let Some(mate) = seeing.min_by(|a, b| a.age.total_cmp(&b.age)) {
            let ball = Point2::new(mate.ball_x, mate.ball_y);
            let ball = ground.field_from_robot.inverse_transform_point(&ball);
            request_walk(blackboard, Walk::turning(turn_to(angle_of(&ball.coords))))?;
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::TEAM).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::MOTION).publishes(topics::MOTION)
    }
}

monas::activity!(TurnToReport);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, Pose, Team, TeamReport};

    #[test]
    fn it_turns_to_the_ball_of_the_newest_report() {
        let mut stage = ActivityFixture::new();
        let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game).publish(topics::POSE, Pose { x: 1.0, ..Pose::default() });
        let report = |ball_found, ball_y, age| TeamReport {
            ball_found,
            ball_x: 1.0,
            ball_y,
            age,
            ..TeamReport::default()
        };
        let mates = vec![report(true, 1.0, 2.0), report(true, -1.0, 0.5), report(false, 1.0, 0.0)];
        stage.publish(topics::TEAM, Team { own: None, mates });
        assert!(stage.run(&mut TurnToReport));
        let walk = stage.latest(topics::MOTION).unwrap();
        assert!(walk.wz < -1.0 && walk.vx == 0.0, "{walk:?}");
    }
}
