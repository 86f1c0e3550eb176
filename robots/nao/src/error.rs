//! Errors of the connection to a Nao.

use monas_robot::ErrorKind as BodyError;

/// An error of the connection to a Nao.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
}

/// The kind of error.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The bytes received are not what LoLA sends.
    Protocol,
    /// The other end does not answer, or has closed the connection.
    Disconnected,
}

impl Error {
    pub(crate) fn protocol(message: impl Into<String>) -> Error {
        Error { kind: ErrorKind::Protocol, message: message.into() }
    }

    pub(crate) fn disconnected(message: impl Into<String>) -> Error {
        Error { kind: ErrorKind::Disconnected, message: message.into() }
    }

    /// The kind of error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}

impl From<Error> for monas_robot::Error {
    fn from(error: Error) -> monas_robot::Error {
        let kind = match error.kind {
            ErrorKind::Protocol => BodyError::Protocol,
            ErrorKind::Disconnected => BodyError::Disconnected,
        };
        monas_robot::Error::new(kind, error.message)
    }
}
