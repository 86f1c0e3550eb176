//! What a hub holds of one topic of one host: its last messages, and the counters of its publishers.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::encoding::Encoding;
use crate::message::AnyMessage;
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

/// A message in a ring, or on its way there. It lies in two cache lines, and never in three.
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
    /// In order of publication.
    entries: VecDeque<Entry>,
    capacity: usize,
    next: u64,
    /// The number over all topics of the first message there ever was.
    begun: u64,
    /// How many messages of each publisher, sorted by publisher.
    sequences: Vec<(PublisherId, u64)>,
    taps: usize,
    /// Encodings that left the ring, to be used again when nobody holds them any more.
    spares: Vec<Arc<Encoding>>,
    /// Whose turn it is to go when there are too many.
    turn: usize,
}

/// How many encodings wait for whoever keeps them: a link those that it may have to send again.
const SPARE: usize = 4;

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

    /// Makes room for one message. If the ring is full the oldest leaves, and is given back.
    #[inline]
    pub(crate) fn make_room(&mut self) -> Option<Arc<dyn AnyMessage>> {
        if self.entries.len() < self.capacity {
            return None;
        }
        let Entry { sample, encoding, .. } = self.entries.pop_front()?;
        self.reuse(encoding);
        Some(sample.message)
    }

    /// Where taps share the encoding of the next message, if there are any.
    #[inline]
    pub(crate) fn next_encoding(&mut self) -> Option<Arc<Encoding>> {
        (self.taps > 0).then(|| self.vacant().unwrap_or_default())
    }

    /// Appends a message, for which there is room.
    #[inline]
    pub(crate) fn push(&mut self, entry: Entry) {
        if self.next == 0 {
            self.begun = entry.order;
        }
        self.next += 1;
        self.entries.push_back(entry);
    }

    /// An encoding that nobody holds any more, of no message.
    fn vacant(&mut self) -> Option<Arc<Encoding>> {
        let place = self.spares.iter_mut().position(|spare| Arc::get_mut(spare).is_some())?;
        let mut encoding = self.spares.swap_remove(place);
        Arc::get_mut(&mut encoding)?.clear();
        Some(encoding)
    }

    /// Keeps an encoding that left for when nobody holds it.
    fn reuse(&mut self, encoding: Option<Arc<Encoding>>) {
        let Some(encoding) = encoding else { return };
        if self.spares.len() < SPARE {
            self.spares.push(encoding);
        } else {
            self.turn = (self.turn + 1) % SPARE;
            self.spares[self.turn] = encoding;
        }
    }

    /// The newest message, and where its encoding is shared.
    #[inline]
    pub(crate) fn newest(&self) -> Option<&Entry> {
        self.entries.back()
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
        self.entries.range(skipped..)
    }

    /// How many messages from the one with index `cursor` on are no longer held.
    pub(crate) fn missed(&self, cursor: u64) -> u64 {
        self.first().saturating_sub(cursor)
    }

    /// The index of the first message that was published later than the one with number `order`.
    pub(crate) fn after(&self, order: u64) -> u64 {
        self.first() + self.entries.partition_point(|entry| entry.order <= order) as u64
    }

    /// Whether there was a message by number `order`, held or not.
    pub(crate) fn had_any_by(&self, order: u64) -> bool {
        self.next > 0 && self.begun <= order
    }
}
