//! Errors of starting and running a loaded match, and of drawing a recorded one.

/// An error that prevents a match from starting or continuing, or a picture of a recorded one.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
    #[source]
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

/// The kind of error.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The field rejects its parameters or the line-up.
    Field,
    /// A body cannot be opened.
    Body,
    /// The agents cannot be built or run.
    Agents,
    /// The recording cannot be written or read.
    Recording,
    /// A recording does not show what is to be drawn.
    Picture,
}

impl Error {
    pub(crate) fn field(error: monas_sim::Error) -> Error {
        Error { kind: ErrorKind::Field, message: error.to_string(), source: Some(error.into()) }
    }

    pub(crate) fn body(host: &str, error: monas_robot::Error) -> Error {
        let message = format!("the body of {host} cannot be opened: {error}");
        Error { kind: ErrorKind::Body, message, source: Some(error.into()) }
    }

    pub(crate) fn agents(error: monas::Error) -> Error {
        let details: Vec<String> = error.diagnostics().iter().map(ToString::to_string).collect();
        let message = [vec![error.to_string()], details].concat().join("\n");
        Error { kind: ErrorKind::Agents, message, source: Some(error.into()) }
    }

    pub(crate) fn refused(message: String) -> Error {
        Error { kind: ErrorKind::Agents, message, source: None }
    }

    pub(crate) fn recording(error: monas_tape::Error) -> Error {
        let message = format!("cannot record: {error}");
        Error { kind: ErrorKind::Recording, message, source: Some(error.into()) }
    }

    pub(crate) fn unreadable(error: monas_tape::Error) -> Error {
        Error { kind: ErrorKind::Recording, message: error.to_string(), source: Some(error.into()) }
    }

    pub(crate) fn picture(message: String) -> Error {
        Error { kind: ErrorKind::Picture, message, source: None }
    }

    /// The diagnostics, if the cause is a file or setting of the user.
    pub fn diagnostics(&self) -> &[yase::Diagnostic] {
        let source = self.source.as_deref();
        let agents = source.and_then(|source| source.downcast_ref::<monas::Error>());
        agents.map_or(&[], monas::Error::diagnostics)
    }

    /// The kind of error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}
