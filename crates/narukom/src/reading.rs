//! What has been delivered to one blackboard of one topic.

use std::cell::Cell;
use std::collections::VecDeque;

use crate::ring::{Entry, Ring};
use crate::sample::{AnySample, TopicSlot};
use crate::topic::{Kind, TopicDeclaration};

/// The delivered messages of a topic, and the place in the hub's ring where the next delivery begins.
#[derive(Clone)]
pub(crate) struct Reading {
    kind: Kind,
    depth: usize,
    cursor: u64,
    /// `state`: at most one. `signal`: this cycle's. `data`: a history sorted by time of publication, equal times in
    /// order of publication.
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

impl Reader {
    fn has_seen(self, entry: &Entry) -> bool {
        entry.origin.blackboard == self.blackboard && entry.origin.nth <= self.seen
    }
}

impl Reading {
    /// The reading that a blackboard would have by now if it had read the topic from the start.
    pub(crate) fn attach(topic: &TopicDeclaration, ring: &Ring, reader: Reader, window: Window) -> Reading {
        let first = if topic.kind() == Kind::Signal { window.since } else { 0 };
        let mut reading = Reading {
            kind: topic.kind(),
            depth: topic.depth(),
            cursor: ring.after(window.delivered.max(first)),
            samples: VecDeque::new(),
            lost: 0,
            interest: Cell::new(false),
        };
        let entries = ring.from(0).filter(|entry| entry.order > first && entry.order <= window.delivered);
        entries.for_each(|entry| reading.accept(entry, reader));
        reading
    }

    /// Takes what was published since the last delivery, and notes each message in `arrivals`.
    pub(crate) fn deliver(&mut self, ring: &Ring, reader: Reader, arrivals: &mut Vec<(u64, TopicSlot)>) {
        if self.kind != Kind::State {
            self.lost += ring.missed(self.cursor);
        }
        for entry in ring.from(self.cursor) {
            self.accept(entry, reader);
            arrivals.push((entry.order, entry.sample.header.topic));
        }
        self.cursor = ring.next();
    }

    fn accept(&mut self, entry: &Entry, reader: Reader) {
        let sample = entry.sample.clone();
        match self.kind {
            Kind::State => {
                self.samples.clear();
                self.samples.push_back(sample);
            }
            Kind::Signal if reader.has_seen(entry) => {}
            Kind::Signal => self.samples.push_back(sample),
            Kind::Data => self.insert(sample),
        }
    }

    fn insert(&mut self, sample: AnySample) {
        if self.samples.len() == self.depth {
            self.samples.pop_front();
        }
        let published = sample.header.published;
        let later = self.samples.iter().rev().take_while(|other| other.header.published > published).count();
        self.samples.insert(self.samples.len() - later, sample);
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

    pub(crate) fn samples(&self) -> &VecDeque<AnySample> {
        &self.samples
    }

    /// Whether the end of the cycle has something to do here.
    pub(crate) fn is_open(&self) -> bool {
        self.kind == Kind::Signal && !self.samples.is_empty()
    }

    pub(crate) fn lost(&self) -> u64 {
        self.lost
    }

    pub(crate) fn interest(&self) -> bool {
        self.interest.get()
    }

    pub(crate) fn set_interest(&self, interest: bool) {
        self.interest.set(interest);
    }
}
