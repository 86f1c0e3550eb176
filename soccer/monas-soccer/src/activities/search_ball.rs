//! Search for the ball.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::{request_scan, request_stand, request_walk};
use super::shot::{RobotAndField, ground};
use crate::functionality::avoidance::keep_out;
use crate::functionality::guard::GoalPositioning;
use crate::functionality::walk::{Walk, stride_to};
use crate::{Ball, topics};

/// Searches for the ball with the head and, after a sweep, by turning towards the position where it
/// was seen last. After a full turn without success the robot walks to the centre of the field. The
/// goalkeeper searches from between its posts.
///
/// Parameters `look` (s): how long only the head searches; `turn_speed` (rad/s); `wander` (s): time
/// without the ball after which the robot walks to the centre.
#[derive(Clone, Copy, Debug)]
pub struct SearchBall {
    look: f64,
    turn_speed: f64,
    wander: f64,
    guard: GoalPositioning,
}

impl Default for SearchBall {
    fn default() -> SearchBall {
        SearchBall { look: 2.5, turn_speed: 0.7, wander: 13.0, guard: GoalPositioning::default() }
    }
}

impl Activity for SearchBall {
    fn configure(&mut self, parameters: &Parameters) {
        self.look = parameters.number("look").unwrap_or(self.look);
        self.turn_speed = parameters.number("turn_speed").unwrap_or(self.turn_speed);
        self.wander = parameters.number("wander").unwrap_or(self.wander);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        request_scan(blackboard)?;
        match self.walk(blackboard) {
            Some(walk) => request_walk(blackboard, walk)?,
            None => request_stand(blackboard)?,
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::MOTION).publishes(topics::MOTION).publishes(topics::HEAD)
    }
}

impl SearchBall {
    fn walk(&self, blackboard: &Blackboard) -> Option<Walk> {
        let ground = ground(blackboard);
        let keeps_goal = blackboard.read(topics::GAME_STATE).is_some_and(|game| game.goalkeeper);
        if let (true, Some(ground)) = (keeps_goal, &ground) {
            let place = self.guard.place(&ground.field, None);
            return Some(self.guard.walk(&ground.field_from_robot, &place));
        }
        let ball = blackboard.read(topics::BALL)?;
        if ball.age < self.look {
            return None;
        }
        let walk = self.roam(ball, ground.as_ref());
        Some(ground.map_or(walk, |ground| keep_out(walk, &ground.field, &ground.field_from_robot)))
    }

    /// Turns towards the last known position of the ball; after a full turn, walks to the centre of
    /// the field and turns there.
    fn roam(&self, ball: &Ball, ground: Option<&RobotAndField>) -> Walk {
        let centre = ground.map(|ground| ground.field_from_robot.inverse_transform_point(&Point2::origin()));
        match centre {
            Some(centre) if ball.age > self.wander && centre.coords.norm() > 0.5 => {
                stride_to(centre, centre.coords.norm())
            }
            _ => Walk::turning(self.turn_speed.copysign(ball.bearing)),
        }
    }
}

monas::activity!(SearchBall);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, HeadMode, MotionKind, Pose};

    fn lost(age: f64, bearing: f64) -> Ball {
        Ball { age, bearing, ..Ball::default() }
    }

    fn run(ball: Ball, game: GameState, pose: Option<Pose>) -> crate::MotionRequest {
        let (mut stage, mut activity) = (ActivityFixture::new(), SearchBall::default());
        stage.publish(topics::BALL, ball).publish(topics::GAME_STATE, game);
        pose.map(|pose| stage.publish(topics::POSE, pose).now);
        assert!(stage.run(&mut activity));
        assert_eq!(stage.latest(topics::HEAD).unwrap().mode(), HeadMode::Scan);
        stage.latest(topics::MOTION).unwrap()
    }

    fn field() -> GameState {
        GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() }
    }

    #[test]
    fn the_head_scans_first_then_the_robot_turns_after_the_ball() {
        assert_eq!(run(lost(1.0, 0.4), field(), None).kind(), MotionKind::Stand);
        assert!(run(lost(4.0, 0.4), field(), None).wz > 0.0);
        assert!(run(lost(4.0, -0.4), field(), None).wz < 0.0);
    }

    #[test]
    fn after_a_turn_without_a_ball_it_walks_to_the_centre() {
        let pose = Pose { x: -2.0, ..Pose::default() };
        let walk = run(lost(20.0, 0.4), field(), Some(pose));
        assert!(walk.vx > 0.2 && walk.wz.abs() < 1e-9, "{walk:?}");
        let there = Pose { x: -0.2, ..Pose::default() };
        assert!(run(lost(20.0, 0.4), field(), Some(there)).wz > 0.0, "there it turns on");
    }

    #[test]
    fn the_goalkeeper_searches_from_between_its_posts() {
        let game = GameState { goalkeeper: true, ..field() };
        let walk = run(
            lost(20.0, 0.4),
            game,
            Some(Pose { x: -1.5, heading: std::f64::consts::PI, ..Pose::default() }),
        );
        assert!(walk.vx > 0.1, "it walks home: {walk:?}");
        let walk = run(lost(20.0, 0.4), game, Some(Pose { x: -2.65, ..Pose::default() }));
        assert_eq!((walk.vx, walk.vy, walk.wz), (0.0, 0.0, 0.0));
    }
}
