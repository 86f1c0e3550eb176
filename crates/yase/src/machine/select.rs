//! Which transitions are enabled, and which of them win.

use smallvec::SmallVec;

use crate::chart::{Compound, CompoundId, Place, ScopedGuard, Trigger};
use crate::host::{Host, Report};
use crate::machine::activities::Phase;
use crate::machine::draw::Search;
use crate::machine::queues::Occurrence;
use crate::machine::run::Pending;
use crate::machine::step::Step;
use crate::machine::view::View;
use crate::semantics::{ConflictChoice, Firing, RunningOnExit};
use crate::trace::Occasion;

impl<H: Host> Step<'_, H> {
    /// Finds the candidates for an event or, without one, for a step without.
    ///
    /// Places are visited children before parents. A state is looked at if from some active leaf inside it, outward, no transition has been
    /// found yet: inner ones win. Before a state with a way through a JOIN, what lies in the other sources of that is visited too.
    pub(super) fn select(&mut self, occurrence: Option<&Occurrence>) {
        self.run.begin_micro_step();
        match &self.chart.visits {
            Some(order) if occurrence.is_none() => self.visit_in_order(order),
            _ => self.visit(occurrence),
        }
        if !self.run.selection.candidates.is_empty() {
            self.run.selection.held.clear();
        }
    }

    fn visit(&mut self, occurrence: Option<&Occurrence>) {
        let (masks, last) = (&self.chart.masks, self.chart.layout.len());
        let sources = if occurrence.is_some() { &masks.triggered } else { &masks.eventless };
        let mut next = self.run.active.next_common(sources, 0, last);
        while let Some(index) = next {
            self.consider(Place(index as u32), occurrence);
            next = self.run.active.next_common(sources, index + 1, last);
        }
    }

    fn visit_in_order(&mut self, order: &[Place]) {
        for &place in order {
            if self.run.is_active(place) && self.chart.masks.eventless.contains(place.index()) {
                self.consider(place, None);
            }
        }
    }

    /// Finds the candidate among the ways out of one state that has completed.
    pub(super) fn select_at(&mut self, place: Place) {
        self.run.begin_micro_step();
        if self.run.is_active(place) {
            self.consider(place, None);
        }
    }

    fn consider(&mut self, place: Place, occurrence: Option<&Occurrence>) {
        if occurrence.is_none() && self.is_frozen(place) || !self.is_open(place) {
            return;
        }
        let state = &self.chart.states[place.index()];
        let branches = if occurrence.is_some() { state.triggered } else { state.eventless };
        if let Some(found) = self.scan(branches, Search { state: Some(place), occurrence }) {
            self.add_candidate(found, place);
            let chart = self.chart;
            chart.compounds[found.0 as usize].sources().for_each(|source| self.close(source));
        }
    }

    /// Candidates stand in the order of their sources, inner ones first, or, for phases, in that of the leaves they were found for.
    fn add_candidate(&mut self, found: CompoundId, place: Place) {
        let first = self.chart.layout.first(place).index();
        let (run, phases) = (&mut *self.run, self.chart.semantics_ref().firing == Firing::Phases);
        let leaf = run.tips.next_without(&run.selection.closed, first, place.index());
        let selection = &mut run.selection;
        let found_for = match leaf.filter(|_| phases) {
            Some(leaf) => Place(leaf as u32),
            None => place,
        };
        let index = selection.found_for.partition_point(|&other| other <= found_for);
        selection.candidates.insert(index, found);
        selection.found_for.insert(index, found_for);
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
            || self.run.tips.next_without(&selection.closed, first, place.index()).is_some()
    }

    fn close(&mut self, place: Place) {
        let first = self.chart.layout.first(place).index();
        let run = &mut *self.run;
        let mut next = run.tips.next(first, place.index());
        while let Some(index) = next {
            run.selection.closed.insert(index);
            next = run.tips.next(index + 1, place.index());
        }
    }

    pub(super) fn runs_inside(&self, place: Place) -> bool {
        self.run.running.any_in(self.chart.layout.first(place).index(), place.index())
    }

    /// Whether a candidate was found that begins inside a state.
    pub(super) fn can_step_inside(&self, place: Place) -> bool {
        let first = self.chart.layout.first(place);
        let begins_inside =
            |&id: &CompoundId| self.compound(id).sources().any(|it| first <= it && it < place);
        self.run.selection.candidates.iter().any(begins_inside)
    }

    /// Whether all sources of a JOIN have completed, and nothing was found from any of the active leaves inside them, outward: a JOIN takes
    /// its sources as a whole, when none of them can step any more.
    pub(super) fn can_join(&self, join: usize) -> bool {
        self.chart.joins[join].sources.iter().all(|&source| {
            let first = self.chart.layout.first(source).index();
            self.run.is_active(source)
                && self.run.is_complete(self.chart, source)
                && !self.run.selection.closed.any_in(first, source.index())
        })
    }

    /// Reads a guard. One without a value counts as false and raises an error event, once until it has succeeded or what it reads has
    /// changed, and once in a micro-step for its segment, however often and on however many blackboards it is read.
    pub(super) fn holds(&mut self, guard: usize) -> bool {
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
                if self.run.note_failure(self.chart, guard) {
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
    pub(super) fn is_blocked(&self, compound: &Compound) -> bool {
        let chart = self.chart;
        if compound.sources().any(|source| self.run.is_being_left(chart, source)) {
            return true;
        }
        if compound.interrupts || self.semantics().on_exit == RunningOnExit::Interrupted {
            return false;
        }
        let runs =
            |source: Place| self.run.running_regions.contains(chart.states[source.index()].region.index());
        compound.sources().any(runs) || self.leaves_running(compound)
    }

    pub(super) fn leaves_running(&self, compound: &Compound) -> bool {
        self.semantics().on_exit == RunningOnExit::Blocks
            && compound
                .exits
                .is_some_and(|(first, last)| self.run.running.any_in(first.index(), last.index()))
    }

    /// Of the transitions that wait for activities the innermost counts, as it does of those that can fire.
    pub(super) fn note_blocked(&mut self, compound: CompoundId, place: Place) {
        let first = self.chart.layout.first(place).index();
        let run = &mut *self.run;
        let mut is_new = false;
        let mut next = run.tips.next_without(&run.selection.noted, first, place.index());
        while let Some(index) = next {
            is_new = true;
            run.selection.noted.insert(index);
            next = run.tips.next_without(&run.selection.noted, index + 1, place.index());
        }
        if is_new {
            run.selection.has_noted = true;
            run.selection.held.push(compound);
        }
    }

    /// Lets the winners among the candidates be selected. One that conflicts with others wins if it is nested in all of them; else it loses,
    /// since candidates stand in the order of precedence, unless the chooser says otherwise.
    pub(super) fn resolve(&mut self) {
        for index in 0..self.run.selection.candidates.len() {
            let candidate = self.run.selection.candidates[index];
            match self.losers(candidate) {
                Some(losers) => {
                    let selection = &mut self.run.selection;
                    selection.selected.retain(|other| !losers.contains(other));
                    selection.preempted.extend(losers);
                    selection.selected.push(candidate);
                }
                None => self.run.selection.preempted.push(candidate),
            }
        }
        let (chart, selected) = (self.chart, &mut self.run.selection.selected);
        if selected.len() > 1 && self.chart.semantics_ref().firing == Firing::EachTransition {
            selected.sort_by_key(|&id| chart.compounds[id.0 as usize].key);
        }
    }

    /// The selected transitions that a candidate wins against; none if it loses.
    fn losers(&mut self, candidate: CompoundId) -> Option<SmallVec<[CompoundId; 4]>> {
        let chart = self.chart;
        let compound = &chart.compounds[candidate.0 as usize];
        let mut losers = SmallVec::new();
        for index in 0..self.run.selection.selected.len() {
            let id = self.run.selection.selected[index];
            let other = &chart.compounds[id.0 as usize];
            if !compound.conflicts_with(other, &self.run.active) {
                continue;
            }
            let wins = self.is_nested(compound, other)
                || !self.is_nested(other, compound)
                    && self.semantics().conflict == ConflictChoice::Random
                    && self.run.chooser.choose(2) == 1;
            if !wins {
                return None;
            }
            losers.push(id);
        }
        Some(losers)
    }

    /// Whether one begins inside a state at which the other begins, of a JOIN at any of its sources.
    fn is_nested(&self, inner: &Compound, outer: &Compound) -> bool {
        let layout = &self.chart.layout;
        inner
            .sources()
            .any(|inner| outer.sources().any(|outer| inner != outer && layout.contains(outer, inner)))
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
pub(super) fn matches(trigger: &Trigger, occurrence: &Occurrence) -> bool {
    match trigger {
        Trigger::Any | Trigger::NoneOf(_) if occurrence.expiry.is_some() => false,
        trigger => trigger.matches(occurrence.event),
    }
}
