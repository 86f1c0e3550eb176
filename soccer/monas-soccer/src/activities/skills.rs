//! One-time motions: falls and dives, and what they share with kicks.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use monas_robot::Skill;
use narukom::Timestamp;

use super::motion_requests::{KickStyle, request_skill};
use crate::{MotionKind, topics};

/// Polling interval for the end of a motion; a message that reports it is handled at once.
const POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Time after which a motion whose end is not reported has failed: no activity commands the body.
const TIMEOUT: Duration = Duration::from_secs(20);

/// A motion in progress: its number and start time.
pub(super) type RunningSkill = Option<(u64, Timestamp)>;

/// Requests a motion once; done when it is over.
pub(super) fn perform(
    under_way: &mut RunningSkill,
    kind: MotionKind,
    style: KickStyle,
    blackboard: &mut Blackboard,
) -> Result<Progress, BoxError> {
    let now = blackboard.now();
    let Some((number, since)) = *under_way else {
        *under_way = Some((request_skill(blackboard, kind, style)?, now));
        return Ok(Progress::after(POLL_INTERVAL));
    };
    let over = blackboard.read(topics::MOTION_STATE).is_some_and(|state| state.done >= number);
    if over {
        *under_way = None;
        return Ok(Progress::Done);
    }
    if now.since(since) > TIMEOUT {
        *under_way = None;
        let seconds = TIMEOUT.as_secs();
        return Err(format!("the end of {} was not reported for {seconds} s", kind.as_str_name()).into());
    }
    Ok(Progress::after(POLL_INTERVAL))
}

macro_rules! skill {
    ($($(#[$documentation:meta])* $name:ident: $kind:ident;)*) => {$(
        $(#[$documentation])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name {
            under_way: RunningSkill,
        }

        impl Activity for $name {
            fn start(&mut self, _: &mut Blackboard) -> Result<(), BoxError> {
                self.under_way = None;
                Ok(())
            }

            fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
                perform(&mut self.under_way, MotionKind::$kind, KickStyle::default(), blackboard)
            }

            fn stop(&mut self, _: &mut Blackboard) {
                self.under_way = None;
            }

            fn topics(&self) -> Topics {
                let topics = Topics::declared().reads(topics::MOTION).ends_on(topics::MOTION_STATE);
                topics.publishes(topics::MOTION).performs(Skill::$kind.as_str_name())
            }
        }

        monas::activity!($name);
    )*};
}

skill! {
    /// Drops to the left, done when the robot has got up.
    LeftFall: FallLeft;
    /// Drops to the right, done when the robot has got up.
    RightFall: FallRight;
    /// Dives to the left, done when the robot has got up.
    LeftDive: DiveLeft;
    /// Dives to the right, done when the robot has got up.
    RightDive: DiveRight;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{MotionPhase, MotionState};

    fn state(done: u64) -> MotionState {
        MotionState { phase: MotionPhase::Standing.into(), done, ..MotionState::default() }
    }

    #[test]
    fn each_asks_for_its_own_motion() {
        let activities: [(&mut dyn Activity, MotionKind); 4] = [
            (&mut LeftFall::default(), MotionKind::FallLeft),
            (&mut RightFall::default(), MotionKind::FallRight),
            (&mut LeftDive::default(), MotionKind::DiveLeft),
            (&mut RightDive::default(), MotionKind::DiveRight),
        ];
        for (activity, kind) in activities {
            let mut stage = ActivityFixture::new();
            stage.run(activity);
            assert_eq!(stage.latest(topics::MOTION).unwrap().kind(), kind);
        }
    }

    #[test]
    fn it_lasts_until_its_motion_ends_and_can_be_requested_again() {
        let (mut stage, mut activity) = (ActivityFixture::new(), LeftDive::default());
        stage.publish(topics::MOTION_STATE, state(6));
        assert!(!stage.run(&mut activity));
        assert_eq!(stage.latest(topics::MOTION).unwrap().number, 7, "beyond what was ever done");
        assert!(!stage.run(&mut activity));
        stage.publish(topics::MOTION_STATE, state(7));
        assert!(stage.run(&mut activity));
        assert!(!stage.run(&mut activity));
        assert_eq!(stage.latest(topics::MOTION).unwrap().number, 8);
    }

    #[test]
    fn a_motion_that_is_not_performed_fails() {
        let (mut stage, mut activity) = (ActivityFixture::new(), RightDive::default());
        stage.run(&mut activity);
        stage.wait(TIMEOUT + POLL_INTERVAL);
        let error = stage.fails(&mut activity).unwrap();
        assert_eq!(error, "the end of DIVE_RIGHT was not reported for 20 s");
    }

    #[test]
    fn a_stopped_agent_restarts() {
        let (mut stage, mut activity) = (ActivityFixture::new(), LeftDive::default());
        stage.run(&mut activity);
        activity.under_way = None;
        stage.run(&mut activity);
        assert_eq!(stage.latest(topics::MOTION).unwrap().number, 2);
    }
}
