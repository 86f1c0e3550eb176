//! Tracks the ball.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use super::motion_requests::request_gaze;
use crate::functionality::head::HeadController;
use crate::topics;

/// Keeps the head on the ball. The body does not move.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrackBall {
    head: HeadController,
}

impl Activity for TrackBall {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        if let Some(ball) = blackboard.read(topics::BALL).copied() {
            request_gaze(blackboard, self.head.look_at(ball.position()))?;
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(topics::BALL).publishes(topics::HEAD)
    }
}

monas::activity!(TrackBall);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Ball, HeadMode};

    #[test]
    fn the_head_follows_the_ball_and_the_body_does_not_move() {
        let mut stage = ActivityFixture::new();
        stage.publish(topics::BALL, Ball { x: 1.0, y: 1.0, found: true, ..Ball::default() });
        assert!(stage.run(&mut TrackBall::default()));
        let head = stage.latest(topics::HEAD).unwrap();
        assert_eq!(head.mode(), HeadMode::Look);
        assert!((head.yaw - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
        assert_eq!(stage.latest(topics::MOTION), None);
    }
}
