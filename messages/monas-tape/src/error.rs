//! The error type.

use std::fmt;
use std::io;
use std::path::Path;

use crate::recording::Channel;

/// An error of a tape.
#[derive(Debug, thiserror::Error)]
#[error("{text}")]
pub struct Error {
    kind: ErrorKind,
    text: String,
    #[source]
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

/// The kinds of errors.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file cannot be opened, read or written.
    File,
    /// The tape is finished and cannot be written any more.
    Finished,
    /// A file is not a tape, or is damaged.
    Damaged,
    /// A file is compressed; tapes are not.
    Compressed,
    /// Messages cannot be decoded: they are not protobuf, or do not match their schema.
    Opaque,
}

impl Error {
    pub(crate) fn file(path: &Path, source: io::Error) -> Error {
        let text = format!("the tape {} cannot be opened: {source}", path.display());
        Error { kind: ErrorKind::File, text, source: Some(source.into()) }
    }

    pub(crate) fn unwritable(path: &Path, source: io::Error) -> Error {
        let text = format!("the tape {} cannot be written: {source}", path.display());
        Error { kind: ErrorKind::File, text, source: Some(source.into()) }
    }

    pub(crate) fn writing(source: mcap::McapError) -> Error {
        let text = format!("the tape cannot be written: {source}");
        Error { kind: ErrorKind::File, text, source: Some(source.into()) }
    }

    /// The recording has gaps.
    pub(crate) fn interrupted(failure: &str, missing: u64) -> Error {
        let text = match missing {
            0 => failure.to_owned(),
            _ => format!("{failure}; up to {missing} messages are missing"),
        };
        Error { kind: ErrorKind::File, text, source: None }
    }

    pub(crate) fn no_thread(source: io::Error) -> Error {
        let text = format!("no thread to write the tape: {source}");
        Error { kind: ErrorKind::File, text, source: Some(source.into()) }
    }

    pub(crate) fn finished() -> Error {
        Error { kind: ErrorKind::Finished, text: "the tape is finished".to_owned(), source: None }
    }

    pub(crate) fn damaged(what: impl fmt::Display) -> Error {
        Error { kind: ErrorKind::Damaged, text: format!("the tape is damaged: {what}"), source: None }
    }

    /// The error in a file.
    pub(crate) fn of_file(self, path: Option<&Path>) -> Error {
        let Some(path) = path else { return self };
        Error { text: format!("{}: {}", path.display(), self.text), ..self }
    }

    pub(crate) fn compressed(with: &str) -> Error {
        let text = format!("the tape is compressed ({with}), which is not supported");
        Error { kind: ErrorKind::Compressed, text, source: None }
    }

    pub(crate) fn opaque(channel: &Channel, why: &str) -> Error {
        let Channel { topic, publisher, .. } = channel;
        let text = format!("the messages of `{publisher}` on `{topic}` cannot be taken apart: {why}");
        Error { kind: ErrorKind::Opaque, text, source: None }
    }

    /// The kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
