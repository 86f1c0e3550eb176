//! Walks to the ball.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::request_walk;
use super::shot::{RobotAndField, ground, others, target};
use crate::functionality::approach::Approach;
use crate::functionality::avoidance::{avoid, keep_out};
use crate::functionality::support::support_place;
use crate::functionality::walk::{Walk, stride_to, turn_to};
use crate::{Ball, topics};

/// Walks behind the ball, so that it lies between the robot and the opponents' goal, avoiding other
/// robots and the own goal area. While a team mate is nearer to the ball, the robot waits ahead of
/// the ball, to its side.
#[derive(Clone, Copy, Debug, Default)]
pub struct WalkTowardsBall {
    approach: Approach,
}

/// How much nearer to the ball a team mate must be to take it, metres.
const NEARER: f64 = 0.3;
/// Distance that a field player keeps from the goal area, metres.
const FROM_AREA: f64 = 0.15;

impl Activity for WalkTowardsBall {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let Some(ball) = blackboard.read(topics::BALL).copied() else { return Ok(Progress::Done) };
        let walk = self.walk(blackboard, &ball);
        request_walk(blackboard, walk)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::ROBOTS).reads(topics::MOTION).publishes(topics::MOTION)
    }
}

impl WalkTowardsBall {
    fn walk(&self, blackboard: &Blackboard, ball: &Ball) -> Walk {
        let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
        let ground = ground(blackboard);
        let target = target(blackboard, ball, ground.as_ref());
        let Some(ground) = ground else { return self.approach.walk(ball.position(), target, &obstacles) };
        let walk = match place_to_wait(blackboard, ball, &ground) {
            Some(place) => wait_at(place, ball, &obstacles),
            None => self.approach.walk(ball.position(), target, &obstacles),
        };
        keep_out(walk, &ground.field, &ground.field_from_robot)
    }
}

/// A waiting position, if a team mate takes the ball or it lies in the own goal area. In the
/// robot's frame.
fn place_to_wait(blackboard: &Blackboard, ball: &Ball, ground: &RobotAndField) -> Option<Point2<f64>> {
    let nearer = |distance: f64| distance < ball.distance - NEARER;
    let mut mates = others(blackboard).filter(|robot| robot.team_mate);
    if !mates.any(|mate| nearer((mate.position() - ball.position()).norm())) {
        return before_area(ground, ball.position());
    }
    let here = Point2::from(ground.field_from_robot.translation.vector);
    let place = support_place(&ground.field, ground.field_from_robot * ball.position(), here);
    Some(ground.field_from_robot.inverse_transform_point(&place))
}

/// The nearest position in front of the own goal area, if `place` lies in it. Both in the robot's
/// frame.
fn before_area(ground: &RobotAndField, place: Point2<f64>) -> Option<Point2<f64>> {
    let in_field = ground.field_from_robot * place;
    let before = Point2::new(ground.field.area_front() + FROM_AREA, in_field.y);
    let inside = ground.field.in_own_area(in_field, 0.0);
    inside.then(|| ground.field_from_robot.inverse_transform_point(&before))
}

/// Walks to a position, avoiding robots and ball, and stays there facing the ball.
pub(super) fn wait_at(place: Point2<f64>, ball: &Ball, obstacles: &[Point2<f64>]) -> Walk {
    let way = place.coords.norm();
    if way < 0.2 {
        return Walk::turning(turn_to(ball.bearing));
    }
    let obstacles: Vec<Point2<f64>> = obstacles.iter().copied().chain([ball.position()]).collect();
    stride_to(avoid(place, &obstacles), way)
}

monas::activity!(WalkTowardsBall);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, MotionRequest, OtherRobot, Pose, Robots};

    fn run(ball: (f64, f64), pose: Option<Pose>, robots: &[OtherRobot]) -> MotionRequest {
        let (mut stage, mut activity) = (ActivityFixture::new(), WalkTowardsBall::default());
        let game = GameState {
            field_length: 6.0,
            field_width: 4.0,
            goal_width: 1.4,
            area_depth: 0.6,
            area_width: 2.2,
            ..GameState::default()
        };
        let ball = Ball {
            x: ball.0,
            y: ball.1,
            distance: libm::hypot(ball.0, ball.1),
            bearing: libm::atan2(ball.1, ball.0),
            ..Ball::default()
        };
        stage.publish(topics::GAME_STATE, game).publish(topics::BALL, ball);
        stage.publish(topics::ROBOTS, Robots { robots: robots.to_vec(), ..Robots::default() });
        pose.map(|pose| stage.publish(topics::POSE, pose).now);
        assert!(stage.run(&mut activity));
        stage.latest(topics::MOTION).unwrap()
    }

    fn robot(x: f64, y: f64, team_mate: bool) -> OtherRobot {
        OtherRobot { x, y, team_mate, age: 0.0 }
    }

    #[test]
    fn a_ball_before_the_goal_is_walked_to_straight() {
        let walk = run((2.0, 0.0), Some(Pose::default()), &[]);
        assert!(walk.vx > 0.2 && walk.wz.abs() < 1e-9, "{walk:?}");
        let lost = run((2.0, 0.0), None, &[]);
        assert!(lost.vx > 0.2, "also by a robot that does not know where it is");
    }

    #[test]
    fn a_ball_on_the_wrong_side_is_walked_round() {
        let facing_own_goal = Pose { heading: std::f64::consts::PI, ..Pose::default() };
        let walk = run((1.0, 0.0), Some(facing_own_goal), &[]);
        assert!(walk.wz.abs() > 0.3, "{walk:?}");
    }

    #[test]
    fn robots_in_the_way_are_passed() {
        assert!(run((2.0, 0.0), Some(Pose::default()), &[robot(0.8, 0.1, false)]).wz < -0.1);
        assert!(run((2.0, 0.0), None, &[robot(0.8, 0.1, true)]).wz < -0.1);
    }

    #[test]
    fn a_team_mate_at_the_ball_keeps_it() {
        let free = run((0.8, 0.0), Some(Pose::default()), &[robot(0.8, -0.8, true)]);
        assert!(free.vx > 0.2 && free.wz.abs() < 0.1, "{free:?}");
        let waits = run((0.8, 0.0), Some(Pose::default()), &[robot(0.8, -0.2, true)]);
        assert!(waits.wz > 0.5, "it goes to the ball's left: {waits:?}");
        let opponent = run((0.8, 0.0), Some(Pose::default()), &[robot(1.0, -0.2, false)]);
        assert!(opponent.wz < waits.wz, "an opponent is no reason to wait: {opponent:?}");
    }

    #[test]
    fn the_own_goals_area_is_left_to_the_goalkeeper() {
        let before_area = Pose { x: -2.25, heading: std::f64::consts::PI, ..Pose::default() };
        let walk = run((0.5, 0.0), Some(before_area), &[]);
        assert!(walk.vx.abs() < 1e-9, "{walk:?}");
    }
}
