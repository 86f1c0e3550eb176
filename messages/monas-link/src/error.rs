//! The error type: a text for people and a kind for programs.

use thiserror::Error as ThisError;

/// An error of a link. The text names the cause; [`kind`](Error::kind) is for programs.
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
    /// The settings contradict each other or the topics.
    Settings,
    /// A file cannot be read, or has invalid content.
    File,
    /// The peer cannot be reached, or refuses.
    Connection,
    /// Another process has the name.
    NameTaken,
    /// The request is rejected; the text states the reason.
    Refused,
    /// A packet is larger than the transport carries.
    TooLarge,
    /// The system cannot create a thread.
    Thread,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, text: impl Into<String>) -> Error {
        Error { kind, text: text.into() }
    }

    /// The transport does not exist, or its feature is disabled.
    pub fn unknown_transport(name: &str) -> Error {
        Error::new(ErrorKind::Settings, format!("`{name}` is not a transport of this program"))
    }

    /// The kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
