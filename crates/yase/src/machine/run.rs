//! Everything about a running chart that changes.

use std::collections::VecDeque;

use crate::bits::BitSet;
use crate::chart::{Chart, CompoundId, Place, RegionId};
use crate::expression::EventId;
use crate::host::ActionPlace;
use crate::machine::activities::Activities;
use crate::machine::bound::Bound;
use crate::machine::chooser::Chooser;
use crate::machine::errors::Fault;
use crate::machine::history::Record;
use crate::machine::newcomers::Newcomers;
use crate::machine::queues::{Incoming, Queues};
use crate::machine::timers::Timers;
use crate::machine::{Status, StepSummary};
use crate::moment::Moment;
use crate::semantics::FailureEvents;
use crate::statechart::{NodeId, NodeKind, TransitionId};
use crate::vocabulary::TopicId;

#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) status: Status,
    pub(super) now: Moment,
    /// Whether something happened that a step may answer to, other than events and timers.
    pub(super) due: bool,
    /// Whether the last step has ended with nothing left to be done, in a configuration from which the short way leads, and nothing has
    /// happened since but arriving events. Every long step takes it back, and says at its end.
    pub(super) is_settled: bool,
    /// What a step has done that is taken one micro-step at a time and has not ended.
    pub(super) under_way: Option<StepSummary>,
    /// The configuration, by place.
    pub(super) active: BitSet,
    /// The BASIC states whose activity runs, by place.
    pub(super) running: BitSet,
    /// The regions that they lock.
    pub(super) running_regions: BitSet,
    pub(super) activities: Activities,
    pub(super) timers: Timers,
    pub(super) queues: Queues,
    /// Interrupting transitions that wait for cancelled activities, oldest first.
    pub(super) pending: Vec<Pending>,
    /// The guards that had no value when they were last read.
    pub(super) erred: Vec<ErredGuard>,
    /// The segments whose guards had none in this micro-step, of which it was told.
    told: Vec<TransitionId>,
    /// The segments with a weight that were drawn in this micro-step, in order.
    pub(super) drawn: Vec<TransitionId>,
    /// The blackboards that were written in this step.
    pub(super) written: BitSet,
    /// The active STARTs of which it was told that they wait.
    pub(super) waiting_starts: BitSet,
    pub(super) newcomers: Newcomers,
    pub(super) bound: Bound,
    pub(super) chooser: Chooser,
    /// The innermost active nodes, by place: active leaves, and composites without an active child.
    pub(super) tips: BitSet,
    /// The composites that were left without an active child.
    pub(super) vacated: BitSet,
    /// The segments into JOINs that were taken by themselves, by number.
    pub(super) arrived: BitSet,
    /// The states that have completed and were not looked at since, where that is done once.
    pub(super) completions: VecDeque<Place>,
    /// What each HISTORY remembers.
    pub(super) records: Box<[Record]>,
    /// Whether the root has reached its END and is to be left.
    pub(super) ending: bool,
    /// Whether TERMINATE was reached in this micro-step.
    pub(super) terminates: bool,
    /// What kept the chart from being started.
    pub(super) failure: Option<Fault>,
    /// The configuration before this micro-step, in charts with CHOICEs.
    pub(super) before: BitSet,
    /// What is to be entered, with all that is around it.
    pub(super) marked: BitSet,
    /// What is to be entered next, the first one last.
    pub(super) entering: Vec<Place>,
    /// What is to be left.
    pub(super) leaving: Vec<Place>,
    /// The selected transitions that enter something, in the order of their scopes in the document.
    pub(super) in_document: Vec<CompoundId>,
    /// Timers that belong to a target that is not yet known.
    pub(super) unbound: Vec<usize>,
    pub(super) selection: Selection,
    pub(super) log: Log,
    /// Where texts that are assigned are copied to.
    pub(super) text: String,
}

/// An interrupting transition that has been selected.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pending {
    pub(super) compound: CompoundId,
    pub(super) event: Option<EventId>,
}

/// A guard that had no value.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErredGuard {
    pub(super) guard: usize,
    /// Whether a message that it reads has arrived since, which its blackboard has still to receive.
    pub(super) stale: bool,
}

/// What a micro-step works with.
#[derive(Clone, Debug)]
pub(super) struct Selection {
    /// Enabled transitions, inner before outer, then in the order of the document.
    pub(super) candidates: Vec<CompoundId>,
    /// For each of them, the state that it was found at or, for phases, the first active leaf that it was found for.
    pub(super) found_for: Vec<Place>,
    /// Those that win and can fire now.
    pub(super) selected: Vec<CompoundId>,
    pub(super) preempted: Vec<CompoundId>,
    /// Those that would be enabled but for running activities.
    pub(super) held: Vec<CompoundId>,
    /// The active leaves for which a transition was found, on the way from them outward.
    pub(super) closed: BitSet,
    /// The active leaves for which a transition was found that would be enabled but for running activities.
    pub(super) noted: BitSet,
    /// Whether there are any.
    pub(super) has_noted: bool,
}

impl Selection {
    pub(super) fn clear(&mut self) {
        if !self.candidates.is_empty() {
            self.closed.clear();
            self.candidates.clear();
            self.found_for.clear();
        }
        if self.has_noted {
            self.noted.clear();
            self.has_noted = false;
        }
        self.selected.clear();
        self.preempted.clear();
        self.held.clear();
    }
}

/// What a trace record borrows.
#[derive(Clone, Debug, Default)]
pub(super) struct Log {
    pub(super) wanted: bool,
    pub(super) exits: Vec<NodeId>,
    pub(super) effects: Vec<ActionPlace>,
    pub(super) taken: Vec<TransitionId>,
    pub(super) entries: Vec<NodeId>,
    pub(super) guards: Vec<(TransitionId, Option<bool>)>,
}

impl Log {
    pub(super) fn clear(&mut self) {
        self.exits.clear();
        self.effects.clear();
        self.taken.clear();
        self.entries.clear();
        self.guards.clear();
    }
}

impl Run {
    pub(super) fn new(chart: &Chart) -> Run {
        let places = chart.layout.len();
        let regions = chart.regions.len();
        Run {
            status: Status::Idle,
            now: Moment::ZERO,
            due: false,
            is_settled: false,
            under_way: None,
            active: BitSet::new(places),
            running: BitSet::new(places),
            running_regions: BitSet::new(regions),
            activities: Activities::new(chart.activities.len()),
            timers: Timers::new(chart.timers.len()),
            queues: Queues::default(),
            pending: Vec::with_capacity(4),
            erred: Vec::new(),
            told: Vec::new(),
            drawn: Vec::new(),
            written: BitSet::new(regions),
            waiting_starts: BitSet::new(places),
            newcomers: Newcomers::default(),
            bound: Bound::new(),
            chooser: Chooser::declared(),
            tips: BitSet::new(places),
            vacated: BitSet::new(places),
            arrived: BitSet::new(chart.joins.iter().map(|join| join.sources.len()).sum()),
            completions: VecDeque::new(),
            records: vec![Record::default(); chart.histories.len()].into(),
            ending: false,
            terminates: false,
            failure: None,
            before: BitSet::new(places),
            marked: BitSet::new(places),
            entering: Vec::new(),
            leaving: Vec::new(),
            in_document: Vec::new(),
            unbound: Vec::new(),
            selection: Selection {
                candidates: Vec::with_capacity(regions),
                found_for: Vec::with_capacity(regions),
                selected: Vec::with_capacity(regions),
                preempted: Vec::with_capacity(regions),
                held: Vec::with_capacity(regions),
                closed: BitSet::new(places),
                noted: BitSet::new(places),
                has_noted: false,
            },
            log: Log::default(),
            text: String::new(),
        }
    }

    /// Becomes equal to another at rest; what a micro-step works with is not looked at, since the next one begins with clearing it.
    pub(super) fn copy_from(&mut self, other: &Run) {
        // all by name, so that a field that is added is thought of here
        let Run {
            status,
            now,
            due,
            is_settled,
            under_way,
            active,
            running,
            running_regions,
            activities,
            timers,
            queues,
            pending,
            erred,
            told: _,
            drawn: _,
            written,
            waiting_starts,
            newcomers,
            bound,
            chooser,
            tips,
            vacated,
            arrived,
            completions,
            records,
            ending,
            terminates,
            failure,
            before,
            marked,
            entering,
            leaving,
            in_document,
            unbound,
            selection: _,
            log: _,
            text: _,
        } = other;
        (self.status, self.now, self.due, self.is_settled) = (*status, *now, *due, *is_settled);
        (self.under_way, self.ending, self.terminates) = (*under_way, *ending, *terminates);
        let sets = [
            active,
            running,
            running_regions,
            written,
            waiting_starts,
            tips,
            vacated,
            arrived,
            before,
            marked,
        ];
        let own = [
            &mut self.active,
            &mut self.running,
            &mut self.running_regions,
            &mut self.written,
            &mut self.waiting_starts,
            &mut self.tips,
            &mut self.vacated,
            &mut self.arrived,
            &mut self.before,
            &mut self.marked,
        ];
        own.into_iter().zip(sets).for_each(|(own, other)| own.copy_from(other));
        self.activities.copy_from(activities);
        self.timers.copy_from(timers);
        self.queues.clone_from(queues);
        self.pending.clone_from(pending);
        self.erred.clone_from(erred);
        self.newcomers.clone_from(newcomers);
        self.bound.clone_from(bound);
        self.chooser.clone_from(chooser);
        self.completions.clone_from(completions);
        self.records.clone_from(records);
        self.failure.clone_from(failure);
        self.entering.clone_from(entering);
        self.leaving.clone_from(leaving);
        self.in_document.clone_from(in_document);
        self.unbound.clone_from(unbound);
    }

    /// Forgets everything but how many activities were ever started.
    pub(super) fn reset(&mut self, now: Moment) {
        self.status = Status::Running;
        self.now = now;
        self.due = true;
        self.is_settled = false;
        self.under_way = None;
        self.active.clear();
        self.running.clear();
        self.running_regions.clear();
        self.activities.reset();
        self.timers.reset();
        self.queues.clear();
        self.pending.clear();
        self.erred.clear();
        self.written.clear();
        self.waiting_starts.clear();
        self.newcomers = Newcomers::default();
        self.bound.reset(now);
        self.tips.clear();
        self.vacated.clear();
        self.arrived.clear();
        self.completions.clear();
        self.records.iter_mut().for_each(|record| record.is_known = false);
        self.ending = false;
        self.terminates = false;
        self.failure = None;
        self.marked.clear();
    }

    /// The chart could not be started: nothing has been entered.
    pub(super) fn forget_entered(&mut self) {
        self.active.clear();
        self.tips.clear();
        self.running.clear();
        self.running_regions.clear();
        self.activities.reset();
        self.timers.reset();
        self.completions.clear();
        self.marked.clear();
        self.entering.clear();
        self.unbound.clear();
    }

    /// What is noted of one micro-step is forgotten.
    pub(super) fn begin_micro_step(&mut self) {
        self.log.clear();
        self.selection.clear();
        self.told.clear();
        self.drawn.clear();
    }

    /// A guard has had no value: says whether that is to be told.
    pub(super) fn note_failure(&mut self, chart: &Chart, guard: usize) -> bool {
        let is_new = !self.erred.iter().any(|erred| erred.guard == guard);
        let every_time = chart.semantics_ref().failures == FailureEvents::EveryTime;
        if is_new && !every_time {
            self.erred.push(ErredGuard { guard, stale: false });
        }
        let segment = chart.guards[guard].transition;
        let is_told = self.told.contains(&segment);
        if (is_new || every_time) && !is_told {
            self.told.push(segment);
            return true;
        }
        false
    }

    /// A message has arrived on a topic, or an action has written it on one blackboard: guards that had no value may have one.
    pub(super) fn topic_changed(&mut self, chart: &Chart, topic: TopicId, written_on: Option<RegionId>) {
        self.erred.retain_mut(|erred| {
            let guard = &chart.guards[erred.guard];
            let reads = guard.guard.reads().contains(&topic);
            erred.stale |= reads && written_on.is_none();
            !(reads && written_on == Some(guard.region))
        });
    }

    /// A blackboard has received what had arrived.
    pub(super) fn delivered(&mut self, chart: &Chart, region: RegionId) {
        self.erred.retain(|erred| !(erred.stale && chart.guards[erred.guard].region == region));
    }

    /// A timer was set or has expired.
    pub(super) fn timer_changed(&mut self, chart: &Chart, timer: usize) {
        let changed = &chart.timers[timer];
        self.erred.retain(|erred| {
            let guard = &chart.guards[erred.guard];
            let reads = guard.guard.timers().iter().any(|read| read.0 as usize == changed.number);
            !(reads && guard.region == changed.region)
        });
    }

    /// The timers of a state that is left are forgotten, and so are their expiries.
    pub(super) fn release_timers(&mut self, chart: &Chart, place: Place) {
        while let Some(timer) = self.timers.release(place) {
            self.queues.withdraw(timer);
            self.timer_changed(chart, timer);
        }
    }

    /// Whether an interrupting transition that leaves it waits for activities to return.
    pub(super) fn is_being_left(&self, chart: &Chart, place: Place) -> bool {
        self.pending.iter().any(|pending| chart.compounds[pending.compound.0 as usize].leaves(place))
    }

    /// An event is queued before those that arrive.
    pub(super) fn raise(&mut self, chart: &Chart, event: EventId, is_known: bool, token: u64) {
        let incoming = Incoming { event, expiry: None, token, is_known };
        self.queues.raise(incoming, chart.semantics().pool);
    }

    /// A node becomes active.
    pub(super) fn activate(&mut self, chart: &Chart, place: Place) {
        self.active.insert(place.index());
        if !matches!(chart.states[place.index()].kind, NodeKind::Or | NodeKind::And) {
            self.tips.insert(place.index());
        }
    }

    pub(super) fn is_active(&self, place: Place) -> bool {
        self.active.contains(place.index())
    }
}
