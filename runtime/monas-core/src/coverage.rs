//! Coverage of a chart: active states and fired transitions.

use yase::{CompiledChart, NodeKind, TraceRecord};

/// Coverage of one chart so far.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct ChartCoverage {
    /// The host it runs on.
    pub host: String,
    /// The agent it belongs to.
    pub agent: String,
    /// Its name.
    pub model: String,
    /// Its BASIC states.
    pub states: Vec<StateCoverage>,
    /// Its transitions, segment by segment.
    pub transitions: Vec<TransitionCoverage>,
}

/// The number of entries of a BASIC state.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct StateCoverage {
    /// Its path, without the root's name.
    pub path: String,
    /// The number of entries.
    pub entered: u64,
}

/// The number of times that a transition fired.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct TransitionCoverage {
    /// The paths of source and target: `a -> b`.
    pub name: String,
    /// The number of times that it fired.
    pub fired: u64,
    /// Whether its guard is the literal `false`: it never fires by intention.
    pub never: bool,
}

impl ChartCoverage {
    /// The paths of BASIC states that were never active.
    pub fn states_missed(&self) -> impl Iterator<Item = &str> {
        self.states.iter().filter(|state| state.entered == 0).map(|state| state.path.as_str())
    }

    /// The names of transitions that never fired, though they may.
    pub fn transitions_missed(&self) -> impl Iterator<Item = &str> {
        let missed = self.transitions.iter().filter(|transition| transition.fired == 0 && !transition.never);
        missed.map(|transition| transition.name.as_str())
    }

    /// Adds the coverage of another run of the same model.
    pub fn add(&mut self, other: &ChartCoverage) {
        for (state, more) in self.states.iter_mut().zip(&other.states) {
            state.entered += more.entered;
        }
        for (transition, more) in self.transitions.iter_mut().zip(&other.transitions) {
            transition.fired += more.fired;
        }
    }
}

/// Counts of entries per node and firings per segment, by index.
pub(crate) struct CoverageCounts {
    entered: Vec<u64>,
    fired: Vec<u64>,
}

impl CoverageCounts {
    pub(crate) fn new(chart: &CompiledChart) -> CoverageCounts {
        let statechart = chart.statechart();
        CoverageCounts {
            entered: vec![0; statechart.nodes().len()],
            fired: vec![0; statechart.transitions().len()],
        }
    }

    pub(crate) fn count(&mut self, chart: &CompiledChart, record: &TraceRecord<'_>) {
        record.entries.iter().for_each(|node| self.entered[node.0 as usize] += 1);
        let segments = record.selected.iter().flat_map(|&compound| chart.segments(compound));
        segments.chain(record.taken).for_each(|segment| self.fired[segment.0 as usize] += 1);
    }

    pub(crate) fn table(&self, chart: &CompiledChart, host: &str, agent: &str) -> ChartCoverage {
        let statechart = chart.statechart();
        let basic = statechart.nodes().filter(|(_, node)| node.kind == NodeKind::Basic);
        let states = basic.map(|(id, _)| StateCoverage {
            path: chart.short_path(id),
            entered: self.entered[id.0 as usize],
        });
        let transitions = statechart.transitions().map(|(id, transition)| TransitionCoverage {
            name: crate::chart_runner::transition_name(chart, id),
            fired: self.fired[id.0 as usize],
            never: transition.expression.is_never(),
        });
        ChartCoverage {
            host: host.into(),
            agent: agent.into(),
            model: statechart.name.clone(),
            states: states.collect(),
            transitions: transitions.collect(),
        }
    }
}
