//! One run-to-completion step.

use crate::bits::BitSet;
use crate::compile::{CompiledChart, NodeIndex};
use crate::expression::EventId;
use crate::host::{Host, Notice};
use crate::ids::ScopeId;
use crate::machine::activities::InvocationPhase;
use crate::machine::errors::StepError;
use crate::machine::machine_state::MachineState;
use crate::machine::queues::{PoppedEvent, QueuedEvent};
use crate::machine::{MachineError, MicroStep, Status, StepSummary};
use crate::semantics::{Deferral, Delivery, Semantics};
use crate::trace::{MicroStepCause, TraceRecord};

/// A step in progress.
pub(crate) struct Macrostep<'a, H> {
    pub(crate) chart: &'a CompiledChart,
    pub(crate) run: &'a mut MachineState,
    pub(crate) host: &'a mut H,
    pub(crate) summary: StepSummary,
}

impl<'a, H: Host> Macrostep<'a, H> {
    pub(crate) fn new(
        chart: &'a CompiledChart,
        run: &'a mut MachineState,
        host: &'a mut H,
    ) -> Macrostep<'a, H> {
        run.log.wanted = host.wants_trace();
        Macrostep { chart, run, host, summary: StepSummary::default() }
    }

    pub(crate) fn semantics(&self) -> &'a Semantics {
        self.chart.semantics_ref()
    }

    /// Takes transitions until none is enabled.
    pub(crate) fn run(mut self) -> Result<StepSummary, MachineError> {
        self.begin_or_resume();
        while self.advance()? {}
        self.finish();
        Ok(self.summary)
    }

    /// Takes the next micro-step, or ends the step if there is none.
    pub(crate) fn run_micro_step(mut self) -> Result<MicroStep, MachineError> {
        self.begin_or_resume();
        if self.advance()? {
            self.run.step_in_progress = Some(self.summary);
            return Ok(MicroStep::Progressed);
        }
        self.finish();
        Ok(MicroStep::Stable(self.summary))
    }

    /// Begins a step, or continues the one in progress.
    fn begin_or_resume(&mut self) {
        match self.run.step_in_progress.take() {
            Some(summary) => self.summary = summary,
            None => self.begin(),
        }
    }

    fn advance(&mut self) -> Result<bool, MachineError> {
        self.micro_step().map_err(|fault| self.fail(fault))
    }

    #[cold]
    fn fail(&mut self, fault: StepError) -> MachineError {
        self.halt(Status::Stopped);
        let cycle = self.run.livelock_limit.cycle();
        MachineError::new(fault, self.chart, &cycle)
    }

    fn begin(&mut self) {
        self.run.needs_step = false;
        self.run.livelock_limit.begin(self.run.now);
        if !self.run.regions_to_enter.is_empty()
            && let Err(fault) = self.enter_new_regions()
        {
            self.run.failure = Some(fault);
        }
        self.expire_timers();
        if self.semantics().delivery == Delivery::EachStep {
            self.deliver_to_all();
        }
    }

    fn expire_timers(&mut self) {
        if self.run.timers.next_deadline().is_none_or(|next| next > self.run.now) {
            return;
        }
        while let Some(timer) = self.run.timers.expire(self.run.now, &mut self.run.chooser) {
            self.run.timer_changed(self.chart, timer);
            if let Some(event) = self.chart.timers[timer].event {
                self.run.queues.arrive(QueuedEvent { expiry: Some(timer as u32), ..event.into() });
            }
        }
    }

    pub(crate) fn deliver_to_all(&mut self) {
        for (index, region) in self.chart.regions.iter().enumerate() {
            if self.run.is_active(region.root) && !self.run.running_regions.contains(index) {
                self.deliver(ScopeId(index as u32));
            }
        }
    }

    pub(crate) fn deliver(&mut self, region: ScopeId) {
        self.host.deliver(region);
        if !self.run.failed_guards.is_empty() {
            self.run.delivered(self.chart, region);
        }
    }

    /// Executes the next micro-step, if there is one. The order is: states with a pending interrupt
    /// are left; held events are offered; then transitions without an event, then raised events,
    /// then arrived ones.
    fn micro_step(&mut self) -> Result<bool, StepError> {
        if let Some(fault) = self.run.failure.take() {
            return Err(fault);
        }
        if self.run.status != Status::Running || self.run.root_is_final {
            return Ok(false);
        }
        Ok(!self.run.pending.is_empty() && self.fire_pending()?
            || !self.run.queues.held.is_empty() && self.offer_held()?
            || self.step_without_event()?
            || self.offer_next()?)
    }

    /// Examines states that have just completed, where that happens once; then all transitions
    /// without an event.
    fn step_without_event(&mut self) -> Result<bool, StepError> {
        while let Some(node) = self.run.completions.pop_front() {
            self.select_at(node);
            if !self.run.selection.candidates.is_empty() {
                return self.take_eventless();
            }
        }
        if !self.run.active.meets(&self.chart.node_sets.eventless) {
            return Ok(false);
        }
        self.select(None);
        if self.run.selection.candidates.is_empty() {
            return Ok(false);
        }
        self.take_eventless()
    }

    fn take_eventless(&mut self) -> Result<bool, StepError> {
        self.count_micro_step()?;
        self.take(MicroStepCause::Eventless)?;
        Ok(true)
    }

    fn offer_held(&mut self) -> Result<bool, StepError> {
        match self.run.queues.next_held() {
            Some(occurrence) => self.offer(occurrence),
            None => Ok(false),
        }
    }

    fn offer_next(&mut self) -> Result<bool, StepError> {
        if self.run.queues.has_deferred() {
            let (chart, active) = (self.chart, &self.run.active);
            self.run.queues.recall_deferred(|event| deferring(chart, active, event, |_| true).is_some());
        }
        if let Some(occurrence) = self.run.queues.next_raised() {
            return self.offer(occurrence);
        }
        match self.run.queues.next_arrived() {
            Some(occurrence) => self.offer(occurrence),
            None => Ok(false),
        }
    }

    /// Offers one event to the configuration.
    fn offer(&mut self, occurrence: PoppedEvent) -> Result<bool, StepError> {
        self.count_micro_step()?;
        self.host.event_taken_from_queue(occurrence.event, occurrence.is_known, occurrence.token);
        self.select(Some(&occurrence));
        let occasion = MicroStepCause::Event(occurrence.event);
        if let Some(node) = self.claimant(occurrence.event) {
            self.run.selection.clear();
            self.run.queues.defer(occurrence);
            self.emit_trace(occasion, Some(node));
            return Ok(true);
        }
        if !self.run.selection.candidates.is_empty() {
            self.take(occasion)?;
        } else {
            let deferred = self.hold_or_defer(occurrence);
            self.emit_trace(occasion, deferred);
        }
        Ok(true)
    }

    /// The innermost active state that defers an event and keeps it from the transitions that were
    /// found: none of them is its own or of a state inside it.
    #[inline]
    fn claimant(&self, event: EventId) -> Option<NodeIndex> {
        if self.semantics().deferral != Deferral::Innermost {
            return None;
        }
        let (chart, selection) = (self.chart, &self.run.selection);
        let found = if selection.candidates.is_empty() { &selection.held } else { &selection.candidates };
        deferring(chart, &self.run.active, event, |node| {
            let own = |source| chart.layout.contains(node, source);
            !found.iter().any(|&id| self.compound(id).sources().any(own))
        })
    }

    /// An event that no transition takes is held, deferred (by the state that is returned) or
    /// dropped.
    #[inline(never)]
    pub(crate) fn hold_or_defer(&mut self, occurrence: PoppedEvent) -> Option<NodeIndex> {
        let deferral = self.semantics().deferral;
        let run = &mut *self.run;
        if !run.selection.held.is_empty() {
            run.queues.push_held(occurrence, &run.selection.held);
            return None;
        }
        if deferral == Deferral::Off {
            return None;
        }
        let node = deferring(self.chart, &run.active, occurrence.event, |_| true)?;
        run.queues.defer(occurrence);
        Some(node)
    }

    /// Takes the selected transitions.
    fn take(&mut self, occasion: MicroStepCause) -> Result<(), StepError> {
        self.resolve();
        self.suspend_interrupting(occasion);
        self.fire_selected()?;
        self.emit_trace(occasion, None);
        Ok(())
    }

    /// Counts one more micro-step.
    pub(crate) fn count_micro_step(&mut self) -> Result<(), StepError> {
        let (limit, bound) = (self.semantics().limit, &mut self.run.livelock_limit);
        if !bound.allows_micro_step(limit) {
            return Err(StepError::NeverRests);
        }
        if self.summary.micro_steps == 0 && !bound.admits_step(limit) {
            return Err(StepError::NeverAdvances);
        }
        bound.count_micro_step();
        self.summary.micro_steps += 1;
        Ok(())
    }

    pub(crate) fn emit_trace(&mut self, occasion: MicroStepCause, deferred: Option<NodeIndex>) {
        let run = &*self.run;
        if !run.log.wanted {
            return;
        }
        let record = TraceRecord {
            time: run.now,
            cause: occasion,
            selected: &run.selection.selected,
            preempted: &run.selection.preempted,
            held: &run.selection.held,
            deferred: deferred.map(|node| self.chart.layout.node(node)),
            exits: &run.log.exits,
            effects: &run.log.effects,
            taken: &run.log.taken,
            entries: &run.log.entries,
            guards: &run.log.guards,
        };
        self.host.trace(self.chart, &record);
    }

    /// Ends the step in a stable configuration: publishes outputs, and starts the activities of
    /// entered states.
    fn finish(&mut self) {
        if self.run.root_is_final {
            self.leave_all(Status::Finished);
        }
        self.publish_written();
        if self.run.activities.take_queued() {
            self.start_activities();
        }
        self.report_waiting_starts();
    }

    /// Leaves all states, in a separate trace record.
    pub(crate) fn leave_all(&mut self, status: Status) {
        self.run.begin_micro_step();
        self.collect_between(NodeIndex(0), self.chart.layout.root());
        self.leave_collected();
        self.emit_trace(MicroStepCause::Finish, None);
        self.publish_written();
        self.halt(status);
    }

    pub(crate) fn publish_written(&mut self) {
        if self.run.written.is_empty() {
            return;
        }
        let last = self.chart.regions.len();
        while let Some(index) = self.run.written.next(0, last) {
            self.run.written.remove(index);
            self.host.publish_all(ScopeId(index as u32));
        }
    }

    fn start_activities(&mut self) {
        let last = self.chart.layout.len();
        let mut next = self.run.running.next(0, last);
        while let Some(index) = next {
            self.start_activity(NodeIndex(index as u32));
            next = self.run.running.next(index + 1, last);
        }
    }

    fn start_activity(&mut self, node: NodeIndex) {
        let Some(activity) = self.chart.states[node.index()].activity else { return };
        let slot = self.run.activities.slot_mut(activity);
        if slot.phase != InvocationPhase::Queued {
            return;
        }
        slot.phase = InvocationPhase::Running;
        let slot = *slot;
        let activation = self.run.activation(self.chart, node, slot);
        self.summary.started += 1;
        self.host.start(activation);
        if slot.cancelled {
            self.host.cancel(activation);
        }
    }

    fn report_waiting_starts(&mut self) {
        if self.run.status != Status::Running {
            return;
        }
        let (starts, last) = (&self.chart.node_sets.starts, self.chart.layout.len());
        if !self.run.active.meets(starts) {
            return;
        }
        let mut from = 0;
        while let Some(index) =
            self.run.active.next_common_without(starts, &self.run.waiting_starts, from, last)
        {
            from = index + 1;
            let node = NodeIndex(index as u32);
            if !self.is_frozen(node) {
                self.run.waiting_starts.insert(index);
                let start = self.chart.layout.node(node);
                self.host.report(self.chart, Notice::StartWaits { start });
            }
        }
    }

    /// Stops without leaving any state.
    pub(crate) fn halt(&mut self, status: Status) {
        for (activity, slot) in self.run.activities.used() {
            let node = self.chart.activities[activity];
            let activation = self.run.activation(self.chart, node, slot);
            match slot.phase {
                InvocationPhase::Running if !slot.cancelled => self.host.cancel(activation),
                InvocationPhase::Ongoing => self.host.stop(activation),
                _ => {}
            }
        }
        self.run.activities.reset();
        self.run.running.clear();
        self.run.running_regions.clear();
        self.run.queues.clear();
        self.run.pending.clear();
        self.run.completions.clear();
        self.run.marked.clear();
        self.run.entering.clear();
        self.run.incomplete.clear();
        self.run.unbound_timers.clear();
        self.run.status = status;
    }
}

/// The first active state, inner before outer, that defers an event and fits.
fn deferring(
    chart: &CompiledChart,
    active: &BitSet,
    event: EventId,
    fits: impl Fn(NodeIndex) -> bool,
) -> Option<NodeIndex> {
    let last = chart.layout.len();
    let mut next = active.next_common(&chart.node_sets.deferring, 0, last);
    while let Some(index) = next {
        if chart.states[index].defer.contains(&event) && fits(NodeIndex(index as u32)) {
            return Some(NodeIndex(index as u32));
        }
        next = active.next_common(&chart.node_sets.deferring, index + 1, last);
    }
    None
}
