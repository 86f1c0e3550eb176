//! What can go wrong when agents are put together and run.

use yase::Diagnostic;

/// An agent, chart or body that cannot be put together or run.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
    hint: Option<String>,
    diagnostics: Vec<Diagnostic>,
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

/// What has gone wrong.
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
    /// A module brings what there is already, or an activity cannot be made.
    Module,
    /// Two hosts, or two agents of a host, have one name.
    DuplicateName,
    /// There is no host of that name.
    UnknownHost,
    /// An agent has activities, but nothing says how often they run.
    NoFrequency,
    /// Something people wrote cannot be used; [`Error::diagnostics`] says what.
    Invalid,
    /// A part of the hub refuses to be set up.
    Hub,
    /// A body failed.
    Body,
    /// The world failed.
    World,
    /// A link cannot be opened.
    Link,
    /// The system gave no thread.
    Thread,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Error {
        Error { kind, message: message.into(), hint: None, diagnostics: Vec::new(), source: None }
    }

    pub(crate) fn with_hint(mut self, hint: impl Into<String>) -> Error {
        self.hint = Some(hint.into());
        self
    }

    /// Says which of those that there are could be meant.
    pub(crate) fn with_nearest<'a>(self, wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Error {
        match yase::diagnostic::nearest(wrong, known) {
            Some(near) => self.with_hint(format!("did you mean `{near}`?")),
            None => self,
        }
    }

    pub(crate) fn caused_by(mut self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Error {
        self.source = Some(source.into());
        self
    }

    pub(crate) fn hub(error: narukom::Error) -> Error {
        Error::new(ErrorKind::Hub, error.to_string()).caused_by(error)
    }

    pub(crate) fn invalid(diagnostics: Vec<Diagnostic>) -> Error {
        let count = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count();
        let first = diagnostics.iter().find(|diagnostic| diagnostic.is_error());
        let message = match (count, first) {
            (1, Some(first)) => first.to_string(),
            (_, Some(first)) => format!("{first}, and {} more", count - 1),
            (_, None) => "nothing usable".into(),
        };
        Error { diagnostics, ..Error::new(ErrorKind::Invalid, message) }
    }

    /// What has gone wrong.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// What to do about it, if that can be said.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// What is wrong with the texts that people wrote, for [`ErrorKind::Invalid`].
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }
}
