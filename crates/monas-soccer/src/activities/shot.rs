//! What the behaviours at the ball see of the game: where the ball is to go and who is in the way.

use monas::Blackboard;
use nalgebra::{Isometry2, Point2};

use crate::functionality::aim::{kick_target, shot_target};
use crate::functionality::field::Field;
use crate::{Ball, OtherRobot, topics};

/// Where robot and field are to each other, as far as the robot knows.
#[derive(Clone, Copy)]
pub(super) struct Ground {
    pub field: Field,
    pub field_from_robot: Isometry2<f64>,
}

/// Nothing while the robot does not know where it stands or on which field.
pub(super) fn ground(blackboard: &Blackboard) -> Option<Ground> {
    let field = blackboard.read(topics::GAME_STATE)?.field();
    let field_from_robot = blackboard.read(topics::POSE)?.field_from_robot();
    (field.length > 0.0).then_some(Ground { field, field_from_robot })
}

/// Where the ball is to be kicked, in the robot's frame. A robot that does not know where it stands kicks ahead.
pub(super) fn target(blackboard: &Blackboard, ball: &Ball, ground: Option<&Ground>) -> Point2<f64> {
    let Some(Ground { field, field_from_robot }) = ground else { return Point2::new(ball.x + 3.0, ball.y) };
    let opponents: Vec<Point2<f64>> = others(blackboard)
        .filter(|robot| !robot.team_mate)
        .map(|robot| field_from_robot * robot.position())
        .collect();
    let ball = field_from_robot * ball.position();
    let target = kick_target(field, ball, shot_target(field, ball, &opponents));
    field_from_robot.inverse_transform_point(&target)
}

/// The other robots that were seen lately.
pub(super) fn others(blackboard: &Blackboard) -> impl Iterator<Item = &OtherRobot> {
    blackboard.read(topics::ROBOTS).into_iter().flat_map(|robots| &robots.robots)
}
