//! The steps of a chart on a tape.

use monas::records::Chart;
use prost::Message;
use yase::{NodeId, TransitionId};

use crate::run_view::CHART;
use crate::tape_run::{TapeChart, TapeRun};

/// A step with its position on the tape.
#[derive(Clone, Debug)]
pub(crate) struct RecordedStep {
    /// The index of its record among the messages of the tape.
    pub(crate) index: usize,
    pub(crate) step: Chart,
}

impl RecordedStep {
    /// The segments that fired, in order.
    pub(crate) fn fired(&self) -> impl Iterator<Item = TransitionId> {
        self.step.selected.iter().chain(&self.step.taken).map(|segment| TransitionId(*segment))
    }

    pub(crate) fn has_fired(&self, segment: TransitionId) -> bool {
        self.fired().any(|fired| fired == segment)
    }
}

/// All steps of a chart, in order.
pub(crate) struct ChartHistory {
    pub(crate) steps: Vec<RecordedStep>,
}

impl TapeRun {
    pub(crate) fn history(&self, chart: &TapeChart) -> ChartHistory {
        let step = |index: usize| {
            let (entry, channel) = self.entry(index)?;
            let is_own =
                channel.topic == CHART && channel.host == chart.host && channel.publisher == chart.agent;
            let step = is_own.then(|| Chart::decode(self.bytes(entry)).ok()).flatten()?;
            (step.chart == chart.chart).then_some(RecordedStep { index, step })
        };
        ChartHistory { steps: (0..self.len()).filter_map(step).collect() }
    }

    /// The number of messages up to and with the next firing of a transition after `count`
    /// messages, or the last one before.
    pub(crate) fn firing_from(&self, count: usize, key: &str, id: u32, is_back: bool) -> Option<usize> {
        let chart = self.charts().iter().find(|chart| chart.key().text() == key)?;
        let history = self.history(chart);
        let has_fired = |one: &&RecordedStep| one.has_fired(TransitionId(id));
        let found = match is_back {
            false => history.since(count).iter().find(has_fired),
            true => history.until(count.saturating_sub(1)).iter().rfind(has_fired),
        };
        found.map(|one| one.index + 1)
    }
}

impl ChartHistory {
    /// The steps among the first `count` messages of the tape.
    pub(crate) fn until(&self, count: usize) -> &[RecordedStep] {
        &self.steps[..self.steps.partition_point(|step| step.index < count)]
    }

    /// The steps from the first `count` messages on.
    pub(crate) fn since(&self, count: usize) -> &[RecordedStep] {
        &self.steps[self.until(count).len()..]
    }

    /// Whether a node is active after steps.
    pub(crate) fn is_active(steps: &[RecordedStep], node: NodeId) -> bool {
        steps.iter().rev().find_map(|RecordedStep { step, .. }| {
            let is_entered = step.entries.contains(&node.0);
            (is_entered || step.exits.contains(&node.0)).then_some(is_entered)
        }) == Some(true)
    }
}
