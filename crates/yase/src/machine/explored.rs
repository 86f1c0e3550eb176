//! What exploration needs of a machine: when two of them will do the same from now on, and timers without a clock.

use std::time::Duration;

use crate::bits::BitSet;
use crate::chart::{Chart, CompoundId};
use crate::host::Activation;
use crate::machine::activities::{Phase, Slot};
use crate::machine::queues::Occurrence;
use crate::machine::timers::Deadline;
use crate::machine::{Machine, Status};
use crate::moment::Moment;
use crate::statechart::NodeId;

/// When timers expire that have not been chosen to.
const LATER: Moment = Moment::from_nanos(u64::MAX);

/// What of a machine can matter to what it does from now on.
///
/// A timer that was never set and one that is over are the same to a chart that asks only whether it must still wait, as `[timeout]` does: neither expires any
/// more, both let the guard hold, and both are forgotten when the timer is set anew. They differ to a guard that asks whether a timer *has* expired
/// (`TimeoutCheck(timeout)`), to code, and while the event of the expiry still waits. A loop with a timer of its own has fewer states by that: three instead of four,
/// and they multiply with each loop beside it.
pub(crate) struct Sight {
    /// The timers of which it matters whether they are over or were never set.
    told_apart: BitSet,
}

impl Sight {
    pub(crate) fn new(chart: &Chart) -> Sight {
        let mut told_apart = BitSet::new(chart.timers.len());
        for scoped in &chart.guards {
            let first = chart.regions[scoped.region.index()].timers;
            let timers = scoped.guard.timers_told_apart();
            timers.iter().for_each(|timer| told_apart.insert(first + timer.0 as usize));
        }
        Sight { told_apart }
    }

    /// To which everything matters.
    #[cfg(test)]
    pub(crate) fn of_all(chart: &Chart) -> Sight {
        let mut told_apart = BitSet::new(chart.timers.len());
        (0..chart.timers.len()).for_each(|timer| told_apart.insert(timer));
        Sight { told_apart }
    }
}

/// Equal keys, equal futures.
pub(crate) type Key = Box<[u32]>;

impl Machine {
    /// [The words](Machine::write_key) of a machine at rest.
    pub(crate) fn key(&self, sight: &Sight) -> Key {
        let mut key = Vec::new();
        self.write_key(sight, &mut key);
        key.into()
    }

    /// What a machine at rest will do, but for the time, as words: equal words, equal futures.
    pub(crate) fn write_key(&self, sight: &Sight, key: &mut Vec<u32>) {
        let run = &self.run;
        key.clear();
        key.push(run.status as u32 * 2 + u32::from(run.ending));
        for set in [&run.active, &run.vacated, &run.arrived, &run.running_regions] {
            key.extend(set.words().flat_map(|word| [word as u32, (word >> 32) as u32]));
        }
        let slots = run.activities.slots();
        key.extend(slots.chunks(8).map(|slots| slots.iter().fold(0, |word, slot| word << 4 | phase(slot))));
        let slots = run.timers.slots.iter().enumerate();
        key.extend(slots.map(|(timer, slot)| self.timer_as_seen(timer, *slot, sight)));
        self.write_queues(key);
        key.extend(run.completions.iter().map(|place| place.0));
        for record in &run.records {
            key.push(u32::MAX - u32::from(record.is_known));
            if record.is_known {
                key.extend(record.places.iter().map(|place| place.0));
            }
        }
    }

    fn timer_as_seen(&self, timer: usize, slot: Option<Deadline>, sight: &Sight) -> u32 {
        let Some(deadline) = slot else { return 0 };
        let expiry = Some(timer as u32);
        let is_as_unset = deadline.expired
            && !sight.told_apart.contains(timer)
            && !self.run.queues.all().any(|occurrence| occurrence.expiry == expiry);
        let owner = deadline.owner.map_or(0, |it| it.0 + 1);
        if is_as_unset { 0 } else { (owner << 2) | (1 + u32::from(deadline.expired)) }
    }

    fn write_queues(&self, key: &mut Vec<u32>) {
        let queues = &self.run.queues;
        for queue in [&queues.raised, &queues.arrived, &queues.deferred] {
            queue.iter().for_each(|occurrence| note(key, occurrence));
            key.push(u32::MAX);
        }
        for held in &queues.held {
            note(key, &held.occurrence);
            key.push(held.compounds.len() as u32);
            key.extend(held.compounds.iter().map(|&CompoundId(number)| number));
            key.push(u32::from(held.offer));
        }
        key.push(u32::MAX);
        for pending in &self.run.pending {
            key.extend([pending.compound.0, pending.event.map_or(u32::MAX, |event| event.0)]);
        }
        key.push(u32::MAX);
    }

    /// Becomes equal to another machine of the same chart that is at rest, without asking for memory.
    pub(crate) fn copy_from(&mut self, other: &Machine) {
        self.run.copy_from(&other.run);
    }

    /// A moment after the last step: what a chart does at one moment is bounded, and the moments of an exploration are many.
    pub(crate) fn next_moment(&self) -> Moment {
        Moment::from_nanos(self.run.now.as_nanos().saturating_add(1))
    }

    /// Has all timers that are set wait until they are chosen to expire.
    pub(crate) fn put_timers_off(&mut self) {
        for deadline in self.run.timers.slots.iter_mut().flatten().filter(|deadline| !deadline.expired) {
            deadline.moment = LATER;
        }
        self.run.timers.look_again();
    }

    /// The timers that are set and have not expired, by number.
    pub(crate) fn timers_set(&self) -> Vec<usize> {
        let slots = self.run.timers.slots.iter().enumerate();
        slots.filter(|(_, slot)| slot.is_some_and(|it| !it.expired)).map(|(timer, _)| timer).collect()
    }

    /// The timers that were set since they all were last put off, and how long each runs.
    pub(crate) fn timers_started(&self) -> Vec<(usize, Duration)> {
        let slots = self.run.timers.slots.iter().enumerate();
        let started = slots.filter_map(|(timer, slot)| {
            let deadline = slot.filter(|it| !it.expired && it.moment != LATER)?;
            Some((timer, deadline.moment.since(self.run.now)))
        });
        started.collect()
    }

    /// Has a timer expire at the next step. Says whether it was set.
    pub(crate) fn make_due(&mut self, timer: usize) -> bool {
        let now = self.next_moment();
        let Some(Some(deadline)) = self.run.timers.slots.get_mut(timer) else { return false };
        let is_set = !deadline.expired;
        if is_set {
            deadline.moment = now;
            self.run.timers.look_again();
        }
        is_set
    }

    /// Whether an event of that name waits to be offered again.
    pub(crate) fn is_waiting(&self, name: &str) -> bool {
        let event = self.chart.event(name).0;
        self.run.queues.all().any(|occurrence| occurrence.event == event)
    }

    /// The activity of a state, if it runs.
    pub(crate) fn running_at(&self, node: NodeId) -> Option<Activation> {
        let place = self.chart.layout.place(node)?;
        let slot = self.run.activities.slot(self.chart.states[place.index()].activity?);
        let runs = self.run.status == Status::Running && slot.phase == Phase::Running;
        runs.then(|| self.run.activation(&self.chart, place, slot))
    }

    /// The activities that run.
    pub(crate) fn running(&self) -> Vec<Activation> {
        let chart: &Chart = &self.chart;
        let running = chart.activities.iter().enumerate().filter_map(|(activity, &place)| {
            let slot = self.run.activities.slot(activity);
            (slot.phase == Phase::Running).then(|| self.run.activation(chart, place, slot))
        });
        if self.run.status == Status::Running { running.collect() } else { Vec::new() }
    }
}

/// Less than 16.
fn phase(slot: &Slot) -> u32 {
    slot.phase as u32 * 2 + u32::from(slot.cancelled && slot.phase == Phase::Running)
}

fn note(key: &mut Vec<u32>, occurrence: &Occurrence) {
    let expiry = occurrence.expiry.map_or(u32::MAX, |timer| timer);
    key.extend([occurrence.event.0, expiry, u32::from(occurrence.raised)]);
}
