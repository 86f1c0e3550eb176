//! The mutable state of a running chart.

use std::collections::VecDeque;

use crate::bits::BitSet;
use crate::compile::{CompiledChart, NodeIndex};
use crate::expression::EventId;
use crate::ids::{ActionLocation, CompoundTransitionId, ScopeId};
use crate::machine::activities::ActivityTable;
use crate::machine::chooser::Chooser;
use crate::machine::errors::StepError;
use crate::machine::history::HistoryValue;
use crate::machine::livelock_limit::LivelockLimit;
use crate::machine::queues::{EventQueues, QueuedEvent};
use crate::machine::regions_to_enter::RegionsToEnter;
use crate::machine::timers::TimerTable;
use crate::machine::{Status, StepSummary};
use crate::semantics::FailureEvents;
use crate::statechart::{NodeId, NodeKind, TransitionId};
use crate::timestamp::Timestamp;
use crate::vocabulary::TopicId;

#[derive(Clone, Debug)]
pub(crate) struct MachineState {
    pub(crate) status: Status,
    pub(crate) now: Timestamp,
    /// Whether a step is due for reasons other than events and timers.
    pub(crate) needs_step: bool,
    /// The summary so far of a step that is executed by micro-steps and has not ended.
    pub(crate) step_in_progress: Option<StepSummary>,
    /// The configuration, by node index.
    pub(crate) active: BitSet,
    /// The BASIC states whose activity is running, by node index.
    pub(crate) running: BitSet,
    /// The regions locked by them.
    pub(crate) running_regions: BitSet,
    pub(crate) activities: ActivityTable,
    pub(crate) timers: TimerTable,
    pub(crate) queues: EventQueues,
    /// Interrupting transitions that wait for cancelled activities, oldest first.
    pub(crate) pending: Vec<PendingInterrupt>,
    /// The guards that had no value in their last evaluation.
    pub(crate) failed_guards: Vec<FailedGuard>,
    /// The segments whose guards had no value in this micro-step, and were reported.
    reported_failures: Vec<TransitionId>,
    /// The weighted segments chosen in this micro-step, in order.
    pub(crate) drawn_segments: Vec<TransitionId>,
    /// The blackboards that were written in this step.
    pub(crate) written: BitSet,
    /// The active STARTs that have been reported as waiting.
    pub(crate) waiting_starts: BitSet,
    pub(crate) regions_to_enter: RegionsToEnter,
    pub(crate) livelock_limit: LivelockLimit,
    pub(crate) chooser: Chooser,
    /// The innermost active nodes, by index: active leaves, and composites without an active child.
    pub(crate) active_leaves: BitSet,
    /// The composites that were left without an active child.
    pub(crate) vacated: BitSet,
    /// The segments into JOINs that were taken individually, by index.
    pub(crate) arrived: BitSet,
    /// The states that have completed and were not examined since, where that happens once.
    pub(crate) completions: VecDeque<NodeIndex>,
    /// The value of each HISTORY.
    pub(crate) records: Box<[HistoryValue]>,
    /// Whether the root has reached its END and is to be left.
    pub(crate) root_is_final: bool,
    /// Whether TERMINATE was reached in this micro-step.
    pub(crate) terminates: bool,
    /// The error that prevented the start of the chart.
    pub(crate) failure: Option<StepError>,
    /// The configuration before this micro-step, in charts with CHOICEs.
    pub(crate) previous_configuration: BitSet,
    /// The nodes to be entered, with all their ancestors.
    pub(crate) marked: BitSet,
    /// The nodes to be entered next, the first one last.
    pub(crate) entering: Vec<NodeIndex>,
    /// The ANDs that were entered on the way to a target, and whose other regions are not yet.
    pub(crate) incomplete: Vec<NodeIndex>,
    /// The transitions of a micro-step in phases that end where they arrive.
    pub(crate) ending_early: Vec<CompoundTransitionId>,
    /// The composite whose START is being left.
    pub(crate) starting: Option<NodeIndex>,
    /// The nodes to be left.
    pub(crate) leaving: Vec<NodeIndex>,
    /// The selected transitions that enter a node, in the document order of their scopes.
    pub(crate) document_order: Vec<CompoundTransitionId>,
    /// Timers whose owner, a target, is not yet known.
    pub(crate) unbound_timers: Vec<usize>,
    pub(crate) selection: TransitionSelection,
    pub(crate) log: StepLog,
    /// A buffer for assigned texts.
    pub(crate) text: String,
}

/// An interrupting transition that has been selected.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PendingInterrupt {
    pub(crate) compound: CompoundTransitionId,
    pub(crate) event: Option<EventId>,
}

/// A guard that had no value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FailedGuard {
    pub(crate) guard: usize,
    /// Whether a message that it reads has arrived since, but is not delivered to its blackboard
    /// yet.
    pub(crate) stale: bool,
}

/// The working memory of a micro-step.
#[derive(Clone, Debug)]
pub(crate) struct TransitionSelection {
    /// Enabled transitions, inner before outer, then in document order.
    pub(crate) candidates: Vec<CompoundTransitionId>,
    /// For each of them, the state at which it was found or, for phases, the first active leaf for
    /// which it was found.
    pub(crate) found_for: Vec<NodeIndex>,
    /// The transitions that win and can be taken now.
    pub(crate) selected: Vec<CompoundTransitionId>,
    pub(crate) preempted: Vec<CompoundTransitionId>,
    /// The transitions that would be enabled if no activity were running.
    pub(crate) held: Vec<CompoundTransitionId>,
    /// The active leaves for which a transition was found, at them or at an ancestor.
    pub(crate) closed: BitSet,
    /// The active leaves for which a transition was found that would be enabled if no activity were
    /// running.
    pub(crate) noted: BitSet,
    /// Whether there are any.
    pub(crate) has_noted: bool,
}

impl TransitionSelection {
    #[inline]
    pub(crate) fn clear(&mut self) {
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

/// The buffers of a trace record.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepLog {
    pub(crate) wanted: bool,
    pub(crate) exits: Vec<NodeId>,
    pub(crate) effects: Vec<ActionLocation>,
    pub(crate) taken: Vec<TransitionId>,
    pub(crate) entries: Vec<NodeId>,
    pub(crate) guards: Vec<(TransitionId, Option<bool>)>,
}

impl StepLog {
    pub(crate) fn clear(&mut self) {
        self.exits.clear();
        self.effects.clear();
        self.taken.clear();
        self.entries.clear();
        self.guards.clear();
    }
}

impl MachineState {
    pub(crate) fn new(chart: &CompiledChart) -> MachineState {
        let count = chart.layout.len();
        let regions = chart.regions.len();
        MachineState {
            status: Status::Idle,
            now: Timestamp::ZERO,
            needs_step: false,
            step_in_progress: None,
            active: BitSet::new(count),
            running: BitSet::new(count),
            running_regions: BitSet::new(regions),
            activities: ActivityTable::new(chart.activities.len()),
            timers: TimerTable::new(chart.timers.len()),
            queues: EventQueues::default(),
            pending: Vec::with_capacity(4),
            failed_guards: Vec::new(),
            reported_failures: Vec::new(),
            drawn_segments: Vec::new(),
            written: BitSet::new(regions),
            waiting_starts: BitSet::new(count),
            regions_to_enter: RegionsToEnter::default(),
            livelock_limit: LivelockLimit::new(),
            chooser: Chooser::declared(),
            active_leaves: BitSet::new(count),
            vacated: BitSet::new(count),
            arrived: BitSet::new(chart.joins.iter().map(|join| join.regions.len()).sum()),
            completions: VecDeque::new(),
            records: vec![HistoryValue::default(); chart.histories.len()].into(),
            root_is_final: false,
            terminates: false,
            failure: None,
            previous_configuration: BitSet::new(count),
            marked: BitSet::new(count),
            entering: Vec::new(),
            incomplete: Vec::new(),
            ending_early: Vec::new(),
            starting: None,
            leaving: Vec::new(),
            document_order: Vec::new(),
            unbound_timers: Vec::new(),
            selection: TransitionSelection {
                candidates: Vec::with_capacity(regions),
                found_for: Vec::with_capacity(regions),
                selected: Vec::with_capacity(regions),
                preempted: Vec::with_capacity(regions),
                held: Vec::with_capacity(regions),
                closed: BitSet::new(count),
                noted: BitSet::new(count),
                has_noted: false,
            },
            log: StepLog::default(),
            text: String::new(),
        }
    }

    /// Copies the state of another machine in a stable configuration; the working memory of a
    /// micro-step is not copied, since the next one clears it.
    pub(crate) fn copy_from(&mut self, other: &MachineState) {
        // destructured, so that the compiler reports a new field
        let MachineState {
            status,
            now,
            needs_step,
            step_in_progress,
            active,
            running,
            running_regions,
            activities,
            timers,
            queues,
            pending,
            failed_guards,
            reported_failures: _,
            drawn_segments: _,
            written,
            waiting_starts,
            regions_to_enter,
            livelock_limit,
            chooser,
            active_leaves,
            vacated,
            arrived,
            completions,
            records,
            root_is_final,
            terminates,
            failure,
            previous_configuration,
            marked,
            entering,
            incomplete: _,
            ending_early: _,
            starting: _,
            leaving,
            document_order,
            unbound_timers,
            selection: _,
            log: _,
            text: _,
        } = other;
        (self.status, self.now, self.needs_step) = (*status, *now, *needs_step);
        (self.step_in_progress, self.root_is_final, self.terminates) =
            (*step_in_progress, *root_is_final, *terminates);
        let sets = [
            active,
            running,
            running_regions,
            written,
            waiting_starts,
            active_leaves,
            vacated,
            arrived,
            previous_configuration,
            marked,
        ];
        let own = [
            &mut self.active,
            &mut self.running,
            &mut self.running_regions,
            &mut self.written,
            &mut self.waiting_starts,
            &mut self.active_leaves,
            &mut self.vacated,
            &mut self.arrived,
            &mut self.previous_configuration,
            &mut self.marked,
        ];
        own.into_iter().zip(sets).for_each(|(own, other)| own.copy_from(other));
        self.activities.copy_from(activities);
        self.timers.copy_from(timers);
        self.queues.clone_from(queues);
        self.pending.clone_from(pending);
        self.failed_guards.clone_from(failed_guards);
        self.regions_to_enter.clone_from(regions_to_enter);
        self.livelock_limit.clone_from(livelock_limit);
        self.chooser.clone_from(chooser);
        self.completions.clone_from(completions);
        self.records.clone_from(records);
        self.failure.clone_from(failure);
        self.entering.clone_from(entering);
        self.leaving.clone_from(leaving);
        self.document_order.clone_from(document_order);
        self.unbound_timers.clone_from(unbound_timers);
    }

    /// Discards everything except the number of activities started so far.
    pub(crate) fn reset(&mut self, now: Timestamp) {
        self.status = Status::Running;
        self.now = now;
        self.needs_step = true;
        self.step_in_progress = None;
        self.active.clear();
        self.running.clear();
        self.running_regions.clear();
        self.activities.reset();
        self.timers.reset();
        self.queues.clear();
        self.pending.clear();
        self.failed_guards.clear();
        self.written.clear();
        self.waiting_starts.clear();
        self.regions_to_enter = RegionsToEnter::default();
        self.livelock_limit.reset(now);
        self.active_leaves.clear();
        self.vacated.clear();
        self.arrived.clear();
        self.completions.clear();
        self.records.iter_mut().for_each(|record| record.is_known = false);
        self.root_is_final = false;
        self.terminates = false;
        self.failure = None;
        self.marked.clear();
    }

    /// Undoes the entries of a chart that could not be started.
    pub(crate) fn clear_entered(&mut self) {
        self.active.clear();
        self.active_leaves.clear();
        self.running.clear();
        self.running_regions.clear();
        self.activities.reset();
        self.timers.reset();
        self.completions.clear();
        self.marked.clear();
        self.entering.clear();
        self.incomplete.clear();
        self.unbound_timers.clear();
    }

    /// Clears the records of one micro-step.
    #[inline]
    pub(crate) fn begin_micro_step(&mut self) {
        if self.log.wanted {
            self.log.clear();
        }
        self.selection.clear();
        self.reported_failures.clear();
        self.drawn_segments.clear();
    }

    /// Records that a guard had no value; returns whether that is to be reported.
    pub(crate) fn record_guard_failure(&mut self, chart: &CompiledChart, guard: usize) -> bool {
        let is_new = !self.failed_guards.iter().any(|erred| erred.guard == guard);
        let every_time = chart.semantics_ref().failures == FailureEvents::EveryTime;
        if is_new && !every_time {
            self.failed_guards.push(FailedGuard { guard, stale: false });
        }
        let segment = chart.guards[guard].transition;
        let is_told = self.reported_failures.contains(&segment);
        if (is_new || every_time) && !is_told {
            self.reported_failures.push(segment);
            return true;
        }
        false
    }

    /// A message has arrived on a topic, or an action has written it in one scope: guards that had
    /// no value may have one.
    pub(crate) fn topic_changed(
        &mut self,
        chart: &CompiledChart,
        topic: TopicId,
        written_on: Option<ScopeId>,
    ) {
        self.failed_guards.retain_mut(|erred| {
            let guard = &chart.guards[erred.guard];
            let reads = guard.guard.reads().contains(&topic);
            erred.stale |= reads && written_on.is_none();
            !(reads && written_on == Some(guard.region))
        });
    }

    /// A blackboard has received the arrived messages.
    #[inline]
    pub(crate) fn delivered(&mut self, chart: &CompiledChart, region: ScopeId) {
        self.failed_guards.retain(|erred| !(erred.stale && chart.guards[erred.guard].region == region));
    }

    /// A timer was set or has expired.
    #[inline]
    pub(crate) fn timer_changed(&mut self, chart: &CompiledChart, timer: usize) {
        if self.failed_guards.is_empty() {
            return;
        }
        let changed = &chart.timers[timer];
        self.failed_guards.retain(|erred| {
            let guard = &chart.guards[erred.guard];
            let reads = guard.guard.timers().iter().any(|read| read.0 as usize == changed.number);
            !(reads && guard.region == changed.region)
        });
    }

    /// Discards the timers of a state that is left, with their expiries.
    pub(crate) fn release_timers(&mut self, chart: &CompiledChart, node: NodeIndex) {
        while let Some(timer) = self.timers.release(node) {
            self.queues.withdraw(timer);
            self.timer_changed(chart, timer);
        }
    }

    /// Whether a pending interrupting transition will leave it when activities have returned.
    #[inline]
    pub(crate) fn has_pending_exit(&self, chart: &CompiledChart, node: NodeIndex) -> bool {
        self.pending.iter().any(|pending| chart.compounds[pending.compound.0 as usize].leaves(node))
    }

    /// Queues an event before those that arrive.
    pub(crate) fn raise(&mut self, chart: &CompiledChart, event: EventId, is_known: bool, token: u64) {
        let incoming = QueuedEvent { event, expiry: None, token, is_known };
        self.queues.raise(incoming, chart.semantics().pool);
    }

    /// A node becomes active.
    #[inline]
    pub(crate) fn activate(&mut self, chart: &CompiledChart, node: NodeIndex) {
        self.active.insert(node.index());
        if !matches!(chart.states[node.index()].kind, NodeKind::Or | NodeKind::And) {
            self.active_leaves.insert(node.index());
        }
    }

    #[inline]
    pub(crate) fn is_active(&self, node: NodeIndex) -> bool {
        self.active.contains(node.index())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::statechart::{Node, NodeKind, Statechart, Transition};
    use crate::vocabulary::TypeEnvironment;
    use crate::{Activation, Host, Machine, Semantics, Timestamp};

    struct NoActivities;

    impl Host for NoActivities {
        fn start(&mut self, _: Activation) {}
        fn cancel(&mut self, _: Activation) {}
        fn stop(&mut self, _: Activation) {}
    }

    #[test]
    fn arrivals_at_any_number_of_exit_points_are_kept() {
        let mut chart = Statechart::new("exits");
        let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
        let last = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "last"));
        let mut before = start;
        for number in 0..65 {
            let both = chart.add(Statechart::ROOT, Node::new(NodeKind::And, format!("both{number}")));
            let exit = chart.add(both, Node::new(NodeKind::ExitPoint, "out"));
            for _ in 0..2 {
                let region = chart.add(both, Node::new(NodeKind::Or, ""));
                let begin = chart.add(region, Node::new(NodeKind::Start, ""));
                let state = chart.add(region, Node::new(NodeKind::Basic, "state"));
                chart.connect(Transition::new(begin, state));
                chart.connect(Transition::new(state, exit));
            }
            chart.connect(Transition::new(before, both));
            before = exit;
        }
        chart.connect(Transition::new(before, last));
        let compiled = chart.compile_with(&TypeEnvironment::default(), Semantics::uml()).unwrap();
        let mut machine = Machine::new(Arc::new(compiled));
        machine.start(Timestamp::ZERO, &mut NoActivities);
        machine.run_to_completion(Timestamp::ZERO, &mut NoActivities).unwrap();
        assert!(machine.is_active(last), "{:?}", machine.configuration());
    }
}
