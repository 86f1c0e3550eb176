//! Why a schema was not compiled.

use std::io;
use std::path::Path;

/// Why messages could not be generated. What it says names the file, the message or the field at fault.
#[derive(Debug, thiserror::Error)]
#[error("{text}")]
pub struct Error {
    kind: ErrorKind,
    text: String,
    #[source]
    source: Option<io::Error>,
}

/// What kind of error it is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file is missing, or is not a valid schema.
    Schema,
    /// A file is written in another edition than proto3.
    Syntax,
    /// A file declares no package.
    Package,
    /// A name is not in the style of its kind, so that Rust would know it under another one.
    Name,
    /// A message of another package is used, and nobody said where its Rust code is.
    Unmapped,
    /// A file could not be written.
    Output,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, text: String) -> Error {
        Error { kind, text, source: None }
    }

    pub(crate) fn schema(error: &protox::Error) -> Error {
        // The debug form is the one that says line and column.
        Error::new(ErrorKind::Schema, format!("{error:?}"))
    }

    pub(crate) fn output(path: &Path, source: io::Error) -> Error {
        let text = format!("{} cannot be written", path.display());
        Error { kind: ErrorKind::Output, text, source: Some(source) }
    }

    /// What kind of error it is.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
