//! What a hub holds of one topic of one host: its last messages, and the counters of its publishers.

use std::sync::Arc;

use crate::encoding::Encoding;
use crate::exchange::Outgoing;
use crate::sample::{AnySample, PublisherId};

/// Identifies a blackboard among those of a hub, so that it knows its own messages when they come back.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Origin {
    /// The blackboard, from 1; 0 for a publisher outside agents.
    pub(crate) blackboard: u32,
    /// How many messages the blackboard had written on the topic, this one included.
    pub(crate) nth: u64,
}

impl Origin {
    /// Not a blackboard.
    pub(crate) const OUTSIDE: Origin = Origin { blackboard: 0, nth: 0 };
}

/// A message in a ring. It lies in two cache lines, and never in three.
#[repr(align(32))]
pub(crate) struct Entry {
    pub(crate) sample: AnySample,
    /// The hub's running number over all topics.
    pub(crate) order: u64,
    pub(crate) origin: Origin,
    /// Where its encoding is shared; there if the topic was tapped when it was published.
    pub(crate) encoding: Option<Arc<Encoding>>,
}

/// The last messages of a topic. Each has a running index; readers keep the index of the one they want next. What they look at comes first,
/// in one cache line.
#[repr(C, align(64))]
pub(crate) struct Ring {
    /// In order of publication from `start` on, and then from 0.
    entries: Vec<Entry>,
    start: usize,
    capacity: usize,
    next: u64,
    /// The number over all topics of the first message there ever was.
    begun: u64,
    /// How many messages of each publisher, sorted by publisher.
    sequences: Vec<(PublisherId, u64)>,
    taps: usize,
    /// An encoding that left the ring, to be used again.
    spare: Option<Arc<Encoding>>,
}

impl Ring {
    pub(crate) fn new(capacity: usize) -> Ring {
        Ring {
            entries: Vec::new(),
            start: 0,
            capacity,
            next: 0,
            begun: 0,
            sequences: Vec::new(),
            taps: 0,
            spare: None,
        }
    }

    /// How many messages it holds at most.
    pub(crate) fn capacity(&self) -> usize {
        self.capacity
    }

    /// The number of the publisher's next message.
    #[inline]
    pub(crate) fn next_sequence(&mut self, publisher: PublisherId) -> u64 {
        match self.sequences.binary_search_by_key(&publisher, |(other, _)| *other) {
            Ok(place) => {
                self.sequences[place].1 += 1;
                self.sequences[place].1
            }
            Err(place) => {
                self.sequences.insert(place, (publisher, 1));
                1
            }
        }
    }

    /// Appends a message. When the ring is full the oldest leaves, and is given back with it.
    #[inline]
    pub(crate) fn push(&mut self, message: &mut Outgoing, order: u64, is_observed: bool) {
        let content = if is_observed { message.message.clone() } else { message.message.take() };
        let Some(content) = content else { return };
        if self.taps > 0 {
            message.encoding = Some(self.spare.take().unwrap_or_default());
        }
        let (header, origin, encoding) = (message.header, message.origin, message.encoding.clone());
        if self.entries.len() < self.capacity {
            let sample = AnySample { message: content, header };
            self.entries.push(Entry { sample, order, origin, encoding });
        } else {
            let oldest = &mut self.entries[self.start];
            message.left = Some(std::mem::replace(&mut oldest.sample.message, content));
            (oldest.sample.header, oldest.order, oldest.origin) = (header, order, origin);
            let encoding = std::mem::replace(&mut oldest.encoding, encoding);
            self.start = if self.start + 1 == self.capacity { 0 } else { self.start + 1 };
            self.reuse(encoding);
        }
        if self.next == 0 {
            self.begun = order;
        }
        self.next += 1;
    }

    /// Keeps an encoding that left, if nobody holds it.
    fn reuse(&mut self, encoding: Option<Arc<Encoding>>) {
        if let Some(mut encoding) = encoding
            && let Some(place) = Arc::get_mut(&mut encoding)
        {
            place.clear();
            self.spare = Some(encoding);
        }
    }

    /// The newest message, and where its encoding is shared.
    #[inline]
    pub(crate) fn newest(&self) -> Option<&Entry> {
        self.entries[..self.start].last().or_else(|| self.entries.last())
    }

    /// Counts the taps.
    pub(crate) fn add_tap(&mut self) {
        self.taps += 1;
    }

    /// One tap less.
    pub(crate) fn remove_tap(&mut self) {
        self.taps = self.taps.saturating_sub(1);
    }

    /// The index that the next message will have.
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// The index of the oldest message that is held.
    fn first(&self) -> u64 {
        self.next - self.entries.len() as u64
    }

    /// The messages from the one with index `cursor` on, oldest first.
    #[inline]
    pub(crate) fn from(&self, cursor: u64) -> impl Iterator<Item = &Entry> {
        let skipped = cursor.saturating_sub(self.first()).min(self.entries.len() as u64) as usize;
        let (newer, older) = self.entries.split_at(self.start);
        let (older_skipped, newer_skipped) = (skipped.min(older.len()), skipped.saturating_sub(older.len()));
        older[older_skipped..].iter().chain(&newer[newer_skipped..])
    }

    /// How many messages from the one with index `cursor` on are no longer held.
    pub(crate) fn missed(&self, cursor: u64) -> u64 {
        self.first().saturating_sub(cursor)
    }

    /// The index of the first message that was published later than the one with number `order`.
    pub(crate) fn after(&self, order: u64) -> u64 {
        let (newer, older) = self.entries.split_at(self.start);
        let count = |entries: &[Entry]| entries.partition_point(|entry| entry.order <= order);
        self.first() + (count(older) + count(newer)) as u64
    }

    /// Whether there was a message by number `order`, held or not.
    pub(crate) fn had_any_by(&self, order: u64) -> bool {
        self.next > 0 && self.begun <= order
    }
}
