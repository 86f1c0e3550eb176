//! Settings of checks: the environment of a chart and the limits of exploration.

use std::collections::BTreeSet;

use yase::Statechart;

use crate::program_symbols::ProgramSymbols;

/// Settings of a check.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CheckSettings {
    /// External events, raised by activities, other agents and people.
    pub events: BTreeSet<String>,
    /// Limit of explored states; 0 disables exploration.
    pub states: usize,
    /// The number of activities that the agent's pool runs at once; 12 by default.
    pub pool: Option<usize>,
    /// The program's messages, functions and activities; names are not checked without them.
    pub world: Option<ProgramSymbols>,
    /// Coverage of charts in recordings.
    pub recorded: Vec<RecordedCoverage>,
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
            states: 100_000,
            pool: None,
            world: None,
            recorded: Vec::new(),
        }
    }
}
