//! Selects the enabled transitions, and resolves their conflicts.

use smallvec::SmallVec;

use crate::compile::{CompletionGate, CompoundTransition, EventFilter, NodeIndex, ScopedGuard, TimerGate};
use crate::expression::TimerState;
use crate::host::{Host, Notice};
use crate::ids::CompoundTransitionId;
use crate::machine::activities::InvocationPhase;
use crate::machine::branch_selection::BranchQuery;
use crate::machine::machine_state::PendingInterrupt;
use crate::machine::queues::PoppedEvent;
use crate::machine::step::Macrostep;
use crate::machine::view::ScopeView;
use crate::semantics::{ActivityOnExit, ConflictResolution, Firing};
use crate::trace::MicroStepCause;

impl<H: Host> Macrostep<'_, H> {
    /// Finds the candidates for an event or, without one, for a micro-step without event.
    ///
    /// Nodes are visited children before parents. A state is examined if, for some active leaf
    /// inside it, no transition has been found yet from the leaf outward: inner ones take
    /// precedence. Before a state with a path through a JOIN, the insides of its other sources are
    /// visited too.
    pub(crate) fn select(&mut self, occurrence: Option<&PoppedEvent>) {
        self.run.begin_micro_step();
        match &self.chart.selection_order {
            Some(order) if occurrence.is_none() => self.visit_in_order(order),
            _ => self.visit(occurrence),
        }
        if !self.run.selection.candidates.is_empty() {
            self.run.selection.held.clear();
        }
    }

    /// The configuration does not change during the visit, so its words are read once. States that
    /// wait for a running activity are not examined.
    fn visit(&mut self, occurrence: Option<&PoppedEvent>) {
        let sets = &self.chart.node_sets;
        let sources = if occurrence.is_some() { &sets.triggered } else { &sets.eventless };
        for word in 0..sources.word_count() {
            let mut nodes = self.run.active.word(word) & sources.word(word);
            if occurrence.is_none() {
                nodes &= !(self.run.running.word(word) & sets.awaiting_return.word(word));
            }
            while nodes != 0 {
                let index = word as u32 * u64::BITS + nodes.trailing_zeros();
                nodes &= nodes - 1;
                self.consider(NodeIndex(index), occurrence);
            }
        }
    }

    fn visit_in_order(&mut self, order: &[NodeIndex]) {
        for &node in order {
            if self.run.is_active(node) && self.chart.node_sets.eventless.contains(node.index()) {
                self.consider(node, None);
            }
        }
    }

    /// Finds the candidate among the paths out of one state that has completed.
    pub(crate) fn select_at(&mut self, node: NodeIndex) {
        self.run.begin_micro_step();
        if self.run.is_active(node) {
            self.consider(node, None);
        }
    }

    #[inline]
    fn consider(&mut self, node: NodeIndex, occurrence: Option<&PoppedEvent>) {
        let chart = self.chart;
        let entry = &chart.selection_table[node.index()];
        if occurrence.is_none() && (!self.passes(entry.gate, node) || self.is_frozen(node))
            || !self.lacks_candidate(entry.first, node)
            || occurrence.is_none() && self.waits_for_timers(&entry.timer_gates)
        {
            return;
        }
        let branches = if occurrence.is_some() { entry.triggered } else { entry.eventless };
        let is_complete = occurrence.is_none() && entry.gate != CompletionGate::Open;
        if let Some(found) = self.scan(branches, BranchQuery { state: Some(node), occurrence, is_complete }) {
            self.add_candidate(found, node);
            let compound = &chart.compounds[found.0 as usize];
            compound.sources().for_each(|source| self.mark_decided(source));
        }
    }

    /// Whether the transitions without a trigger need to be examined.
    #[inline]
    fn passes(&self, gate: CompletionGate, node: NodeIndex) -> bool {
        match gate {
            CompletionGate::Open => true,
            CompletionGate::Returned(activity) => {
                self.run.activities.slot(activity).phase == InvocationPhase::Done
            }
            CompletionGate::End(end) => self.run.is_active(end) || self.run.vacated.contains(node.index()),
        }
    }

    /// Whether all guards that would be evaluated test a timer first that is not over. They are
    /// recorded as if they had been evaluated.
    #[inline]
    fn waits_for_timers(&mut self, gates: &[TimerGate]) -> bool {
        let run = &mut *self.run;
        let is_closed = |gate: &TimerGate| match run.timers.state(gate.timer, run.now) {
            TimerState::Unset => !gate.when_unset,
            TimerState::Running => true,
            TimerState::Over => false,
        };
        // An evaluation without a failure ends the record of an earlier one.
        if gates.is_empty() || !run.failed_guards.is_empty() || !gates.iter().all(is_closed) {
            return false;
        }
        if run.log.wanted {
            run.log.guards.extend(gates.iter().map(|gate| (gate.transition, Some(false))));
        }
        true
    }

    /// Candidates are ordered by their sources, inner ones first, or, for phases, by the leaves for
    /// which they were found.
    fn add_candidate(&mut self, found: CompoundTransitionId, node: NodeIndex) {
        let found_for = match self.chart.semantics_ref().firing {
            Firing::EachTransition | Firing::EachSegment => node,
            Firing::Phases => {
                let (run, first) = (&*self.run, self.chart.layout.first(node).index());
                let leaf = run.active_leaves.next_without(&run.selection.closed, first, node.index());
                leaf.map_or(node, |leaf| NodeIndex(leaf as u32))
            }
        };
        let selection = &mut self.run.selection;
        let index = match selection.found_for.last() {
            Some(&last) if last > found_for => {
                selection.found_for.partition_point(|&other| other <= found_for)
            }
            _ => selection.found_for.len(),
        };
        selection.candidates.insert(index, found);
        selection.found_for.insert(index, found_for);
    }

    /// Whether it is about to be left, by an interrupting transition or for a held event: it then
    /// takes no transition without an event.
    #[inline]
    pub(crate) fn is_frozen(&self, node: NodeIndex) -> bool {
        !(self.run.pending.is_empty() && self.run.queues.held.is_empty()) && self.is_about_to_be_left(node)
    }

    #[inline(never)]
    fn is_about_to_be_left(&self, node: NodeIndex) -> bool {
        let leaves = |compound: CompoundTransitionId| self.compound(compound).leaves(node);
        self.run.has_pending_exit(self.chart, node)
            || self.run.queues.held.iter().any(|held| held.compounds.iter().copied().any(leaves))
    }

    /// Whether an active leaf inside has no candidate yet.
    #[inline]
    fn lacks_candidate(&self, first: NodeIndex, node: NodeIndex) -> bool {
        let selection = &self.run.selection;
        selection.candidates.is_empty()
            || self.run.active_leaves.next_without(&selection.closed, first.index(), node.index()).is_some()
    }

    #[inline]
    fn mark_decided(&mut self, node: NodeIndex) {
        let first = self.chart.layout.first(node).index();
        let run = &mut *self.run;
        run.selection.closed.add_between(&run.active_leaves, first, node.index());
    }

    pub(crate) fn has_running_inside(&self, node: NodeIndex) -> bool {
        self.run.running.any_in(self.chart.layout.first(node).index(), node.index())
    }

    /// Whether a candidate begins inside a state.
    pub(crate) fn can_step_inside(&self, node: NodeIndex) -> bool {
        let first = self.chart.layout.first(node);
        let begins_inside =
            |&id: &CompoundTransitionId| self.compound(id).sources().any(|it| first <= it && it < node);
        self.run.selection.candidates.iter().any(begins_inside)
    }

    /// Whether all sources of a JOIN have completed, and no transition was found from any of the
    /// active leaves inside them outward: a JOIN takes its sources as a whole, when nothing in them
    /// is enabled any more.
    pub(crate) fn can_join(&self, join: usize) -> bool {
        self.chart.joins[join].sources.iter().all(|&source| {
            let first = self.chart.layout.first(source).index();
            self.run.is_active(source)
                && self.run.is_complete(self.chart, source)
                && !self.run.selection.closed.any_in(first, source.index())
        })
    }

    /// Evaluates a guard. One without a value counts as false and raises an error event, once until
    /// it has succeeded or its inputs have changed, and once per micro-step for its segment,
    /// regardless of the number of evaluations and scopes.
    pub(crate) fn evaluate_guard(&mut self, guard: usize) -> bool {
        let ScopedGuard { transition, region, guard: program } = &self.chart.guards[guard];
        let view = ScopeView { chart: self.chart, run: self.run, host: self.host, region: *region };
        if !self.run.log.wanted
            && self.run.failed_guards.is_empty()
            && let Some(value) = program.evaluate_plainly(&view)
        {
            return value;
        }
        let result = program.evaluate(&view);
        // The literal `false` reads nothing.
        if self.run.log.wanted && !program.is_literally_false() {
            self.run.log.guards.push((*transition, result.as_ref().ok().copied()));
        }
        match result {
            Ok(value) => {
                if !self.run.failed_guards.is_empty() {
                    self.run.failed_guards.retain(|erred| erred.guard != guard);
                }
                value
            }
            Err(error) => {
                if self.run.record_guard_failure(self.chart, guard) {
                    self.run.raise(self.chart, self.chart.errors.guard, true, 0);
                    self.host
                        .report(self.chart, Notice::GuardFailed { transition: *transition, error: &error });
                }
                false
            }
        }
    }

    /// Whether running activities block a transition: one in its own scope, or one in a state it
    /// would leave. An interrupting one is blocked only by another that is already pending.
    pub(crate) fn is_blocked(&self, compound: &CompoundTransition) -> bool {
        let chart = self.chart;
        if !self.run.pending.is_empty()
            && compound.sources().any(|source| self.run.has_pending_exit(chart, source))
        {
            return true;
        }
        if compound.interrupts || self.semantics().on_exit == ActivityOnExit::Interrupted {
            return false;
        }
        if self.run.running.is_empty() {
            return false;
        }
        let runs = |source: NodeIndex| {
            self.run.running_regions.contains(chart.states[source.index()].region.index())
        };
        compound.sources().any(runs) || self.exits_running_activity(compound)
    }

    pub(crate) fn exits_running_activity(&self, compound: &CompoundTransition) -> bool {
        self.semantics().on_exit == ActivityOnExit::Blocks
            && compound
                .exits
                .is_some_and(|(first, last)| self.run.running.any_in(first.index(), last.index()))
    }

    /// Records a transition that waits for activities. As among enabled transitions, the innermost
    /// counts.
    pub(crate) fn note_blocked(&mut self, compound: CompoundTransitionId, node: NodeIndex) {
        let first = self.chart.layout.first(node).index();
        let run = &mut *self.run;
        let mut is_new = false;
        let mut next = run.active_leaves.next_without(&run.selection.noted, first, node.index());
        while let Some(index) = next {
            is_new = true;
            run.selection.noted.insert(index);
            next = run.active_leaves.next_without(&run.selection.noted, index + 1, node.index());
        }
        if is_new {
            run.selection.has_noted = true;
            run.selection.held.push(compound);
        }
    }

    /// Resolves conflicts and selects the winning candidates. A candidate that conflicts with
    /// others wins if it is nested in all of them; otherwise it loses, since candidates are in
    /// order of precedence, unless the chooser decides otherwise.
    pub(crate) fn resolve(&mut self) {
        if let [only] = self.run.selection.candidates[..] {
            self.run.selection.selected.push(only);
            return;
        }
        for index in 0..self.run.selection.candidates.len() {
            let candidate = self.run.selection.candidates[index];
            match self.preempted_by(candidate) {
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
        if selected.len() > 1 && self.chart.semantics_ref().firing != Firing::Phases {
            selected.sort_by_key(|&id| chart.compounds[id.0 as usize].key);
        }
    }

    /// The selected transitions that a candidate preempts; `None` if it loses.
    fn preempted_by(
        &mut self,
        candidate: CompoundTransitionId,
    ) -> Option<SmallVec<[CompoundTransitionId; 4]>> {
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
                    && self.semantics().conflict == ConflictResolution::Random
                    && self.run.chooser.choose(2) == 1;
            if !wins {
                return None;
            }
            losers.push(id);
        }
        Some(losers)
    }

    /// Whether one begins inside a source state of the other; for a JOIN, any of its sources.
    fn is_nested(&self, inner: &CompoundTransition, outer: &CompoundTransition) -> bool {
        let layout = &self.chart.layout;
        inner
            .sources()
            .any(|inner| outer.sources().any(|outer| inner != outer && layout.contains(outer, inner)))
    }

    /// Suspends selected transitions that would leave running activities, and requests those to
    /// return.
    pub(crate) fn suspend_interrupting(&mut self, occasion: MicroStepCause) {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            let compound = self.compound(id);
            if !self.exits_running_activity(compound) {
                index += 1;
                continue;
            }
            self.run.selection.selected.remove(index);
            self.run.selection.held.push(id);
            let event = match occasion {
                MicroStepCause::Event(event) => Some(event),
                _ => None,
            };
            self.run.pending.push(PendingInterrupt { compound: id, event });
            if let Some((first, last)) = self.compound(id).exits {
                self.cancel_between(first, last);
            }
        }
    }

    fn cancel_between(&mut self, first: NodeIndex, last: NodeIndex) {
        let mut next = self.run.running.next(first.index(), last.index());
        while let Some(index) = next {
            self.cancel(NodeIndex(index as u32));
            next = self.run.running.next(index + 1, last.index());
        }
    }

    /// Requests an activity to return. One that is queued but not started receives the request
    /// after its start.
    fn cancel(&mut self, node: NodeIndex) {
        let Some(activity) = self.chart.states[node.index()].activity else { return };
        let slot = self.run.activities.slot_mut(activity);
        let is_new = !std::mem::replace(&mut slot.cancelled, true);
        let slot = *slot;
        if is_new && slot.phase == InvocationPhase::Running {
            let activation = self.run.activation(self.chart, node, slot);
            self.host.cancel(activation);
        }
    }

    pub(crate) fn compound(&self, id: CompoundTransitionId) -> &'_ CompoundTransition {
        &self.chart.compounds[id.0 as usize]
    }
}

/// The expiry of a timer matches only triggers that name it.
pub(crate) fn matches(trigger: &EventFilter, occurrence: &PoppedEvent) -> bool {
    match trigger {
        EventFilter::Any | EventFilter::NoneOf(_) if occurrence.expiry.is_some() => false,
        trigger => trigger.matches(occurrence.event),
    }
}
