//! Access by slot or name for topics known at run time only: for runtimes, links and tools.

use super::Blackboard;
use crate::error::Error;
use crate::hub::Hub;
use crate::message::AnyMessage;
use crate::sample::{AnySample, HostId, TopicSlot};

/// Access by slot or name, for runtimes and tools.
impl Blackboard {
    /// The hub.
    pub fn hub(&self) -> &Hub {
        &self.hub
    }

    /// The publisher name.
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

    /// Like [`latest`](Blackboard::latest), with the header.
    pub fn latest_sample(&self, slot: TopicSlot) -> Option<&AnySample> {
        self.from(HostId::LOCAL).latest_sample(slot)
    }

    /// Like [`latest_sample`](Blackboard::latest_sample), but for inspection: it does not count as
    /// a read, so it does not subscribe the blackboard to the topic, and own signals are still
    /// delivered. [`peek`](Blackboard::peek) also covers topics that are not read here.
    pub fn shown(&self, slot: TopicSlot) -> Option<&AnySample> {
        self.from(HostId::LOCAL).shown(slot)
    }

    /// All readable messages of a topic, oldest first: the latest state, the signals of this cycle,
    /// the history.
    pub fn samples(&self, slot: TopicSlot) -> impl DoubleEndedIterator<Item = &AnySample> {
        self.from(HostId::LOCAL).samples(slot)
    }

    /// The newest message of a topic, for inspection: it does not subscribe the blackboard to the
    /// topic, and own signals are still delivered.
    pub fn peek(&self, slot: TopicSlot) -> Option<AnySample> {
        self.from(HostId::LOCAL).peek(slot)
    }

    /// Subscribes to the topics that match a pattern, with the syntax of [`Hub::subscriber`].
    /// [`samples`](Blackboard::samples) returns each topic's messages,
    /// [`arrivals`](Blackboard::arrivals) the topics with new ones.
    ///
    /// # Errors
    /// The pattern is not well formed or matches no topic.
    pub fn subscribe(&self, pattern: &str) -> Result<Vec<TopicSlot>, Error> {
        let slots = self.hub.matching(pattern)?;
        slots.iter().for_each(|slot| self.interest(*slot));
        Ok(slots)
    }

    /// Subscribes to a topic, as a first read would.
    pub fn interest(&self, slot: TopicSlot) {
        self.from(HostId::LOCAL).interest(slot);
    }

    /// Whether the topic has been read here, of any host.
    pub fn is_read(&self, slot: TopicSlot) -> bool {
        let entry = self.entries.get(slot.index());
        entry.is_some_and(|entry| entry.inboxes().any(|reading| reading.is_read()))
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

    /// The number of topics that messages are delivered of since they were first read, each host's
    /// counted by itself.
    #[inline]
    pub fn read_count(&self) -> usize {
        self.attached.borrow().len()
    }

    /// The topics that were first read after this [count](Blackboard::read_count), in order.
    pub fn read_since(&self, count: usize) -> Vec<TopicSlot> {
        self.attached.borrow().iter().skip(count).map(|channel| channel.topic).collect()
    }

    /// Like [`lost`](Blackboard::lost), by slot.
    pub fn lost_at(&self, slot: TopicSlot) -> u64 {
        self.from(HostId::LOCAL).lost_at(slot)
    }
}
