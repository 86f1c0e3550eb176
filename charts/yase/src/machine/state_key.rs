//! Support for exploration: state keys, and timers without a clock.

use std::time::Duration;

use crate::bits::BitSet;
use crate::compile::CompiledChart;
use crate::expression::EventId;
use crate::ids::{Activation, CompoundTransitionId};
use crate::machine::activities::{ActivityState, InvocationPhase};
use crate::machine::queues::PoppedEvent;
use crate::machine::timers::ArmedTimer;
use crate::machine::{Machine, Status};
use crate::statechart::NodeId;
use crate::timestamp::Timestamp;

/// The deadline of timers that have not been chosen to expire.
const UNCHOSEN_DEADLINE: Timestamp = Timestamp::from_nanos(u64::MAX);

/// The parts of a machine's state that can affect its later steps.
///
/// A timer that was never set and one that has expired are equal to a chart that only tests whether
/// it must still wait, as `[timeout]` does: neither expires any more, both let the guard hold, and
/// both are discarded when the timer is set again. They differ for a guard that tests whether a
/// timer *has* expired (`TimeoutCheck(timeout)`), for code, and while the expiry event is pending.
/// This reduces the states of a loop with its own timer from four to three, and these multiply with
/// each parallel loop.
#[derive(Debug)]
pub struct RelevantState {
    /// The timers for which "expired" and "never set" must be distinguished.
    distinguished_timers: BitSet,
}

impl RelevantState {
    /// The relevant state of a chart.
    pub fn new(chart: &CompiledChart) -> RelevantState {
        let mut told_apart = BitSet::new(chart.timers.len());
        for scoped in &chart.guards {
            let first = chart.regions[scoped.region.index()].timers;
            let timers = scoped.guard.timers_distinguished_from_unset();
            timers.iter().for_each(|timer| told_apart.insert(first + timer.0 as usize));
        }
        RelevantState { distinguished_timers: told_apart }
    }

    /// Everything is relevant.
    pub fn of_all(chart: &CompiledChart) -> RelevantState {
        let mut told_apart = BitSet::new(chart.timers.len());
        (0..chart.timers.len()).for_each(|timer| told_apart.insert(timer));
        RelevantState { distinguished_timers: told_apart }
    }
}

/// Machines with equal keys behave equally from then on.
pub type StateKey = Box<[u32]>;

impl Machine {
    /// [The words](Machine::write_key) of a machine in a stable configuration.
    pub fn key(&self, sight: &RelevantState) -> StateKey {
        let mut key = Vec::new();
        self.write_key(sight, &mut key);
        key.into()
    }

    /// Writes the state of a machine in a stable configuration, without the time: equal words mean
    /// equal behaviour from then on.
    pub fn write_key(&self, sight: &RelevantState, key: &mut Vec<u32>) {
        let run = &self.run;
        key.clear();
        key.push(run.status as u32 * 2 + u32::from(run.root_is_final));
        // most of a large chart is inactive: of sets and slots only those parts are written that
        // are not empty, behind their places
        for set in [&run.active, &run.vacated, &run.arrived, &run.running_regions] {
            for (index, word) in set.words().enumerate().filter(|(_, word)| *word != 0) {
                key.extend([index as u32, word as u32, (word >> 32) as u32]);
            }
            key.push(u32::MAX);
        }
        key.extend(run.activities.used().map(|(activity, slot)| (activity as u32) << 4 | phase(&slot)));
        key.push(u32::MAX);
        for (timer, armed) in run.timers.armed() {
            let word = self.timer_key(timer, armed, sight);
            if word != 0 {
                key.extend([timer as u32, word]);
            }
        }
        key.push(u32::MAX);
        self.write_queues(key);
        key.extend(run.completions.iter().map(|node| node.0));
        for record in &run.records {
            key.push(u32::MAX - u32::from(record.is_known));
            if record.is_known {
                key.extend(record.nodes.iter().map(|node| node.0));
            }
        }
    }

    fn timer_key(&self, timer: usize, deadline: ArmedTimer, sight: &RelevantState) -> u32 {
        let expiry = Some(timer as u32);
        let is_as_unset = deadline.expired
            && !sight.distinguished_timers.contains(timer)
            && !self.run.queues.all().any(|occurrence| occurrence.expiry == expiry);
        let owner = deadline.owner.map_or(0, |it| it.0 + 1);
        if is_as_unset { 0 } else { (owner << 2) | (1 + u32::from(deadline.expired)) }
    }

    fn write_queues(&self, key: &mut Vec<u32>) {
        let queues = &self.run.queues;
        for queue in [&queues.raised, &queues.arrived, &queues.deferred] {
            queue.iter().for_each(|occurrence| push_occurrence(key, occurrence));
            key.push(u32::MAX);
        }
        for held in &queues.held {
            push_occurrence(key, &held.occurrence);
            key.push(held.compounds.len() as u32);
            key.extend(held.compounds.iter().map(|&CompoundTransitionId(number)| number));
            key.push(u32::from(held.offer));
        }
        key.push(u32::MAX);
        for pending in &self.run.pending {
            key.extend([pending.compound.0, pending.event.map_or(u32::MAX, |event| event.0)]);
        }
        key.push(u32::MAX);
    }

    /// Copies another machine of the same chart in a stable configuration, without allocating.
    pub fn copy_from(&mut self, other: &Machine) {
        self.run.copy_from(&other.run);
    }

    /// A time after the last step: the number of steps at one time is limited, and an exploration
    /// makes many.
    pub fn next_moment(&self) -> Timestamp {
        Timestamp::from_nanos(self.run.now.as_nanos().saturating_add(1))
    }

    /// Postpones all timers that are set until they are chosen to expire.
    pub fn postpone_timers(&mut self) {
        self.run.timers.postpone(UNCHOSEN_DEADLINE);
    }

    /// The timers that are set and have not expired, by number.
    pub fn timers_set(&self) -> Vec<usize> {
        let waiting = self.run.timers.armed().filter(|(_, it)| !it.expired);
        waiting.map(|(timer, _)| timer).collect()
    }

    /// The timers set since the last postponement, with their durations.
    pub fn timers_started(&self) -> Vec<(usize, Duration)> {
        let started = self.run.timers.armed().filter(|(_, it)| !it.expired && it.moment != UNCHOSEN_DEADLINE);
        started.map(|(timer, it)| (timer, it.moment.since(self.run.now))).collect()
    }

    /// Makes a timer expire in the next step. Returns whether it was set.
    pub fn make_due(&mut self, timer: usize) -> bool {
        let now = self.next_moment();
        let Some(armed) = self.run.timers.slot(timer).filter(|armed| !armed.expired) else { return false };
        self.run.timers.set_slot(timer, Some(ArmedTimer { moment: now, ..armed }));
        self.run.timers.recompute_next();
        true
    }

    /// Whether an event of that name waits to be offered again.
    pub fn is_waiting(&self, name: &str) -> bool {
        let event = self.chart.event(name).0;
        self.run.queues.all().any(|occurrence| occurrence.event == event)
    }

    /// Keeps the oldest `max` waiting occurrences of each event and discards the others; returns
    /// the events of which it has discarded any. For explorations, which would otherwise find a new
    /// state each time that an event is raised and not taken.
    pub fn limit_queues(&mut self, max: usize) -> Vec<EventId> {
        let queues = &mut self.run.queues;
        if queues.all().nth(max).is_none() {
            return Vec::new();
        }
        let mut waiting: Vec<(EventId, u64)> = queues.all().map(|it| (it.event, it.number)).collect();
        waiting.sort_unstable();
        let cut: Vec<(EventId, u64)> = waiting
            .chunk_by(|one, other| one.0 == other.0)
            .flat_map(|same| same.iter().skip(max))
            .copied()
            .collect();
        if !cut.is_empty() {
            queues.discard(|it| cut.binary_search(&(it.event, it.number)).is_ok());
        }
        let mut events: Vec<EventId> = cut.into_iter().map(|(event, _)| event).collect();
        events.dedup();
        events
    }

    /// The memory of a machine of this chart, in bytes, roughly.
    pub fn estimated_bytes(&self) -> usize {
        let sets = 12 * self.run.active.words().count() * size_of::<u64>();
        let slots = self.run.activities.bytes() + self.run.timers.bytes();
        let records: usize = self.run.records.iter().map(|it| 32 + 8 * it.nodes.len()).sum();
        size_of::<Machine>() + sets + slots + records + 64 * self.run.queues.all().count()
    }

    /// The activity of a state, if it is running.
    pub fn running_at(&self, node: NodeId) -> Option<Activation> {
        let index = self.chart.layout.find_index(node)?;
        let slot = self.run.activities.slot(self.chart.states[index.index()].activity?);
        let runs = self.run.status == Status::Running && slot.phase == InvocationPhase::Running;
        runs.then(|| self.run.activation(&self.chart, index, slot))
    }

    /// The running activities.
    pub fn running(&self) -> Vec<Activation> {
        let chart: &CompiledChart = &self.chart;
        let running = self.run.activities.used().filter_map(|(activity, slot)| {
            let node = chart.activities[activity];
            (slot.phase == InvocationPhase::Running).then(|| self.run.activation(chart, node, slot))
        });
        if self.run.status == Status::Running { running.collect() } else { Vec::new() }
    }
}

/// A number below 16.
fn phase(slot: &ActivityState) -> u32 {
    slot.phase as u32 * 2 + u32::from(slot.cancelled && slot.phase == InvocationPhase::Running)
}

fn push_occurrence(key: &mut Vec<u32>, occurrence: &PoppedEvent) {
    let expiry = occurrence.expiry.map_or(u32::MAX, |timer| timer);
    key.extend([occurrence.event.0, expiry, u32::from(occurrence.raised)]);
}
