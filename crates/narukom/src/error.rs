//! What can go wrong: a message for people and a kind for programs.

use thiserror::Error as ThisError;

/// An error of Narukom. What it says names the thing at fault; [`kind`](Error::kind) is for programs.
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
    /// A topic's path or a subscription's pattern is not well formed.
    BadPath,
    /// One topic is declared with two message types.
    TypesDiffer,
    /// One topic is declared with two ways of keeping.
    KindsDiffer,
    /// Two topics have the same name hash; one must be renamed.
    HashCollision,
    /// Nobody declared the topic.
    UndeclaredTopic,
    /// The message is not of the topic's type.
    WrongType,
    /// More messages wait for `publish_all` than a blackboard holds.
    OutboxFull,
    /// Bytes are no encoding of a message of the topic's type, or more than are taken.
    Malformed,
    /// More hosts or publishers than a hub numbers.
    TooMany,
    /// A message is said to come from elsewhere, but names the hub's own host.
    OwnHost,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, text: String) -> Error {
        Error { kind, text }
    }

    /// What kind of error it is.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
