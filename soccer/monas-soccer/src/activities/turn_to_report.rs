//! Turns to a ball that a team mate sees.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use nalgebra::Point2;

use super::motion_requests::request_walk;
use super::shot::{ground, others};
use crate::functionality::avoidance::{avoid, keep_out};
use crate::functionality::field::FieldModel;
use crate::functionality::geometry::angle_of;
use crate::functionality::support::{AHEAD, cover_place, support_place};
use crate::functionality::walk::{Walk, turn_to, walk_to};
use crate::topics;

/// Turns to where the newest report of a team mate has the ball, and walks facing it to where it
/// supports the mate: ahead of the ball, or in the own half between ball and goal. Does nothing
/// without a report or pose.
#[derive(Clone, Copy, Debug, Default)]
pub struct TurnToReport;

/// Bearing of the ball below which the robot also walks, radians.
const FACING: f64 = 0.6;
/// Distance from its place below which it only turns, metres.
const THERE: f64 = 0.25;

impl Activity for TurnToReport {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        let (Some(ground), Some(team)) = (ground(blackboard), blackboard.read(topics::TEAM)) else {
            return Ok(Progress::Done);
        };
        let seeing = team.mates.iter().filter(|mate| mate.ball_found);
        if let Some(mate) = seeing.min_by(|a, b| a.age.total_cmp(&b.age)) {
            let ball = Point2::new(mate.ball_x, mate.ball_y);
            let here = Point2::from(ground.field_from_robot.translation.vector);
            let place = ground.field_from_robot.inverse_transform_point(&place(&ground.field, ball, here));
            let ball = ground.field_from_robot.inverse_transform_point(&ball);
            let bearing = angle_of(&ball.coords);
            let obstacles: Vec<Point2<f64>> = others(blackboard).map(|robot| robot.position()).collect();
            let walk = if bearing.abs() < FACING && place.coords.norm() > THERE {
                walk_to(avoid(place, &obstacles), place.coords.norm(), bearing)
            } else {
                Walk::turning(turn_to(bearing))
            };
            request_walk(blackboard, keep_out(walk, &ground.field, &ground.field_from_robot))?;
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::TEAM).reads(topics::GAME_STATE).reads(topics::POSE);
        topics.reads(topics::ROBOTS).reads(topics::MOTION).publishes(topics::MOTION)
    }
}

/// The place of a supporter that does not see the ball. All in the field frame.
fn place(field: &FieldModel, ball: Point2<f64>, here: Point2<f64>) -> Point2<f64> {
    match ball.x < 0.0 {
        true => cover_place(field, ball),
        false => support_place(field, ball, here, AHEAD),
    }
}

monas::activity!(TurnToReport);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::activities::activity_fixture::ActivityFixture;
    use crate::{GameState, Pose, Team, TeamReport};

    #[test]
    fn it_turns_to_the_ball_of_the_newest_report() {
        let mut stage = ActivityFixture::new();
        let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
        stage.publish(topics::GAME_STATE, game).publish(topics::POSE, Pose { x: 1.0, ..Pose::default() });
        let report = |ball_found, ball_y, age| TeamReport {
            ball_found,
            ball_x: 1.0,
            ball_y,
            age,
            ..TeamReport::default()
        };
        let mates = vec![report(true, 1.0, 2.0), report(true, -1.0, 0.5), report(false, 1.0, 0.0)];
        stage.publish(topics::TEAM, Team { own: None, mates });
        assert!(stage.run(&mut TurnToReport));
        let walk = stage.latest(topics::MOTION).unwrap();
        assert!(walk.wz < -1.0 && walk.vx == 0.0, "{walk:?}");
    }

    #[test]
    fn facing_the_ball_it_walks_to_where_it_supports_the_mate() {
        let walk = |ball_x| {
            let mut stage = ActivityFixture::new();
            let game = GameState { field_length: 6.0, field_width: 4.0, ..GameState::default() };
            stage
                .publish(topics::GAME_STATE, game)
                .publish(topics::POSE, Pose { x: -2.0, ..Pose::default() });
            let report = TeamReport { ball_found: true, ball_x, ..TeamReport::default() };
            stage.publish(topics::TEAM, Team { own: None, mates: vec![report] });
            assert!(stage.run(&mut TurnToReport));
            stage.latest(topics::MOTION).unwrap()
        };
        let (ahead, cover) = (walk(0.5), walk(-1.0));
        assert!(ahead.vx > 0.2 && ahead.vy > 0.05, "ahead of the ball and aside: {ahead:?}");
        assert!(cover.vx.abs() < 0.05 && cover.vy == 0.0, "it is there: {cover:?}");
    }
}
