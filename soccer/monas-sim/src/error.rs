//! Errors of setting up and accessing a world.

use crate::lineup::LineupError;

/// An error of this crate: a message for people and an [`ErrorKind`] for programs.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
}

/// The kinds of [`Error`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// No parameter has this name; `keys()` of the struct lists those that exist.
    UnknownParameter,
    /// A value is not finite or outside the range of its parameter.
    OutOfRange,
    /// Parameters contradict each other, such as a goal wider than the field.
    Inconsistent,
    /// Teams or robots are missing, duplicated, too many, or refer to teams that do not exist.
    Lineup,
    /// No robot has this index.
    UnknownRobot,
    /// A person's decision as the referee is not possible in the present state of the game.
    IllegalCall,
}

impl Error {
    /// The kind of error, for programs.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into() }
    }

    pub(crate) fn unknown_parameter(structure: &str, key: &str) -> Self {
        Self::new(ErrorKind::UnknownParameter, format!("{structure} has no parameter `{key}`"))
    }

    pub(crate) fn out_of_range(key: &str, value: f64, min: f64, max: f64, unit: &str) -> Self {
        let message = format!("`{key}` is {value}, but must lie from {min} to {max} ({unit})");
        Self::new(ErrorKind::OutOfRange, message)
    }

    pub(crate) fn unknown_robot(index: usize, count: usize) -> Self {
        Self::new(ErrorKind::UnknownRobot, format!("there is no robot {index}: the world has {count}"))
    }
}

impl From<LineupError> for Error {
    fn from(error: LineupError) -> Error {
        Error::new(ErrorKind::Lineup, error.to_string())
    }
}
