//! Standing up.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use super::wishes::request_stand;
use crate::{MotionPhase, topics};

/// Wants the robot to stand, and is done when it does.
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
        Topics::declared().reads(topics::MOTION).reads(topics::MOTION_STATE).publishes(topics::MOTION)
    }
}

monas::activity!(Stand);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::stage::Stage;
    use crate::{MotionKind, MotionState};

    #[test]
    fn it_lasts_until_the_robot_stands() {
        let mut stage = Stage::new();
        assert!(!stage.run(&mut Stand));
        assert_eq!(stage.said(topics::MOTION).unwrap().kind(), MotionKind::Stand);
        stage.tell(topics::MOTION_STATE, MotionState { phase: MotionPhase::Fallen.into(), done: 0 });
        assert!(!stage.run(&mut Stand));
        stage.tell(topics::MOTION_STATE, MotionState { phase: MotionPhase::Standing.into(), done: 0 });
        assert!(stage.run(&mut Stand));
    }
}
