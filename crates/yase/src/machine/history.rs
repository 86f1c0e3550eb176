//! What HISTORYs remember.

use crate::chart::{Chart, History, Place};
use crate::host::Host;
use crate::machine::errors::Fault;
use crate::machine::run::Run;
use crate::machine::step::Step;
use crate::statechart::NodeKind;

/// What was active in a composite when it was left last.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    /// Whether there is one.
    pub(super) is_known: bool,
    /// Of a shallow one the child, of a deep one all that was active inside.
    pub(super) places: Vec<Place>,
}

impl Run {
    /// Notes what is active in the composites between two places that are about to be left.
    pub(super) fn record_histories(&mut self, chart: &Chart, first: Place, last: Place) {
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

    fn record(&mut self, chart: &Chart, number: usize, history: &History) {
        let (first, last) =
            (chart.layout.first(history.owner).index(), history.owner.index().saturating_sub(1));
        let record = &mut self.records[number];
        record.places.clear();
        if history.is_deep {
            let mut next = self.active.next(first, last);
            while let Some(index) = next {
                record.places.push(Place(index as u32));
                next = self.active.next(index + 1, last);
            }
        } else if chart.states[history.owner.index()].kind == NodeKind::Or {
            // the child is the last of what is active in an OR
            record.places.extend(self.active.last(first, last).map(|index| Place(index as u32)));
        }
        let is_and = chart.states[history.owner.index()].kind == NodeKind::And;
        record.is_known = is_and || !record.places.is_empty();
    }
}

impl<H: Host> Step<'_, H> {
    /// Where HISTORYs of a composite are marked, marks what they stand for instead.
    pub(super) fn resolve_histories(&mut self, owner: Place) -> Result<(), Fault> {
        let numbers = self.chart.states[owner.index()].histories.clone();
        while let Some(number) = self.marked_history(numbers.clone()) {
            let history = &self.chart.histories[number];
            self.run.marked.remove(history.place.index());
            if !self.run.records[number].is_known {
                self.follow(history.branches, owner)?;
                continue;
            }
            let run = &mut *self.run;
            run.records[number].places.iter().for_each(|place| run.marked.insert(place.index()));
        }
        Ok(())
    }

    fn marked_history(&self, mut numbers: std::ops::Range<usize>) -> Option<usize> {
        numbers.find(|&number| self.run.marked.contains(self.chart.histories[number].place.index()))
    }
}
