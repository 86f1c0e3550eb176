//! Findings about a change.

use yase::Diagnostic;

use monas_core::error::{Error, ErrorKind};
use monas_core::records::Finding;

/// The diagnostics of a refused change.
pub(crate) type ChangeRefusal = Vec<Diagnostic>;

/// One reason without a location in a text.
pub(crate) fn refusal(code: &'static str, message: impl Into<String>) -> ChangeRefusal {
    vec![Diagnostic::error(code, 0..0, message)]
}

/// One reason with a hint.
pub(crate) fn refusal_with(
    code: &'static str,
    message: impl Into<String>,
    hint: impl Into<String>,
) -> ChangeRefusal {
    vec![Diagnostic::error(code, 0..0, message).with_hint(hint)]
}

/// An unknown name, with the known name that is most similar.
pub(crate) fn unknown<'a>(
    code: &'static str,
    message: impl Into<String>,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> ChangeRefusal {
    let known: Vec<&str> = known.into_iter().collect();
    let diagnostic = Diagnostic::error(code, 0..0, message).with_nearest(name, known.iter().copied());
    vec![match (&diagnostic.hint, known.is_empty()) {
        (None, false) => diagnostic.with_hint(format!("there are {}", known.join(", "))),
        _ => diagnostic,
    }]
}

/// The diagnostics of a construction error.
pub(crate) fn build_refusal(code: &'static str, error: &Error) -> ChangeRefusal {
    match (error.kind(), error.hint()) {
        (ErrorKind::Invalid, _) => error.diagnostics().to_vec(),
        (_, Some(hint)) => refusal_with(code, error.to_string(), hint),
        (_, None) => refusal(code, error.to_string()),
    }
}

/// A diagnostic as a message.
pub(crate) fn finding(diagnostic: &Diagnostic) -> Finding {
    let (line, column) = diagnostic.position().unwrap_or_default();
    let number = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    Finding {
        code: diagnostic.code.into(),
        is_error: diagnostic.is_error(),
        message: diagnostic.message.clone(),
        hint: diagnostic.hint.clone().unwrap_or_default(),
        file: diagnostic.source.as_ref().map(|source| source.name.clone()).unwrap_or_default(),
        line: number(line),
        column: number(column),
    }
}

/// A note on a change that was applied.
pub(crate) fn note(message: String) -> Finding {
    Finding { message, ..Finding::default() }
}
