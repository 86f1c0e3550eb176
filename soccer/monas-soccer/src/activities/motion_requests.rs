//! Requests of the behaviours to MotionController.

use monas::{Blackboard, BoxError};

use crate::functionality::head::Gaze;
use crate::functionality::walk::Walk;
use crate::{HeadMode, HeadRequest, MotionKind, MotionRequest, topics};

/// Requests standing still.
///
/// # Errors
/// The calling activity does not declare the topic.
pub fn request_stand(blackboard: &mut Blackboard) -> Result<(), BoxError> {
    let number = last_number(blackboard);
    publish(blackboard, MotionRequest { kind: MotionKind::Stand.into(), number, ..MotionRequest::default() })
}

/// Requests a walk; it ends half a second after the last request.
///
/// # Errors
/// The calling activity does not declare the topic.
pub fn request_walk(blackboard: &mut Blackboard, walk: Walk) -> Result<(), BoxError> {
    let number = last_number(blackboard);
    let Walk { ahead: vx, left: vy, turn: wz } = walk;
    publish(
        blackboard,
        MotionRequest { kind: MotionKind::Walk.into(), vx, vy, wz, number, ..MotionRequest::default() },
    )
}

/// The purpose and the strength of a kick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct KickStyle {
    /// Whether it is a pass to a team mate.
    pub is_pass: bool,
    /// Desired speed of the ball, m/s; zero: as fast as the body kicks it.
    pub ball_speed: f64,
}

/// Requests a one-time motion; the returned number identifies its completion. Motions other than
/// kicks have the default style.
///
/// # Errors
/// The calling activity does not declare the topic.
pub fn request_skill(
    blackboard: &mut Blackboard,
    kind: MotionKind,
    style: KickStyle,
) -> Result<u64, BoxError> {
    let done = blackboard.read(topics::MOTION_STATE).map_or(0, |state| state.done);
    let number = last_number(blackboard).max(done) + 1;
    tracing::info!(motion = kind.as_str_name(), "motion requested");
    let KickStyle { is_pass, ball_speed } = style;
    let kind = kind.into();
    publish(blackboard, MotionRequest { kind, number, is_pass, ball_speed, ..MotionRequest::default() })?;
    Ok(number)
}

/// Requests the head to look in a direction.
///
/// # Errors
/// The calling activity does not declare the topic.
pub fn request_gaze(blackboard: &mut Blackboard, gaze: Gaze) -> Result<(), BoxError> {
    let Gaze { yaw, pitch } = gaze;
    Ok(blackboard.publish(topics::HEAD, HeadRequest { mode: HeadMode::Look.into(), yaw, pitch })?)
}

/// Requests the head to search.
///
/// # Errors
/// The calling activity does not declare the topic.
pub fn request_scan(blackboard: &mut Blackboard) -> Result<(), BoxError> {
    Ok(blackboard
        .publish(topics::HEAD, HeadRequest { mode: HeadMode::Scan.into(), ..HeadRequest::default() })?)
}

fn publish(blackboard: &mut Blackboard, request: MotionRequest) -> Result<(), BoxError> {
    Ok(blackboard.publish(topics::MOTION, request)?)
}

fn last_number(blackboard: &Blackboard) -> u64 {
    blackboard.read(topics::MOTION).map_or(0, |request| request.number)
}
