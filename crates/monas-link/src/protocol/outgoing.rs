//! The messages of one topic on their way out: what waits, what was sent and may be asked for again.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use narukom::Moment;

use super::counters::Sent;
use super::payload::MessageBytes;

/// So many bytes of a topic are kept, besides its last message.
pub(crate) const KEPT_BYTES: usize = 8 << 20;

/// The messages of a topic that this host sends. Those in `kept` have consecutive numbers.
pub(crate) struct Outgoing {
    kept: VecDeque<Kept>,
    /// How many are kept at most.
    depth: usize,
    /// Whether what was sent is kept to be sent again.
    repeats: bool,
    /// The number of the newest message taken.
    last: u64,
    /// The number of the next message to be sent for the first time.
    next: u64,
    bytes: usize,
    repairs: BTreeSet<(u64, Arc<str>)>,
    counted: Sent,
}

struct Kept {
    number: u64,
    stamp: Arc<[u8]>,
    payload: MessageBytes,
    sent_again: Option<Moment>,
}

/// What is to be sent of a topic.
pub(crate) struct Parcel {
    pub(crate) to: Option<Arc<str>>,
    pub(crate) stamp: Arc<[u8]>,
    pub(crate) payload: MessageBytes,
}

impl Outgoing {
    pub(crate) fn new(depth: usize, repeats: bool) -> Outgoing {
        Outgoing {
            kept: VecDeque::new(),
            depth: depth.max(1),
            repeats,
            last: 0,
            next: 1,
            bytes: 0,
            repairs: BTreeSet::new(),
            counted: Sent::default(),
        }
    }

    /// The number that the next message will have.
    pub(crate) fn next_number(&self) -> u64 {
        self.last + 1
    }

    /// Takes the message with the [next number](Outgoing::next_number). Older ones make place for it.
    pub(crate) fn take(&mut self, stamp: Arc<[u8]>, payload: MessageBytes) {
        self.counted.taken += 1;
        self.last += 1;
        self.bytes += payload.len();
        self.kept.push_back(Kept { number: self.last, stamp, payload, sent_again: None });
        while self.kept.len() > self.depth || (self.bytes > KEPT_BYTES && self.kept.len() > 1) {
            self.drop_oldest();
        }
    }

    /// Counts a message that cannot be sent.
    pub(crate) fn refuse_oversize(&mut self) {
        self.counted.taken += 1;
        self.counted.oversize += 1;
    }

    /// Counts messages that the hub no longer had.
    pub(crate) fn set_lost(&mut self, lost: u64) {
        self.counted.lost = lost;
    }

    fn drop_oldest(&mut self) {
        let Some(oldest) = self.kept.pop_front() else { return };
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

    /// The next thing to be sent: what somebody lacks, before what is new.
    pub(crate) fn send(&mut self, now: Moment) -> Option<Parcel> {
        while let Some((number, to)) = self.repairs.pop_first() {
            if let Some(parcel) = self.repair(number, to, now) {
                return Some(parcel);
            }
        }
        self.send_new()
    }

    fn repair(&mut self, number: u64, to: Arc<str>, now: Moment) -> Option<Parcel> {
        let place = self.place(number)?;
        let kept = &mut self.kept[place];
        kept.sent_again = Some(now);
        self.counted.resent += 1;
        self.counted.bytes += (kept.stamp.len() + kept.payload.len()) as u64;
        Some(Parcel { to: Some(to), stamp: kept.stamp.clone(), payload: kept.payload.clone() })
    }

    fn send_new(&mut self) -> Option<Parcel> {
        let kept = &self.kept[self.place(self.next)?];
        let parcel = Parcel { to: None, stamp: kept.stamp.clone(), payload: kept.payload.clone() };
        self.counted.sent += 1;
        self.counted.bytes += (parcel.stamp.len() + parcel.payload.len()) as u64;
        self.next += 1;
        while !self.repeats && self.kept.front().is_some_and(|oldest| oldest.number < self.next) {
            self.drop_oldest();
        }
        Some(parcel)
    }

    /// Where the message with a number is kept.
    fn place(&self, number: u64) -> Option<usize> {
        let place = usize::try_from(number.checked_sub(self.kept.front()?.number)?).ok()?;
        (place < self.kept.len()).then_some(place)
    }

    /// Notes that `peer` lacks messages `first..=last`. What was sent again less than `patience` ago may still be on its way.
    pub(crate) fn ask(&mut self, first: u64, last: u64, peer: &Arc<str>, now: Moment, patience: Duration) {
        let next = self.next;
        let wanted = |kept: &&Kept| (first..=last).contains(&kept.number) && kept.number < next;
        let is_due = |kept: &&Kept| kept.sent_again.is_none_or(|at| now >= at + patience);
        let due = self.kept.iter().filter(wanted).filter(is_due).map(|kept| (kept.number, peer.clone()));
        self.repairs.extend(due);
    }

    /// The oldest message that can be sent again, and the newest that was sent.
    pub(crate) fn head(&self) -> (u64, u64) {
        let oldest = self.kept.front().map_or(self.next, |oldest| oldest.number.min(self.next));
        (oldest, self.next - 1)
    }

    pub(crate) fn counted(&self) -> Sent {
        Sent { waiting: self.last + 1 - self.next, ..self.counted }
    }
}
