//! How urgent activities are.

use yase::{Chart, NodeId, TraceRecord};

/// The priority of each state's activity: the state's own, or else that of the transition that led into the state.
pub(super) struct Urgency {
    /// By node.
    of_state: Vec<i32>,
    /// By node: the priority of the segment by which it was entered last.
    of_entry: Vec<i32>,
}

impl Urgency {
    pub(super) fn new(chart: &Chart) -> Urgency {
        let of_state: Vec<i32> = chart.statechart().nodes().map(|(_, node)| node.priority).collect();
        Urgency { of_entry: vec![0; of_state.len()], of_state }
    }

    /// Takes over from a chart that this one replaces.
    pub(super) fn take_over(&mut self, old: &Urgency, counterpart: impl Fn(NodeId) -> Option<NodeId>) {
        for (node, priority) in (0..).map(NodeId).zip(&old.of_entry) {
            let place = counterpart(node).map(|node| node.0 as usize);
            if let Some(known) = place.and_then(|place| self.of_entry.get_mut(place)) {
                *known = *priority;
            }
        }
    }

    /// Takes note of a micro-step.
    pub(super) fn note(&mut self, chart: &Chart, record: &TraceRecord<'_>) {
        for node in record.entries {
            self.of_entry[node.0 as usize] = 0;
        }
        let selected = record.selected.iter().flat_map(|&compound| chart.segments(compound));
        for segment in selected.chain(record.taken) {
            let transition = chart.statechart().transition(*segment);
            self.of_entry[transition.target.0 as usize] = transition.priority;
        }
    }

    /// That of the activity of a state that is active. Higher runs first.
    pub(super) fn of(&self, node: NodeId) -> i32 {
        let place = node.0 as usize;
        match self.of_state.get(place) {
            Some(0) | None => self.of_entry.get(place).copied().unwrap_or(0),
            Some(own) => *own,
        }
    }
}
