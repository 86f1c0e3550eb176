//! The error type of schema compilation.

use std::path::Path;
use std::{fmt, io};

/// An error of message generation. The text names the file, message or field at fault.
#[derive(thiserror::Error)]
#[error("{text}")]
pub struct Error {
    kind: ErrorKind,
    text: String,
    #[source]
    source: Option<io::Error>,
}

/// The kinds of errors.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file is missing, or is not a valid schema.
    Schema,
    /// A file does not use proto3.
    Syntax,
    /// A file declares no package.
    Package,
    /// A name does not follow the naming style of its kind, so its Rust name would differ, or it is
    /// taken.
    Name,
    /// A message of another package is used without a mapping to its Rust module.
    Unmapped,
    /// A file could not be written.
    Output,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, text: String) -> Error {
        Error { kind, text, source: None }
    }

    pub(crate) fn schema(error: &protox::Error) -> Error {
        // Only the debug form contains line and column.
        Error::new(ErrorKind::Schema, format!("{error:?}"))
    }

    pub(crate) fn output(path: &Path, source: io::Error) -> Error {
        let text = format!("{} cannot be written", path.display());
        Error { kind: ErrorKind::Output, text, source: Some(source) }
    }

    /// The error with the position of its cause in front.
    pub(crate) fn at(self, position: &str) -> Error {
        Error { text: format!("{position}: {}", self.text), ..self }
    }

    /// The kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}

/// The text with its cause: an error that `main` of a build script returns is printed in this form.
impl fmt::Debug for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.source {
            Some(source) => write!(formatter, "{}: {source}", self.text),
            None => formatter.write_str(&self.text),
        }
    }
}
