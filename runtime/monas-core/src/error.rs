//! Errors of assembling and running agents.

use yase::Diagnostic;

/// An agent, chart or body that cannot be assembled or run.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
    hint: Option<String>,
    diagnostics: Vec<Diagnostic>,
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

/// Kind of an error.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// No activity is registered under that name.
    UnknownActivity,
    /// Several crates register that name.
    AmbiguousActivity,
    /// Several crates register a function of that name.
    AmbiguousFunction,
    /// Several crates register a generated statechart of that name.
    AmbiguousChart,
    /// No generated statechart is registered under that name.
    UnknownChart,
    /// A module defines a name that exists already, or an activity cannot be constructed.
    Module,
    /// Two hosts, or two agents of a host, have the same name.
    DuplicateName,
    /// There is no host of that name.
    UnknownHost,
    /// An agent has a list of activities but no frequency.
    NoFrequency,
    /// Written input cannot be used; [`Error::diagnostics`] has the details.
    Invalid,
    /// The hub rejected a topic, publisher or subscriber.
    Hub,
    /// A body failed.
    Body,
    /// The world failed.
    World,
    /// A link cannot be opened.
    Link,
    /// The system could not create a thread.
    Thread,
    /// An activity did not return within a limit.
    Stuck,
}

impl Error {
    /// An error with a message.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Error {
        Error { kind, message: message.into(), hint: None, diagnostics: Vec::new(), source: None }
    }

    /// Adds a remedy.
    pub fn with_hint(mut self, hint: impl Into<String>) -> Error {
        self.hint = Some(hint.into());
        self
    }

    /// Adds a hint with the nearest of the known names.
    pub fn with_nearest<'a>(self, wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Error {
        match yase::diagnostic::nearest(wrong, known) {
            Some(near) => self.with_hint(format!("did you mean `{near}`?")),
            None => self,
        }
    }

    /// Adds the cause.
    pub fn caused_by(mut self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Error {
        self.source = Some(source.into());
        self
    }

    /// An error of a hub.
    pub fn hub(error: narukom::Error) -> Error {
        Error::new(ErrorKind::Hub, error.to_string()).caused_by(error)
    }

    /// [`ErrorKind::Invalid`] with its diagnostics.
    pub fn invalid(diagnostics: Vec<Diagnostic>) -> Error {
        let count = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count();
        let first = diagnostics.iter().find(|diagnostic| diagnostic.is_error());
        let message = match (count, first) {
            (1, Some(first)) => first.to_string(),
            (_, Some(first)) => format!("{first}, and {} more", count - 1),
            (_, None) => "nothing usable".into(),
        };
        Error { diagnostics, ..Error::new(ErrorKind::Invalid, message) }
    }

    /// The kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// A hint for its correction, if there is one.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// Diagnostics of the written input, for [`ErrorKind::Invalid`].
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }
}

/// All values.
///
/// # Errors
/// The first error that is not [`ErrorKind::Invalid`], otherwise all diagnostics.
pub fn collect_all<T>(results: impl Iterator<Item = Result<T, Error>>) -> Result<Vec<T>, Error> {
    let mut values = Vec::new();
    let mut diagnostics = Vec::new();
    for result in results {
        match result {
            Ok(value) => values.push(value),
            Err(error) if error.kind() == ErrorKind::Invalid => {
                diagnostics.extend_from_slice(error.diagnostics())
            }
            Err(error) => return Err(error),
        }
    }
    if diagnostics.is_empty() { Ok(values) } else { Err(Error::invalid(diagnostics)) }
}
