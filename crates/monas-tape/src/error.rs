//! What can go wrong with a tape.

use std::io;
use std::path::Path;

/// An error of a tape.
#[derive(Debug, thiserror::Error)]
#[error("{text}")]
pub struct Error {
    kind: ErrorKind,
    text: String,
    #[source]
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

/// What kind of error it is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file cannot be opened, read or written.
    File,
    /// The tape is not written any more: it is finished.
    Finished,
    /// A file is not a tape, or is damaged.
    Damaged,
    /// A file is compressed; tapes are not.
    Compressed,
}

impl Error {
    pub(crate) fn file(path: &Path, source: io::Error) -> Error {
        let text = format!("the tape {} cannot be opened", path.display());
        Error { kind: ErrorKind::File, text, source: Some(source.into()) }
    }

    pub(crate) fn writing(source: mcap::McapError) -> Error {
        let text = "the tape cannot be written".to_owned();
        Error { kind: ErrorKind::File, text, source: Some(source.into()) }
    }

    pub(crate) fn finished() -> Error {
        Error { kind: ErrorKind::Finished, text: "the tape is finished".to_owned(), source: None }
    }

    pub(crate) fn damaged(what: &str) -> Error {
        Error { kind: ErrorKind::Damaged, text: format!("the tape is damaged: {what}"), source: None }
    }

    pub(crate) fn compressed(with: &str) -> Error {
        let text = format!("the tape is compressed ({with}), which is not supported");
        Error { kind: ErrorKind::Compressed, text, source: None }
    }

    /// What kind of error it is.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
