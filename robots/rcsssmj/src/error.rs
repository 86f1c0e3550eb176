//! Errors of the connection to the simulation server.

use monas_robot::{BodyFault, ErrorKind as BodyError};

/// An error of the connection to the server, or of the files that the body needs.
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
    /// The bytes received are not what the server sends.
    Protocol,
    /// The server does not answer, or has closed the connection.
    Disconnected,
    /// A program, a file or an option of the body is missing or not usable.
    Configuration,
}

impl Error {
    pub(crate) fn protocol(message: impl Into<String>) -> Error {
        Error { kind: ErrorKind::Protocol, message: message.into() }
    }

    pub(crate) fn disconnected(message: impl Into<String>) -> Error {
        Error { kind: ErrorKind::Disconnected, message: message.into() }
    }

    pub(crate) fn configuration(message: impl Into<String>) -> Error {
        Error { kind: ErrorKind::Configuration, message: message.into() }
    }

    /// The kind of error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}

impl From<BodyFault> for Error {
    fn from(fault: BodyFault) -> Error {
        Error::configuration(fault.message)
    }
}

impl From<Error> for monas_robot::Error {
    fn from(error: Error) -> monas_robot::Error {
        let kind = match error.kind {
            ErrorKind::Protocol => BodyError::Protocol,
            ErrorKind::Disconnected => BodyError::Disconnected,
            ErrorKind::Configuration => BodyError::Configuration,
        };
        monas_robot::Error::new(kind, error.message)
    }
}
