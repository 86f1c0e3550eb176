//! The places of a goalkeeper.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use super::motion_requests::request_walk;
use super::shot::ground;
use crate::functionality::guard::GoalPositioning;
use crate::topics;

/// Walks to the place between the ball and the middle of the own goal, and stays there.
#[derive(Clone, Copy, Debug, Default)]
pub struct KeepGoal {
    guard: GoalPositioning,
}

/// Walks to the place before the middle of the own goal, and stays there.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReturnToGoal {
    guard: GoalPositioning,
}

/// Steps to the side on which the ball will pass, so that it meets the robot.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepAside {
    guard: GoalPositioning,
}

impl Activity for KeepGoal {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let (Some(ground), Some(ball)) = (ground(blackboard), blackboard.read(topics::BALL)) else {
            return Ok(Progress::Done);
        };
        let ball_in_field = ground.field_from_robot * ball.position();
        let pose = self.guard.keeper_pose(&ground.field, Some(ball_in_field));
        request_walk(blackboard, self.guard.walk(&ground.field_from_robot, &pose))?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::MOTION).publishes(topics::MOTION)
    }
}

impl Activity for ReturnToGoal {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let Some(ground) = ground(blackboard) else { return Ok(Progress::Done) };
        let pose = self.guard.keeper_pose(&ground.field, None);
        request_walk(blackboard, self.guard.walk(&ground.field_from_robot, &pose))?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::MOTION).publishes(topics::MOTION)
    }
}

impl Activity for StepAside {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        if let Some(ball) = blackboard.read(topics::BALL).copied() {
            request_walk(blackboard, self.guard.step_before(ball.crossing_y))?;
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        Topics::declared().reads(topics::BALL).reads(topics::MOTION).publishes(topics::MOTION)
    }
}

monas::activity!(KeepGoal);
monas::activity!(ReturnToGoal);
monas::activity!(StepAside);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Ball, GameState, MotionRequest, Pose};

    fn run(activity: &mut dyn Activity, ball: Ball, pose: Pose) -> MotionRequest {
        let mut stage = ActivityFixture::new();
        let game = GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game).publish(topics::POSE, pose).publish(topics::BALL, ball);
        assert!(stage.run(activity));
        assert_eq!(stage.latest(topics::HEAD), None);
        stage.latest(topics::MOTION).unwrap()
    }

    fn home() -> Pose {
        Pose { x: -2.65, confidence: 1.0, ..Pose::default() }
    }

    fn ball(x: f64, y: f64) -> Ball {
        Ball { x, y, distance: libm::hypot(x, y), found: true, ..Ball::default() }
    }

    fn walk(request: MotionRequest) -> (f64, f64, f64) {
        (request.vx, request.vy, request.wz)
    }

    #[test]
    fn a_keeper_goes_between_ball_and_goal() {
        assert!(run(&mut KeepGoal::default(), ball(2.5, 1.5), home()).vy > 0.05);
        assert_eq!(walk(run(&mut KeepGoal::default(), ball(2.5, 0.0), home())), (0.0, 0.0, 0.0));
    }

    #[test]
    fn a_keeper_comes_back_before_the_middle_of_the_goal() {
        let out = Pose { x: -1.5, heading: std::f64::consts::PI, ..Pose::default() };
        assert!(run(&mut ReturnToGoal::default(), Ball::default(), out).vx > 0.1);
        assert_eq!(walk(run(&mut ReturnToGoal::default(), ball(2.5, 1.5), home())), (0.0, 0.0, 0.0));
    }

    #[test]
    fn a_keeper_steps_before_a_shot() {
        let shot = Ball { approaching: true, crossing_y: -0.1, ..ball(1.0, 0.0) };
        let step = run(&mut StepAside::default(), shot, home());
        assert!(step.vy < -0.05 && step.vx == 0.0, "{step:?}");
    }
}
