//! Limits of an exploration, and its progress reports.

use std::ops::ControlFlow;

/// Limits of an exploration. A number converts to a limit of states only.
#[derive(Clone, Copy)]
pub struct ExplorationLimits<'a> {
    /// The largest number of states.
    pub states: usize,
    /// The largest amount of memory for states and steps, in bytes, as far as it can be estimated.
    pub bytes: usize,
    /// Called for each state that is expanded, with how far the exploration has come; it may stop
    /// it. An exploration reads no clock: the caller does.
    pub observe: &'a (dyn Fn(ExplorationProgress) -> ControlFlow<()> + 'a),
}

/// Progress of an exploration.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ExplorationProgress {
    /// The number of states found.
    pub states: usize,
    /// The number of states that were found and have not been expanded.
    pub open: usize,
    /// The estimated memory, in bytes.
    pub bytes: usize,
}

/// Why an exploration is incomplete.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ExplorationStop {
    /// There are more states than the limit.
    States,
    /// The states take more memory than the limit.
    Bytes,
    /// The observer has stopped it.
    Observer,
    /// A step has more alternatives than are tried.
    Alternatives,
    /// Events are raised faster than they are consumed: more than [`QUEUED`] waiting ones were
    /// discarded.
    Queues,
}

/// The largest number of waiting occurrences of one event that is distinguished; larger numbers are
/// treated as this one. Otherwise a queue that grows without bound would make each state new.
pub const QUEUED: usize = 3;

impl From<usize> for ExplorationLimits<'static> {
    fn from(states: usize) -> ExplorationLimits<'static> {
        ExplorationLimits { states, bytes: usize::MAX, observe: &|_| ControlFlow::Continue(()) }
    }
}

impl ExplorationLimits<'_> {
    /// Whether the exploration has to end here.
    pub(crate) fn stop(&self, progress: ExplorationProgress) -> Option<ExplorationStop> {
        if progress.bytes > self.bytes {
            return Some(ExplorationStop::Bytes);
        }
        (self.observe)(progress).is_break().then_some(ExplorationStop::Observer)
    }
}
