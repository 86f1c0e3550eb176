//! Which transitions are enabled, and which of them win.

use crate::chart::{Branch, Compound, CompoundId, Condition, Place, ScopedGuard, Trigger};
use crate::host::{Host, Report};
use crate::machine::activities::Phase;
use crate::machine::queues::Occurrence;
use crate::machine::run::{ErredGuard, Pending};
use crate::machine::step::Step;
use crate::machine::view::View;
use crate::semantics::{Eventless, FailureEvents};
use crate::trace::Occasion;

impl<H: Host> Step<'_, H> {
    /// Finds the candidates for an event or, without one, for a step without.
    ///
    /// Places are visited children before parents. A state is looked at if from some active leaf inside it, outward, no transition has been
    /// found yet: inner ones win.
    pub(super) fn select(&mut self, occurrence: Option<&Occurrence>) {
        self.run.log.clear();
        self.run.selection.clear();
        let (masks, last) = (&self.chart.masks, self.chart.layout.len());
        let sources = if occurrence.is_some() { &masks.triggered } else { &masks.eventless };
        let mut next = self.run.active.next_common(sources, 0, last);
        while let Some(index) = next {
            self.consider(Place(index as u32), occurrence);
            next = self.run.active.next_common(sources, index + 1, last);
        }
        if !self.run.selection.candidates.is_empty() {
            self.run.selection.held.clear();
        }
    }

    fn consider(&mut self, place: Place, occurrence: Option<&Occurrence>) {
        if occurrence.is_none() && self.is_frozen(place) || !self.is_open(place) {
            return;
        }
        if let Some(compound) = self.best(place, occurrence) {
            self.run.selection.candidates.push(compound);
            self.close(place);
        }
    }

    /// Whether it is about to be left, by an interrupting transition or for a held event: then nothing of it happens without an event.
    pub(super) fn is_frozen(&self, place: Place) -> bool {
        let leaves = |compound: CompoundId| self.compound(compound).leaves(place);
        self.run.is_being_left(self.chart, place)
            || self.run.queues.held.iter().any(|held| held.compounds.iter().copied().any(leaves))
    }

    /// Whether some active leaf inside has no candidate yet.
    fn is_open(&self, place: Place) -> bool {
        let first = self.chart.layout.first(place).index();
        let selection = &self.run.selection;
        selection.candidates.is_empty()
            || self
                .run
                .active
                .next_common_without(&self.chart.masks.leaves, &selection.closed, first, place.index())
                .is_some()
    }

    fn close(&mut self, place: Place) {
        let first = self.chart.layout.first(place).index();
        let run = &mut *self.run;
        let mut next = run.active.next_common(&self.chart.masks.leaves, first, place.index());
        while let Some(index) = next {
            run.selection.closed.insert(index);
            next = run.active.next_common(&self.chart.masks.leaves, index + 1, place.index());
        }
    }

    /// The first complete way out of a state whose segments are all allowed and which no running activity forbids.
    fn best(&mut self, place: Place, occurrence: Option<&Occurrence>) -> Option<CompoundId> {
        let chart = self.chart;
        let state = &chart.states[place.index()];
        let branches = if occurrence.is_some() { state.triggered } else { state.eventless };
        let mut index = branches.start;
        while index < branches.end {
            let branch = &chart.branches[index];
            if !self.meets(branch, place, occurrence) || !branch.guard.is_none_or(|guard| self.holds(guard)) {
                index = branch.skip;
                continue;
            }
            if let Some(id) = branch.compound {
                if !self.is_blocked(self.compound(id), place) {
                    return Some(id);
                }
                if occurrence.is_some() {
                    self.note_blocked(id, place);
                }
            }
            index += 1;
        }
        None
    }

    fn meets(&self, branch: &Branch, place: Place, occurrence: Option<&Occurrence>) -> bool {
        match (branch.condition, occurrence) {
            (Condition::None, _) => true,
            (Condition::Trigger(trigger), Some(occurrence)) => {
                matches(&self.chart.triggers[trigger], occurrence)
            }
            (Condition::Completed, None) if self.semantics().eventless == Eventless::AsWritten => {
                self.run.is_complete(self.chart, place)
            }
            (Condition::Completed | Condition::Quiescent, None) => {
                !self.runs_inside(place) && !self.can_step_inside(place)
            }
            (Condition::NoStepInside, None) => !self.can_step_inside(place),
            _ => false,
        }
    }

    fn runs_inside(&self, place: Place) -> bool {
        self.run.running.any_in(self.chart.layout.first(place).index(), place.index())
    }

    /// Candidates from inside, if any, are the latest.
    fn can_step_inside(&self, place: Place) -> bool {
        let first = self.chart.layout.first(place);
        self.run.selection.candidates.last().is_some_and(|&last| self.compound(last).source >= first)
    }

    /// Reads a guard. One without a value counts as false and raises an error event, once until it has succeeded or what it reads has
    /// changed.
    fn holds(&mut self, guard: usize) -> bool {
        let ScopedGuard { transition, region, guard: program } = &self.chart.guards[guard];
        let view = View { chart: self.chart, run: self.run, host: self.host, region: *region };
        let result = program.evaluate(&view);
        // The word `false` reads nothing.
        if self.run.log.wanted && !program.is_literally_false() {
            self.run.log.guards.push((*transition, result.as_ref().ok().copied()));
        }
        match result {
            Ok(value) => {
                self.run.erred.retain(|erred| erred.guard != guard);
                value
            }
            Err(error) => {
                let every_time = self.semantics().failures == FailureEvents::EveryTime;
                if every_time || !self.run.erred.iter().any(|erred| erred.guard == guard) {
                    if !every_time {
                        self.run.erred.push(ErredGuard { guard, stale: false });
                    }
                    self.run.raise(self.chart, self.chart.errors.guard, true, 0);
                    self.host
                        .report(self.chart, Report::GuardFailed { transition: *transition, error: &error });
                }
                false
            }
        }
    }

    /// Whether running activities forbid a transition: one in its own region, or one in a state it would leave. An interrupting one is
    /// forbidden only by another that is already waiting.
    fn is_blocked(&self, compound: &Compound, place: Place) -> bool {
        if self.run.is_being_left(self.chart, place) {
            return true;
        }
        let region = self.chart.states[place.index()].region;
        !compound.interrupts
            && (self.run.running_regions.contains(region.index()) || self.leaves_running(compound))
    }

    pub(super) fn leaves_running(&self, compound: &Compound) -> bool {
        compound.exits.is_some_and(|(first, last)| self.run.running.any_in(first.index(), last.index()))
    }

    /// Of the transitions that wait for activities the innermost counts, as it does of those that can fire.
    fn note_blocked(&mut self, compound: CompoundId, place: Place) {
        let first = self.chart.layout.first(place).index();
        let (run, leaves) = (&mut *self.run, &self.chart.masks.leaves);
        let mut is_new = false;
        let mut next = run.active.next_common_without(leaves, &run.selection.noted, first, place.index());
        while let Some(index) = next {
            is_new = true;
            run.selection.noted.insert(index);
            next = run.active.next_common_without(leaves, &run.selection.noted, index + 1, place.index());
        }
        if is_new {
            run.selection.has_noted = true;
            run.selection.held.push(compound);
        }
    }

    /// Lets the winners among the candidates be selected. Candidates come inner before outer, then in the order of the document, which
    /// is the order of precedence.
    pub(super) fn resolve(&mut self) {
        let (chart, selection) = (self.chart, &mut self.run.selection);
        let compound = |id: CompoundId| &chart.compounds[id.0 as usize];
        for &candidate in &selection.candidates {
            let loses =
                selection.selected.iter().any(|&other| compound(other).conflicts_with(compound(candidate)));
            if loses { &mut selection.preempted } else { &mut selection.selected }.push(candidate);
        }
        if selection.selected.len() > 1 {
            selection.selected.sort_unstable_by_key(|&id| compound(id).key);
        }
    }

    /// Sets selected transitions aside that would leave running activities, and asks those to return.
    pub(super) fn suspend_interrupting(&mut self, occasion: Occasion) {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            let compound = self.compound(id);
            if !self.leaves_running(compound) {
                index += 1;
                continue;
            }
            self.run.selection.selected.remove(index);
            self.run.selection.held.push(id);
            let event = match occasion {
                Occasion::Event(event) => Some(event),
                _ => None,
            };
            self.run.pending.push(Pending { compound: id, event });
            if let Some((first, last)) = self.compound(id).exits {
                self.cancel_between(first, last);
            }
        }
    }

    fn cancel_between(&mut self, first: Place, last: Place) {
        let mut next = self.run.running.next(first.index(), last.index());
        while let Some(index) = next {
            self.cancel(Place(index as u32));
            next = self.run.running.next(index + 1, last.index());
        }
    }

    /// One that has been queued but not started is asked as soon as it has been.
    fn cancel(&mut self, place: Place) {
        let Some(activity) = self.chart.states[place.index()].activity else { return };
        let slot = self.run.activities.slot_mut(activity);
        let is_new = !std::mem::replace(&mut slot.cancelled, true);
        let slot = *slot;
        if is_new && slot.phase == Phase::Running {
            let activation = self.run.activation(self.chart, place, slot);
            self.host.cancel(activation);
        }
    }

    pub(super) fn compound(&self, id: CompoundId) -> &'_ Compound {
        &self.chart.compounds[id.0 as usize]
    }
}

/// The expiry of a timer matches only triggers that name it.
fn matches(trigger: &Trigger, occurrence: &Occurrence) -> bool {
    match trigger {
        Trigger::Any | Trigger::NoneOf(_) if occurrence.expiry.is_some() => false,
        trigger => trigger.matches(occurrence.event),
    }
}
