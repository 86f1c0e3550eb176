//! Walks to the middle of the field.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::{request_stand, request_walk};
use super::shot::{ground, others};
use crate::functionality::avoidance::{avoid, keep_out};
use crate::functionality::walk::stride_to;
use crate::topics;

/// Walks towards the middle of the field, from which most of it can be seen. Stands still while the
/// pose is unknown.
#[derive(Clone, Copy, Debug, Default)]
pub struct WalkTowardsCentre;

impl Activity for WalkTowardsCentre {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let Some(ground) = ground(blackboard) else {
            request_stand(blackboard)?;
            return Ok(Progress::Done);
        };
        let centre = ground.field_from_robot.inverse_transform_point(&Point2::origin());
        let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
        let walk = stride_to(avoid(centre, &obstacles), centre.coords.norm());
        request_walk(blackboard, keep_out(walk, &ground.field, &ground.field_from_robot))?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::GAME_STATE).reads(topics::POSE).reads(topics::ROBOTS);
        topics.reads(topics::MOTION).publishes(topics::MOTION)
    }
}

monas::activity!(WalkTowardsCentre);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, MotionKind, Pose};

    #[test]
    fn it_walks_to_the_middle_of_the_field() {
        let mut stage = ActivityFixture::new();
        assert!(stage.run(&mut WalkTowardsCentre));
        let motion = stage.latest(topics::MOTION).unwrap();
        assert_eq!(motion.kind(), MotionKind::Stand, "it does not know where it is");
        let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game);
        stage.publish(topics::POSE, Pose { x: -2.0, ..Pose::default() });
        assert!(stage.run(&mut WalkTowardsCentre));
        let walk = stage.latest(topics::MOTION).unwrap();
        assert!(walk.vx > 0.2 && walk.wz.abs() < 1e-9, "{walk:?}");
    }
}
