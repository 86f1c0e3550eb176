//! Findings of a verification, with the traces that lead there.

use std::fmt;

use yase::Diagnostic;

/// A finding of a verification.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Finding {
    /// The diagnostic.
    pub diagnostic: Diagnostic,
    /// A trace that leads there, in the text form of [`yase_explore::Trace::parse`], on the
    /// [abstraction](crate::explorable) of the chart.
    pub trace: Option<String>,
}

impl From<Diagnostic> for Finding {
    fn from(diagnostic: Diagnostic) -> Finding {
        Finding { diagnostic, trace: None }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.fmt(f)
    }
}
