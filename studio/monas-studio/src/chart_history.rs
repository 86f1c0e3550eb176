//! The steps of a chart on a tape.

use std::collections::BTreeMap;

use monas::records::Chart;
use prost::Message;
use yase::{NodeId, Statechart, TransitionId};

use crate::run_view::CHART_TOPIC;
use crate::tape_run::{TapeChart, TapeRun};

/// A step with its position on the tape.
#[derive(Clone, Debug)]
pub(crate) struct RecordedStep {
    /// The index of its record among the messages of the tape.
    pub(crate) index: usize,
    pub(crate) step: Chart,
    /// Whether it summarises the steps before the beginning of the tape: it enters the states that
    /// were active there, as far as later steps show.
    pub(crate) is_before: bool,
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
            let is_own = channel.topic == CHART_TOPIC
                && channel.host == chart.host
                && channel.publisher == chart.agent;
            let step = is_own.then(|| Chart::decode(self.bytes(entry)).ok()).flatten()?;
            let recorded = RecordedStep { index, step, is_before: false };
            (recorded.step.chart == chart.chart).then_some(recorded)
        };
        let mut steps: Vec<RecordedStep> = (0..self.len()).filter_map(step).collect();
        if let Some(RecordedStep { index, step, .. }) = steps.first().filter(|_| self.is_cut(chart)) {
            let entries = active_before(&chart.statechart, &steps);
            let step = Chart { chart: chart.chart, time: step.time, entries, ..Chart::default() };
            steps.insert(0, RecordedStep { index: *index, step, is_before: true });
        }
        ChartHistory { steps }
    }

    /// Whether the tape begins after the first step of the agent's charts.
    pub(crate) fn is_cut(&self, chart: &TapeChart) -> bool {
        let sequences = (0..self.len()).filter_map(|index| self.entry(index)).filter(|(_, channel)| {
            channel.topic == CHART_TOPIC && channel.host == chart.host && channel.publisher == chart.agent
        });
        sequences.map(|(entry, _)| entry.sequence).next().is_some_and(|first| first > 1)
    }

    /// The number of messages up to and with the next firing of a transition after `count`
    /// messages, or the last one before.
    pub(crate) fn firing_from(&self, count: usize, key: &str, id: u32, is_backward: bool) -> Option<usize> {
        let chart = self.charts().iter().find(|chart| chart.key().text() == key)?;
        let history = self.history(chart);
        let has_fired = |one: &&RecordedStep| one.has_fired(TransitionId(id));
        let found = match is_backward {
            false => history.since(count).iter().find(has_fired),
            true => history.until(count.saturating_sub(1)).iter().rfind(has_fired),
        };
        found.map(|one| one.index + 1)
    }
}

/// The nodes that were active before these steps: those that are left before they are entered, or
/// in which something is left or entered before.
fn active_before(chart: &Statechart, steps: &[RecordedStep]) -> Vec<u32> {
    let mut was_active = BTreeMap::new();
    let around = |node: u32| {
        let is_known = (node as usize) < chart.nodes().len();
        is_known.then(|| chart.ancestors(NodeId(node))).into_iter().flatten().map(|around| around.0)
    };
    for RecordedStep { step, .. } in steps {
        for &left in &step.exits {
            for node in std::iter::once(left).chain(around(left)) {
                was_active.entry(node).or_insert(true);
            }
        }
        for &entered in &step.entries {
            was_active.entry(entered).or_insert(false);
            for node in around(entered).filter(|node| !step.entries.contains(node)) {
                was_active.entry(node).or_insert(true);
            }
        }
    }
    was_active.into_iter().filter_map(|(node, was_active)| was_active.then_some(node)).collect()
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

    /// The nodes that were active where the tape begins, if that is after the first step.
    pub(crate) fn active_before(&self) -> Vec<NodeId> {
        let before = self.steps.first().filter(|first| first.is_before);
        before.into_iter().flat_map(|first| &first.step.entries).map(|node| NodeId(*node)).collect()
    }

    /// Whether a node is active after steps.
    pub(crate) fn is_active(steps: &[RecordedStep], node: NodeId) -> bool {
        steps.iter().rev().find_map(|RecordedStep { step, .. }| {
            let is_entered = step.entries.contains(&node.0);
            (is_entered || step.exits.contains(&node.0)).then_some(is_entered)
        }) == Some(true)
    }
}
