//! State of the other hosts.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use narukom::Timestamp;

use super::clock::ClockFilter;
use super::counters::ReceivedCounters;
use super::incoming::{IncomingStream, StampedMessage};

/// The most hosts that a link remembers; the one that has been silent longest is forgotten first.
pub(crate) const PEER_LIMIT: usize = 64;

/// The most topics that a host may offer.
pub(crate) const OFFER_LIMIT: usize = 1024;

/// The number of earlier incarnations of a host that are remembered, so that late packets are
/// recognised.
const REMEMBERED_INCARNATIONS: usize = 4;

/// The number of times that a refusal is sent without an acknowledgement.
pub(crate) const REFUSAL_TRIES: u8 = 8;

/// Another host.
pub(crate) struct Peer {
    pub(crate) name: Arc<str>,
    /// Incarnation of its link; `None` before its Hello.
    pub(crate) incarnation: Option<u64>,
    past: VecDeque<u64>,
    /// When a packet of its current incarnation last arrived.
    alive: Timestamp,
    /// Whether a packet of another incarnation arrived whose Hello is missing.
    is_doubted: bool,
    /// By index; `None` for offers that have not arrived.
    pub(crate) topics: Vec<Option<PeerTopic>>,
    pub(crate) clock: ClockFilter,
    /// When its last Beat was sent, by its clock, and received, by ours. `None` once it has been
    /// echoed.
    pub(crate) beat: Option<(u64, Timestamp)>,
    pub(crate) last_received: Timestamp,
}

/// A topic of another host.
pub(crate) struct PeerTopic {
    pub(crate) path: Arc<str>,
    pub(crate) state: PeerTopicState,
}

/// The treatment of a topic of another host.
pub(crate) enum PeerTopicState {
    /// It is not received here.
    Unwanted,
    /// The access list forbids it.
    Forbidden(ReceivedCounters),
    /// Its declaration differs. The refusal is still to be repeated this many times.
    Different { counted: ReceivedCounters, tries: u8 },
    /// It is read, as the topic with this index of the link.
    Read { topic: usize, incoming: IncomingStream },
}

impl Peer {
    pub(crate) fn new(name: Arc<str>, now: Timestamp) -> Peer {
        Peer {
            name,
            incarnation: None,
            past: VecDeque::new(),
            alive: now,
            is_doubted: false,
            topics: Vec::new(),
            clock: ClockFilter::default(),
            beat: None,
            last_received: now,
        }
    }

    /// Whether packets of this incarnation are late ones of an earlier incarnation.
    ///
    /// Incarnations are not ordered: a late Hello of an unknown incarnation looks like a new one,
    /// and then the true one like an old one. So an incarnation believed to be old is accepted
    /// again when the one believed to be current has been silent for `silence`.
    pub(crate) fn is_stale(&self, incarnation: u64, now: Timestamp, silence: Duration) -> bool {
        self.past.contains(&incarnation) && now.since(self.alive) <= silence
    }

    /// Begins another incarnation, with `total` topics. Waiting messages of the last one are
    /// delivered.
    pub(crate) fn begin(
        &mut self,
        incarnation: u64,
        total: usize,
        now: Timestamp,
        deliver: &mut impl FnMut(usize, StampedMessage),
    ) {
        self.end(deliver);
        self.alive = now;
        self.is_doubted = false;
        self.past.retain(|past| *past != incarnation);
        if self.past.len() == REMEMBERED_INCARNATIONS {
            self.past.pop_front();
        }
        self.past.extend(self.incarnation.replace(incarnation));
        self.topics = (0..total).map(|_| None).collect();
        self.clock = ClockFilter::default();
        self.beat = None;
    }

    /// Delivers the waiting messages.
    pub(crate) fn end(&mut self, deliver: &mut impl FnMut(usize, StampedMessage)) {
        for reading in self.topics.iter_mut().flatten() {
            if let PeerTopicState::Read { topic, incoming } = &mut reading.state {
                incoming.end(&mut |message| deliver(*topic, message));
            }
        }
    }

    /// Handles a packet of an incarnation; returns whether it is the current one.
    pub(crate) fn is_current(&mut self, incarnation: u64, now: Timestamp, silence: Duration) -> bool {
        let is_known = self.incarnation == Some(incarnation);
        if is_known {
            self.alive = now;
        }
        self.is_doubted |= !is_known && !self.is_stale(incarnation, now, silence);
        is_known
    }

    /// Whether its incarnation or some of its offers are unknown.
    pub(crate) fn is_incomplete(&self) -> bool {
        self.incarnation.is_none() || self.is_doubted || self.topics.iter().any(Option::is_none)
    }
}
