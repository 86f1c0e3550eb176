//! The completion of states, and its consequences.

use crate::compile::{Arrival, CompiledChart, NodeIndex};
use crate::machine::activities::InvocationPhase;
use crate::machine::machine_state::MachineState;
use crate::semantics::CompletionTrigger;
use crate::statechart::NodeKind;

impl MachineState {
    /// Whether an active state has completed.
    #[inline]
    pub(crate) fn is_complete(&self, chart: &CompiledChart, node: NodeIndex) -> bool {
        let state = &chart.states[node.index()];
        if state
            .activity
            .is_some_and(|activity| self.activities.slot(activity).phase != InvocationPhase::Done)
        {
            return false;
        }
        if self.vacated.contains(node.index()) {
            return true;
        }
        match state.kind {
            NodeKind::And => {
                state.parts.iter().all(|&region| self.is_active(region) && self.is_complete(chart, region))
            }
            NodeKind::Or => state.parts.iter().any(|&end| self.is_active(end)),
            _ => true,
        }
    }

    /// Whether all enclosing composites have reached an END, as the completion event of an AND
    /// requires.
    fn has_ended(&self, chart: &CompiledChart, node: NodeIndex) -> bool {
        let state = &chart.states[node.index()];
        match state.kind {
            NodeKind::And => state.parts.iter().all(|&region| self.has_ended(chart, region)),
            _ => self.vacated.contains(node.index()) || state.parts.iter().any(|&end| self.is_active(end)),
        }
    }

    /// Processes the entry of an END other than the root's.
    pub(crate) fn end_reached(&mut self, chart: &CompiledChart, node: NodeIndex) {
        let Some(composite) = chart.states[node.index()].parent else { return };
        if chart.semantics_ref().completion_events {
            self.raise_done(chart, composite);
        }
        self.completed(chart, composite);
    }

    /// Raises the completion event of a composite, and those of the ANDs that are complete with it.
    fn raise_done(&mut self, chart: &CompiledChart, composite: NodeIndex) {
        let mut next = Some(composite);
        while let Some(node) = next {
            if let Some(event) = chart.states[node.index()].done {
                self.raise(chart, event, true, 0);
            }
            next = chart.states[node.index()].parent.filter(|&parent| {
                chart.states[parent.index()].kind == NodeKind::And && self.has_ended(chart, parent)
            });
        }
    }

    /// Records that a state has completed: where completion is examined once, it is examined next,
    /// with the ANDs that are complete with it.
    #[inline]
    pub(crate) fn completed(&mut self, chart: &CompiledChart, node: NodeIndex) {
        self.completed_from(chart, Some(node));
    }

    #[inline]
    fn completed_from(&mut self, chart: &CompiledChart, first: Option<NodeIndex>) {
        if chart.semantics_ref().eventless != CompletionTrigger::Once {
            return;
        }
        let mut next = first;
        while let Some(node) = next {
            if !self.completions.contains(&node) {
                self.completions.push_back(node);
            }
            next = self.complete_and(chart, node);
        }
    }

    /// The AND that contains a region, if it has completed.
    fn complete_and(&self, chart: &CompiledChart, region: NodeIndex) -> Option<NodeIndex> {
        let parent = chart.states[region.index()].parent?;
        let is_and = chart.states[parent.index()].kind == NodeKind::And;
        (is_and && self.is_complete(chart, parent)).then_some(parent)
    }

    /// Discards the pending completion of a state that was left.
    #[inline]
    pub(crate) fn forget_completion(&mut self, chart: &CompiledChart, node: NodeIndex) {
        self.vacated.remove(node.index());
        if !self.completions.is_empty() {
            self.completions.retain(|&completed| completed != node);
        }
        if !chart.joins.is_empty() {
            self.forget_arrivals_of(chart, node);
        }
    }

    /// Records that a composite remains without an active child, and counts as complete. For a
    /// region that has arrived at a JOIN this is already known: only the AND around it may become
    /// complete.
    pub(crate) fn mark_vacated(&mut self, chart: &CompiledChart, node: NodeIndex, has_arrived: bool) {
        self.vacated.insert(node.index());
        self.active_leaves.insert(node.index());
        self.completed_from(chart, if has_arrived { self.complete_and(chart, node) } else { Some(node) });
    }

    /// A child of a composite is entered.
    #[inline]
    pub(crate) fn mark_occupied(&mut self, chart: &CompiledChart, composite: Option<NodeIndex>) {
        let Some(node) = composite.filter(|index| self.vacated.contains(index.index())) else { return };
        self.vacated.remove(node.index());
        self.active_leaves.remove(node.index());
        self.forget_arrivals_of(chart, node);
    }

    /// A region that is left, by itself or with its AND, or gets a child again, no longer counts as
    /// arrived at a JOIN.
    fn forget_arrivals_of(&mut self, chart: &CompiledChart, region: NodeIndex) {
        for join in &chart.joins {
            for (slot, _) in join.slots().zip(&join.regions).filter(|(_, other)| **other == region) {
                self.arrived.remove(slot);
            }
        }
    }

    /// Records that a region has arrived where others do.
    #[inline]
    pub(crate) fn arrive(&mut self, chart: &CompiledChart, arrival: Arrival) {
        let joined = chart.joins.iter().find(|join| join.slots().contains(&arrival.slot));
        // in phases another transition may have left the AND before
        if joined.is_some_and(|join| self.is_active(join.around)) {
            self.arrived.insert(arrival.slot);
        }
    }
}
