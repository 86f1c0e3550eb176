//! Limits of an exploration, and what it reports to its caller on the way.

use std::ops::ControlFlow;

/// How far an exploration goes. A number stands for a limit of states alone.
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

/// How far an exploration has come.
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
    /// Events are raised faster than they are taken: waiting ones beyond a number were not kept
    /// ([`QUEUED`]).
    Queues,
}

/// So many waiting occurrences of one event are distinguished; more are taken for so many.
/// Otherwise a queue that grows without bound would make each state a new one.
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
