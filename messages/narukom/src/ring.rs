//! The state of one topic of one host in a hub: the last messages, and the counters of its
//! publishers.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::encoding::EncodingSlot;
use crate::message::AnyMessage;
use crate::sample::{AnySample, PublisherId};

/// Identifies a blackboard within a hub, so that it recognises its own messages when they are
/// delivered.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct WriterId {
    /// The blackboard, from 1; 0 for a publisher outside of agents.
    pub(crate) blackboard: u32,
    /// The number of messages that the blackboard had written on the topic, this one included.
    pub(crate) nth: u64,
}

impl WriterId {
    /// Not a blackboard.
    pub(crate) const OUTSIDE: WriterId = WriterId { blackboard: 0, nth: 0 };
}

/// A message in a ring, or on its way there. Its size and alignment let it span two cache lines,
/// never three.
#[repr(align(32))]
pub(crate) struct RingEntry {
    pub(crate) sample: AnySample,
    /// The hub's running number over all topics.
    pub(crate) order: u64,
    pub(crate) origin: WriterId,
    /// The shared encoding; present if the topic had an encoded subscriber when the message was
    /// published.
    pub(crate) encoding: Option<Arc<EncodingSlot>>,
}

/// The last messages of a topic. Each has a sequential index; readers keep the index of the next
/// one to fetch. The fields that readers check come first, in one cache line.
#[repr(C, align(64))]
pub(crate) struct Ring {
    /// In order of publication.
    entries: VecDeque<RingEntry>,
    capacity: usize,
    next: u64,
    /// The number, over all topics, of the first message ever published on the topic.
    begun: u64,
    /// The number of messages of each publisher, sorted by publisher.
    sequences: Vec<(PublisherId, u64)>,
    taps: usize,
    /// Encodings that left the ring, to be reused when they have no other references.
    spares: Vec<Arc<EncodingSlot>>,
    /// Index of the next encoding to discard when there are too many.
    turn: usize,
}

/// The most encodings that wait for their last reader, such as a link that may have to retransmit
/// them.
const MAX_SPARE_ENCODINGS: usize = 4;

impl Ring {
    pub(crate) fn new(capacity: usize) -> Ring {
        Ring {
            entries: VecDeque::new(),
            capacity,
            next: 0,
            begun: 0,
            sequences: Vec::new(),
            taps: 0,
            spares: Vec::new(),
            turn: 0,
        }
    }

    /// The most messages that it holds.
    pub(crate) fn capacity(&self) -> usize {
        self.capacity
    }

    /// The number of the publisher's next message.
    #[inline]
    pub(crate) fn next_sequence(&mut self, publisher: PublisherId) -> u64 {
        match self.sequences.binary_search_by_key(&publisher, |(other, _)| *other) {
            Ok(index) => {
                self.sequences[index].1 += 1;
                self.sequences[index].1
            }
            Err(position) => {
                self.sequences.insert(position, (publisher, 1));
                1
            }
        }
    }

    /// Makes room for one message. If the ring is full the oldest leaves and is returned.
    #[inline]
    pub(crate) fn make_room(&mut self) -> Option<Arc<dyn AnyMessage>> {
        if self.entries.len() < self.capacity {
            return None;
        }
        let RingEntry { sample, encoding, .. } = self.entries.pop_front()?;
        self.reuse(encoding);
        Some(sample.message)
    }

    /// The encoding slot of the next message, shared by encoded subscribers, if there are any.
    #[inline]
    pub(crate) fn next_encoding(&mut self) -> Option<Arc<EncodingSlot>> {
        (self.taps > 0).then(|| self.vacant().unwrap_or_default())
    }

    /// Appends a message; there must be room.
    #[inline]
    pub(crate) fn push(&mut self, entry: RingEntry) {
        if self.next == 0 {
            self.begun = entry.order;
        }
        self.next += 1;
        self.entries.push_back(entry);
    }

    /// An empty encoding slot without other references.
    fn vacant(&mut self) -> Option<Arc<EncodingSlot>> {
        let index = self.spares.iter_mut().position(|spare| Arc::get_mut(spare).is_some())?;
        let mut encoding = self.spares.swap_remove(index);
        Arc::get_mut(&mut encoding)?.clear();
        Some(encoding)
    }

    /// Keeps an encoding that left the ring, to reuse it when it has no other references.
    fn reuse(&mut self, encoding: Option<Arc<EncodingSlot>>) {
        let Some(encoding) = encoding else { return };
        if self.spares.len() < MAX_SPARE_ENCODINGS {
            self.spares.push(encoding);
        } else {
            self.turn = (self.turn + 1) % MAX_SPARE_ENCODINGS;
            self.spares[self.turn] = encoding;
        }
    }

    /// The newest message with its shared encoding.
    #[inline]
    pub(crate) fn newest(&self) -> Option<&RingEntry> {
        self.entries.back()
    }

    /// Adds an encoded subscriber.
    pub(crate) fn add_tap(&mut self) {
        self.taps += 1;
    }

    /// Removes an encoded subscriber.
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

    /// The messages from index `cursor` on, oldest first.
    #[inline]
    pub(crate) fn from(&self, cursor: u64) -> impl Iterator<Item = &RingEntry> {
        let skipped = cursor.saturating_sub(self.first()).min(self.entries.len() as u64) as usize;
        self.entries.range(skipped..)
    }

    /// The number of messages from index `cursor` on that are no longer held.
    pub(crate) fn missed(&self, cursor: u64) -> u64 {
        self.first().saturating_sub(cursor)
    }

    /// The index of the first message that was published after number `order`.
    pub(crate) fn after(&self, order: u64) -> u64 {
        self.first() + self.entries.partition_point(|entry| entry.order <= order) as u64
    }

    /// Whether there was a message up to number `order`, held or not.
    pub(crate) fn was_nonempty_at(&self, order: u64) -> bool {
        self.next > 0 && self.begun <= order
    }
}
