//! The event queues: raised, arrived, deferred and held.

use smallvec::SmallVec;

use crate::expression::EventId;
use crate::ids::CompoundTransitionId;
use crate::machine::fifo::Fifo;
use crate::semantics::EventPool;

/// An occurrence of an event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoppedEvent {
    pub(crate) event: EventId,
    /// The number of the occurrence: lower is older.
    pub(crate) number: u64,
    /// Whether an action raised it.
    pub(crate) raised: bool,
    /// The timer whose expiry it is.
    pub(crate) expiry: Option<u32>,
    /// The token supplied by the host.
    pub(crate) token: u64,
    /// Whether an expression uses exactly this name.
    pub(crate) is_known: bool,
}

/// An event to be queued.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QueuedEvent {
    pub(crate) event: EventId,
    pub(crate) expiry: Option<u32>,
    pub(crate) token: u64,
    pub(crate) is_known: bool,
}

impl From<EventId> for QueuedEvent {
    /// An event of the chart, without a token.
    fn from(event: EventId) -> QueuedEvent {
        QueuedEvent { event, expiry: None, token: 0, is_known: true }
    }
}

/// An occurrence that waits for running activities.
#[derive(Clone, Debug)]
pub(crate) struct HeldEvent {
    pub(crate) occurrence: PoppedEvent,
    /// The transitions it would enable.
    pub(crate) compounds: SmallVec<[CompoundTransitionId; 4]>,
    /// Whether a blocking activity has returned.
    pub(crate) offer: bool,
}

/// The queues; each is ordered by age.
#[derive(Clone, Debug, Default)]
pub(crate) struct EventQueues {
    pub(crate) count: u64,
    pub(crate) raised: Fifo<PoppedEvent>,
    pub(crate) arrived: Fifo<PoppedEvent>,
    pub(crate) deferred: Fifo<PoppedEvent>,
    pub(crate) held: Vec<HeldEvent>,
}

impl EventQueues {
    pub(crate) fn clear(&mut self) {
        self.raised.clear();
        self.arrived.clear();
        self.deferred.clear();
        self.held.clear();
    }

    /// All queued occurrences.
    pub(crate) fn all(&self) -> impl Iterator<Item = &PoppedEvent> {
        let held = self.held.iter().map(|held| &held.occurrence);
        self.raised.iter().chain(&*self.arrived).chain(&*self.deferred).chain(held)
    }

    /// Whether an event can be offered now.
    pub(crate) fn is_waiting(&self) -> bool {
        !self.raised.is_empty() || !self.arrived.is_empty() || self.held.iter().any(|held| held.offer)
    }

    /// A raised event is queued before those that have arrived or, with a single queue, after them.
    pub(crate) fn raise(&mut self, source: QueuedEvent, pool: EventPool) {
        let raised = pool == EventPool::RaisedFirst;
        let occurrence = self.occurrence(source, raised);
        if raised { &mut self.raised } else { &mut self.arrived }.push(occurrence);
    }

    #[inline]
    pub(crate) fn arrive(&mut self, source: QueuedEvent) {
        let occurrence = self.occurrence(source, false);
        self.arrived.push(occurrence);
    }

    /// Numbers a new occurrence.
    #[inline]
    pub(crate) fn occurrence(&mut self, source: QueuedEvent, raised: bool) -> PoppedEvent {
        self.count += 1;
        let QueuedEvent { event, expiry, token, is_known } = source;
        PoppedEvent { event, number: self.count, raised, expiry, token, is_known }
    }

    #[inline]
    pub(crate) fn next_raised(&mut self) -> Option<PoppedEvent> {
        self.raised.pop()
    }

    #[inline]
    pub(crate) fn next_arrived(&mut self) -> Option<PoppedEvent> {
        self.arrived.pop()
    }

    /// The oldest held occurrence that is to be offered again.
    #[inline]
    pub(crate) fn next_held(&mut self) -> Option<PoppedEvent> {
        let index = self.held.iter().position(|held| held.offer)?;
        Some(self.held.remove(index).occurrence)
    }

    pub(crate) fn push_held(&mut self, occurrence: PoppedEvent, compounds: &[CompoundTransitionId]) {
        let index = self.held.partition_point(|held| held.occurrence.number < occurrence.number);
        self.held.insert(index, HeldEvent { occurrence, compounds: compounds.into(), offer: false });
    }

    #[inline]
    pub(crate) fn has_deferred(&self) -> bool {
        !self.deferred.is_empty()
    }

    pub(crate) fn defer(&mut self, occurrence: PoppedEvent) {
        insert(&mut self.deferred, occurrence);
    }

    /// Moves events that are no longer deferred back to their queue, before newer ones.
    pub(crate) fn recall_deferred(&mut self, is_deferred: impl Fn(EventId) -> bool) {
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

    /// Discards the expiry of a timer that is set again.
    pub(crate) fn withdraw(&mut self, timer: usize) {
        self.discard(|occurrence| occurrence.expiry == Some(timer as u32));
    }

    /// Discards waiting occurrences.
    pub(crate) fn discard(&mut self, is_meant: impl Fn(&PoppedEvent) -> bool) {
        let other = |occurrence: &PoppedEvent| !is_meant(occurrence);
        self.raised.retain(other);
        self.arrived.retain(other);
        self.deferred.retain(other);
        self.held.retain(|held| other(&held.occurrence));
    }

    /// Marks held events to be offered again.
    pub(crate) fn release(&mut self, blocked: impl Fn(CompoundTransitionId) -> bool) {
        for held in &mut self.held {
            held.offer |= held.compounds.iter().any(|&compound| blocked(compound));
        }
    }
}

fn insert(queue: &mut Fifo<PoppedEvent>, occurrence: PoppedEvent) {
    let index = queue.partition_point(|other| other.number < occurrence.number);
    queue.insert(index, occurrence);
}
