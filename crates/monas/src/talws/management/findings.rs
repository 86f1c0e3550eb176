//! What there is to say of a change.

use yase::Diagnostic;

use crate::error::{Error, ErrorKind};
use crate::records::Finding;

/// Why a change is refused.
pub(super) type Refusal = Vec<Diagnostic>;

/// One reason, which is about no text.
pub(super) fn refusal(code: &'static str, message: impl Into<String>) -> Refusal {
    vec![Diagnostic::error(code, 0..0, message)]
}

/// One reason, and what would be right.
pub(super) fn refusal_with(
    code: &'static str,
    message: impl Into<String>,
    hint: impl Into<String>,
) -> Refusal {
    vec![Diagnostic::error(code, 0..0, message).with_hint(hint)]
}

/// A name that nobody has, and the one that may be meant.
pub(super) fn unknown<'a>(
    code: &'static str,
    message: impl Into<String>,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Refusal {
    let known: Vec<&str> = known.into_iter().collect();
    let diagnostic = Diagnostic::error(code, 0..0, message).with_nearest(name, known.iter().copied());
    vec![match (&diagnostic.hint, known.is_empty()) {
        (None, false) => diagnostic.with_hint(format!("there are {}", known.join(", "))),
        _ => diagnostic,
    }]
}

/// What cannot be put together.
pub(super) fn unusable(code: &'static str, error: &Error) -> Refusal {
    match (error.kind(), error.hint()) {
        (ErrorKind::Invalid, _) => error.diagnostics().to_vec(),
        (_, Some(hint)) => refusal_with(code, error.to_string(), hint),
        (_, None) => refusal(code, error.to_string()),
    }
}

/// As it is published.
pub(super) fn finding(diagnostic: &Diagnostic) -> Finding {
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

/// What is said of a change that was made.
pub(super) fn remark(message: String) -> Finding {
    Finding { message, ..Finding::default() }
}
