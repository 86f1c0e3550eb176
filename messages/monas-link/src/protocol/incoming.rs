//! The receiving side of one topic of one host: reorders messages and counts each once.

use std::collections::{BTreeMap, VecDeque};

use super::counters::ReceivedCounters;
use super::payload::MessageBytes;

/// The most messages of a topic that wait for earlier ones.
pub(crate) const HELD_MESSAGES: usize = 1024;

/// The most bytes of a topic that wait for earlier ones.
pub(crate) const HELD_BYTES: usize = 4 << 20;

/// The number of remembered ranges of skipped messages, to distinguish late messages from
/// duplicates.
const REMEMBERED_GAPS: usize = 32;

/// Higher numbers are rejected as implausible.
pub(crate) const HIGHEST_NUMBER: u64 = u64::MAX / 2;

/// A message with the content of its stamp.
#[derive(Clone, Debug)]
pub(crate) struct StampedMessage {
    pub(crate) publisher: String,
    pub(crate) sequence: u64,
    pub(crate) published: u64,
    pub(crate) payload: MessageBytes,
}

/// The messages of a topic of another host. All up to `settled` are delivered or counted as a gap.
pub(crate) struct IncomingStream {
    is_reliable: bool,
    settled: u64,
    held: BTreeMap<u64, StampedMessage>,
    held_bytes: usize,
    gaps: VecDeque<(u64, u64)>,
    counted: ReceivedCounters,
}

impl IncomingStream {
    /// Reads the messages after number `start`.
    pub(crate) fn new(is_reliable: bool, start: u64) -> IncomingStream {
        IncomingStream {
            is_reliable,
            settled: start,
            held: BTreeMap::new(),
            held_bytes: 0,
            gaps: VecDeque::new(),
            counted: ReceivedCounters { start, last: start, ..ReceivedCounters::default() },
        }
    }

    /// Handles a message; passes all messages that can be delivered to `deliver`, in order.
    pub(crate) fn arrive(
        &mut self,
        number: u64,
        message: StampedMessage,
        deliver: &mut impl FnMut(StampedMessage),
    ) {
        self.counted.arrived += 1;
        self.counted.bytes += message.payload.len() as u64;
        if number <= self.settled {
            self.count_old(number);
        } else if self.held.contains_key(&number) {
            self.counted.duplicates += 1;
        } else {
            self.counted.last = self.counted.last.max(number);
            self.held_bytes += message.payload.len();
            self.held.insert(number, message);
            self.deliver_ready(deliver);
        }
    }

    fn count_old(&mut self, number: u64) {
        if self.gaps.iter().any(|&(first, last)| (first..=last).contains(&number)) {
            self.counted.late += 1;
        } else {
            self.counted.duplicates += 1;
        }
    }

    /// Delivers messages that need not wait.
    fn deliver_ready(&mut self, deliver: &mut impl FnMut(StampedMessage)) {
        while let Some((&number, _)) = self.held.first_key_value() {
            let is_crowded = self.held.len() > HELD_MESSAGES || self.held_bytes > HELD_BYTES;
            if number > self.settled + 1 && self.is_reliable && !is_crowded {
                return;
            }
            self.give_up_before(number);
            self.deliver_first(deliver);
        }
    }

    fn deliver_first(&mut self, deliver: &mut impl FnMut(StampedMessage)) {
        let Some((number, message)) = self.held.pop_first() else { return };
        self.held_bytes -= message.payload.len();
        self.settled = number;
        self.counted.delivered += 1;
        deliver(message);
    }

    /// Counts missing messages with lower numbers than `number` as gaps.
    fn give_up_before(&mut self, number: u64) {
        let first = self.settled + 1;
        if number <= first {
            return;
        }
        self.counted.gaps += number - first;
        if self.gaps.len() == REMEMBERED_GAPS {
            self.gaps.pop_front();
        }
        self.gaps.push_back((first, number - 1));
        self.settled = number - 1;
    }

    /// Handles the sender's progress: it has sent everything up to `last`, and can retransmit from
    /// `first` on.
    pub(crate) fn head(&mut self, first: u64, last: u64, deliver: &mut impl FnMut(StampedMessage)) {
        if first > last.saturating_add(1) || last > HIGHEST_NUMBER {
            return;
        }
        self.counted.last = self.counted.last.max(last);
        self.skip_to(first, deliver);
    }

    /// Skips missing messages with lower numbers than `first`.
    fn skip_to(&mut self, first: u64, deliver: &mut impl FnMut(StampedMessage)) {
        while let Some((&number, _)) = self.held.first_key_value().filter(|(number, _)| **number < first) {
            self.give_up_before(number);
            self.deliver_first(deliver);
        }
        self.give_up_before(first);
        self.deliver_ready(deliver);
    }

    /// Delivers the messages that wait and counts the rest as gaps: the stream ends.
    pub(crate) fn end(&mut self, deliver: &mut impl FnMut(StampedMessage)) {
        self.skip_to(self.counted.last.saturating_add(1), deliver);
    }

    /// The missing messages: at most `limit` ranges of numbers.
    pub(crate) fn missing(&self, limit: usize) -> Vec<(u64, u64)> {
        let (mut spans, mut next) = (Vec::new(), self.settled + 1);
        for &number in self.held.keys() {
            if number > next {
                spans.push((next, number - 1));
            }
            next = number + 1;
            if spans.len() == limit {
                return spans;
            }
        }
        if next <= self.counted.last {
            spans.push((next, self.counted.last));
        }
        spans
    }

    /// Whether messages are missing.
    pub(crate) fn is_missing(&self) -> bool {
        self.settled + (self.held.len() as u64) < self.counted.last
    }

    /// The number of bytes that wait here.
    pub(crate) fn held_bytes(&self) -> usize {
        self.held_bytes
    }

    /// Counts a delivered message as rejected by the hub. Returns `false` if it cannot have been
    /// delivered here: then it came from an earlier stream, whose counters are gone.
    pub(crate) fn reject_delivered(&mut self) -> bool {
        let Some(delivered) = self.counted.delivered.checked_sub(1) else { return false };
        self.counted.delivered = delivered;
        self.counted.refused += 1;
        self.counted.gaps += 1;
        true
    }

    pub(crate) fn counted(&self) -> ReceivedCounters {
        let held = self.held.len() as u64;
        ReceivedCounters { held, missing: self.counted.last - self.settled - held, ..self.counted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(number: u64) -> StampedMessage {
        StampedMessage {
            publisher: String::new(),
            sequence: number,
            published: 0,
            payload: Vec::new().into(),
        }
    }

    /// Handles messages, and returns which were delivered.
    fn deliver(incoming: &mut IncomingStream, numbers: &[u64]) -> Vec<u64> {
        let mut delivered = Vec::new();
        for &number in numbers {
            incoming.arrive(number, message(number), &mut |message| delivered.push(message.sequence));
        }
        delivered
    }

    fn head(incoming: &mut IncomingStream, first: u64, last: u64) -> Vec<u64> {
        let mut delivered = Vec::new();
        incoming.head(first, last, &mut |message| delivered.push(message.sequence));
        delivered
    }

    #[test]
    fn reliable_messages_wait_for_earlier_ones() {
        let mut incoming = IncomingStream::new(true, 0);
        assert_eq!(deliver(&mut incoming, &[1, 3, 4, 3]), [1]);
        assert_eq!(incoming.missing(8), [(2, 2)]);
        assert_eq!(deliver(&mut incoming, &[2, 2]), [2, 3, 4]);
        let counted = incoming.counted();
        assert_eq!((counted.arrived, counted.delivered, counted.duplicates), (6, 4, 2));
    }

    #[test]
    fn messages_that_can_no_longer_arrive_are_a_gap() {
        let mut incoming = IncomingStream::new(true, 0);
        assert_eq!(deliver(&mut incoming, &[2, 6]), [0; 0]);
        assert_eq!(head(&mut incoming, 5, 7), [2]);
        assert_eq!(incoming.missing(8), [(5, 5), (7, 7)]);
        assert_eq!(deliver(&mut incoming, &[3]), [0; 0], "its place has passed");
        let counted = incoming.counted();
        assert_eq!((counted.gaps, counted.late, counted.held, counted.missing), (3, 1, 1, 2));
        assert_eq!(
            counted.last - counted.start,
            counted.delivered + counted.gaps + counted.held + counted.missing
        );
    }

    #[test]
    fn messages_delivered_by_a_stream_are_not_withdrawn() {
        let mut incoming = IncomingStream::new(true, 0);
        assert!(!incoming.reject_delivered());
        assert_eq!(incoming.counted(), IncomingStream::new(true, 0).counted());
        deliver(&mut incoming, &[1]);
        assert!(incoming.reject_delivered());
        let counted = incoming.counted();
        assert_eq!((counted.delivered, counted.refused, counted.gaps), (0, 1, 1));
    }

    #[test]
    fn unreliable_messages_do_not_wait() {
        let mut incoming = IncomingStream::new(false, 0);
        assert_eq!(deliver(&mut incoming, &[1, 4, 3, 4]), [1, 4]);
        let counted = incoming.counted();
        assert_eq!((counted.gaps, counted.late, counted.duplicates), (2, 1, 1));
    }

    #[test]
    fn no_more_is_held_than_fits() {
        let mut incoming = IncomingStream::new(true, 0);
        let numbers: Vec<u64> = (2..2 + HELD_MESSAGES as u64).collect();
        assert_eq!(deliver(&mut incoming, &numbers), [0; 0]);
        assert_eq!(deliver(&mut incoming, &[10_000]).len(), HELD_MESSAGES, "the first is given up");
        assert_eq!(incoming.counted().gaps, 1);
        let large = StampedMessage { payload: vec![0; HELD_BYTES + 1].into(), ..message(0) };
        let mut delivered = 0;
        incoming.arrive(20_000, large, &mut |_| delivered += 1);
        assert_eq!(delivered, 2);
        assert_eq!(incoming.held_bytes(), 0);
    }

    #[test]
    fn numbers_that_cannot_be_are_harmless() {
        let mut incoming = IncomingStream::new(true, 0);
        assert_eq!(head(&mut incoming, u64::MAX, u64::MAX), [0; 0]);
        assert_eq!(head(&mut incoming, 9, 3), [0; 0]);
        assert_eq!(incoming.counted(), ReceivedCounters::default());
        assert_eq!(head(&mut incoming, 1, HIGHEST_NUMBER), [0; 0]);
        assert_eq!(incoming.missing(8), [(1, HIGHEST_NUMBER)]);
    }

    #[test]
    fn the_end_leaves_nothing_open() {
        let mut incoming = IncomingStream::new(true, 10);
        deliver(&mut incoming, &[12, 14]);
        let mut delivered = 0;
        incoming.end(&mut |_| delivered += 1);
        let counted = incoming.counted();
        assert_eq!((delivered, counted.gaps, counted.held, counted.missing), (2, 2, 0, 0));
    }
}
