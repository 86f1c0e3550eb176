//! The values of HISTORYs.

use crate::compile::{CompiledChart, HistoryNode, NodeIndex};
use crate::host::Host;
use crate::machine::errors::StepError;
use crate::machine::machine_state::MachineState;
use crate::machine::step::Macrostep;
use crate::semantics::Firing;
use crate::statechart::NodeKind;

/// The nodes that were active in a composite when it was left last.
#[derive(Clone, Debug, Default)]
pub(crate) struct HistoryValue {
    /// Whether there is a value.
    pub(crate) is_known: bool,
    /// For a shallow one the child, for a deep one all nodes that were active inside.
    pub(crate) nodes: Vec<NodeIndex>,
}

impl MachineState {
    /// Records the active nodes of the composites between two indices before they are left.
    #[inline]
    pub(crate) fn record_histories(&mut self, chart: &CompiledChart, first: NodeIndex, last: NodeIndex) {
        let from = chart.histories.partition_point(|history| history.owner < first);
        for (number, history) in chart.histories.iter().enumerate().skip(from) {
            if history.owner > last {
                return;
            }
            if self.is_active(history.owner) {
                self.record(chart, number, history);
            }
        }
    }

    fn record(&mut self, chart: &CompiledChart, number: usize, history: &HistoryNode) {
        let (first, last) =
            (chart.layout.first(history.owner).index(), history.owner.index().saturating_sub(1));
        // an exit point has emptied it before it is left: that was recorded
        let is_empty = first > last || !self.active.any_in(first, last);
        if is_empty && !self.vacated.contains(history.owner.index()) {
            return;
        }
        let record = &mut self.records[number];
        record.nodes.clear();
        if history.is_deep {
            let mut next = self.active.next(first, last);
            while let Some(index) = next {
                record.nodes.push(NodeIndex(index as u32));
                next = self.active.next(index + 1, last);
            }
        } else if chart.states[history.owner.index()].kind == NodeKind::Or {
            // the child has the highest index among the active nodes inside an OR
            record.nodes.extend(self.active.last(first, last).map(|index| NodeIndex(index as u32)));
        }
        let is_and = chart.states[history.owner.index()].kind == NodeKind::And;
        record.is_known = is_and || !record.nodes.is_empty();
    }
}

impl<H: Host> Macrostep<'_, H> {
    /// Replaces the marks on the HISTORYs of a composite by marks on their values, or takes the
    /// path out of one without a value. Returns whether there were marks.
    pub(crate) fn resolve_histories(&mut self, owner: NodeIndex) -> Result<bool, StepError> {
        let mut is_marked = false;
        let numbers = self.chart.states[owner.index()].histories.clone();
        while let Some(number) = self.marked_history(numbers.clone()) {
            let history = &self.chart.histories[number];
            is_marked = true;
            self.run.marked.remove(history.node.index());
            if !self.run.records[number].is_known {
                match self.semantics().firing {
                    Firing::EachSegment => self.follow_segments(history.branches, true)?,
                    _ => self.follow(history.branches, owner)?,
                };
                continue;
            }
            let run = &mut *self.run;
            run.records[number].nodes.iter().for_each(|node| run.marked.insert(node.index()));
        }
        Ok(is_marked)
    }

    fn marked_history(&self, mut numbers: std::ops::Range<usize>) -> Option<usize> {
        numbers.find(|&number| self.run.marked.contains(self.chart.histories[number].node.index()))
    }
}
