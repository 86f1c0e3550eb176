//! Passing the ball.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use narukom::Moment;

use super::bring_ball::LOOK;
use super::skills::{UnderWay, perform};
use super::wishes::{request_gaze, request_walk};
use crate::functionality::head::Head;
use crate::functionality::walk::{Walk, turn_to};
use crate::{MotionKind, topics};

/// Kicks the ball ahead with the foot before which it lies, and then watches for a while what comes of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct PassBall {
    kick: Option<MotionKind>,
    under_way: UnderWay,
    kicked_at: Option<Moment>,
    head: Head,
}

/// For so long what comes of a pass is watched.
const WATCH: Duration = Duration::from_secs(6);

impl Activity for PassBall {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let now = blackboard.now();
        match self.kicked_at {
            Some(kicked_at) if now.since(kicked_at) >= WATCH => {
                self.forget();
                Ok(Progress::Done)
            }
            Some(_) => self.watch(blackboard),
            None => {
                let progress = self.kick(blackboard)?;
                if progress != Progress::Done {
                    return Ok(progress);
                }
                self.kicked_at = Some(now);
                Ok(Progress::after(LOOK))
            }
        }
    }

    fn stop(&mut self, _: &mut Blackboard) {
        self.forget();
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::MOTION).reads(topics::MOTION_STATE);
        topics.publishes(topics::MOTION).publishes(topics::HEAD)
    }
}

impl PassBall {
    fn forget(&mut self) {
        *self = PassBall { head: self.head, ..PassBall::default() };
    }

    fn kick(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let is_left = blackboard.read(topics::BALL).is_some_and(|ball| ball.y >= 0.0);
        let foot = if is_left { MotionKind::KickLeft } else { MotionKind::KickRight };
        let kick = *self.kick.get_or_insert(foot);
        perform(&mut self.under_way, kick, blackboard)
    }

    /// Stands, turned to the ball.
    fn watch(&self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        if let Some(ball) = blackboard.read(topics::BALL).copied() {
            request_gaze(blackboard, self.head.look_at(ball.position()))?;
            request_walk(blackboard, Walk::turning(turn_to(ball.bearing)))?;
        }
        Ok(Progress::after(LOOK))
    }
}

monas::activity!(PassBall as "passBall");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::stage::{Stage, TICK};
    use crate::{Ball, HeadMode, MotionState};

    #[test]
    fn it_kicks_with_the_foot_at_the_ball_and_then_watches() {
        for (y, kind) in [(0.05, MotionKind::KickLeft), (-0.05, MotionKind::KickRight)] {
            let (mut stage, mut activity) = (Stage::new(), PassBall::default());
            stage.tell(topics::BALL, Ball { x: 0.15, y, ..Ball::default() });
            assert!(!stage.run(&mut activity));
            let wanted = stage.said(topics::MOTION).unwrap();
            assert_eq!((wanted.kind(), wanted.number), (kind, 1));
            stage.tell(topics::BALL, Ball { x: 1.0, y: -3.0 * y, bearing: -0.3, ..Ball::default() });
            assert!(!stage.wait(TICK).run(&mut activity));
            assert_eq!(stage.said(topics::MOTION).unwrap().number, 1, "it kicks once");
            stage.tell(topics::MOTION_STATE, MotionState { done: 1, ..MotionState::default() });
            assert!(!stage.run(&mut activity));
            assert!(!stage.wait(TICK).run(&mut activity));
            assert_eq!(stage.said(topics::HEAD).unwrap().mode(), HeadMode::Look);
            assert!(stage.said(topics::MOTION).unwrap().wz < -0.1);
            assert!(stage.wait(WATCH).run(&mut activity));
        }
    }
}
