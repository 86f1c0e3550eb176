//! Events on their way: raised, arrived, deferred and held.

use smallvec::SmallVec;

use crate::chart::CompoundId;
use crate::expression::EventId;
use crate::machine::fifo::Fifo;
use crate::semantics::EventPool;

/// An event that happened.
#[derive(Clone, Copy, Debug)]
pub(super) struct Occurrence {
    pub(super) event: EventId,
    /// Counts the occurrences: less is older.
    pub(super) number: u64,
    /// Whether an action raised it.
    pub(super) raised: bool,
    /// The timer whose expiry it is.
    pub(super) expiry: Option<u32>,
    /// A number that the host gave it.
    pub(super) token: u64,
    /// Whether an expression names it as it was named.
    pub(super) is_known: bool,
}

/// An event that is to be queued.
#[derive(Clone, Copy, Debug)]
pub(super) struct Incoming {
    pub(super) event: EventId,
    pub(super) expiry: Option<u32>,
    pub(super) token: u64,
    pub(super) is_known: bool,
}

impl From<EventId> for Incoming {
    /// An event of the chart, without a token.
    fn from(event: EventId) -> Incoming {
        Incoming { event, expiry: None, token: 0, is_known: true }
    }
}

/// An occurrence that waits for running activities.
#[derive(Clone, Debug)]
pub(super) struct Held {
    pub(super) occurrence: Occurrence,
    /// The transitions it would enable.
    pub(super) compounds: SmallVec<[CompoundId; 4]>,
    /// Whether an activity that was in the way has returned.
    pub(super) offer: bool,
}

/// Every queue is ordered by age.
#[derive(Clone, Debug, Default)]
pub(super) struct Queues {
    pub(super) count: u64,
    pub(super) raised: Fifo<Occurrence>,
    pub(super) arrived: Fifo<Occurrence>,
    pub(super) deferred: Fifo<Occurrence>,
    pub(super) held: Vec<Held>,
}

impl Queues {
    pub(super) fn clear(&mut self) {
        self.raised.clear();
        self.arrived.clear();
        self.deferred.clear();
        self.held.clear();
    }

    /// Everything in them.
    pub(super) fn all(&self) -> impl Iterator<Item = &Occurrence> {
        let held = self.held.iter().map(|held| &held.occurrence);
        self.raised.iter().chain(&*self.arrived).chain(&*self.deferred).chain(held)
    }

    /// Whether some event can be offered now.
    pub(super) fn is_waiting(&self) -> bool {
        !self.raised.is_empty() || !self.arrived.is_empty() || self.held.iter().any(|held| held.offer)
    }

    /// An event that was raised waits before those that have arrived or, in one pool, behind them.
    pub(super) fn raise(&mut self, source: Incoming, pool: EventPool) {
        let raised = pool == EventPool::RaisedFirst;
        let occurrence = self.occurrence(source, raised);
        if raised { &mut self.raised } else { &mut self.arrived }.push(occurrence);
    }

    pub(super) fn arrive(&mut self, source: Incoming) {
        let occurrence = self.occurrence(source, false);
        self.arrived.push(occurrence);
    }

    /// Numbers an event that has come.
    pub(super) fn occurrence(&mut self, source: Incoming, raised: bool) -> Occurrence {
        self.count += 1;
        let Incoming { event, expiry, token, is_known } = source;
        Occurrence { event, number: self.count, raised, expiry, token, is_known }
    }

    pub(super) fn next_raised(&mut self) -> Option<Occurrence> {
        self.raised.pop()
    }

    #[inline]
    pub(super) fn first_arrived(&self) -> Option<&Occurrence> {
        self.arrived.front()
    }

    /// Forgets the first that has arrived, without looking at it.
    #[inline]
    pub(super) fn drop_arrived(&mut self) {
        self.arrived.drop_front();
    }

    pub(super) fn next_arrived(&mut self) -> Option<Occurrence> {
        self.arrived.pop()
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

fn insert(queue: &mut Fifo<Occurrence>, occurrence: Occurrence) {
    let index = queue.partition_point(|other| other.number < occurrence.number);
    queue.insert(index, occurrence);
}
