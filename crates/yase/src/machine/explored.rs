//! What exploration needs of a machine: when two of them will do the same from now on, and timers without a clock.

use std::time::Duration;

use crate::chart::{Chart, CompoundId};
use crate::host::Activation;
use crate::machine::activities::Phase;
use crate::machine::queues::Occurrence;
use crate::machine::{Machine, Status};
use crate::moment::Moment;

/// When timers expire that have not been chosen to.
const LATER: Moment = Moment::from_nanos(u64::MAX);

/// What a machine at rest will do, but for the time: equal keys, equal futures.
pub(crate) type Key = Box<[u32]>;

impl Machine {
    pub(crate) fn key(&self) -> Key {
        let run = &self.run;
        let mut key = vec![0, 0, run.status as u32, u32::from(run.ending)];
        let nodes = self.chart.layout.len();
        let regions = self.chart.regions.len();
        let arrived = self.chart.joins.iter().map(|join| join.sources.len()).sum();
        for (set, last) in [
            (&run.active, nodes),
            (&run.vacated, nodes),
            (&run.arrived, arrived),
            (&run.running_regions, regions),
        ] {
            key.extend(
                std::iter::successors(set.next(0, last), |&index| set.next(index + 1, last))
                    .map(|index| index as u32),
            );
            key.push(u32::MAX);
        }
        key.extend((0..self.chart.activities.len()).map(|activity| {
            let slot = run.activities.slot(activity);
            slot.phase as u32 * 2 + u32::from(slot.cancelled && slot.phase == Phase::Running)
        }));
        for slot in &run.timers.slots {
            match slot {
                None => key.push(0),
                Some(deadline) => {
                    key.extend([1 + u32::from(deadline.expired), deadline.owner.map_or(0, |it| it.0 + 1)])
                }
            }
        }
        let queues = &run.queues;
        for queue in [&queues.raised, &queues.arrived, &queues.deferred] {
            queue.iter().for_each(|occurrence| note(&mut key, occurrence));
            key.push(u32::MAX);
        }
        for held in &queues.held {
            note(&mut key, &held.occurrence);
            key.push(held.compounds.len() as u32);
            key.extend(held.compounds.iter().map(|&CompoundId(number)| number));
            key.push(u32::from(held.offer));
        }
        key.push(u32::MAX);
        for pending in &run.pending {
            key.extend([pending.compound.0, pending.event.map_or(u32::MAX, |event| event.0)]);
        }
        key.push(u32::MAX);
        key.extend(run.completions.iter().map(|place| place.0));
        for record in &run.records {
            key.push(u32::MAX - u32::from(record.is_known));
            if record.is_known {
                key.extend(record.places.iter().map(|place| place.0));
            }
        }
        // at the front, so that two keys seldom need be compared further
        let sum = key.iter().fold(0xcbf2_9ce4_8422_2325_u64, |sum, &word| {
            (sum ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3)
        });
        (key[0], key[1]) = ((sum >> 32) as u32, sum as u32);
        key.into()
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

fn note(key: &mut Vec<u32>, occurrence: &Occurrence) {
    let expiry = occurrence.expiry.map_or(u32::MAX, |timer| timer);
    key.extend([occurrence.event.0, expiry, u32::from(occurrence.raised)]);
}
