//! The messages of one topic delivered to one blackboard.

use std::cell::Cell;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use crate::message::AnyMessage;
use crate::ring::{Ring, RingEntry, WriterId};
use crate::sample::{AnySample, Header, HostId, TopicSlot};
use crate::timestamp::Timestamp;
use crate::topic::{RetentionKind, TopicDeclaration};

/// The delivered messages of a topic, and the index in the hub's ring at which the next delivery
/// begins.
#[derive(Clone)]
pub(crate) struct Inbox {
    kind: RetentionKind,
    depth: usize,
    age: Option<Duration>,
    cursor: u64,
    /// `state`: at most one. `signal`: those of this cycle. `data`: a history sorted by time of
    /// publication by this host's clock, equal times in order of arrival.
    samples: VecDeque<AnySample>,
    lost: u64,
    /// Whether the blackboard reads the topic; an inherited inbox is inactive until it does.
    interest: Cell<bool>,
}

/// The last publication delivered to a blackboard, and the last one delivered a cycle earlier.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct DeliveryWindow {
    pub(crate) since: u64,
    pub(crate) delivered: u64,
}

/// The reader: decides which messages are its own, and which of these it has already seen.
#[derive(Clone, Copy)]
pub(crate) struct ReaderView {
    pub(crate) blackboard: u32,
    /// The number of its own signals on the topic that were read before the hub delivered them.
    pub(crate) seen: u64,
}

/// The results of a delivery besides the messages.
#[derive(Default)]
pub(crate) struct Delivery {
    /// Number, topic and host of each message.
    pub(crate) arrivals: Vec<(u64, TopicSlot, HostId)>,
    /// Messages that were replaced, to be dropped after the hub's lock is released.
    pub(crate) leaving: Vec<Arc<dyn AnyMessage>>,
}

impl ReaderView {
    fn has_seen(self, origin: WriterId) -> bool {
        origin.blackboard == self.blackboard && origin.nth <= self.seen
    }
}

impl Inbox {
    /// The inbox that a blackboard would have if it had read the topic from the start. If the hub
    /// no longer holds the state of that time, the inbox begins with the oldest state that it
    /// holds.
    pub(crate) fn attach(
        topic: &TopicDeclaration,
        ring: Option<&Ring>,
        reader: ReaderView,
        window: DeliveryWindow,
    ) -> Inbox {
        let first = if topic.kind() == RetentionKind::Signal { window.since } else { 0 };
        let mut reading = Inbox {
            kind: topic.kind(),
            depth: topic.depth(),
            age: topic.age(),
            cursor: ring.map_or(0, |ring| ring.after(window.delivered.max(first))),
            samples: VecDeque::new(),
            lost: 0,
            interest: Cell::new(false),
        };
        let Some(ring) = ring else { return reading };
        let mut leaving = Vec::new();
        let entries = ring.from(0).filter(|entry| entry.order > first && entry.order <= window.delivered);
        entries.for_each(|entry| reading.accept(entry.sample.clone(), entry.origin, reader, &mut leaving));
        if reading.kind == RetentionKind::State
            && reading.samples.is_empty()
            && ring.was_nonempty_at(window.delivered)
        {
            ring.from(0)
                .take(1)
                .for_each(|entry| reading.accept(entry.sample.clone(), entry.origin, reader, &mut leaving));
        }
        reading
    }

    /// Takes what was published since the last delivery.
    #[inline]
    pub(crate) fn deliver(&mut self, ring: &Ring, reader: ReaderView, delivery: &mut Delivery) {
        if self.kind != RetentionKind::State {
            self.lost += ring.missed(self.cursor);
        }
        if ring.next() == self.cursor + 1 {
            ring.newest().into_iter().for_each(|entry| self.insert_from_ring(entry, reader, delivery));
        } else {
            ring.from(self.cursor).for_each(|entry| self.insert_from_ring(entry, reader, delivery));
        }
        self.cursor = ring.next();
    }

    /// Takes the message that follows the delivered ones.
    #[inline]
    pub(crate) fn deliver_next(
        &mut self,
        order: u64,
        sample: AnySample,
        origin: WriterId,
        reader: ReaderView,
        delivery: &mut Delivery,
    ) {
        let Header { topic, host, .. } = sample.header;
        delivery.arrivals.push((order, topic, host));
        self.accept(sample, origin, reader, &mut delivery.leaving);
        self.cursor += 1;
    }

    #[inline]
    fn insert_from_ring(&mut self, entry: &RingEntry, reader: ReaderView, delivery: &mut Delivery) {
        let header = &entry.sample.header;
        delivery.arrivals.push((entry.order, header.topic, header.host));
        self.accept(entry.sample.clone(), entry.origin, reader, &mut delivery.leaving);
    }

    #[inline]
    fn accept(
        &mut self,
        sample: AnySample,
        origin: WriterId,
        reader: ReaderView,
        leaving: &mut Vec<Arc<dyn AnyMessage>>,
    ) {
        match self.kind {
            RetentionKind::State => match self.samples.back_mut() {
                Some(known) => leaving.push(std::mem::replace(known, sample).message),
                None => self.samples.push_back(sample),
            },
            RetentionKind::Signal if reader.has_seen(origin) => {}
            RetentionKind::Signal => self.samples.push_back(sample),
            RetentionKind::Data => self.insert(sample, leaving),
        }
    }

    /// Keeps the newest by time: a message too old for a full history is dropped.
    fn insert(&mut self, sample: AnySample, leaving: &mut Vec<Arc<dyn AnyMessage>>) {
        let local = sample.header.local;
        if self.samples.len() == self.depth {
            if self.samples.front().is_some_and(|oldest| oldest.header.local > local) {
                return;
            }
            leaving.extend(self.samples.pop_front().map(|sample| sample.message));
        }
        let later = self.samples.iter().rev().take_while(|other| other.header.local > local).count();
        self.samples.insert(self.samples.len() - later, sample);
    }

    /// Drops messages that are too old to be read again.
    #[inline]
    pub(crate) fn expire(&mut self, now: Timestamp, leaving: &mut Vec<Arc<dyn AnyMessage>>) {
        if self.age.is_none() {
            return;
        }
        let oldest = self.oldest(now);
        while self.samples.front().is_some_and(|sample| sample.header.local < oldest) {
            leaving.extend(self.samples.pop_front().map(|sample| sample.message));
        }
    }

    /// Copies the topic from another blackboard; whether it is read here is unchanged.
    pub(crate) fn take_over(&mut self, other: &Inbox) {
        self.cursor = other.cursor;
        self.lost = other.lost;
        self.samples.clone_from(&other.samples);
    }

    /// Ends a cycle: drops the signals.
    pub(crate) fn close(&mut self) {
        if self.kind == RetentionKind::Signal {
            self.samples.clear();
        }
    }

    /// Messages published earlier than this are too old to be read.
    #[inline]
    pub(crate) fn oldest(&self, now: Timestamp) -> Timestamp {
        self.age.map_or(Timestamp::ZERO, |age| now - age)
    }

    /// The most messages that are read.
    #[inline]
    pub(crate) fn limit(&self) -> usize {
        match self.kind {
            RetentionKind::State => 1,
            RetentionKind::Signal => usize::MAX,
            RetentionKind::Data => self.depth,
        }
    }

    #[inline]
    pub(crate) fn samples(&self) -> &VecDeque<AnySample> {
        &self.samples
    }

    /// Whether the end of the cycle has work to do here.
    #[inline]
    pub(crate) fn is_open(&self) -> bool {
        self.kind == RetentionKind::Signal && !self.samples.is_empty()
    }

    pub(crate) fn lost(&self) -> u64 {
        self.lost
    }

    pub(crate) fn is_read(&self) -> bool {
        self.interest.get()
    }

    #[inline]
    pub(crate) fn set_is_read(&self, interest: bool) {
        self.interest.set(interest);
    }
}
