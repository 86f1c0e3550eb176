//! One run-to-completion step.

use crate::bits::BitSet;
use crate::chart::{Chart, Place, RegionId};
use crate::expression::EventId;
use crate::host::{Host, Report};
use crate::machine::activities::Phase;
use crate::machine::errors::Fault;
use crate::machine::queues::{Incoming, Occurrence};
use crate::machine::run::Run;
use crate::machine::{MachineError, MicroStep, Status, StepSummary};
use crate::semantics::{Deferral, Delivery, Semantics};
use crate::trace::{Occasion, TraceRecord};

/// A step under way.
pub(super) struct Step<'a, H> {
    pub(super) chart: &'a Chart,
    pub(super) run: &'a mut Run,
    pub(super) host: &'a mut H,
    pub(super) summary: StepSummary,
}

impl<'a, H: Host> Step<'a, H> {
    pub(super) fn new(chart: &'a Chart, run: &'a mut Run, host: &'a mut H) -> Step<'a, H> {
        run.log.wanted = host.wants_trace();
        run.is_settled = false;
        Step { chart, run, host, summary: StepSummary::default() }
    }

    pub(super) fn semantics(&self) -> &'a Semantics {
        self.chart.semantics_ref()
    }

    /// Takes transitions until none is enabled. This is the long way: apart from the short one, so that the compiler keeps that small.
    #[inline(never)]
    pub(super) fn run(mut self) -> Result<StepSummary, MachineError> {
        self.open();
        self.run_on()
    }

    /// Goes on with a step that has begun.
    #[inline(never)]
    pub(super) fn run_on(mut self) -> Result<StepSummary, MachineError> {
        while self.advance()? {}
        self.finish();
        Ok(self.summary)
    }

    /// Takes the next micro-step, or ends the step if there is none.
    pub(super) fn run_one(mut self) -> Result<MicroStep, MachineError> {
        self.open();
        if self.advance()? {
            self.run.under_way = Some(self.summary);
            return Ok(MicroStep::Made);
        }
        self.finish();
        Ok(MicroStep::AtRest(self.summary))
    }

    /// Begins a step, or goes on with the one under way.
    fn open(&mut self) {
        match self.run.under_way.take() {
            Some(summary) => self.summary = summary,
            None => self.begin(),
        }
    }

    fn advance(&mut self) -> Result<bool, MachineError> {
        self.micro_step().map_err(|fault| self.fail(fault))
    }

    #[cold]
    fn fail(&mut self, fault: Fault) -> MachineError {
        self.halt(Status::Stopped);
        let cycle = self.run.bound.cycle();
        MachineError::new(fault, self.chart, &cycle)
    }

    fn begin(&mut self) {
        self.run.due = false;
        self.run.bound.begin(self.run.now);
        if !self.run.newcomers.is_empty()
            && let Err(fault) = self.welcome()
        {
            self.run.failure = Some(fault);
        }
        self.expire_timers();
        if self.semantics().delivery == Delivery::EachStep {
            self.deliver_to_all();
        }
    }

    fn expire_timers(&mut self) {
        while let Some(timer) = self.run.timers.expire(self.run.now, &mut self.run.chooser) {
            self.run.timer_changed(self.chart, timer);
            if let Some(event) = self.chart.timers[timer].event {
                self.run.queues.arrive(Incoming { expiry: Some(timer as u32), ..event.into() });
            }
        }
    }

    pub(super) fn deliver_to_all(&mut self) {
        for (index, region) in self.chart.regions.iter().enumerate() {
            if self.run.is_active(region.root) && !self.run.running_regions.contains(index) {
                self.deliver(RegionId(index as u32));
            }
        }
    }

    pub(super) fn deliver(&mut self, region: RegionId) {
        self.host.deliver(region);
        if !self.run.erred.is_empty() {
            self.run.delivered(self.chart, region);
        }
    }

    /// The next micro-step, if there is one: a cancelled state is left at last; what was held is offered; then what needs no event,
    /// then raised events, then arrived ones.
    fn micro_step(&mut self) -> Result<bool, Fault> {
        if let Some(fault) = self.run.failure.take() {
            return Err(fault);
        }
        if self.run.status != Status::Running || self.run.ending {
            return Ok(false);
        }
        Ok(self.fire_pending()? || self.offer_held()? || self.eventless()? || self.offer_next()?)
    }

    /// What has just completed, where that is looked at once; then all that needs no event.
    fn eventless(&mut self) -> Result<bool, Fault> {
        while let Some(place) = self.run.completions.pop_front() {
            self.select_at(place);
            if !self.run.selection.candidates.is_empty() {
                return self.take_eventless();
            }
        }
        let (sources, last) = (&self.chart.masks.eventless, self.chart.layout.len());
        if self.run.active.next_common(sources, 0, last).is_none() {
            return Ok(false);
        }
        self.select(None);
        if self.run.selection.candidates.is_empty() {
            return Ok(false);
        }
        self.take_eventless()
    }

    fn take_eventless(&mut self) -> Result<bool, Fault> {
        self.admit()?;
        self.take(Occasion::Eventless)?;
        Ok(true)
    }

    fn offer_held(&mut self) -> Result<bool, Fault> {
        match self.run.queues.next_held() {
            Some(occurrence) => self.offer(occurrence),
            None => Ok(false),
        }
    }

    fn offer_next(&mut self) -> Result<bool, Fault> {
        if self.run.queues.has_deferred() {
            let (chart, active) = (self.chart, &self.run.active);
            self.run.queues.recall(|event| deferring(chart, active, event).is_some());
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
    fn offer(&mut self, occurrence: Occurrence) -> Result<bool, Fault> {
        self.admit()?;
        self.host.offered(occurrence.event, occurrence.is_known, occurrence.token);
        self.select(Some(&occurrence));
        let occasion = Occasion::Event(occurrence.event);
        if !self.run.selection.candidates.is_empty() {
            self.take(occasion)?;
        } else {
            let deferred = self.keep(occurrence);
            self.emit(occasion, deferred);
        }
        Ok(true)
    }

    /// What nobody took is held, deferred (by the state that is returned) or dropped.
    #[inline(never)]
    pub(super) fn keep(&mut self, occurrence: Occurrence) -> Option<Place> {
        let deferral = self.semantics().deferral;
        let run = &mut *self.run;
        if !run.selection.held.is_empty() {
            run.queues.hold(occurrence, &run.selection.held);
            return None;
        }
        if deferral == Deferral::Off {
            return None;
        }
        let place = deferring(self.chart, &run.active, occurrence.event)?;
        run.queues.defer(occurrence);
        Some(place)
    }

    /// Fires what was selected.
    fn take(&mut self, occasion: Occasion) -> Result<(), Fault> {
        self.resolve();
        self.suspend_interrupting(occasion);
        self.fire_selected()?;
        self.emit(occasion, None);
        Ok(())
    }

    /// Counts one more micro-step.
    pub(super) fn admit(&mut self) -> Result<(), Fault> {
        let (limit, bound) = (self.semantics().limit, &mut self.run.bound);
        if !bound.allows_micro_step(limit) {
            return Err(Fault::NeverRests);
        }
        if self.summary.micro_steps == 0 && !bound.admits_step(limit) {
            return Err(Fault::NeverAdvances);
        }
        bound.count_micro_step();
        self.summary.micro_steps += 1;
        Ok(())
    }

    pub(super) fn emit(&mut self, occasion: Occasion, deferred: Option<Place>) {
        let run = &*self.run;
        if !run.log.wanted {
            return;
        }
        let record = TraceRecord {
            time: run.now,
            occasion,
            selected: &run.selection.selected,
            preempted: &run.selection.preempted,
            held: &run.selection.held,
            deferred: deferred.map(|place| self.chart.layout.node(place)),
            exits: &run.log.exits,
            effects: &run.log.effects,
            taken: &run.log.taken,
            entries: &run.log.entries,
            guards: &run.log.guards,
        };
        self.host.trace(self.chart, &record);
    }

    /// The chart is at rest: what was written is published, and the activities of entered states start.
    fn finish(&mut self) {
        if self.run.ending {
            self.leave_all(Status::Finished);
        }
        self.publish_written();
        if self.run.activities.take_queued() {
            self.start_activities();
        }
        self.report_waiting_starts();
        self.run.is_settled = self.run.can_go_on_directly(self.chart);
    }

    /// Leaves every state, in a record of its own.
    pub(super) fn leave_all(&mut self, status: Status) {
        self.run.begin_micro_step();
        self.collect_between(Place(0), self.chart.layout.root());
        self.leave_collected();
        self.emit(Occasion::Finish, None);
        self.publish_written();
        self.halt(status);
    }

    pub(super) fn publish_written(&mut self) {
        if self.run.written.is_empty() {
            return;
        }
        let last = self.chart.regions.len();
        while let Some(index) = self.run.written.next(0, last) {
            self.run.written.remove(index);
            self.host.publish_all(RegionId(index as u32));
        }
    }

    fn start_activities(&mut self) {
        let last = self.chart.layout.len();
        let mut next = self.run.running.next(0, last);
        while let Some(index) = next {
            self.start_activity(Place(index as u32));
            next = self.run.running.next(index + 1, last);
        }
    }

    fn start_activity(&mut self, place: Place) {
        let Some(activity) = self.chart.states[place.index()].activity else { return };
        let slot = self.run.activities.slot_mut(activity);
        if slot.phase != Phase::Queued {
            return;
        }
        slot.phase = Phase::Running;
        let slot = *slot;
        let activation = self.run.activation(self.chart, place, slot);
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
        let (starts, last) = (&self.chart.masks.starts, self.chart.layout.len());
        if !self.run.active.meets(starts) {
            return;
        }
        let mut from = 0;
        while let Some(index) =
            self.run.active.next_common_without(starts, &self.run.waiting_starts, from, last)
        {
            from = index + 1;
            let place = Place(index as u32);
            if !self.is_frozen(place) {
                self.run.waiting_starts.insert(index);
                let start = self.chart.layout.node(place);
                self.host.report(self.chart, Report::StartWaits { start });
            }
        }
    }

    /// Ends everything without leaving any state.
    pub(super) fn halt(&mut self, status: Status) {
        for (activity, &place) in self.chart.activities.iter().enumerate() {
            let slot = self.run.activities.slot(activity);
            let activation = self.run.activation(self.chart, place, slot);
            match slot.phase {
                Phase::Running if !slot.cancelled => self.host.cancel(activation),
                Phase::Ongoing => self.host.stop(activation),
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
        self.run.unbound.clear();
        self.run.status = status;
    }
}

/// The first active state, inner before outer, that defers an event.
fn deferring(chart: &Chart, active: &BitSet, event: EventId) -> Option<Place> {
    let last = chart.layout.len();
    let mut next = active.next_common(&chart.masks.deferring, 0, last);
    while let Some(index) = next {
        if chart.states[index].defer.contains(&event) {
            return Some(Place(index as u32));
        }
        next = active.next_common(&chart.masks.deferring, index + 1, last);
    }
    None
}
