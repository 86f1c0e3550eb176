//! The error type: a text for people and a kind for programs.

use thiserror::Error as ThisError;

/// An error of Narukom. The text names the cause; [`kind`](Error::kind) is for programs.
#[derive(Clone, PartialEq, Eq, Debug, ThisError)]
#[error("{text}")]
pub struct Error {
    kind: ErrorKind,
    text: String,
}

/// The kinds of errors.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A topic's path or a subscription's pattern is not well formed.
    BadPath,
    /// One topic is declared with two message types.
    TypesDiffer,
    /// One topic is declared with two retention kinds.
    KindsDiffer,
    /// Two topics have the same name hash; one must be renamed.
    HashCollision,
    /// The topic is not declared.
    UndeclaredTopic,
    /// The message does not have the topic's type.
    WrongType,
    /// More messages wait for `publish_all` than a blackboard accepts.
    OutboxFull,
    /// Bytes do not encode a message of the topic's type, or are too long.
    Malformed,
    /// Too many hosts or publishers for a hub.
    TooMany,
    /// A message is received as remote but names the hub's own host.
    OwnHost,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, text: String) -> Error {
        Error { kind, text }
    }

    /// The kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
