//! Waiting for Vision.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use narukom::PublisherId;

use crate::topics;

/// Done at once when there is a message of the ball that it has not used yet; until then it waits for one.
#[derive(Clone, Copy, Debug, Default)]
pub struct WaitForBallMessage {
    used: Option<(PublisherId, u64)>,
}

/// How often it looks by itself; it is called as soon as a message comes.
const LOOK: Duration = Duration::from_millis(100);

impl Activity for WaitForBallMessage {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let newest =
            blackboard.sample(topics::BALL).map(|ball| (ball.header.publisher, ball.header.sequence));
        if newest == self.used {
            return Ok(Progress::after(LOOK));
        }
        self.used = newest;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(topics::BALL)
    }
}

monas::activity!(WaitForBallMessage);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ball;
    use crate::activities::stage::Stage;

    #[test]
    fn each_message_is_used_once() {
        let (mut stage, mut activity) = (Stage::new(), WaitForBallMessage::default());
        assert!(!stage.run(&mut activity));
        for _ in 0..3 {
            stage.tell(topics::BALL, Ball::default());
            assert!(stage.run(&mut activity));
            assert!(!stage.run(&mut activity));
        }
    }
}
