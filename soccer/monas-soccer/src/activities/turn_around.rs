//! Turns on the spot while the ball is not seen.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use narukom::Timestamp;

use super::motion_requests::request_walk;
use super::shot::ground;
use crate::functionality::avoidance::keep_out;
use crate::functionality::walk::Walk;
use crate::topics;

/// Turns towards the side on which the ball was seen last, and on to the same side: once the place
/// where it was seen lies behind the robot, its side changes with every step.
///
/// Parameter `turn_speed` (rad/s).
#[derive(Clone, Copy, Debug)]
pub struct TurnAround {
    turn_speed: f64,
    /// The present turn, and when it was last requested.
    turning: Option<(Timestamp, f64)>,
}

/// Time without a request after which a turn is over.
const TURN_TIMEOUT: Duration = Duration::from_secs(1);

impl Default for TurnAround {
    fn default() -> TurnAround {
        TurnAround { turn_speed: 0.7, turning: None }
    }
}

impl Activity for TurnAround {
    fn configure(&mut self, parameters: &Parameters) {
        self.turn_speed = parameters.number("turn_speed").unwrap_or(self.turn_speed);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let now = blackboard.now();
        let side = blackboard.read(topics::BALL).map_or(0.0, |ball| ball.bearing);
        let same = self.turning.filter(|(at, _)| now.since(*at) < TURN_TIMEOUT);
        let turn = same.map_or(self.turn_speed.copysign(side), |(_, turn)| turn);
        self.turning = Some((now, turn));
        let walk = Walk::turning(turn);
        let walk = match ground(blackboard) {
            Some(ground) => keep_out(walk, &ground.field, &ground.field_from_robot),
            None => walk,
        };
        request_walk(blackboard, walk)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::MOTION).publishes(topics::MOTION)
    }
}

monas::activity!(TurnAround);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ball;
    use crate::activities::activity_fixture::{ActivityFixture, TICK};

    #[test]
    fn it_turns_to_where_the_ball_went() {
        for bearing in [0.4, -0.4] {
            let mut stage = ActivityFixture::new();
            stage.publish(topics::BALL, Ball { bearing, age: 4.0, ..Ball::default() });
            assert!(stage.run(&mut TurnAround::default()));
            let walk = stage.latest(topics::MOTION).unwrap();
            assert_eq!((walk.vx, walk.vy, walk.wz), (0.0, 0.0, 0.7f64.copysign(bearing)));
        }
    }

    #[test]
    fn it_turns_on_when_the_ball_was_seen_behind_it() {
        let (mut stage, mut activity) = (ActivityFixture::new(), TurnAround::default());
        for bearing in [0.5, 3.1, -3.1, -2.0] {
            stage.publish(topics::BALL, Ball { bearing, age: 4.0, ..Ball::default() });
            stage.run(&mut activity);
            assert_eq!(stage.latest(topics::MOTION).unwrap().wz, 0.7, "{bearing}");
            stage.wait(TICK);
        }
        stage.wait(TURN_TIMEOUT).run(&mut activity);
        assert_eq!(stage.latest(topics::MOTION).unwrap().wz, -0.7, "later it begins anew");
    }
}
