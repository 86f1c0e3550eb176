//! Settings of checks: the environment of a chart and the limits of exploration.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use yase::Statechart;
use yase_explore::{ExplorationLimits, ExplorationProgress};

use crate::program_symbols::ProgramSymbols;

/// Settings of a check.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CheckSettings {
    /// External events, raised by activities, other agents and people.
    pub events: BTreeSet<String>,
    /// Limit of explored states; 0 disables exploration.
    pub states: usize,
    /// Limit of the memory of explored states, in bytes, as far as it can be estimated.
    pub bytes: usize,
    /// Follows the progress of explorations and may stop them.
    pub observer: ProgressObserver,
    /// The number of activities that the agent's pool runs at once; 12 by default.
    pub pool: Option<usize>,
    /// The program's messages, functions and activities; names are not checked without them.
    pub world: Option<ProgramSymbols>,
    /// Coverage of charts in recordings.
    pub recorded: Vec<RecordedCoverage>,
}

/// Progress of a check.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum CheckProgress {
    /// Nodes and transitions are being checked.
    Checking {
        /// The number checked so far.
        done: usize,
        /// The total number.
        of: usize,
    },
    /// States are explored.
    Exploring(ExplorationProgress),
}

/// Observes the progress of a check: called repeatedly with the progress, it may stop the check,
/// which then returns its partial result. A check reads no clock; its caller does.
#[derive(Clone)]
pub struct ProgressObserver {
    checking: Arc<dyn Fn(CheckProgress) -> ControlFlow<()> + Send + Sync>,
    exploring: Arc<dyn Fn(ExplorationProgress) -> ControlFlow<()> + Send + Sync>,
}

impl ProgressObserver {
    /// An observer that calls a function.
    pub fn new(
        observe: impl Fn(CheckProgress) -> ControlFlow<()> + Send + Sync + 'static,
    ) -> ProgressObserver {
        let checking = Arc::new(observe);
        let exploring = checking.clone();
        ProgressObserver {
            checking,
            exploring: Arc::new(move |progress| exploring(CheckProgress::Exploring(progress))),
        }
    }

    /// Whether an exploration has to stop.
    pub(crate) fn stops(&self, progress: ExplorationProgress) -> bool {
        (self.exploring)(progress).is_break()
    }
}

impl Default for ProgressObserver {
    /// An observer that never stops a check.
    fn default() -> ProgressObserver {
        ProgressObserver::new(|_| ControlFlow::Continue(()))
    }
}

/// Counts the nodes and transitions that are checked before an exploration.
pub(crate) struct CheckedParts<'a> {
    observer: &'a ProgressObserver,
    checked: Cell<usize>,
    total: usize,
    is_stopped: Cell<bool>,
}

impl<'a> CheckedParts<'a> {
    /// None yet of a number.
    pub(crate) fn new(settings: &'a CheckSettings, of: usize) -> CheckedParts<'a> {
        let (done, is_stopped) = (Cell::new(0), Cell::new(false));
        CheckedParts { observer: &settings.observer, checked: done, total: of, is_stopped }
    }

    /// Counts some parts. Whether the observer lets the check go on.
    pub(crate) fn go_on_after(&self, parts: usize) -> bool {
        let done = self.checked.get() + parts;
        self.checked.set(done);
        let progress = CheckProgress::Checking { done, of: self.total };
        let is_stopped = self.is_stopped.get() || (self.observer.checking)(progress).is_break();
        self.is_stopped.set(is_stopped);
        !is_stopped
    }

    /// Whether the observer has stopped the check.
    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped.get()
    }
}

impl fmt::Debug for ProgressObserver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ProgressObserver")
    }
}

impl CheckSettings {
    /// The limits of an exploration.
    pub(crate) fn limits(&self) -> ExplorationLimits<'_> {
        ExplorationLimits { states: self.states, bytes: self.bytes, observe: &*self.observer.exploring }
    }
}

/// Coverage of a chart in recorded runs.
#[derive(Clone, Debug)]
pub struct RecordedCoverage {
    /// The chart.
    pub chart: Statechart,
    /// The nodes that were entered at least once.
    pub entered: BTreeSet<yase::NodeId>,
    /// The transitions that fired at least once.
    pub fired: BTreeSet<yase::TransitionId>,
}

impl Default for CheckSettings {
    fn default() -> CheckSettings {
        CheckSettings {
            events: BTreeSet::new(),
            states: 300_000,
            bytes: 1 << 30,
            observer: ProgressObserver::default(),
            pool: None,
            world: None,
            recorded: Vec::new(),
        }
    }
}
