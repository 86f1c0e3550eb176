//! The phase of a body's motion, and the side to which it falls.

use crate::Side;
use crate::Vector;

/// The phase of a body's motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BodyPhase {
    /// Upright, feet still.
    #[default]
    Standing,
    /// Upright, feet moving.
    Walking,
    /// Kicking with a foot.
    Kicking(Side),
    /// Intentionally falling from the knees to a side.
    SideFalling(Side),
    /// Intentionally diving to a side.
    Diving(Side),
    /// Falling unintentionally.
    Falling(Direction),
    /// Lying on the ground until commanded to stand up.
    Fallen(Direction),
    /// Standing up.
    StandingUp,
    /// Sitting down.
    SittingDown,
    /// Sitting until commanded to stand up.
    Sitting,
}

impl BodyPhase {
    /// Whether the body is on its feet and in balance.
    pub fn is_upright(self) -> bool {
        matches!(self, Self::Standing | Self::Walking | Self::Kicking(_))
    }

    /// Whether the body lies on the ground.
    pub fn is_fallen(self) -> bool {
        matches!(self, Self::Fallen(_))
    }
}

/// The side on which a body lies or to which it falls, in its own frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// On its face.
    Front,
    /// On its back.
    Back,
    /// On its left side.
    Left,
    /// On its right side.
    Right,
}

impl Direction {
    /// The unit vector of this direction in the frame of the body.
    pub fn vector(self) -> Vector {
        match self {
            Self::Front => Vector::new(1.0, 0.0),
            Self::Back => Vector::new(-1.0, 0.0),
            Self::Left => Vector::new(0.0, 1.0),
            Self::Right => Vector::new(0.0, -1.0),
        }
    }

    /// The direction nearest to that of `vector`.
    pub(crate) fn nearest(vector: Vector) -> Self {
        match (vector.x.abs() >= vector.y.abs(), vector.x >= 0.0, vector.y >= 0.0) {
            (true, true, _) => Self::Front,
            (true, false, _) => Self::Back,
            (false, _, true) => Self::Left,
            (false, _, false) => Self::Right,
        }
    }
}
