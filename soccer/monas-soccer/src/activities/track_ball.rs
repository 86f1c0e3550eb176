//! Tracks the ball.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};

use super::motion_requests::{request_gaze, request_walk};
use super::shot::ground;
use crate::functionality::field::Goal;
use crate::functionality::guard::GoalPositioning;
use crate::functionality::head::{Gaze, HeadController};
use crate::{Ball, topics};

/// Keeps the head on the ball. The goalkeeper also stays between ball and goal, and returns there
/// after a dive or a search. It steps sideways to block a shot that needs no dive.
///
/// A field player with an uncertain pose looks up at a goal from time to time while the ball is
/// neither near nor fast.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrackBall {
    head: HeadController,
    guard: GoalPositioning,
}

/// Duration and period of looks at a goal, seconds.
const GLANCE: (f64, f64) = (0.6, 3.0);
/// Confidence of the pose above which no look is needed.
const CERTAIN: f64 = 0.85;

impl Activity for TrackBall {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let Some(ball) = blackboard.read(topics::BALL).copied() else { return Ok(Progress::Done) };
        let gaze = self.glance(blackboard, &ball).unwrap_or(self.head.look_at(ball.position()));
        request_gaze(blackboard, gaze)?;
        self.keep_goal(blackboard, &ball)?;
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::MOTION).publishes(topics::MOTION).publishes(topics::HEAD)
    }
}

impl TrackBall {
    fn keep_goal(&self, blackboard: &mut Blackboard, ball: &Ball) -> Result<(), BoxError> {
        if !keeps_goal(blackboard) {
            return Ok(());
        }
        if ball.approaching {
            return request_walk(blackboard, self.guard.step_before(ball.crossing_y));
        }
        let Some(ground) = ground(blackboard) else { return Ok(()) };
        let ball_in_field = ground.field_from_robot * ball.position();
        let place = self.guard.place(&ground.field, Some(ball_in_field));
        request_walk(blackboard, self.guard.walk(&ground.field_from_robot, &place))
    }

    /// The gaze at the goal nearer to the ball's direction, if a look is due.
    fn glance(&self, blackboard: &Blackboard, ball: &Ball) -> Option<Gaze> {
        let uncertain = blackboard.read(topics::POSE)?.confidence < CERTAIN;
        let quiet = ball.distance > 0.7 && ball.speed < 0.3 && ball.age < GLANCE.0;
        let time = libm::fmod(blackboard.now().as_secs_f64(), GLANCE.1) < GLANCE.0;
        if !(uncertain && quiet && time) || keeps_goal(blackboard) {
            return None;
        }
        let ground = ground(blackboard)?;
        let gazes = [Goal::Opponent, Goal::Own].map(|goal| {
            let goal_in_robot = ground.field_from_robot.inverse_transform_point(&ground.field.goal(goal));
            self.head.look_at(goal_in_robot)
        });
        let off = |gaze: &Gaze| (gaze.yaw - ball.bearing).abs();
        gazes.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))
    }
}

fn keeps_goal(blackboard: &Blackboard) -> bool {
    blackboard.read(topics::GAME_STATE).is_some_and(|game| game.goalkeeper)
}

monas::activity!(TrackBall);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, HeadMode, HeadRequest, Pose};

    fn run(ball: Ball, goalkeeper: bool, pose: Pose) -> (HeadRequest, Option<crate::MotionRequest>) {
        let (mut stage, mut activity) = (ActivityFixture::new(), TrackBall::default());
        let game = GameState {
            goalkeeper,
            field_length: 6.0,
            field_width: 4.0,
            goal_width: 1.4,
            ..Default::default()
        };
        stage.publish(topics::BALL, ball).publish(topics::GAME_STATE, game).publish(topics::POSE, pose);
        stage.now = narukom::Timestamp::from_nanos(9_300_000_000);
        stage.run(&mut activity);
        (stage.latest(topics::HEAD).unwrap(), stage.latest(topics::MOTION))
    }

    fn ball(x: f64, y: f64) -> Ball {
        Ball { x, y, distance: libm::hypot(x, y), bearing: libm::atan2(y, x), found: true, ..Ball::default() }
    }

    #[test]
    fn a_field_players_head_follows_the_ball_and_its_body_does_not_move() {
        let (head, motion) = run(ball(1.0, 1.0), false, Pose { confidence: 1.0, ..Pose::default() });
        assert_eq!(head.mode(), HeadMode::Look);
        assert!((head.yaw - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
        assert_eq!(motion, None);
    }

    #[test]
    fn one_that_is_lost_looks_up_at_a_goal() {
        let lost = Pose { confidence: 0.2, ..Pose::default() };
        assert_eq!(run(ball(1.0, 1.0), false, lost).0.yaw, 0.0);
        assert!(run(ball(0.2, 0.2), false, lost).0.yaw > 0.5, "not with the ball at its feet");
        assert!(run(Ball { speed: 1.0, ..ball(1.0, 1.0) }, false, lost).0.yaw > 0.5, "not while it rolls");
    }

    #[test]
    fn the_goalkeeper_goes_between_ball_and_goal() {
        let home = Pose { x: -2.65, confidence: 1.0, ..Pose::default() };
        let (_, motion) = run(ball(2.5, 1.5), true, home);
        assert!(motion.unwrap().vy > 0.05, "{motion:?}");
        let (_, motion) = run(ball(2.5, 0.0), true, home);
        assert_eq!(motion.map(|walk| (walk.vx, walk.vy, walk.wz)), Some((0.0, 0.0, 0.0)));
    }

    #[test]
    fn the_goalkeeper_steps_before_a_shot() {
        let home = Pose { x: -2.65, confidence: 1.0, ..Pose::default() };
        let shot = Ball { approaching: true, crossing_y: -0.1, ..ball(1.0, 0.0) };
        let (_, motion) = run(shot, true, home);
        assert!(motion.is_some_and(|walk| walk.vy < -0.05 && walk.vx == 0.0), "{motion:?}");
    }
}
