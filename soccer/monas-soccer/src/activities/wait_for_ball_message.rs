//! Waits for messages of Vision.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use narukom::PublisherId;

use crate::topics;

/// Done when there is a new message about the ball; otherwise waits for one.
#[derive(Clone, Copy, Debug, Default)]
pub struct WaitForBallMessage {
    used: Option<(PublisherId, u64)>,
}

/// Polling interval; the activity is also called as soon as a message arrives.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

impl Activity for WaitForBallMessage {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let newest =
            blackboard.sample(topics::BALL).map(|ball| (ball.header.publisher, ball.header.sequence));
        if newest == self.used {
            return Ok(Progress::after(POLL_INTERVAL));
        }
        self.used = newest;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().ends_on(topics::BALL)
    }
}

monas::activity!(WaitForBallMessage);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ball;
    use crate::activities::activity_fixture::ActivityFixture;

    #[test]
    fn each_message_is_used_once() {
        let (mut stage, mut activity) = (ActivityFixture::new(), WaitForBallMessage::default());
        assert!(!stage.run(&mut activity));
        for _ in 0..3 {
            stage.publish(topics::BALL, Ball::default());
            assert!(stage.run(&mut activity));
            assert!(!stage.run(&mut activity));
        }
    }
}
