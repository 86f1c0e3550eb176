//! Positions the ball in front of a foot, for a pass or a shot.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;
use narukom::Timestamp;

use super::motion_requests::{request_gaze, request_walk};
use super::shot::{RobotAndField, ground, others, target};
use crate::functionality::align::Alignment;
use crate::functionality::approach::Approach;
use crate::functionality::avoidance::keep_out;
use crate::functionality::geometry::angle_of;
use crate::functionality::guard::GoalPositioning;
use crate::functionality::head::HeadController;
use crate::functionality::walk::Walk;
use crate::{AttackPart, Ball, topics};

/// Polling interval; the activity is also called as soon as the ball is seen.
pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Time limit, after which it has failed.
const TIMEOUT: Duration = Duration::from_secs(25);
/// A ball that is not seen for this long is lost, seconds.
pub(super) const BALL_LOST_AFTER: f64 = 2.5;
/// Distance from the ball within which the robot aligns instead of approaching, metres.
const ALIGN_DISTANCE: f64 = 0.25;
/// Accepted final error of the heading to the target, radians.
const HEADING_TOLERANCE: f64 = 0.2;

/// Walks to the ball and round it, looking at it, until it lies in front of a foot and the robot
/// faces a target.
#[derive(Clone, Copy, Debug, Default)]
struct BringBall {
    approach: Approach,
    alignment: Alignment,
    head: HeadController,
    since: Option<Timestamp>,
}

impl BringBall {
    /// Continues; done when the ball is in position or when this has failed. A later kick checks
    /// its own conditions.
    fn advance(
        &mut self,
        blackboard: &mut Blackboard,
        target: impl Fn(&Blackboard, &Ball, Option<&RobotAndField>) -> Point2<f64>,
    ) -> Result<Progress, BoxError> {
        let now = blackboard.now();
        let late = now.since(*self.since.get_or_insert(now)) > TIMEOUT;
        let Some(ball) = blackboard.read(topics::BALL).copied().filter(|ball| ball.age < BALL_LOST_AFTER)
        else {
            return Ok(Progress::Done);
        };
        let ground = ground(blackboard);
        let target = target(blackboard, &ball, ground.as_ref());
        if late || ball.in_own_area || self.is_there(&ball, target) {
            return Ok(Progress::Done);
        }
        request_gaze(blackboard, self.head.look_at(ball.position()))?;
        let walk = self.walk(blackboard, &ball, target, ground.as_ref());
        request_walk(blackboard, walk)?;
        Ok(Progress::after(POLL_INTERVAL))
    }

    fn is_there(&self, ball: &Ball, target: Point2<f64>) -> bool {
        let off = angle_of(&(target - ball.position()));
        self.alignment.is_at_foot(ball.position()) && off.abs() < HEADING_TOLERANCE
    }

    fn walk(
        &self,
        blackboard: &Blackboard,
        ball: &Ball,
        target: Point2<f64>,
        ground: Option<&RobotAndField>,
    ) -> Walk {
        if ball.approaching {
            return GoalPositioning::default().step_before(ball.crossing_y);
        }
        if ball.distance <= ALIGN_DISTANCE {
            return self.alignment.walk(ball.position(), target);
        }
        let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
        let walk = self.approach.walk(ball.position(), target, &obstacles);
        ground.map_or(walk, |ground| keep_out(walk, &ground.field, &ground.field_from_robot))
    }
}

/// The target of a pass: the partner in the attack. In the robot's frame.
pub(super) fn mate(blackboard: &Blackboard, ball: &Ball, ground: Option<&RobotAndField>) -> Point2<f64> {
    let attack = blackboard.read(topics::ATTACK);
    match (attack, ground) {
        (Some(attack), Some(ground)) => {
            ground.field_from_robot.inverse_transform_point(&Point2::new(attack.mate_x, attack.mate_y))
        }
        _ => target(blackboard, ball, ground),
    }
}

macro_rules! bring_ball {
    ($($(#[$documentation:meta])* $name:ident: $target:path, $part:ident;)*) => {$(
        $(#[$documentation])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name {
            bring: BringBall,
        }

        impl Activity for $name {
            fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
                let attack = blackboard.read(topics::ATTACK);
                let has_part = attack.is_none_or(|attack| attack.part() == AttackPart::$part);
                let progress =
                    if has_part { self.bring.advance(blackboard, $target)? } else { Progress::Done };
                if progress == Progress::Done {
                    self.bring.since = None;
                }
                Ok(progress)
            }

            fn stop(&mut self, _: &mut Blackboard) {
                self.bring.since = None;
            }

            fn topics(&self) -> Topics {
                let topics = Topics::declared().ends_on(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
                let topics = topics.reads(topics::ROBOTS).reads(topics::MOTION).reads(topics::ATTACK);
                topics.publishes(topics::MOTION).publishes(topics::HEAD)
            }
        }

        monas::activity!($name);
    )*};
}

bring_ball! {
    /// Walks to the ball and lines up for a pass to the partner in the attack. Ends when the ball
    /// lies in front of a foot or in the own goal area, is lost, or after 25 s, and when the player
    /// is no longer the center; it never kicks.
    BringBallToPass: mate, Center;
    /// Walks to the ball and lines up for a shot at the widest gap in the goal. Ends when the ball
    /// lies in front of a foot or in the own goal area, is lost, or after 25 s, and when the player
    /// is no longer the partner; it never kicks.
    BringBallToShoot: target, CenterFor;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Attack, GameState, HeadMode, MotionKind, Pose};

    fn stage(ball: (f64, f64)) -> ActivityFixture {
        let mut stage = ActivityFixture::new();
        let game = GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
        let distance = libm::hypot(ball.0, ball.1);
        stage.publish(topics::GAME_STATE, game).publish(topics::POSE, Pose::default());
        stage.publish(topics::BALL, Ball { found: true, x: ball.0, y: ball.1, distance, ..Ball::default() });
        stage
    }

    #[test]
    fn it_walks_and_looks_until_the_ball_is_at_a_foot() {
        let mut activity = BringBallToShoot::default();
        for ball in [(2.0, 0.0), (0.22, 0.05), (0.15, 0.12)] {
            let mut stage = stage(ball);
            assert!(!stage.run(&mut activity), "{ball:?}");
            assert_eq!(stage.latest(topics::MOTION).unwrap().kind(), MotionKind::Walk);
            assert_eq!(stage.latest(topics::HEAD).unwrap().mode(), HeadMode::Look);
        }
        let mut there = stage((0.15, 0.05));
        assert!(there.run(&mut activity));
        assert_eq!(there.latest(topics::MOTION), None, "it never kicks");
    }

    fn center() -> Attack {
        Attack { part: AttackPart::Center.into(), ..Attack::default() }
    }

    #[test]
    fn it_ends_with_its_part() {
        let mut stage = stage((0.22, 0.05));
        stage.publish(topics::ATTACK, Attack { mate_x: 1.5, ..center() });
        assert!(!stage.run(&mut BringBallToPass::default()));
        assert!(stage.run(&mut BringBallToShoot::default()));
        stage.publish(topics::ATTACK, Attack::default());
        assert!(stage.run(&mut BringBallToPass::default()));
    }

    #[test]
    fn for_a_pass_it_has_to_face_the_mate() {
        let mut activity = BringBallToPass::default();
        let mut stage = stage((0.15, 0.05));
        stage.publish(topics::ATTACK, Attack { mate_x: 1.0, mate_y: 1.5, ..center() });
        assert!(!stage.run(&mut activity));
        assert!(stage.latest(topics::MOTION).unwrap().wz > 0.3, "it turns to where the mate is");
        stage.publish(topics::ATTACK, Attack { mate_x: 1.5, mate_y: 0.1, ..center() });
        assert!(stage.run(&mut activity));
    }

    #[test]
    fn it_gives_up_when_the_ball_is_lost_and_after_a_while() {
        let mut activity = BringBallToShoot::default();
        let mut lost = stage((2.0, 0.0));
        lost.publish(topics::BALL, Ball { x: 2.0, distance: 2.0, age: BALL_LOST_AFTER, ..Ball::default() });
        assert!(lost.run(&mut activity));
        let mut kept_out = stage((2.0, 0.0));
        let ball = Ball { found: true, x: 2.0, distance: 2.0, in_own_area: true, ..Ball::default() };
        kept_out.publish(topics::BALL, ball);
        assert!(kept_out.run(&mut activity), "no field player may enter the own area");
        let mut stage = stage((2.0, 0.0));
        assert!(!stage.run(&mut activity));
        assert!(stage.wait(TIMEOUT + POLL_INTERVAL).run(&mut activity));
        assert!(!stage.run(&mut activity), "a restart resets the time limit");
    }
}
