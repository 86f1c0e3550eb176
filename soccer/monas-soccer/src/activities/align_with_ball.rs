//! Alignment with the ball before a kick.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};

use super::motion_requests::request_walk;
use super::shot::{ground, target};
use crate::functionality::align::Alignment;
use crate::topics;

/// Turns round the ball until the robot faces the target, then moves until the ball is in front of
/// a foot. It never kicks.
///
/// Parameters `kick_x`, `kick_y` (m): best position of the ball for a kick; `turn_x` (m): distance
/// ahead at which the ball is kept while the robot turns round it; `tolerance` (rad): accepted
/// error of the heading.
#[derive(Clone, Copy, Debug, Default)]
pub struct AlignWithBall {
    alignment: Alignment,
}

impl Activity for AlignWithBall {
    fn configure(&mut self, parameters: &Parameters) {
        let alignment = &mut self.alignment;
        alignment.kick_x = parameters.number("kick_x").unwrap_or(alignment.kick_x);
        alignment.kick_y = parameters.number("kick_y").unwrap_or(alignment.kick_y);
        alignment.turn_x = parameters.number("turn_x").unwrap_or(alignment.turn_x);
        alignment.tolerance = parameters.number("tolerance").unwrap_or(alignment.tolerance);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let Some(ball) = blackboard.read(topics::BALL).copied() else { return Ok(Progress::Done) };
        let target = target(blackboard, &ball, ground(blackboard).as_ref());
        request_walk(blackboard, self.alignment.walk(ball.position(), target))?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::ROBOTS).reads(topics::MOTION).publishes(topics::MOTION)
    }
}

monas::activity!(AlignWithBall);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Ball, GameState, MotionKind, MotionRequest, Pose};

    fn run(ball: (f64, f64), heading: f64) -> MotionRequest {
        let (mut stage, mut activity) = (ActivityFixture::new(), AlignWithBall::default());
        let game = GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game).publish(topics::POSE, Pose { heading, ..Pose::default() });
        stage.publish(topics::BALL, Ball { x: ball.0, y: ball.1, ..Ball::default() });
        assert!(stage.run(&mut activity));
        stage.latest(topics::MOTION).unwrap()
    }

    #[test]
    fn facing_the_goal_it_closes_in() {
        let walk = run((0.22, 0.05), 0.0);
        assert!(walk.vx > 0.05 && walk.vy.abs() < 0.01, "{walk:?}");
    }

    #[test]
    fn facing_elsewhere_it_turns_round_the_ball() {
        let walk = run((0.205, 0.05), 0.8);
        assert!(walk.wz < -0.3 && walk.vy > 0.05, "{walk:?}");
    }

    #[test]
    fn it_never_kicks() {
        for x in 0..25 {
            for y in -10..10 {
                let kind = run((f64::from(x) * 0.01, f64::from(y) * 0.01), 0.0).kind();
                assert_eq!(kind, MotionKind::Walk);
            }
        }
    }
}
