//! Walks to the ball.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::request_walk;
use super::shot::{RobotAndField, ground, others, target};
use crate::functionality::approach::Approach;
use crate::functionality::avoidance::keep_out;
use crate::functionality::interception::meeting_point;
use crate::{Ball, topics};

/// Walks behind the ball, so that it lies between the robot and the opponents' goal, avoiding other
/// robots and the own goal area.
///
/// Parameters (m), which depend on the size of the robot: `stand_off`, the distance from the ball
/// at which the path ends; `circle`, the radius of the circle on which the robot walks round the
/// ball; `face_target`, the distance from the end at which it faces the target. Parameter
/// `foresight` (s): the time for which it predicts a rolling ball to walk to the meeting point; by
/// default zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct WalkTowardsBall {
    approach: Approach,
    foresight: f64,
}

/// The effective speed of a robot towards a place, m/s: its path is not straight.
const EFFECTIVE_SPEED: f64 = 0.2;
/// The deceleration of a rolling ball, m/s².
const ROLLING_DECELERATION: f64 = 0.3;

impl Activity for WalkTowardsBall {
    fn configure(&mut self, parameters: &Parameters) {
        let length = |key, length: &mut f64| {
            let positive =
                |text: &str| text.parse().ok().filter(|value: &f64| value.is_finite() && *value > 0.0);
            *length = parameters.read(key, "a length above 0", positive).unwrap_or(*length);
        };
        length("stand_off", &mut self.approach.stand_off);
        length("circle", &mut self.approach.circle);
        length("face_target", &mut self.approach.face_target);
        self.foresight = parameters.number("foresight").unwrap_or(self.foresight);
    }

    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let Some(ball) = blackboard.read(topics::BALL).copied() else { return Ok(Progress::Done) };
        let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
        let ground = ground(blackboard);
        let target = target(blackboard, &ball, ground.as_ref());
        let walk = self.approach.walk(self.meeting_point(&ball, ground.as_ref()), target, &obstacles);
        let walk = ground.map_or(walk, |ground| keep_out(walk, &ground.field, &ground.field_from_robot));
        request_walk(blackboard, walk)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::ROBOTS).reads(topics::MOTION).publishes(topics::MOTION)
    }
}

impl WalkTowardsBall {
    /// The point at which the robot meets the ball, on the field, in the robot's frame.
    fn meeting_point(&self, ball: &Ball, ground: Option<&RobotAndField>) -> Point2<f64> {
        if self.foresight <= 0.0 {
            return ball.position();
        }
        let (position, velocity) = (ball.position(), ball.velocity());
        let point = meeting_point(position, velocity, ROLLING_DECELERATION, EFFECTIVE_SPEED, self.foresight);
        let Some(RobotAndField { field, field_from_robot }) = ground else { return point };
        let (end, side) = (field.length / 2.0, field.width / 2.0);
        let there = field_from_robot * point;
        let there = Point2::new(there.x.clamp(-end, end), there.y.clamp(-side, side));
        field_from_robot.inverse_transform_point(&there)
    }
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
    fn a_larger_robot_stops_farther_from_the_ball() {
        let mut large = WalkTowardsBall::default();
        large.configure(&Parameters::new().with("stand_off", "0.8").with("circle", "1.0"));
        let near_ball = (0.8, 0.0);
        let mut stage = ActivityFixture::new();
        stage.publish(topics::BALL, Ball { x: near_ball.0, distance: 0.8, ..Ball::default() });
        assert!(stage.run(&mut large));
        assert!(stage.latest(topics::MOTION).unwrap().vx < 0.01);
        assert!(run(near_ball, None, &[]).vx > 0.2);
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
    fn with_foresight_it_walks_to_where_it_meets_a_rolling_ball() {
        let turn = |foresight| {
            let (mut stage, mut activity) = (ActivityFixture::new(), WalkTowardsBall::default());
            activity.configure(&Parameters::new().with("foresight", foresight));
            let ball = Ball { x: 1.5, distance: 1.5, vy: 1.5, speed: 1.5, ..Ball::default() };
            stage.publish(topics::BALL, ball);
            assert!(stage.run(&mut activity));
            stage.latest(topics::MOTION).unwrap().wz
        };
        assert!(turn("0").abs() < 1e-9);
        assert!(turn("3") > 1.0, "it rolls to the left: {}", turn("3"));
    }

    #[test]
    fn robots_in_the_way_are_passed() {
        assert!(run((2.0, 0.0), Some(Pose::default()), &[robot(0.8, 0.1, false)]).wz < -0.1);
        assert!(run((2.0, 0.0), None, &[robot(0.8, 0.1, true)]).wz < -0.1);
    }

    #[test]
    fn the_own_goals_area_is_not_entered() {
        let before_area = Pose { x: -2.3, heading: std::f64::consts::PI, ..Pose::default() };
        let walk = run((0.5, 0.0), Some(before_area), &[]);
        assert!(walk.vx.abs() < 1e-9, "{walk:?}");
    }
}
