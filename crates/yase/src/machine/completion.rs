//! Which states have completed, and what follows from that.

use crate::chart::{Chart, Compound, Place};
use crate::machine::activities::Phase;
use crate::machine::run::Run;
use crate::semantics::Eventless;
use crate::statechart::NodeKind;

impl Run {
    /// Whether an active state has completed.
    pub(super) fn is_complete(&self, chart: &Chart, place: Place) -> bool {
        let state = &chart.states[place.index()];
        if self.vacated.contains(place.index()) {
            return true;
        }
        match state.kind {
            NodeKind::And => {
                state.parts.iter().all(|&region| self.is_active(region) && self.is_complete(chart, region))
            }
            NodeKind::Or => state.parts.iter().any(|&end| self.is_active(end)),
            _ => state.activity.is_none_or(|activity| self.activities.slot(activity).phase == Phase::Done),
        }
    }

    /// Whether all that is around has reached an END, as the event of an AND's completion asks for.
    fn has_ended(&self, chart: &Chart, place: Place) -> bool {
        let state = &chart.states[place.index()];
        match state.kind {
            NodeKind::And => state.parts.iter().all(|&region| self.has_ended(chart, region)),
            _ => self.vacated.contains(place.index()) || state.parts.iter().any(|&end| self.is_active(end)),
        }
    }

    /// An END was entered, which is not the root's.
    pub(super) fn end_reached(&mut self, chart: &Chart, place: Place) {
        let Some(composite) = chart.states[place.index()].parent else { return };
        if chart.semantics_ref().completion_events {
            self.raise_done(chart, composite);
        }
        self.completed(chart, composite);
    }

    /// The event of a composite's completion, and those of the ANDs that are complete with it.
    fn raise_done(&mut self, chart: &Chart, composite: Place) {
        let mut next = Some(composite);
        while let Some(place) = next {
            if let Some(event) = chart.states[place.index()].done {
                self.raise(chart, event, true, 0);
            }
            next = chart.states[place.index()].parent.filter(|&parent| {
                chart.states[parent.index()].kind == NodeKind::And && self.has_ended(chart, parent)
            });
        }
    }

    /// A state has completed: where that is looked at once, it is looked at next, and so are the ANDs that are complete with it.
    pub(super) fn completed(&mut self, chart: &Chart, place: Place) {
        self.completed_from(chart, Some(place));
    }

    fn completed_from(&mut self, chart: &Chart, first: Option<Place>) {
        if chart.semantics_ref().eventless != Eventless::Once {
            return;
        }
        let mut next = first;
        while let Some(place) = next {
            if !self.completions.contains(&place) {
                self.completions.push_back(place);
            }
            next = self.complete_and(chart, place);
        }
    }

    /// The AND around a region, if it has completed.
    fn complete_and(&self, chart: &Chart, region: Place) -> Option<Place> {
        let parent = chart.states[region.index()].parent?;
        let is_and = chart.states[parent.index()].kind == NodeKind::And;
        (is_and && self.is_complete(chart, parent)).then_some(parent)
    }

    /// A state was left: whatever was to come of its completion is of no more interest.
    pub(super) fn forget_completion(&mut self, chart: &Chart, place: Place) {
        self.vacated.remove(place.index());
        if !self.completions.is_empty() {
            self.completions.retain(|&completed| completed != place);
        }
        if !chart.joins.is_empty() {
            self.forget_arrivals_of(chart, place);
        }
    }

    /// A composite stays without an active child, and counts as complete. For a region that has arrived at a JOIN that is no news: only
    /// the AND around it may be complete by that.
    pub(super) fn vacate(&mut self, chart: &Chart, place: Place, has_arrived: bool) {
        self.vacated.insert(place.index());
        self.tips.insert(place.index());
        self.completed_from(chart, if has_arrived { self.complete_and(chart, place) } else { Some(place) });
    }

    /// A child of a composite is entered.
    pub(super) fn occupy(&mut self, chart: &Chart, composite: Option<Place>) {
        let Some(place) = composite.filter(|place| self.vacated.contains(place.index())) else { return };
        self.vacated.remove(place.index());
        self.tips.remove(place.index());
        self.forget_arrivals_of(chart, place);
    }

    /// A region that is left, by itself or with its AND, or gets a child again, has not arrived at a JOIN any more.
    fn forget_arrivals_of(&mut self, chart: &Chart, region: Place) {
        for join in &chart.joins {
            for (slot, _) in join.slots().zip(&join.regions).filter(|(_, other)| **other == region) {
                self.arrived.remove(slot);
            }
        }
    }

    /// A segment into a JOIN has been taken by itself. When all have, the way out of it is looked at.
    pub(super) fn arrive_at_join(&mut self, chart: &Chart, compound: &Compound) {
        let Some(slot) = compound.arrives else { return };
        let joined = chart.joins.iter().find(|join| join.slots().contains(&slot));
        // in phases another may have left the AND before
        let Some(join) = joined.filter(|join| self.is_active(join.around)) else { return };
        self.arrived.insert(slot);
        if join.slots().all(|slot| self.arrived.contains(slot))
            && chart.semantics_ref().eventless == Eventless::Once
            && !self.completions.contains(&join.around)
        {
            self.completions.push_back(join.around);
        }
    }
}
