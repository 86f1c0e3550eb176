//! The errors of restoring a snapshot.

use std::fmt;

/// A snapshot does not fit: the list of all mismatches.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RestoreError {
    issues: Box<[RestoreIssue]>,
}

/// One mismatch of a snapshot.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RestoreIssue {
    kind: RestoreIssueKind,
    field: String,
    text: String,
}

/// The kind of a [`RestoreIssue`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
#[non_exhaustive]
pub enum RestoreIssueKind {
    /// The version of the format is unknown.
    Version,
    /// The snapshot was taken of another chart.
    Chart,
    /// The chart has another semantics.
    Semantics,
    /// The chart has no item of that name.
    Unknown,
    /// An item occurs twice.
    Twice,
    /// The active nodes are not a configuration of the chart.
    Configuration,
    /// Parts of the snapshot contradict each other.
    Contradiction,
}

impl RestoreError {
    /// `None` if there is no issue.
    pub(crate) fn new(misfits: Vec<RestoreIssue>) -> Option<RestoreError> {
        if misfits.is_empty() { None } else { Some(RestoreError { issues: misfits.into() }) }
    }

    /// All issues; at least one.
    pub fn issues(&self) -> &[RestoreIssue] {
        &self.issues
    }
}

impl std::error::Error for RestoreError {}

impl fmt::Display for RestoreError {
    /// One issue per line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the snapshot does not fit")?;
        self.issues.iter().try_for_each(|misfit| write!(f, "\n  {misfit}"))
    }
}

impl RestoreIssue {
    pub(crate) fn new(
        kind: RestoreIssueKind,
        field: impl Into<String>,
        text: impl Into<String>,
    ) -> RestoreIssue {
        RestoreIssue { kind, field: field.into(), text: text.into() }
    }

    /// The kind of the issue.
    pub fn kind(&self) -> RestoreIssueKind {
        self.kind
    }

    /// The field of the snapshot: `timers[2].timer`.
    pub fn field(&self) -> &str {
        &self.field
    }
}

impl fmt::Display for RestoreIssue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.text)
    }
}
