//! Passing the ball.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use monas_robot::Skill;
use narukom::Timestamp;

use super::bring_ball::{POLL_INTERVAL, mate};
use super::motion_requests::{KickStyle, request_gaze, request_walk};
use super::shot::ground;
use super::skills::{RunningSkill, perform};
use crate::functionality::ball_filter::BallModel;
use crate::functionality::head::HeadController;
use crate::functionality::walk::{Walk, turn_to};
use crate::{MotionKind, topics};

/// Kicks the ball ahead with the foot in front of which it lies, so that it arrives slowly at the
/// partner in the attack, and then watches the outcome for a while.
#[derive(Clone, Copy, Debug, Default)]
pub struct PassBall {
    kick: Option<MotionKind>,
    under_way: RunningSkill,
    kicked_at: Option<Timestamp>,
    head: HeadController,
}

/// Time for which the outcome of a pass is observed.
const WATCH_TIME: Duration = Duration::from_millis(500);
/// Speed at which a pass arrives at the partner, m/s.
const ARRIVAL_SPEED: f64 = 0.55;

impl Activity for PassBall {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let now = blackboard.now();
        match self.kicked_at {
            Some(kicked_at) if now.since(kicked_at) >= WATCH_TIME => {
                self.forget();
                Ok(Progress::Done)
            }
            Some(_) => self.watch_pass(blackboard),
            None => {
                let progress = self.kick(blackboard)?;
                if progress != Progress::Done {
                    return Ok(progress);
                }
                self.kicked_at = Some(now);
                Ok(Progress::after(POLL_INTERVAL))
            }
        }
    }

    fn stop(&mut self, _: &mut Blackboard) {
        self.forget();
    }

    fn topics(&self) -> Topics {
        let topics =
            Topics::declared().reads(topics::BALL).reads(topics::MOTION).ends_on(topics::MOTION_STATE);
        let topics = topics.reads(topics::ATTACK).reads(topics::GAME_STATE).reads(topics::POSE);
        let topics = topics.publishes(topics::MOTION).publishes(topics::HEAD);
        topics.performs(Skill::KickLeft.as_str_name()).performs(Skill::KickRight.as_str_name())
    }
}

/// The speed of a ball that rolls to the partner and arrives there slowly, m/s; zero, which is the
/// hardest kick, without a ball.
fn pass_speed(blackboard: &Blackboard) -> f64 {
    let Some(ball) = blackboard.read(topics::BALL).copied() else { return 0.0 };
    let distance = (mate(blackboard, &ball, ground(blackboard).as_ref()) - ball.position()).norm();
    BallModel::default().speed_for(distance, ARRIVAL_SPEED)
}

impl PassBall {
    fn forget(&mut self) {
        *self = PassBall { head: self.head, ..PassBall::default() };
    }

    fn kick(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let is_left = blackboard.read(topics::BALL).is_some_and(|ball| ball.y >= 0.0);
        let foot = if is_left { MotionKind::KickLeft } else { MotionKind::KickRight };
        let kick = *self.kick.get_or_insert(foot);
        let style = KickStyle { is_pass: true, ball_speed: pass_speed(blackboard) };
        perform(&mut self.under_way, kick, style, blackboard)
    }

    /// Stands facing the ball.
    fn watch_pass(&self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        if let Some(ball) = blackboard.read(topics::BALL).copied() {
            request_gaze(blackboard, self.head.look_at(ball.position()))?;
            request_walk(blackboard, Walk::turning(turn_to(ball.bearing)))?;
        }
        Ok(Progress::after(POLL_INTERVAL))
    }
}

monas::activity!(PassBall as "passBall");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::{ActivityFixture, TICK};
    use crate::{Attack, Ball, GameState, HeadMode, MotionState, Pose};

    #[test]
    fn a_pass_is_as_hard_as_the_way_to_the_partner_is_long() {
        let speed_to = |mate_x: f64| {
            let (mut stage, mut activity) = (ActivityFixture::new(), PassBall::default());
            stage.publish(topics::BALL, Ball { x: 0.15, y: 0.05, ..Ball::default() });
            let game =
                GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
            stage.publish(topics::GAME_STATE, game).publish(topics::POSE, Pose::default());
            stage.publish(topics::ATTACK, Attack { mate_x, ..Attack::default() });
            stage.run(&mut activity);
            let wanted = stage.latest(topics::MOTION).unwrap();
            assert!(wanted.is_pass);
            wanted.ball_speed
        };
        let (near, far) = (speed_to(1.15), speed_to(2.65));
        assert!((0.8..1.1).contains(&near) && (1.1..1.5).contains(&far), "{near} {far}");
    }

    #[test]
    fn it_kicks_with_the_foot_at_the_ball_and_then_watches() {
        for (y, kind) in [(0.05, MotionKind::KickLeft), (-0.05, MotionKind::KickRight)] {
            let (mut stage, mut activity) = (ActivityFixture::new(), PassBall::default());
            stage.publish(topics::BALL, Ball { x: 0.15, y, ..Ball::default() });
            assert!(!stage.run(&mut activity));
            let wanted = stage.latest(topics::MOTION).unwrap();
            assert_eq!((wanted.kind(), wanted.number), (kind, 1));
            stage.publish(topics::BALL, Ball { x: 1.0, y: -3.0 * y, bearing: -0.3, ..Ball::default() });
            assert!(!stage.wait(TICK).run(&mut activity));
            assert_eq!(stage.latest(topics::MOTION).unwrap().number, 1, "it kicks once");
            stage.publish(topics::MOTION_STATE, MotionState { done: 1, ..MotionState::default() });
            assert!(!stage.run(&mut activity));
            assert!(!stage.wait(TICK).run(&mut activity));
            assert_eq!(stage.latest(topics::HEAD).unwrap().mode(), HeadMode::Look);
            assert!(stage.latest(topics::MOTION).unwrap().wz < -0.1);
            assert!(stage.wait(WATCH_TIME).run(&mut activity));
        }
    }
}
