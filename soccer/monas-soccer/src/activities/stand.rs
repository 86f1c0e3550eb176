//! Standing.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use super::motion_requests::request_stand;
use crate::{MotionPhase, topics};

/// Requests standing; done when the robot stands.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stand;

impl Activity for Stand {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let phase = blackboard.read(topics::MOTION_STATE).map(|state| state.phase());
        if phase == Some(MotionPhase::Standing) {
            return Ok(Progress::Done);
        }
        request_stand(blackboard)?;
        Ok(Progress::after(Duration::from_millis(100)))
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(topics::MOTION).ends_on(topics::MOTION_STATE).publishes(topics::MOTION)
    }
}

monas::activity!(Stand);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{MotionKind, MotionState};

    #[test]
    fn it_lasts_until_the_robot_stands() {
        let mut stage = ActivityFixture::new();
        assert!(!stage.run(&mut Stand));
        assert_eq!(stage.latest(topics::MOTION).unwrap().kind(), MotionKind::Stand);
        stage.publish(
            topics::MOTION_STATE,
            MotionState { phase: MotionPhase::Fallen.into(), ..MotionState::default() },
        );
        assert!(!stage.run(&mut Stand));
        stage.publish(
            topics::MOTION_STATE,
            MotionState { phase: MotionPhase::Standing.into(), ..MotionState::default() },
        );
        assert!(stage.run(&mut Stand));
    }
}
