//! Walks to where a pass can be received.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;
use narukom::Timestamp;

use super::bring_ball::{BALL_LOST_AFTER, POLL_INTERVAL};
use super::motion_requests::{request_gaze, request_walk};
use super::shot::{ground, others};
use super::support_mate::walk_to;
use crate::functionality::head::HeadController;
use crate::functionality::support::{DISTANCE_AHEAD, support_position};
use crate::{AttackPart, topics};

/// Walks towards the opponents' goal to a position for receiving a pass, and waits there facing the
/// ball until it is passed, until the attack is over for this player, or for 30 s.
#[derive(Clone, Copy, Debug, Default)]
pub struct WalkTowardsGoal {
    head: HeadController,
    since: Option<Timestamp>,
}

/// Maximum time for which a pass is awaited.
const TIMEOUT: Duration = Duration::from_secs(30);

impl Activity for WalkTowardsGoal {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let now = blackboard.now();
        let late = now.since(*self.since.get_or_insert(now)) > TIMEOUT;
        let attack = blackboard.read(topics::ATTACK).copied().unwrap_or_default();
        if late || attack.ball_is_passed || attack.part() != AttackPart::CenterFor {
            self.since = None;
            return Ok(Progress::Done);
        }
        let ball = blackboard.read(topics::BALL).copied().filter(|ball| ball.age < BALL_LOST_AFTER);
        let (Some(ball), Some(ground)) = (ball, ground(blackboard)) else {
            return Ok(Progress::after(POLL_INTERVAL));
        };
        let here = Point2::from(ground.field_from_robot.translation.vector);
        let position =
            support_position(&ground.field, ground.field_from_robot * ball.position(), here, DISTANCE_AHEAD);
        let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
        let walk = walk_to(ground.field_from_robot.inverse_transform_point(&position), &ball, &obstacles);
        request_gaze(blackboard, self.head.look_at(ball.position()))?;
        request_walk(blackboard, walk)?;
        Ok(Progress::after(POLL_INTERVAL))
    }

    fn stop(&mut self, _: &mut Blackboard) {
        self.since = None;
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        let topics = topics.reads(topics::ROBOTS).reads(topics::MOTION).ends_on(topics::ATTACK);
        topics.publishes(topics::MOTION).publishes(topics::HEAD)
    }
}

monas::activity!(WalkTowardsGoal);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Attack, Ball, GameState, Pose};

    fn stage(pose: Pose, ball: Ball) -> ActivityFixture {
        let mut stage = ActivityFixture::new();
        let game = GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game).publish(topics::POSE, pose).publish(topics::BALL, ball);
        stage.publish(topics::ATTACK, engaged());
        stage
    }

    fn engaged() -> Attack {
        Attack { part: AttackPart::CenterFor.into(), ..Attack::default() }
    }

    fn ball(x: f64, y: f64) -> Ball {
        Ball { found: true, x, y, distance: libm::hypot(x, y), bearing: libm::atan2(y, x), ..Ball::default() }
    }

    #[test]
    fn it_walks_ahead_of_the_ball_and_waits_there() {
        let mut behind = stage(Pose { x: -1.0, y: 0.85, ..Pose::default() }, ball(1.0, -0.85));
        assert!(!behind.run(&mut WalkTowardsGoal::default()));
        assert!(behind.latest(topics::MOTION).unwrap().vx > 0.2);
        let mut there = stage(Pose { x: 1.0, y: 0.85, ..Pose::default() }, ball(-1.0, -0.85));
        assert!(!there.run(&mut WalkTowardsGoal::default()));
        let walk = there.latest(topics::MOTION).unwrap();
        assert!(walk.vx == 0.0 && walk.wz < -0.5, "it only turns to the ball: {walk:?}");
    }

    #[test]
    fn it_is_done_when_the_ball_is_passed_or_the_attack_is_over_and_after_a_while() {
        let pose = Pose { x: -1.0, ..Pose::default() };
        let mut passed = stage(pose, ball(1.0, 0.0));
        passed.publish(topics::ATTACK, Attack { ball_is_passed: true, ..engaged() });
        assert!(passed.run(&mut WalkTowardsGoal::default()));
        let mut over = stage(pose, ball(1.0, 0.0));
        over.publish(topics::ATTACK, Attack::default());
        assert!(over.run(&mut WalkTowardsGoal::default()));
        let mut unseen = stage(pose, Ball { age: BALL_LOST_AFTER, ..ball(1.0, 0.0) });
        assert!(!unseen.run(&mut WalkTowardsGoal::default()), "the mate may see it");
        let (mut waiting, mut activity) = (stage(pose, ball(1.0, 0.0)), WalkTowardsGoal::default());
        assert!(!waiting.run(&mut activity));
        assert!(waiting.wait(TIMEOUT + POLL_INTERVAL).run(&mut activity));
        assert!(!waiting.run(&mut activity), "a restart resets the time limit");
    }
}
