//! What can go wrong: a message for people and a kind for programs.

use thiserror::Error as ThisError;

/// An error of a link. What it says names the thing at fault; [`kind`](Error::kind) is for programs.
#[derive(Clone, PartialEq, Eq, Debug, ThisError)]
#[error("{text}")]
pub struct Error {
    kind: ErrorKind,
    text: String,
}

/// What kind of error it is.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The settings contradict each other or the topics.
    Settings,
    /// A file cannot be read, or does not hold what it should.
    File,
    /// The other side cannot be reached, or refuses.
    Connection,
    /// Another process has the name.
    NameTaken,
    /// What was asked for is refused; the error says why.
    Refused,
    /// A packet is larger than the transport carries.
    TooLarge,
    /// The system gives no thread.
    Thread,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, text: impl Into<String>) -> Error {
        Error { kind, text: text.into() }
    }

    /// Nobody knows a way of that name, or it is a feature that is not there.
    pub fn unknown_transport(name: &str) -> Error {
        Error::new(ErrorKind::Settings, format!("`{name}` is no transport of this program"))
    }

    /// What kind of error it is.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
