//! The messages of one topic of one host on their way in: put in order, and each counted once.

use std::collections::{BTreeMap, VecDeque};

use super::counters::Received;
use super::payload::MessageBytes;

/// So many messages of a topic wait for earlier ones.
pub(crate) const HELD_MESSAGES: usize = 1024;

/// So many bytes of a topic wait for earlier ones.
pub(crate) const HELD_BYTES: usize = 4 << 20;

/// So many spans of messages that were given up are remembered, to tell what is late from what came twice.
const REMEMBERED_GAPS: usize = 32;

/// Higher numbers are not believed.
pub(crate) const HIGHEST_NUMBER: u64 = u64::MAX / 2;

/// A message with its stamp's content.
#[derive(Clone, Debug)]
pub(crate) struct Message {
    pub(crate) publisher: String,
    pub(crate) sequence: u64,
    pub(crate) published: u64,
    pub(crate) payload: MessageBytes,
}

/// The messages of a topic of another host. All up to `settled` are delivered or counted as a gap.
pub(crate) struct Incoming {
    is_reliable: bool,
    settled: u64,
    held: BTreeMap<u64, Message>,
    held_bytes: usize,
    gaps: VecDeque<(u64, u64)>,
    counted: Received,
}

impl Incoming {
    /// Reads the messages after number `start`.
    pub(crate) fn new(is_reliable: bool, start: u64) -> Incoming {
        Incoming {
            is_reliable,
            settled: start,
            held: BTreeMap::new(),
            held_bytes: 0,
            gaps: VecDeque::new(),
            counted: Received { start, last: start, ..Received::default() },
        }
    }

    /// Takes a message; what can be delivered is given to `deliver`, in order.
    pub(crate) fn arrive(&mut self, number: u64, message: Message, deliver: &mut impl FnMut(Message)) {
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
            self.settle(deliver);
        }
    }

    fn count_old(&mut self, number: u64) {
        if self.gaps.iter().any(|&(first, last)| (first..=last).contains(&number)) {
            self.counted.late += 1;
        } else {
            self.counted.duplicates += 1;
        }
    }

    /// Delivers what need not wait.
    fn settle(&mut self, deliver: &mut impl FnMut(Message)) {
        while let Some((&number, _)) = self.held.first_key_value() {
            let is_crowded = self.held.len() > HELD_MESSAGES || self.held_bytes > HELD_BYTES;
            if number > self.settled + 1 && self.is_reliable && !is_crowded {
                return;
            }
            self.give_up_before(number);
            self.deliver_first(deliver);
        }
    }

    fn deliver_first(&mut self, deliver: &mut impl FnMut(Message)) {
        let Some((number, message)) = self.held.pop_first() else { return };
        self.held_bytes -= message.payload.len();
        self.settled = number;
        self.counted.delivered += 1;
        deliver(message);
    }

    /// What is not here and has a lower number than `number` will not be delivered.
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

    /// Hears how far the sender is: it has sent everything up to `last`, and can send again what is not older than `first`.
    pub(crate) fn head(&mut self, first: u64, last: u64, deliver: &mut impl FnMut(Message)) {
        if first > last.saturating_add(1) || last > HIGHEST_NUMBER {
            return;
        }
        self.counted.last = self.counted.last.max(last);
        self.skip_to(first, deliver);
    }

    /// Gives up what has a lower number than `first` and is not here.
    fn skip_to(&mut self, first: u64, deliver: &mut impl FnMut(Message)) {
        while let Some((&number, _)) = self.held.first_key_value().filter(|(number, _)| **number < first) {
            self.give_up_before(number);
            self.deliver_first(deliver);
        }
        self.give_up_before(first);
        self.settle(deliver);
    }

    /// Delivers what is here and gives up the rest: nothing more will come.
    pub(crate) fn end(&mut self, deliver: &mut impl FnMut(Message)) {
        self.skip_to(self.counted.last.saturating_add(1), deliver);
    }

    /// What is awaited: at most `limit` spans of numbers.
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

    /// Whether something is awaited.
    pub(crate) fn is_missing(&self) -> bool {
        self.settled + (self.held.len() as u64) < self.counted.last
    }

    /// How many bytes wait here.
    pub(crate) fn held_bytes(&self) -> usize {
        self.held_bytes
    }

    /// A message that was delivered has turned out to be none. False if it cannot have been delivered here: then it came from a stream
    /// that has begun anew since, and its counters are gone.
    pub(crate) fn take_back(&mut self) -> bool {
        let Some(delivered) = self.counted.delivered.checked_sub(1) else { return false };
        self.counted.delivered = delivered;
        self.counted.refused += 1;
        self.counted.gaps += 1;
        true
    }

    pub(crate) fn counted(&self) -> Received {
        let held = self.held.len() as u64;
        Received { held, missing: self.counted.last - self.settled - held, ..self.counted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(number: u64) -> Message {
        Message { publisher: String::new(), sequence: number, published: 0, payload: Vec::new().into() }
    }

    /// Lets messages arrive, and answers what was delivered.
    fn deliver(incoming: &mut Incoming, numbers: &[u64]) -> Vec<u64> {
        let mut delivered = Vec::new();
        for &number in numbers {
            incoming.arrive(number, message(number), &mut |message| delivered.push(message.sequence));
        }
        delivered
    }

    fn head(incoming: &mut Incoming, first: u64, last: u64) -> Vec<u64> {
        let mut delivered = Vec::new();
        incoming.head(first, last, &mut |message| delivered.push(message.sequence));
        delivered
    }

    #[test]
    fn reliable_messages_wait_for_earlier_ones() {
        let mut incoming = Incoming::new(true, 0);
        assert_eq!(deliver(&mut incoming, &[1, 3, 4, 3]), [1]);
        assert_eq!(incoming.missing(8), [(2, 2)]);
        assert_eq!(deliver(&mut incoming, &[2, 2]), [2, 3, 4]);
        let counted = incoming.counted();
        assert_eq!((counted.arrived, counted.delivered, counted.duplicates), (6, 4, 2));
    }

    #[test]
    fn what_can_no_longer_come_is_a_gap() {
        let mut incoming = Incoming::new(true, 0);
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
    fn what_was_delivered_by_a_stream_before_is_not_taken_back() {
        let mut incoming = Incoming::new(true, 0);
        assert!(!incoming.take_back());
        assert_eq!(incoming.counted(), Incoming::new(true, 0).counted());
        deliver(&mut incoming, &[1]);
        assert!(incoming.take_back());
        let counted = incoming.counted();
        assert_eq!((counted.delivered, counted.refused, counted.gaps), (0, 1, 1));
    }

    #[test]
    fn unreliable_messages_do_not_wait() {
        let mut incoming = Incoming::new(false, 0);
        assert_eq!(deliver(&mut incoming, &[1, 4, 3, 4]), [1, 4]);
        let counted = incoming.counted();
        assert_eq!((counted.gaps, counted.late, counted.duplicates), (2, 1, 1));
    }

    #[test]
    fn no_more_is_held_than_fits() {
        let mut incoming = Incoming::new(true, 0);
        let numbers: Vec<u64> = (2..2 + HELD_MESSAGES as u64).collect();
        assert_eq!(deliver(&mut incoming, &numbers), [0; 0]);
        assert_eq!(deliver(&mut incoming, &[10_000]).len(), HELD_MESSAGES, "the first is given up");
        assert_eq!(incoming.counted().gaps, 1);
        let large = Message { payload: vec![0; HELD_BYTES + 1].into(), ..message(0) };
        let mut delivered = 0;
        incoming.arrive(20_000, large, &mut |_| delivered += 1);
        assert_eq!(delivered, 2);
        assert_eq!(incoming.held_bytes(), 0);
    }

    #[test]
    fn numbers_that_cannot_be_are_harmless() {
        let mut incoming = Incoming::new(true, 0);
        assert_eq!(head(&mut incoming, u64::MAX, u64::MAX), [0; 0]);
        assert_eq!(head(&mut incoming, 9, 3), [0; 0]);
        assert_eq!(incoming.counted(), Received::default());
        assert_eq!(head(&mut incoming, 1, HIGHEST_NUMBER), [0; 0]);
        assert_eq!(incoming.missing(8), [(1, HIGHEST_NUMBER)]);
    }

    #[test]
    fn the_end_leaves_nothing_open() {
        let mut incoming = Incoming::new(true, 10);
        deliver(&mut incoming, &[12, 14]);
        let mut delivered = 0;
        incoming.end(&mut |_| delivered += 1);
        let counted = incoming.counted();
        assert_eq!((delivered, counted.gaps, counted.held, counted.missing), (2, 2, 0, 0));
    }
}
