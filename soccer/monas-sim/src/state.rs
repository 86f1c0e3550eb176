//! The ground truth, for tests, pictures and the referee.

use crate::{BodyPhase, FieldGeometry, Physics, Pose, Vector};

/// The ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallState {
    /// Position of its middle in the field frame, m.
    pub position: Vector,
    /// Velocity in the field frame, m/s.
    pub velocity: Vector,
}

/// A robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotState {
    /// Index of its team.
    pub team: usize,
    /// Its number in the team.
    pub number: u8,
    /// Position and heading in the field frame.
    pub pose: Pose,
    /// Velocity in the field frame, m/s.
    pub velocity: Vector,
    /// The intended velocity of its legs in the field frame, ignoring obstacles, m/s.
    pub intent: Vector,
    /// The phase of the body's motion.
    pub phase: BodyPhase,
    /// Head yaw, rad, to the left.
    pub head_yaw: f64,
    /// Head pitch, rad, positive looks down.
    pub head_pitch: f64,
    /// False while a penalty keeps it off the field.
    pub on_field: bool,
}

impl RobotState {
    /// Whether this is its team's goalie, by its number.
    pub fn is_goalie(&self) -> bool {
        self.number == GOALIE_NUMBER
    }
}

/// The number of a goalie (SPL 2010).
pub(crate) const GOALIE_NUMBER: u8 = 1;

/// The ground truth at one time, as input of referee and cameras.
#[derive(Clone, Copy)]
pub(crate) struct WorldView<'a> {
    pub(crate) field: &'a FieldGeometry,
    pub(crate) physics: &'a Physics,
    pub(crate) ball: BallState,
    pub(crate) robots: &'a [RobotState],
    /// For each robot, whether it touches the ball.
    pub(crate) touching_ball: &'a [bool],
    /// The pairs of robots that touch each other, the smaller index first.
    pub(crate) contacts: &'a [(usize, usize)],
}

impl WorldView<'_> {
    /// The robots on the field, with their indices.
    pub(crate) fn on_field(&self) -> impl Iterator<Item = (usize, &RobotState)> + Clone {
        self.robots.iter().enumerate().filter(|(_, robot)| robot.on_field)
    }

    /// The robots that touch the ball now.
    pub(crate) fn touchers(&self) -> impl Iterator<Item = usize> {
        self.touching_ball.iter().enumerate().filter(|(_, touches)| **touches).map(|(robot, _)| robot)
    }
}
