//! What a hub holds of one topic: its last messages, and the counters of its publishers.

use std::collections::VecDeque;

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

/// A message in a ring.
pub(crate) struct Entry {
    pub(crate) sample: AnySample,
    /// The hub's running number over all topics.
    pub(crate) order: u64,
    pub(crate) origin: Origin,
}

/// The last messages of a topic. Each has a running index; readers keep the index of the one they want next.
pub(crate) struct Ring {
    entries: VecDeque<Entry>,
    capacity: usize,
    next: u64,
    sequences: Vec<(PublisherId, u64)>,
}

impl Ring {
    pub(crate) fn new(capacity: usize) -> Ring {
        Ring { entries: VecDeque::new(), capacity, next: 0, sequences: Vec::new() }
    }

    /// The number of the publisher's next message.
    pub(crate) fn next_sequence(&mut self, publisher: PublisherId) -> u64 {
        match self.sequences.iter_mut().find(|(other, _)| *other == publisher) {
            Some((_, sequence)) => {
                *sequence += 1;
                *sequence
            }
            None => {
                self.sequences.push((publisher, 1));
                1
            }
        }
    }

    /// Appends a message; the oldest leaves when the ring is full.
    pub(crate) fn push(&mut self, entry: Entry) {
        if self.entries.len() == self.capacity {
            self.entries.pop_front();
        }
        self.entries.push_back(entry);
        self.next += 1;
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
    pub(crate) fn from(&self, cursor: u64) -> impl DoubleEndedIterator<Item = &Entry> {
        let skipped = cursor.saturating_sub(self.first()) as usize;
        self.entries.range(skipped.min(self.entries.len())..)
    }

    /// How many messages from the one with index `cursor` on are no longer held.
    pub(crate) fn missed(&self, cursor: u64) -> u64 {
        self.first().saturating_sub(cursor)
    }

    /// The index of the first message that was published later than the one with number `order`.
    pub(crate) fn after(&self, order: u64) -> u64 {
        self.first() + self.entries.partition_point(|entry| entry.order <= order) as u64
    }
}
