//! Inputs of the behaviours at the ball: the target and the obstacles.

use monas::Blackboard;
use nalgebra::{Isometry2, Point2};

use crate::functionality::aim::{kick_target, shot_target};
use crate::functionality::field::FieldModel;
use crate::{Ball, OtherRobot, topics};

/// The estimated pose of the robot and the field.
#[derive(Clone, Copy, Debug)]
pub struct RobotAndField {
    /// The field.
    pub field: FieldModel,
    /// The pose as a transformation from the robot's frame to the field frame.
    pub field_from_robot: Isometry2<f64>,
}

/// The pose and the field; none while either is unknown.
pub fn ground(blackboard: &Blackboard) -> Option<RobotAndField> {
    let field = blackboard.read(topics::GAME_STATE)?.field();
    let field_from_robot = blackboard.read(topics::POSE)?.field_from_robot();
    (field.length > 0.0).then_some(RobotAndField { field, field_from_robot })
}

/// The target of a kick in the robot's frame; straight ahead if the pose is unknown.
pub fn target(blackboard: &Blackboard, ball: &Ball, ground: Option<&RobotAndField>) -> Point2<f64> {
    let Some(RobotAndField { field, field_from_robot }) = ground else {
        return Point2::new(ball.x + 3.0, ball.y);
    };
    let opponents: Vec<Point2<f64>> = others(blackboard)
        .filter(|robot| !robot.team_mate)
        .map(|robot| field_from_robot * robot.position())
        .collect();
    let ball = field_from_robot * ball.position();
    let target = kick_target(field, ball, shot_target(field, ball, &opponents));
    field_from_robot.inverse_transform_point(&target)
}

/// Other robots that were seen recently.
pub fn others(blackboard: &Blackboard) -> impl Iterator<Item = &OtherRobot> {
    blackboard.read(topics::ROBOTS).into_iter().flat_map(|robots| &robots.robots)
}

/// Whether the opponents stand still, so that none will take the ball.
pub fn opponents_stand(blackboard: &Blackboard) -> bool {
    blackboard.read(topics::ROBOTS).is_some_and(|robots| robots.opponents_stand)
}
