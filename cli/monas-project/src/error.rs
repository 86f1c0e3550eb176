//! Why a project was not created or changed.

use std::fmt;
use std::path::Path;

use yase::Diagnostic;

/// Why a project was not created or changed.
#[derive(Debug)]
pub struct Error {
    kind: ErrorKind,
    message: String,
    diagnostics: Vec<Diagnostic>,
}

/// The kinds of [`Error`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// An argument, such as a name, cannot be used.
    Argument,
    /// A model, a manifest or the folder is not as it must be; [`Error::diagnostics`] say how.
    Invalid,
    /// A file cannot be read or written, or is there already.
    File,
    /// The activities, functions or messages of the program contradict each other.
    Program,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Error {
        Error { kind, message: message.into(), diagnostics: Vec::new() }
    }

    pub(crate) fn invalid(diagnostics: Vec<Diagnostic>) -> Error {
        Error { kind: ErrorKind::Invalid, message: String::new(), diagnostics }
    }

    /// `verb`: read, write or remove.
    pub(crate) fn file(verb: &str, path: &Path, error: &std::io::Error) -> Error {
        Error::new(ErrorKind::File, format!("cannot {verb} {}: {error}", path.display()))
    }

    /// The kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// The diagnostics, if the kind is [`ErrorKind::Invalid`].
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        for (index, diagnostic) in self.diagnostics.iter().enumerate() {
            write!(f, "{}{diagnostic}", if index > 0 { "\n" } else { "" })?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {}
