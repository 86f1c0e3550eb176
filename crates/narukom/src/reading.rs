//! What has been delivered to one blackboard of one topic.

use std::cell::Cell;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use crate::message::AnyMessage;
use crate::moment::Moment;
use crate::ring::{Entry, Origin, Ring};
use crate::sample::{AnySample, Header, HostId, TopicSlot};
use crate::topic::{Kind, TopicDeclaration};

/// The delivered messages of a topic, and the place in the hub's ring where the next delivery begins.
#[derive(Clone)]
pub(crate) struct Reading {
    kind: Kind,
    depth: usize,
    age: Option<Duration>,
    cursor: u64,
    /// `state`: at most one. `signal`: this cycle's. `data`: a history sorted by time of publication by this host's clock, equal
    /// times in order of arrival.
    samples: VecDeque<AnySample>,
    lost: u64,
    /// Whether somebody reads the topic on this blackboard; an inherited reading waits for that.
    interest: Cell<bool>,
}

/// Up to which publication a blackboard has been delivered, and up to which one cycle earlier.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct Window {
    pub(crate) since: u64,
    pub(crate) delivered: u64,
}

/// Who reads: decides which messages are its own, and which of these it has seen already.
#[derive(Clone, Copy)]
pub(crate) struct Reader {
    pub(crate) blackboard: u32,
    /// How many of its own signals on the topic were read before they came back.
    pub(crate) seen: u64,
}

/// What a delivery brings besides the messages themselves.
#[derive(Default)]
pub(crate) struct Delivery {
    /// Number, topic and host of each message.
    pub(crate) arrivals: Vec<(u64, TopicSlot, HostId)>,
    /// What had to go, to be dropped when the hub's lock is no longer held.
    pub(crate) leaving: Vec<Arc<dyn AnyMessage>>,
}

impl Reader {
    fn has_seen(self, origin: Origin) -> bool {
        origin.blackboard == self.blackboard && origin.nth <= self.seen
    }
}

impl Reading {
    /// The reading that a blackboard would have by now if it had read the topic from the start. A state of which the hub no
    /// longer holds the value of then begins with the oldest that it holds.
    pub(crate) fn attach(
        topic: &TopicDeclaration,
        ring: Option<&Ring>,
        reader: Reader,
        window: Window,
    ) -> Reading {
        let first = if topic.kind() == Kind::Signal { window.since } else { 0 };
        let mut reading = Reading {
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
        if reading.kind == Kind::State && reading.samples.is_empty() && ring.had_any_by(window.delivered) {
            ring.from(0)
                .take(1)
                .for_each(|entry| reading.accept(entry.sample.clone(), entry.origin, reader, &mut leaving));
        }
        reading
    }

    /// Takes what was published since the last delivery.
    #[inline]
    pub(crate) fn deliver(&mut self, ring: &Ring, reader: Reader, delivery: &mut Delivery) {
        if self.kind != Kind::State {
            self.lost += ring.missed(self.cursor);
        }
        if ring.next() == self.cursor + 1 {
            ring.newest().into_iter().for_each(|entry| self.take(entry, reader, delivery));
        } else {
            ring.from(self.cursor).for_each(|entry| self.take(entry, reader, delivery));
        }
        self.cursor = ring.next();
    }

    /// Takes the message after those that were delivered.
    #[inline]
    pub(crate) fn deliver_next(
        &mut self,
        order: u64,
        sample: AnySample,
        origin: Origin,
        reader: Reader,
        delivery: &mut Delivery,
    ) {
        let Header { topic, host, .. } = sample.header;
        delivery.arrivals.push((order, topic, host));
        self.accept(sample, origin, reader, &mut delivery.leaving);
        self.cursor += 1;
    }

    #[inline]
    fn take(&mut self, entry: &Entry, reader: Reader, delivery: &mut Delivery) {
        let header = &entry.sample.header;
        delivery.arrivals.push((entry.order, header.topic, header.host));
        self.accept(entry.sample.clone(), entry.origin, reader, &mut delivery.leaving);
    }

    #[inline]
    fn accept(
        &mut self,
        sample: AnySample,
        origin: Origin,
        reader: Reader,
        leaving: &mut Vec<Arc<dyn AnyMessage>>,
    ) {
        match self.kind {
            Kind::State => match self.samples.back_mut() {
                Some(known) => leaving.push(std::mem::replace(known, sample).message),
                None => self.samples.push_back(sample),
            },
            Kind::Signal if reader.has_seen(origin) => {}
            Kind::Signal => self.samples.push_back(sample),
            Kind::Data => self.insert(sample, leaving),
        }
    }

    /// Keeps the newest by time: what comes too late for a full history is left out.
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

    /// Lets go of what is too old by now to be read again.
    #[inline]
    pub(crate) fn expire(&mut self, now: Moment, leaving: &mut Vec<Arc<dyn AnyMessage>>) {
        if self.age.is_none() {
            return;
        }
        let oldest = self.oldest(now);
        while self.samples.front().is_some_and(|sample| sample.header.local < oldest) {
            leaving.extend(self.samples.pop_front().map(|sample| sample.message));
        }
    }

    /// Becomes what another blackboard has of the topic; whether it is read here remains.
    pub(crate) fn take_over(&mut self, other: &Reading) {
        self.cursor = other.cursor;
        self.lost = other.lost;
        self.samples.clone_from(&other.samples);
    }

    /// Ends a cycle: signals are gone.
    pub(crate) fn close(&mut self) {
        if self.kind == Kind::Signal {
            self.samples.clear();
        }
    }

    /// What was published earlier than this is too old to be read.
    #[inline]
    pub(crate) fn oldest(&self, now: Moment) -> Moment {
        self.age.map_or(Moment::ZERO, |age| now - age)
    }

    /// How many messages are to be read at most.
    #[inline]
    pub(crate) fn limit(&self) -> usize {
        match self.kind {
            Kind::State => 1,
            Kind::Signal => usize::MAX,
            Kind::Data => self.depth,
        }
    }

    #[inline]
    pub(crate) fn samples(&self) -> &VecDeque<AnySample> {
        &self.samples
    }

    /// Whether the end of the cycle has something to do here.
    #[inline]
    pub(crate) fn is_open(&self) -> bool {
        self.kind == Kind::Signal && !self.samples.is_empty()
    }

    pub(crate) fn lost(&self) -> u64 {
        self.lost
    }

    pub(crate) fn interest(&self) -> bool {
        self.interest.get()
    }

    #[inline]
    pub(crate) fn set_interest(&self, interest: bool) {
        self.interest.set(interest);
    }
}
