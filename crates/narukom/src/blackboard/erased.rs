//! Access by slot or name, for runtimes, links and tools: topics that are known at run time only.

use super::Blackboard;
use crate::error::Error;
use crate::hub::Narukom;
use crate::message::AnyMessage;
use crate::sample::{AnySample, HostId, TopicSlot};

/// Access by slot or name, for runtimes and tools.
impl Blackboard {
    /// The hub.
    pub fn hub(&self) -> &Narukom {
        &self.hub
    }

    /// The name under which it publishes.
    pub fn publisher(&self) -> &str {
        &self.sender.name
    }

    /// The slot of the topic at `path`.
    pub fn slot(&self, path: &str) -> Option<TopicSlot> {
        self.hub.topic(path)
    }

    /// The newest message of a topic: of a signal topic, of this cycle only.
    pub fn latest(&self, slot: TopicSlot) -> Option<&dyn AnyMessage> {
        self.from(HostId::LOCAL).latest(slot)
    }

    /// As [`latest`](Blackboard::latest), with the header.
    pub fn latest_sample(&self, slot: TopicSlot) -> Option<&AnySample> {
        self.from(HostId::LOCAL).latest_sample(slot)
    }

    /// As [`latest_sample`](Blackboard::latest_sample), for those who only look on at what is read here: that is no read, so it makes
    /// the blackboard no reader of the topic, and an own signal that nobody else has looked at still comes back.
    /// [`peek`](Blackboard::peek) looks at topics too that nobody reads.
    pub fn shown(&self, slot: TopicSlot) -> Option<&AnySample> {
        self.from(HostId::LOCAL).shown(slot)
    }

    /// All messages of a topic that are there to be read, oldest first: the latest state, the signals of this cycle, the history.
    pub fn samples(&self, slot: TopicSlot) -> impl DoubleEndedIterator<Item = &AnySample> {
        self.from(HostId::LOCAL).samples(slot)
    }

    /// As [`latest`](Blackboard::latest), for a topic known by its path.
    pub fn read_by_name(&self, path: &str) -> Option<&dyn AnyMessage> {
        self.latest(self.slot(path)?)
    }

    /// The newest message of a topic, for those who only look: nobody becomes a reader by it, and own signals still come back.
    pub fn peek(&self, slot: TopicSlot) -> Option<AnySample> {
        self.from(HostId::LOCAL).peek(slot)
    }

    /// Reads the topics that a pattern fits from now on; it is as [`Narukom::subscriber`] has it. Each topic's messages are
    /// [`samples`](Blackboard::samples) of its slot, and [`arrivals`](Blackboard::arrivals) says what is new.
    ///
    /// # Errors
    /// The pattern is not well formed, or fits no topic.
    pub fn subscribe(&self, pattern: &str) -> Result<Vec<TopicSlot>, Error> {
        let slots = self.hub.matching(pattern)?;
        slots.iter().for_each(|slot| self.interest(*slot));
        Ok(slots)
    }

    /// Reads a topic from now on, as a first read would.
    pub fn interest(&self, slot: TopicSlot) {
        self.from(HostId::LOCAL).interest(slot);
    }

    /// Whether the topic has been read here, of any host.
    pub fn is_read(&self, slot: TopicSlot) -> bool {
        let place = self.places.get(slot.index());
        place.is_some_and(|place| place.readings().any(|reading| reading.interest()))
    }

    /// The topics that have been read here, of any host, in order of first read.
    pub fn topics_read(&self) -> Vec<TopicSlot> {
        let mut slots = Vec::new();
        for channel in self.attached.borrow().iter() {
            if !slots.contains(&channel.topic) && self.is_read(channel.topic) {
                slots.push(channel.topic);
            }
        }
        slots
    }

    /// As [`lost`](Blackboard::lost), by slot.
    pub fn lost_at(&self, slot: TopicSlot) -> u64 {
        self.from(HostId::LOCAL).lost_at(slot)
    }
}
