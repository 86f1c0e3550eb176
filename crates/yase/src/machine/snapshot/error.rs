//! Why a snapshot cannot be brought back.

use std::fmt;

/// A snapshot does not fit: everything that is wrong with it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RestoreError {
    misfits: Box<[Misfit]>,
}

/// One thing that is wrong with a snapshot.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Misfit {
    kind: MisfitKind,
    field: String,
    text: String,
}

/// What kind of [`Misfit`] it is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
#[non_exhaustive]
pub enum MisfitKind {
    /// The version of the format is not one that is known.
    Version,
    /// It is of another chart.
    Chart,
    /// The chart is read in another way.
    Semantics,
    /// The chart has nothing of that name.
    Unknown,
    /// Something is there twice.
    Twice,
    /// The active nodes are no configuration of the chart.
    Configuration,
    /// Parts of it contradict each other.
    Contradiction,
}

impl RestoreError {
    /// `None` if nothing is wrong.
    pub(super) fn new(misfits: Vec<Misfit>) -> Option<RestoreError> {
        if misfits.is_empty() { None } else { Some(RestoreError { misfits: misfits.into() }) }
    }

    /// Everything that is wrong; at least one thing.
    pub fn misfits(&self) -> &[Misfit] {
        &self.misfits
    }
}

impl std::error::Error for RestoreError {}

impl fmt::Display for RestoreError {
    /// One finding a line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the snapshot does not fit")?;
        self.misfits.iter().try_for_each(|misfit| write!(f, "\n  {misfit}"))
    }
}

impl Misfit {
    pub(super) fn new(kind: MisfitKind, field: impl Into<String>, text: impl Into<String>) -> Misfit {
        Misfit { kind, field: field.into(), text: text.into() }
    }

    /// What kind of misfit it is.
    pub fn kind(&self) -> MisfitKind {
        self.kind
    }

    /// Where in the snapshot: `timers[2].timer`.
    pub fn field(&self) -> &str {
        &self.field
    }
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.text)
    }
}
