//! Walks to the place for a kick-off.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::{request_scan, request_walk};
use super::shot::others;
use crate::functionality::kick_off::KickOffWalk;
use crate::topics;

/// Walks to the player's place for a kick-off and stands there, while the head looks for landmarks.
/// Turns once around first if the pose is unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct WalkToKickOff {
    walk: KickOffWalk,
}

impl Activity for WalkToKickOff {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        request_scan(blackboard)?;
        let Some(game) = blackboard.read(topics::GAME_STATE) else { return Ok(Progress::Done) };
        let wanted = game.kick_off_pose();
        let pose = blackboard.read(topics::POSE).map(|pose| (pose.field_from_robot(), pose.confidence));
        let robots: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
        let walk = self.walk.walk(blackboard.now(), pose, &wanted, &robots);
        request_walk(blackboard, walk)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::GAME_STATE).reads(topics::POSE).reads(topics::ROBOTS);
        topics.reads(topics::MOTION).publishes(topics::MOTION).publishes(topics::HEAD)
    }
}

monas::activity!(WalkToKickOff);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, HeadMode, Pose};

    fn game() -> GameState {
        GameState { place_x: -1.05, place_y: 0.9, place_heading: -0.7, ..GameState::default() }
    }

    #[test]
    fn it_walks_to_its_place_and_stands_there() {
        let mut stage = ActivityFixture::new();
        let pose = Pose { x: 2.0, heading: std::f64::consts::PI, confidence: 0.9, ..Pose::default() };
        stage.publish(topics::GAME_STATE, game()).publish(topics::POSE, pose);
        assert!(stage.run(&mut WalkToKickOff::default()));
        let walk = stage.latest(topics::MOTION).unwrap();
        assert!(walk.vx > 0.2, "{walk:?}");
        assert_eq!(stage.latest(topics::HEAD).unwrap().mode(), HeadMode::Scan);
        stage.publish(topics::POSE, Pose { x: -1.05, y: 0.9, heading: -0.7, confidence: 0.9 });
        assert!(stage.run(&mut WalkToKickOff::default()));
        let walk = stage.latest(topics::MOTION).unwrap();
        assert_eq!((walk.vx, walk.vy, walk.wz), (0.0, 0.0, 0.0));
    }

    #[test]
    fn it_looks_around_while_it_does_not_know_where_it_is() {
        let mut stage = ActivityFixture::new();
        stage.publish(topics::GAME_STATE, game());
        stage.publish(topics::POSE, Pose { confidence: 0.1, ..Pose::default() });
        assert!(stage.run(&mut WalkToKickOff::default()));
        let walk = stage.latest(topics::MOTION).unwrap();
        assert!(walk.vx == 0.0 && walk.wz.abs() > 0.3, "{walk:?}");
    }
}
