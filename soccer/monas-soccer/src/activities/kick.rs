//! Kicks towards the opponents' goal.

use monas::{Activity, Blackboard, BoxError, Parameters, Progress, Topics};
use monas_robot::Skill;
use nalgebra::Point2;

use super::motion_requests::KickStyle;
use super::shot::{ground, opponents_stand, others};
use super::skills::{RunningSkill, perform};
use crate::functionality::ball_filter::BallModel;
use crate::functionality::field::Goal;
use crate::{MotionKind, topics};

/// The strength of a kick.
#[derive(Clone, Copy, Debug, Default)]
struct Strength {
    /// Distance from the goal beyond which a kick is soft, metres; zero: no kick is soft.
    soft_beyond: f64,
    /// Distance before the goal at which the ball of a soft kick comes to rest, metres.
    rest: f64,
}

/// Distance of an opponent from the ball within which a kick from afar is soft, metres. Where none
/// is near, a hard kick costs less time than a second walk to the ball.
const CONTESTED_DISTANCE: f64 = 1.0;

impl Strength {
    fn of(parameters: &Parameters) -> Strength {
        let number = |name| parameters.number(name).filter(|number| number.is_finite()).unwrap_or(0.0);
        Strength { soft_beyond: number("soft_beyond"), rest: number("rest") }
    }

    /// A kick as hard as the body can, unless the ball is known to be far from the goal and an
    /// opponent is near it.
    fn style(self, blackboard: &Blackboard) -> KickStyle {
        let (Some(ball), Some(ground)) = (blackboard.read(topics::BALL), ground(blackboard)) else {
            return KickStyle::default();
        };
        let is_contested = is_contested(blackboard, ball.position());
        let ball = ground.field_from_robot * ball.position();
        let to_goal = (ground.field.goal(Goal::Opponent) - ball).norm();
        if self.soft_beyond <= 0.0 || to_goal <= self.soft_beyond || !is_contested {
            return KickStyle::default();
        }
        let ball_speed = BallModel::default().speed_for(to_goal - self.rest, 0.0);
        KickStyle { is_pass: false, ball_speed }
    }
}

/// Whether an opponent is near the ball, which is at a point of the robot's frame, and may move.
fn is_contested(blackboard: &Blackboard, ball: Point2<f64>) -> bool {
    !opponents_stand(blackboard)
        && others(blackboard)
            .any(|robot| !robot.team_mate && (robot.position() - ball).norm() < CONTESTED_DISTANCE)
}

macro_rules! kick {
    ($($(#[$documentation:meta])* $name:ident: $kind:ident;)*) => {$(
        $(#[$documentation])*
        ///
        /// Parameters: a kick from more than `soft_beyond` (m) from the goal, with an opponent
        /// within 1 m of the ball, is soft: the ball comes to rest `rest` (m) before the goal. By
        /// default every kick is as hard as the body can.
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name {
            under_way: RunningSkill,
            strength: Strength,
        }

        impl Activity for $name {
            fn configure(&mut self, parameters: &Parameters) {
                self.strength = Strength::of(parameters);
            }

            fn start(&mut self, _: &mut Blackboard) -> Result<(), BoxError> {
                self.under_way = None;
                Ok(())
            }

            fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
                let style = self.strength.style(blackboard);
                perform(&mut self.under_way, MotionKind::$kind, style, blackboard)
            }

            fn stop(&mut self, _: &mut Blackboard) {
                self.under_way = None;
            }

            fn topics(&self) -> Topics {
                let topics = Topics::declared().reads(topics::MOTION).ends_on(topics::MOTION_STATE);
                let topics = topics.reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
                let topics = topics.reads(topics::ROBOTS);
                topics.publishes(topics::MOTION).performs(Skill::$kind.as_str_name())
            }
        }

        monas::activity!($name);
    )*};
}

kick! {
    /// Kicks with the left foot, done when the robot stands again.
    LeftKick: KickLeft;
    /// Kicks with the right foot, done when the robot stands again.
    RightKick: KickRight;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{Ball, GameState, OtherRobot, Pose, Robots};

    /// The kick of a robot in the middle of the field, with the ball at its left foot and another
    /// robot 0.5 m before the ball.
    fn wanted(activity: &mut dyn Activity, pose: Option<Pose>) -> crate::MotionRequest {
        wanted_near(activity, pose, OtherRobot { x: 0.65, y: 0.05, ..OtherRobot::default() })
    }

    fn wanted_near(
        activity: &mut dyn Activity,
        pose: Option<Pose>,
        robot: OtherRobot,
    ) -> crate::MotionRequest {
        wanted_among(activity, pose, Robots { robots: vec![robot], ..Robots::default() })
    }

    fn wanted_among(activity: &mut dyn Activity, pose: Option<Pose>, robots: Robots) -> crate::MotionRequest {
        let mut stage = ActivityFixture::new();
        stage.publish(topics::ROBOTS, robots);
        stage.publish(topics::BALL, Ball { found: true, x: 0.15, y: 0.05, ..Ball::default() });
        let game = GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game);
        if let Some(pose) = pose {
            stage.publish(topics::POSE, pose);
        }
        stage.run(activity);
        stage.latest(topics::MOTION).unwrap()
    }

    fn soft() -> LeftKick {
        LeftKick { strength: Strength { soft_beyond: 2.2, rest: 1.2 }, ..LeftKick::default() }
    }

    #[test]
    fn each_foot_kicks_as_hard_as_it_can() {
        for (activity, kind) in [
            (&mut LeftKick::default() as &mut dyn Activity, MotionKind::KickLeft),
            (&mut RightKick::default(), MotionKind::KickRight),
        ] {
            let kick = wanted(activity, Some(Pose::default()));
            assert_eq!((kick.kind(), kick.ball_speed, kick.is_pass), (kind, 0.0, false));
        }
    }

    #[test]
    fn far_from_the_goal_the_ball_is_laid_before_it() {
        let speed = wanted(&mut soft(), Some(Pose::default())).ball_speed;
        let rolls = speed * speed / (2.0 * BallModel::default().rolling_deceleration);
        let to_goal = libm::hypot(3.0 - 0.15, 0.05);
        assert!((rolls - (to_goal - 1.2)).abs() < 1e-9, "{rolls}");
        let near = Pose { x: 1.0, ..Pose::default() };
        assert_eq!(wanted(&mut soft(), Some(near)).ball_speed, 0.0, "a shot");
        assert_eq!(wanted(&mut soft(), None).ball_speed, 0.0, "the pose is not known");
    }

    #[test]
    fn only_a_contested_ball_is_laid_before_the_goal() {
        let is_soft = |x, team_mate| {
            let robot = OtherRobot { x, y: 0.05, team_mate, ..OtherRobot::default() };
            wanted_near(&mut soft(), Some(Pose::default()), robot).ball_speed > 0.0
        };
        assert!(is_soft(0.15 + CONTESTED_DISTANCE - 0.05, false));
        assert!(!is_soft(0.15 + CONTESTED_DISTANCE + 0.05, false), "the opponent is far");
        assert!(!is_soft(0.65, true), "a team mate");
    }

    #[test]
    fn an_opponent_that_stands_still_contests_no_ball() {
        let opponent = OtherRobot { x: 0.65, y: 0.05, ..OtherRobot::default() };
        for opponents_stand in [false, true] {
            let robots = Robots { robots: vec![opponent], opponents_stand, ..Robots::default() };
            let kick = wanted_among(&mut soft(), Some(Pose::default()), robots);
            assert_eq!(kick.ball_speed > 0.0, !opponents_stand);
        }
    }
}
