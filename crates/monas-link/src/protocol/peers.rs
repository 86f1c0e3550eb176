//! What a link knows of other hosts.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use narukom::Moment;

use super::clock::ClockFilter;
use super::counters::Received;
use super::incoming::{Incoming, Message};

/// A link remembers so many hosts; who has been silent longest is forgotten first.
pub(crate) const PEER_LIMIT: usize = 64;

/// A host may offer so many topics.
pub(crate) const OFFER_LIMIT: usize = 1024;

/// So many earlier lives of a host are remembered, so that what is late does not bring one back.
const REMEMBERED_LIVES: usize = 4;

/// How often a refusal is repeated that nobody answers.
pub(crate) const REFUSAL_TRIES: u8 = 8;

/// Another host.
pub(crate) struct Peer {
    pub(crate) name: Arc<str>,
    /// Of its link; none before its Hello.
    pub(crate) incarnation: Option<u64>,
    past: VecDeque<u64>,
    /// When something of its present life was heard last.
    alive: Moment,
    /// Whether something of another life was heard, whose Hello is missing.
    is_doubted: bool,
    /// By place; those that are not known yet are none.
    pub(crate) topics: Vec<Option<Reading>>,
    pub(crate) clock: ClockFilter,
    /// When its last Beat was sent, by its clock, and received, by ours. None when it has been echoed.
    pub(crate) beat: Option<(u64, Moment)>,
    pub(crate) heard: Moment,
}

/// A topic of another host.
pub(crate) struct Reading {
    pub(crate) path: Arc<str>,
    pub(crate) state: ReadingState,
}

/// What is done with a topic of another host.
pub(crate) enum ReadingState {
    /// Nobody here asked for it.
    Unwanted,
    /// The access list forbids it.
    Forbidden(Received),
    /// It is not what it is here. Said to the other host so many times more.
    Different { counted: Received, tries: u8 },
    /// It is read, under the number of a topic of this link.
    Read { topic: usize, incoming: Incoming },
}

impl Peer {
    pub(crate) fn new(name: Arc<str>, now: Moment) -> Peer {
        Peer {
            name,
            incarnation: None,
            past: VecDeque::new(),
            alive: now,
            is_doubted: false,
            topics: Vec::new(),
            clock: ClockFilter::default(),
            beat: None,
            heard: now,
        }
    }

    /// Whether what comes of this life is of an earlier one and has come late.
    ///
    /// Lives have no order: a late Hello of a life that was never heard of looks like a new life, and the true one then like a past one. So
    /// one that is taken for past is believed again when the one that is taken for present has been silent for `silence`.
    pub(crate) fn is_past(&self, incarnation: u64, now: Moment, silence: Duration) -> bool {
        self.past.contains(&incarnation) && now.since(self.alive) <= silence
    }

    /// Begins another life, with `total` topics. What waited in the last one is delivered.
    pub(crate) fn begin(
        &mut self,
        incarnation: u64,
        total: usize,
        now: Moment,
        deliver: &mut impl FnMut(usize, Message),
    ) {
        self.end(deliver);
        self.alive = now;
        self.is_doubted = false;
        self.past.retain(|past| *past != incarnation);
        if self.past.len() == REMEMBERED_LIVES {
            self.past.pop_front();
        }
        self.past.extend(self.incarnation.replace(incarnation));
        self.topics = (0..total).map(|_| None).collect();
        self.clock = ClockFilter::default();
        self.beat = None;
    }

    /// Delivers what waits.
    pub(crate) fn end(&mut self, deliver: &mut impl FnMut(usize, Message)) {
        for reading in self.topics.iter_mut().flatten() {
            if let ReadingState::Read { topic, incoming } = &mut reading.state {
                incoming.end(&mut |message| deliver(*topic, message));
            }
        }
    }

    /// Hears something of a life; whether it is the one that is known.
    pub(crate) fn is_in(&mut self, incarnation: u64, now: Moment, silence: Duration) -> bool {
        let is_known = self.incarnation == Some(incarnation);
        if is_known {
            self.alive = now;
        }
        self.is_doubted |= !is_known && !self.is_past(incarnation, now, silence);
        is_known
    }

    /// Whether its life is unknown, or some of its offers.
    pub(crate) fn is_unknown(&self) -> bool {
        self.incarnation.is_none() || self.is_doubted || self.topics.iter().any(Option::is_none)
    }
}
