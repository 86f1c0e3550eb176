//! The short way of a step.
//!
//! It does what a step does where most of that has nothing to do: no activity runs, nothing is held, deferred, raised or pending, no timer
//! is due, and out of the active states lead only ways that are direct (see `chart::Direct`). When one of these does not hold, the step goes
//! on the long way, from where it is.
//!
//! All it works with stands in the values of one struct, which are never lent as a whole: so the compiler keeps them in registers. What is
//! seldom done is a call of the long way's own.

use crate::chart::{
    Chart, CompoundId, Direct, DirectActions, DirectPlace, Owner, Place, Reactions, RegionId,
};
use crate::expression::{EventId, ScriptId};
use crate::host::{ActionError, ActionPlace, Host};
use crate::machine::act::Scene;
use crate::machine::queues::Occurrence;
use crate::machine::run::Run;
use crate::machine::script::Performance;
use crate::machine::step::Step;
use crate::machine::view::View;
use crate::machine::{MachineError, Status, StepSummary};
use crate::semantics::Delivery;
use crate::trace::Occasion;

/// A step on the short way.
pub(super) struct ShortStep<'a, H> {
    pub(super) chart: &'a Chart,
    pub(super) direct: &'a Direct,
    pub(super) run: &'a mut Run,
    host: &'a mut H,
    micro_steps: u32,
    pub(super) transitions: u32,
}

/// Makes a run-to-completion step of a settled machine, on the short way as far as that leads.
#[inline(always)]
pub(super) fn run<H: Host>(chart: &Chart, run: &mut Run, host: &mut H) -> Result<StepSummary, MachineError> {
    match &chart.direct {
        Some(direct) if run.timers.next_deadline().is_none_or(|next| next > run.now) => {
            let traced = host.wants_trace();
            run.log.wanted = traced;
            let short = ShortStep { chart, direct, run, host, micro_steps: 0, transitions: 0 };
            // apart, so that what is not traced does not look at each turn whether it is
            if traced { short.run_traced() } else { short.run::<false>() }
        }
        _ => Step::new(chart, run, host).run(),
    }
}

/// Offers one event to a settled machine and makes the step. If nothing else waits, and what the event does can be looked up, it need not
/// queue.
#[inline(always)]
pub(super) fn handle<H: Host>(
    chart: &Chart,
    run: &mut Run,
    host: &mut H,
    event: EventId,
) -> Result<StepSummary, MachineError> {
    if run.status != Status::Running {
        return self::run(chart, run, host);
    }
    let occurrence = run.queues.occurrence(event.into(), false);
    if let Some(direct) = &chart.direct
        && run.timers.next_deadline().is_none_or(|next| next > run.now)
        && run.queues.arrived.has_none()
        && !host.wants_trace()
        && let leaves = run.active.first_word() & direct.leaves
        && let Some(reactions) = direct.leaps.of(event, leaves)
    {
        run.log.wanted = false;
        let short = ShortStep { chart, direct, run, host, micro_steps: 0, transitions: 0 };
        return short.handle(occurrence, reactions, leaves);
    }
    run.queues.arrived.push(occurrence);
    self::run(chart, run, host)
}

impl Run {
    /// Whether nothing is left of the steps that were but the configuration, timers and failed guards, and the short way leads on from here.
    pub(super) fn can_go_on_directly(&self, chart: &Chart) -> bool {
        self.is_at_rest() && chart.direct.as_ref().is_some_and(|direct| self.goes_on_directly(direct))
    }

    /// States with activities, and those that may go on without an event, are detours: so nothing runs, and nothing waits but events.
    #[inline(always)]
    fn goes_on_directly(&self, direct: &Direct) -> bool {
        self.active.first_word() & direct.detours == 0
            && self.queues.raised.has_none()
            && self.queues.deferred.has_none()
            && self.status == Status::Running
    }

    fn is_at_rest(&self) -> bool {
        self.queues.held.is_empty()
            && self.pending.is_empty()
            && self.newcomers.is_empty()
            && self.completions.is_empty()
            && self.under_way.is_none()
            && self.failure.is_none()
    }
}

impl<H: Host> ShortStep<'_, H> {
    #[inline(never)]
    fn run_traced(self) -> Result<StepSummary, MachineError> {
        self.run::<true>()
    }

    #[inline(always)]
    fn run<const TRACED: bool>(mut self) -> Result<StepSummary, MachineError> {
        if TRACED {
            self.run.log.clear();
        }
        self.begin();
        // not copied as a whole: it was just written piece by piece, and processors wait for that
        while let Some(first) = self.run.queues.first_arrived() {
            let Occurrence { event, is_known, token, .. } = *first;
            if !self.admit() {
                return self.go_on();
            }
            self.host.offered(event, is_known, token);
            if TRACED || !self.leap(event) {
                self.offer::<TRACED>(event);
            }
            if !self.run.goes_on_directly(self.direct) {
                return self.go_on();
            }
        }
        Ok(self.finish())
    }

    #[inline(always)]
    fn handle(
        mut self,
        occurrence: Occurrence,
        reactions: &Reactions,
        leaves: u64,
    ) -> Result<StepSummary, MachineError> {
        self.begin();
        if !self.admit() {
            self.run.queues.arrived.push(occurrence);
            return self.go_on();
        }
        self.host.offered(occurrence.event, occurrence.is_known, occurrence.token);
        if !self.leap_from(reactions, leaves) {
            self.run.queues.arrived.push(occurrence);
            self.keep();
        }
        if !self.run.goes_on_directly(self.direct) || !self.run.queues.arrived.has_none() {
            return self.go_on();
        }
        Ok(self.finish())
    }

    #[inline(always)]
    fn begin(&mut self) {
        self.run.due = false;
        if self.chart.semantics_ref().delivery == Delivery::EachStep {
            self.deliver();
        }
    }

    #[inline(never)]
    fn go_on(mut self) -> Result<StepSummary, MachineError> {
        self.run.is_settled = false;
        self.long_way().run_on()
    }

    #[inline(always)]
    fn summary(&self) -> StepSummary {
        StepSummary { micro_steps: self.micro_steps, transitions: self.transitions, started: 0 }
    }

    /// The same step on the long way.
    #[inline(always)]
    pub(super) fn long_way(&mut self) -> Step<'_, H> {
        let summary = self.summary();
        Step { chart: self.chart, run: self.run, host: self.host, summary }
    }

    /// Of a host without messages the compiler leaves nothing here.
    #[inline(always)]
    fn deliver(&mut self) {
        if !self.run.erred.is_empty() {
            return self.long_way().deliver_to_all();
        }
        for (index, region) in self.chart.regions.iter().enumerate() {
            if self.run.is_active(region.root) {
                self.host.deliver(RegionId(index as u32));
            }
        }
    }

    #[inline(always)]
    fn finish(&mut self) -> StepSummary {
        // there are no more blackboards than states
        if self.run.written.first_word() != 0 {
            self.publish();
        }
        self.summary()
    }

    #[inline(never)]
    fn publish(&mut self) {
        self.long_way().publish_written();
    }

    /// Counts one more micro-step, if there may be one: what stands in the way is for the long way to say.
    #[inline(always)]
    fn admit(&mut self) -> bool {
        let (limit, bound) = (self.chart.semantics_ref().limit, &mut self.run.bound);
        if self.micro_steps == 0 {
            if !bound.begin_with_one(self.run.now, limit) {
                return false;
            }
        } else if bound.allows_micro_step(limit) {
            bound.count_micro_step();
        } else {
            return false;
        }
        self.micro_steps += 1;
        true
    }

    /// Offers an event. Most lead to one transition, which happens without a list. Which failures of guards have been told in the micro-step
    /// before need not be forgotten: each of them raised an event, with which the long way has begun one more since.
    #[inline(never)]
    fn offer<const TRACED: bool>(&mut self, event: EventId) {
        let mut search = Search::new(self.run.active.first_word(), self.direct);
        let first = self.next_way::<TRACED>(&mut search, event);
        if TRACED {
            self.run.selection.clear();
        }
        let Some(first) = first else { return self.keep() };
        self.run.queues.drop_arrived();
        match self.next_way::<TRACED>(&mut search, event) {
            None => self.fire::<TRACED>(first),
            Some(second) => self.fire_several::<TRACED>(search, [first, second], event),
        }
        let active = self.run.active.first_word();
        self.run.tips.set_first_word(active & self.direct.leaves);
        if TRACED {
            self.long_way().emit(Occasion::Event(event), None);
            self.run.log.clear();
        }
    }

    #[inline(never)]
    pub(super) fn keep(&mut self) {
        let Some(occurrence) = self.run.queues.next_arrived() else { return };
        self.run.selection.clear();
        let mut step = self.long_way();
        let deferred = step.keep(occurrence);
        step.emit(Occasion::Event(occurrence.event), deferred);
        self.run.log.clear();
    }

    /// The next transition that the event enables: from the innermost states outward, not where all that is active inside has found one.
    #[inline(always)]
    fn next_way<const TRACED: bool>(&mut self, search: &mut Search, event: EventId) -> Option<u16> {
        while search.sources != 0 {
            let place = &self.direct.places[search.sources.trailing_zeros() as usize];
            search.sources &= search.sources - 1;
            if search.open & place.inside == 0 {
                continue;
            }
            let (first, last) = (place.ways.start as usize, place.ways.end as usize);
            let ways = self.direct.ways.get(first..last).unwrap_or_default();
            for (index, way) in (place.ways.start..).zip(ways) {
                if way.event == event && way.guard.is_none_or(|guard| self.holds::<TRACED>(guard)) {
                    search.open &= !place.inside;
                    return Some(index);
                }
            }
        }
        None
    }

    #[inline(always)]
    pub(super) fn holds<const TRACED: bool>(&mut self, guard: u32) -> bool {
        if !TRACED && self.run.erred.is_empty() {
            let scoped = &self.chart.guards[guard as usize];
            let view = View { chart: self.chart, run: self.run, host: self.host, region: scoped.region };
            if let Some(value) = scoped.guard.evaluate_plainly(&view) {
                return value;
            }
            if let Ok(value) = scoped.guard.evaluate(&view) {
                return value;
            }
        }
        self.long_way().holds(guard as usize)
    }

    /// Of transitions that leave the same state, the one that was found first fires; all that do, in the order that is meant, but not one whose
    /// source another has left, nor one after the end.
    #[inline(never)]
    fn fire_several<const TRACED: bool>(&mut self, mut search: Search, found: [u16; 2], event: EventId) {
        let mut chosen = Chosen::default();
        found.into_iter().for_each(|index| self.choose::<TRACED>(&mut chosen, index));
        while let Some(index) = self.next_way::<TRACED>(&mut search, event) {
            self.choose::<TRACED>(&mut chosen, index);
        }
        let direct = self.direct;
        let ways = &mut chosen.ways[..chosen.count];
        if !chosen.in_order {
            ways.sort_unstable_by_key(|&index| direct.ways[index as usize].key);
        }
        for &index in ways.iter() {
            let source = direct.ways[index as usize].source;
            if self.run.active.first_word() & source != 0 && self.run.status == Status::Running {
                self.fire::<TRACED>(index);
            }
        }
    }

    #[inline(always)]
    fn choose<const TRACED: bool>(&mut self, chosen: &mut Chosen, index: u16) {
        let way = &self.direct.ways[index as usize];
        if way.exits & chosen.left == 0 {
            chosen.left |= way.exits;
            chosen.in_order &= chosen.last_key <= way.key;
            chosen.last_key = way.key;
            chosen.ways[chosen.count] = index;
            chosen.count += 1;
        } else if TRACED {
            self.run.selection.preempted.push(way.compound);
        }
    }

    #[inline(always)]
    fn fire<const TRACED: bool>(&mut self, index: u16) {
        let way = &self.direct.ways[index as usize];
        self.transitions += 1;
        self.run.bound.remember(way.compound);
        if TRACED {
            self.run.selection.selected.push(way.compound);
        }
        let mut active = self.run.active.first_word();
        // known before it has happened, so that what comes next need not wait for it
        let after = active & !way.exits | way.enters;
        let mut exits = active & way.exits;
        while exits != 0 {
            let place = exits.trailing_zeros();
            exits &= exits - 1;
            active = self.leave::<TRACED>(Place(place), active);
        }
        if way.acts {
            self.act_on(way.compound);
        }
        let entries = self.direct.entries.get(way.entries.start as usize..way.entries.end as usize);
        for &place in entries.unwrap_or_default() {
            active = self.enter::<TRACED>(place, active);
        }
        self.run.active.set_first_word(after);
    }

    #[inline(never)]
    pub(super) fn act_on(&mut self, compound: CompoundId) {
        let compound = &self.chart.compounds[compound.0 as usize];
        self.long_way().do_actions(compound);
    }

    #[inline(always)]
    fn leave<const TRACED: bool>(&mut self, place: Place, active: u64) -> u64 {
        let state = &self.direct.places[place.index()];
        match state.exit {
            DirectActions::None => {}
            DirectActions::Script(script) => {
                self.perform::<TRACED>(script, state.region, ActionPlace::Exit(state.node));
            }
            DirectActions::Others => self.act_at_exit(state, place),
        }
        let active = active & !(1 << place.0);
        self.run.active.set_first_word(active);
        if TRACED {
            self.run.log.exits.push(state.node);
        }
        active
    }

    #[inline(always)]
    fn enter<const TRACED: bool>(&mut self, place: Place, active: u64) -> u64 {
        let state = &self.direct.places[place.index()];
        let active = active | 1 << place.0;
        if !state.is_plain {
            self.long_way().enter(place);
            return active;
        }
        self.run.active.set_first_word(active);
        if TRACED {
            self.run.log.entries.push(state.node);
        }
        match state.entry {
            DirectActions::None => {}
            DirectActions::Script(script) => {
                self.perform::<TRACED>(script, state.region, ActionPlace::Entry(state.node));
            }
            DirectActions::Others => self.act_at_entry(state, place),
        }
        active
    }

    #[inline(never)]
    pub(super) fn act_at_exit(&mut self, state: &DirectPlace, place: Place) {
        let scene = Scene { place: ActionPlace::Exit(state.node), region: state.region, owner: Owner::None };
        let actions = &self.chart.states[place.index()].exit;
        self.long_way().perform(actions, scene);
    }

    #[inline(never)]
    pub(super) fn act_at_entry(&mut self, state: &DirectPlace, place: Place) {
        let owner = Owner::State(place);
        let scene = Scene { place: ActionPlace::Entry(state.node), region: state.region, owner };
        let actions = &self.chart.states[place.index()].entry;
        self.long_way().perform(actions, scene);
    }

    /// The only action of a place, which is the host's.
    #[inline(always)]
    pub(super) fn perform<const TRACED: bool>(
        &mut self,
        script: ScriptId,
        region: RegionId,
        at: ActionPlace,
    ) {
        if TRACED {
            self.run.log.effects.push(at);
        }
        let mut performance = Performance { chart: self.chart, run: self.run };
        if let Err(error) = self.host.perform(script, region, &mut performance) {
            self.long_way().action_failed(at, 0, &ActionError::Script(error));
        }
    }
}

/// Where transitions are still looked for.
#[derive(Clone, Copy)]
struct Search {
    /// The active states with ways out that were not looked at.
    sources: u64,
    /// The innermost active states that have found none.
    open: u64,
}

impl Search {
    #[inline(always)]
    fn new(active: u64, direct: &Direct) -> Search {
        Search { sources: active & direct.sources, open: active & direct.leaves }
    }
}

/// Transitions that happen together: each has a source of its own, so there are no more than states.
struct Chosen {
    ways: [u16; u64::BITS as usize],
    count: usize,
    /// The states that they leave, if those are active.
    left: u64,
    last_key: u64,
    in_order: bool,
}

impl Default for Chosen {
    fn default() -> Chosen {
        Chosen { ways: [0; u64::BITS as usize], count: 0, left: 0, last_key: 0, in_order: true }
    }
}
