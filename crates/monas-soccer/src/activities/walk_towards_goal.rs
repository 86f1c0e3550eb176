//! Going where a pass is wanted.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;
use narukom::Moment;

use super::bring_ball::{LOOK, LOST};
use super::shot::{ground, others};
use super::walk_towards_ball::wait_at;
use super::wishes::{request_gaze, request_walk};
use crate::functionality::head::Head;
use crate::functionality::support::support_place;
use crate::topics;

/// Walks towards the opponents' goal to where a pass can be taken, and waits there, facing the ball, until it is passed, lost, or 30 s have gone
/// by.
#[derive(Clone, Copy, Debug, Default)]
pub struct WalkTowardsGoal {
    head: Head,
    since: Option<Moment>,
}

/// For so long a pass is waited for.
const PATIENCE: Duration = Duration::from_secs(30);

impl Activity for WalkTowardsGoal {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let now = blackboard.now();
        let late = now.since(*self.since.get_or_insert(now)) > PATIENCE;
        let passed = blackboard.read(topics::ATTACK).is_some_and(|attack| attack.ball_is_passed);
        let ball = blackboard.read(topics::BALL).copied().filter(|ball| ball.age < LOST);
        let (Some(ball), Some(ground), false) = (ball, ground(blackboard), late || passed) else {
            self.since = None;
            return Ok(Progress::Done);
        };
        let here = Point2::from(ground.field_from_robot.translation.vector);
        let place = support_place(&ground.field, ground.field_from_robot * ball.position(), here);
        let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
        let walk = wait_at(ground.field_from_robot.inverse_transform_point(&place), &ball, &obstacles);
        request_gaze(blackboard, self.head.look_at(ball.position()))?;
        request_walk(blackboard, walk)?;
        Ok(Progress::after(LOOK))
    }

    fn stop(&mut self, _: &mut Blackboard) {
        self.since = None;
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        let topics = topics.reads(topics::ROBOTS).reads(topics::MOTION).reads(topics::ATTACK);
        topics.publishes(topics::MOTION).publishes(topics::HEAD)
    }
}

monas::activity!(WalkTowardsGoal);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::stage::Stage;
    use crate::{Attack, Ball, GameState, Pose};

    fn stage(pose: Pose, ball: Ball) -> Stage {
        let mut stage = Stage::new();
        let game = GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
        stage.tell(topics::GAME_STATE, game).tell(topics::POSE, pose).tell(topics::BALL, ball);
        stage
    }

    fn ball(x: f64, y: f64) -> Ball {
        Ball { found: true, x, y, distance: libm::hypot(x, y), bearing: libm::atan2(y, x), ..Ball::default() }
    }

    #[test]
    fn it_walks_ahead_of_the_ball_and_waits_there() {
        let mut behind = stage(Pose { x: -1.0, y: 0.85, ..Pose::default() }, ball(1.0, -0.85));
        assert!(!behind.run(&mut WalkTowardsGoal::default()));
        assert!(behind.said(topics::MOTION).unwrap().vx > 0.2);
        let mut there = stage(Pose { x: 1.0, y: 0.85, ..Pose::default() }, ball(-1.0, -0.85));
        assert!(!there.run(&mut WalkTowardsGoal::default()));
        let walk = there.said(topics::MOTION).unwrap();
        assert!(walk.vx == 0.0 && walk.wz < -0.5, "it only turns to the ball: {walk:?}");
    }

    #[test]
    fn it_is_done_when_the_ball_is_passed_or_lost_and_after_a_while() {
        let pose = Pose { x: -1.0, ..Pose::default() };
        let mut passed = stage(pose, ball(1.0, 0.0));
        passed.tell(topics::ATTACK, Attack { ball_is_passed: true, ..Attack::default() });
        assert!(passed.run(&mut WalkTowardsGoal::default()));
        assert!(stage(pose, Ball { age: LOST, ..ball(1.0, 0.0) }).run(&mut WalkTowardsGoal::default()));
        let (mut waiting, mut activity) = (stage(pose, ball(1.0, 0.0)), WalkTowardsGoal::default());
        assert!(!waiting.run(&mut activity));
        assert!(waiting.wait(PATIENCE + LOOK).run(&mut activity));
        assert!(!waiting.run(&mut activity), "whoever begins anew has new patience");
    }
}
