//! Events on their way: raised, arrived, deferred and held.

use std::collections::VecDeque;

use smallvec::SmallVec;

use crate::chart::CompoundId;
use crate::expression::EventId;

/// An event that happened.
#[derive(Clone, Copy, Debug)]
pub(super) struct Occurrence {
    pub(super) event: EventId,
    /// Counts the occurrences: less is older.
    number: u64,
    raised: bool,
    /// The timer whose expiry it is.
    pub(super) expiry: Option<u32>,
}

/// An occurrence that waits for running activities.
#[derive(Clone, Debug)]
pub(super) struct Held {
    occurrence: Occurrence,
    /// The transitions it would enable.
    pub(super) compounds: SmallVec<[CompoundId; 4]>,
    /// Whether an activity that was in the way has returned.
    pub(super) offer: bool,
}

/// Every queue is ordered by age.
#[derive(Clone, Debug, Default)]
pub(super) struct Queues {
    count: u64,
    raised: VecDeque<Occurrence>,
    arrived: VecDeque<Occurrence>,
    deferred: VecDeque<Occurrence>,
    pub(super) held: Vec<Held>,
}

impl Queues {
    pub(super) fn clear(&mut self) {
        self.raised.clear();
        self.arrived.clear();
        self.deferred.clear();
        self.held.clear();
    }

    /// Whether some event can be offered now.
    pub(super) fn is_waiting(&self) -> bool {
        !self.raised.is_empty() || !self.arrived.is_empty() || self.held.iter().any(|held| held.offer)
    }

    pub(super) fn raise(&mut self, event: EventId) {
        let occurrence = self.occurrence(event, true, None);
        self.raised.push_back(occurrence);
    }

    pub(super) fn arrive(&mut self, event: EventId, expiry: Option<u32>) {
        let occurrence = self.occurrence(event, false, expiry);
        self.arrived.push_back(occurrence);
    }

    fn occurrence(&mut self, event: EventId, raised: bool, expiry: Option<u32>) -> Occurrence {
        self.count += 1;
        Occurrence { event, number: self.count, raised, expiry }
    }

    pub(super) fn next_raised(&mut self) -> Option<Occurrence> {
        self.raised.pop_front()
    }

    pub(super) fn next_arrived(&mut self) -> Option<Occurrence> {
        self.arrived.pop_front()
    }

    /// The oldest held occurrence that is to be offered again.
    pub(super) fn next_held(&mut self) -> Option<Occurrence> {
        let index = self.held.iter().position(|held| held.offer)?;
        Some(self.held.remove(index).occurrence)
    }

    pub(super) fn hold(&mut self, occurrence: Occurrence, compounds: &[CompoundId]) {
        let index = self.held.partition_point(|held| held.occurrence.number < occurrence.number);
        self.held.insert(index, Held { occurrence, compounds: compounds.into(), offer: false });
    }

    pub(super) fn has_deferred(&self) -> bool {
        !self.deferred.is_empty()
    }

    pub(super) fn defer(&mut self, occurrence: Occurrence) {
        insert(&mut self.deferred, occurrence);
    }

    /// Puts what is no longer deferred back where it came from, before what is newer.
    pub(super) fn recall(&mut self, is_deferred: impl Fn(EventId) -> bool) {
        let mut index = 0;
        while let Some(&occurrence) = self.deferred.get(index) {
            if is_deferred(occurrence.event) {
                index += 1;
                continue;
            }
            self.deferred.remove(index);
            insert(if occurrence.raised { &mut self.raised } else { &mut self.arrived }, occurrence);
        }
    }

    /// Forgets the expiry of a timer that is set again.
    pub(super) fn withdraw(&mut self, timer: usize) {
        let other = |occurrence: &Occurrence| occurrence.expiry != Some(timer as u32);
        self.arrived.retain(other);
        self.deferred.retain(other);
        self.held.retain(|held| other(&held.occurrence));
    }

    /// Has what is held offered again.
    pub(super) fn release(&mut self, blocked: impl Fn(CompoundId) -> bool) {
        for held in &mut self.held {
            held.offer |= held.compounds.iter().any(|&compound| blocked(compound));
        }
    }
}

fn insert(queue: &mut VecDeque<Occurrence>, occurrence: Occurrence) {
    let index = queue.partition_point(|other| other.number < occurrence.number);
    queue.insert(index, occurrence);
}
