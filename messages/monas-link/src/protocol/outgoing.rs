//! The sending side of one topic: unsent messages, and those retained for retransmission.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use narukom::Timestamp;

use super::counters::SentCounters;
use super::payload::MessageBytes;

/// The most bytes of a topic that are retained, besides its last message.
pub(crate) const KEPT_BYTES: usize = 8 << 20;

/// The messages of a topic that this host sends. Those in `kept` have consecutive numbers.
pub(crate) struct OutgoingStream {
    retained: VecDeque<RetainedMessage>,
    /// The most messages that are retained.
    depth: usize,
    /// Whether sent messages are retained for retransmission.
    repeats: bool,
    /// The number of the newest message taken.
    last: u64,
    /// The number of the next message to send for the first time.
    next: u64,
    bytes: usize,
    repairs: BTreeSet<(u64, Arc<str>)>,
    counted: SentCounters,
}

struct RetainedMessage {
    number: u64,
    stamp: Arc<[u8]>,
    payload: MessageBytes,
    sent_again: Option<Timestamp>,
}

/// The message of a topic to send next.
pub(crate) struct OutgoingBatch {
    pub(crate) to: Option<Arc<str>>,
    pub(crate) stamp: Arc<[u8]>,
    pub(crate) payload: MessageBytes,
}

impl OutgoingStream {
    pub(crate) fn new(depth: usize, repeats: bool) -> OutgoingStream {
        OutgoingStream {
            retained: VecDeque::new(),
            depth: depth.max(1),
            repeats,
            last: 0,
            next: 1,
            bytes: 0,
            repairs: BTreeSet::new(),
            counted: SentCounters::default(),
        }
    }

    /// The number that the next message will have.
    pub(crate) fn next_number(&self) -> u64 {
        self.last + 1
    }

    /// Adds the message with the [next number](OutgoingStream::next_number), dropping old ones to
    /// make room.
    pub(crate) fn push(&mut self, stamp: Arc<[u8]>, payload: MessageBytes) {
        self.counted.taken += 1;
        self.last += 1;
        self.bytes += payload.len();
        self.retained.push_back(RetainedMessage { number: self.last, stamp, payload, sent_again: None });
        while self.retained.len() > self.depth || (self.bytes > KEPT_BYTES && self.retained.len() > 1) {
            self.drop_oldest();
        }
    }

    /// Counts a message that cannot be sent.
    pub(crate) fn refuse_oversize(&mut self) {
        self.counted.taken += 1;
        self.counted.oversize += 1;
    }

    /// Sets the number of messages that left the hub before they could be taken.
    pub(crate) fn set_lost(&mut self, lost: u64) {
        self.counted.lost = lost;
    }

    fn drop_oldest(&mut self) {
        let Some(oldest) = self.retained.pop_front() else { return };
        self.bytes -= oldest.payload.len();
        while self.repairs.first().is_some_and(|(number, _)| *number <= oldest.number) {
            self.repairs.pop_first();
        }
        if oldest.number >= self.next {
            self.counted.dropped += 1;
            self.next = oldest.number + 1;
        }
    }

    /// Whether there is something to send.
    pub(crate) fn is_ready(&self) -> bool {
        self.next <= self.last || !self.repairs.is_empty()
    }

    /// The next message to send: retransmissions before new ones.
    pub(crate) fn send(&mut self, now: Timestamp) -> Option<OutgoingBatch> {
        while let Some((number, to)) = self.repairs.pop_first() {
            if let Some(batch) = self.resend(number, to, now) {
                return Some(batch);
            }
        }
        self.send_new()
    }

    fn resend(&mut self, number: u64, to: Arc<str>, now: Timestamp) -> Option<OutgoingBatch> {
        let index = self.index_of(number)?;
        let kept = &mut self.retained[index];
        kept.sent_again = Some(now);
        self.counted.resent += 1;
        self.counted.bytes += (kept.stamp.len() + kept.payload.len()) as u64;
        Some(OutgoingBatch { to: Some(to), stamp: kept.stamp.clone(), payload: kept.payload.clone() })
    }

    fn send_new(&mut self) -> Option<OutgoingBatch> {
        let kept = &self.retained[self.index_of(self.next)?];
        let batch = OutgoingBatch { to: None, stamp: kept.stamp.clone(), payload: kept.payload.clone() };
        self.counted.sent += 1;
        self.counted.bytes += (batch.stamp.len() + batch.payload.len()) as u64;
        self.next += 1;
        while !self.repeats && self.retained.front().is_some_and(|oldest| oldest.number < self.next) {
            self.drop_oldest();
        }
        Some(batch)
    }

    /// The index of the message with a number.
    fn index_of(&self, number: u64) -> Option<usize> {
        let index = usize::try_from(number.checked_sub(self.retained.front()?.number)?).ok()?;
        (index < self.retained.len()).then_some(index)
    }

    /// Records that `peer` lacks messages `first..=last`. A message retransmitted less than
    /// `timeout` ago may still be in transit.
    pub(crate) fn request_resend(
        &mut self,
        first: u64,
        last: u64,
        peer: &Arc<str>,
        now: Timestamp,
        timeout: Duration,
    ) {
        let next = self.next;
        let wanted = |kept: &&RetainedMessage| (first..=last).contains(&kept.number) && kept.number < next;
        let is_due = |kept: &&RetainedMessage| kept.sent_again.is_none_or(|at| now >= at + timeout);
        let due = self.retained.iter().filter(wanted).filter(is_due).map(|kept| (kept.number, peer.clone()));
        self.repairs.extend(due);
    }

    /// The oldest message that can be retransmitted, and the newest that was sent.
    pub(crate) fn head(&self) -> (u64, u64) {
        let oldest = self.retained.front().map_or(self.next, |oldest| oldest.number.min(self.next));
        (oldest, self.next - 1)
    }

    pub(crate) fn counted(&self) -> SentCounters {
        SentCounters { waiting: self.last + 1 - self.next, ..self.counted }
    }
}
