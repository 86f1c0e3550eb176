//! Alignment with the ball before a kick.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};

use super::motion_requests::request_walk;
use super::shot::{ground, others, target};
use crate::functionality::align::Alignment;
use crate::topics;

/// Turns round the ball until the robot faces the target, then moves until the ball is in front of
/// a foot. It never kicks.
///
/// Parameters `kick_x`, `kick_y` (m): best position of the ball for a kick; `turn_x` (m): distance
/// ahead at which the ball is kept while the robot turns round it; `tolerance` (rad): accepted
/// error of the heading. While an opponent is within `contested` (m) of the ball, which by default
/// none is, the error `hurried` (rad) is accepted: a kick that is not exact is better than none.
#[derive(Clone, Copy, Debug)]
pub struct AlignWithBall {
    alignment: Alignment,
    contested: f64,
    hurried: f64,
}

impl Default for AlignWithBall {
    fn default() -> AlignWithBall {
        AlignWithBall { alignment: Alignment::default(), contested: 0.0, hurried: 0.6 }
    }
}

impl Activity for AlignWithBall {
    fn configure(&mut self, parameters: &Parameters) {
        let alignment = &mut self.alignment;
        alignment.kick_x = parameters.number("kick_x").unwrap_or(alignment.kick_x);
        alignment.kick_y = parameters.number("kick_y").unwrap_or(alignment.kick_y);
        alignment.turn_x = parameters.number("turn_x").unwrap_or(alignment.turn_x);
        alignment.tolerance = parameters.number("tolerance").unwrap_or(alignment.tolerance);
        self.contested = parameters.number("contested").unwrap_or(self.contested);
        self.hurried = parameters.number("hurried").unwrap_or(self.hurried);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let Some(ball) = blackboard.read(topics::BALL).copied() else { return Ok(Progress::Done) };
        let target = target(blackboard, &ball, ground(blackboard).as_ref());
        let is_contested = others(blackboard)
            .filter(|robot| !robot.team_mate)
            .any(|robot| (robot.position() - ball.position()).norm() < self.contested);
        let alignment = match is_contested {
            true => Alignment { tolerance: self.hurried, patience: 1.0, ..self.alignment },
            false => self.alignment,
        };
        request_walk(blackboard, alignment.walk(ball.position(), target))?;
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
    use crate::{Ball, GameState, MotionKind, MotionRequest, OtherRobot, Pose, Robots};

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
    fn it_turns_less_while_an_opponent_is_near_the_ball() {
        let mut activity = AlignWithBall::default();
        activity.configure(&Parameters::new().with("contested", "0.6").with("hurried", "0.7"));
        let mut walk = |x, team_mate, heading| {
            let mut stage = ActivityFixture::new();
            let game =
                GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
            let robot = OtherRobot { x, team_mate, ..OtherRobot::default() };
            stage
                .publish(topics::GAME_STATE, game)
                .publish(topics::POSE, Pose { heading, ..Pose::default() });
            stage.publish(topics::ROBOTS, Robots { robots: vec![robot], nearest: x });
            stage.publish(topics::BALL, Ball { x: 0.205, y: 0.05, ..Ball::default() });
            assert!(stage.run(&mut activity));
            stage.latest(topics::MOTION).unwrap()
        };
        let is_closing_in = |walk: MotionRequest| walk.vx > 0.05 && walk.vy.abs() < 0.01;
        assert!(is_closing_in(walk(0.6, false, 0.6)));
        assert!(!is_closing_in(walk(0.6, false, 0.9)), "it would kick too far aside");
        assert!(!is_closing_in(walk(0.6, true, 0.6)), "a mate");
        assert!(!is_closing_in(walk(1.2, false, 0.6)), "far away");
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
