//! Searches for the ball.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use super::motion_requests::request_scan;
use crate::topics;

/// Searches for the ball with the head, which sweeps from side to side. The body does not move.
#[derive(Clone, Copy, Debug, Default)]
pub struct SearchBall;

impl Activity for SearchBall {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        request_scan(blackboard)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().publishes(topics::HEAD)
    }
}

monas::activity!(SearchBall);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HeadMode;
    use crate::activities::activity_fixture::ActivityFixture;

    #[test]
    fn only_the_head_searches() {
        let mut stage = ActivityFixture::new();
        assert!(stage.run(&mut SearchBall));
        assert_eq!(stage.latest(topics::HEAD).unwrap().mode(), HeadMode::Scan);
        assert_eq!(stage.latest(topics::MOTION), None);
    }
}
