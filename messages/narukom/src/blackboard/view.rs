//! View of the topics that one host published.

use std::fmt;
use std::time::Duration;

use super::Blackboard;
use crate::history::{History, SurroundingSamples};
use crate::inbox::Inbox;
use crate::message::{AnyMessage, Message};
use crate::sample::{AnySample, Channel, HostId, Sample, TopicSlot};
use crate::timestamp::Timestamp;
use crate::topic::{Retention, Signal, Timed, Topic};

/// The view of one host's topics on a blackboard: `blackboard.from(host).read(BALL)`. Messages are
/// delivered at the same times as those of this host's own topics.
#[derive(Clone, Copy)]
pub struct HostView<'a> {
    pub(super) blackboard: &'a Blackboard,
    pub(super) host: HostId,
}

impl<'a> HostView<'a> {
    /// The newest message of a topic: of a signal topic, of this cycle only.
    pub fn read<K: Retention>(self, topic: Topic<K>) -> Option<&'a K::Message> {
        self.sample(topic).map(|sample| sample.message)
    }

    /// Like [`read`](HostView::read), with the header.
    pub fn sample<K: Retention>(self, topic: Topic<K>) -> Option<Sample<'a, K::Message>> {
        self.latest_sample(self.slot_of(topic)?)?.downcast()
    }

    /// The signals of this cycle, oldest first.
    pub fn signals<M: Message>(
        self,
        topic: Topic<Signal<M>>,
    ) -> impl Iterator<Item = Sample<'a, M>> + use<'a, M> {
        self.history_of(topic).filter_map(AnySample::downcast)
    }

    /// The messages of a history that are at most `age` old by this host's clock, oldest first.
    pub fn recent<K: Timed>(
        self,
        topic: Topic<K>,
        age: Duration,
    ) -> impl DoubleEndedIterator<Item = Sample<'a, K::Message>> + use<'a, K> {
        let oldest = self.blackboard.now - age;
        let recent = self.history_of(topic).filter(move |sample| sample.header.local >= oldest);
        recent.filter_map(AnySample::downcast)
    }

    /// The message of a history that was published nearest to `moment` by this host's clock.
    pub fn nearest<K: Timed>(self, topic: Topic<K>, moment: Timestamp) -> Option<Sample<'a, K::Message>> {
        self.history(self.slot_of(topic)?)?.nearest(moment)?.downcast()
    }

    /// The last message of a history that was published at or before `moment`.
    pub fn nearest_not_newer<K: Timed>(
        self,
        topic: Topic<K>,
        moment: Timestamp,
    ) -> Option<Sample<'a, K::Message>> {
        self.history(self.slot_of(topic)?)?.not_newer(moment)?.downcast()
    }

    /// The first message of a history that was published at or after `moment`.
    pub fn nearest_not_older<K: Timed>(
        self,
        topic: Topic<K>,
        moment: Timestamp,
    ) -> Option<Sample<'a, K::Message>> {
        self.history(self.slot_of(topic)?)?.not_older(moment)?.downcast()
    }

    /// The two messages of a history between which `moment` lies; `None` if it lies outside.
    pub fn around<K: Timed>(
        self,
        topic: Topic<K>,
        moment: Timestamp,
    ) -> Option<SurroundingSamples<'a, K::Message>> {
        self.history(self.slot_of(topic)?)?.around(moment)
    }

    /// The number of messages of a topic that left the hub before they were delivered here. A state
    /// topic loses none, since only the latest message counts.
    pub fn lost<K: Retention>(self, topic: Topic<K>) -> u64 {
        self.slot_of(topic).map_or(0, |slot| self.lost_at(slot))
    }

    fn slot_of<K: Retention>(self, topic: Topic<K>) -> Option<TopicSlot> {
        self.blackboard.hub.topic_table().by_hash(topic.hash())
    }

    fn history_of<K: Retention>(
        self,
        topic: Topic<K>,
    ) -> impl DoubleEndedIterator<Item = &'a AnySample> + use<'a, K> {
        let history = self.slot_of(topic).and_then(|slot| self.history(slot));
        history.into_iter().flat_map(History::iter)
    }
}

/// Access by slot, for runtimes and tools.
impl<'a> HostView<'a> {
    /// The host.
    pub fn host(self) -> HostId {
        self.host
    }

    /// The newest message of a topic: of a signal topic, of this cycle only.
    pub fn latest(self, slot: TopicSlot) -> Option<&'a dyn AnyMessage> {
        self.latest_sample(slot).map(|sample| &*sample.message)
    }

    /// Like [`latest`](HostView::latest), with the header.
    #[inline]
    pub fn latest_sample(self, slot: TopicSlot) -> Option<&'a AnySample> {
        let reading = self.read_from_now_on(slot)?;
        self.newest(slot, reading)
    }

    /// All readable messages of a topic, oldest first: the latest state, the signals of this cycle,
    /// the history.
    pub fn samples(self, slot: TopicSlot) -> impl DoubleEndedIterator<Item = &'a AnySample> + use<'a> {
        self.history(slot).into_iter().flat_map(History::iter)
    }

    /// Like [`latest_sample`](HostView::latest_sample), but for inspection: it does not count as a
    /// read.
    pub fn shown(self, slot: TopicSlot) -> Option<&'a AnySample> {
        let reading = self.blackboard.entries.get(slot.index())?.inbox(self.host)?;
        self.newest(slot, reading)
    }

    /// The newest message of a topic, for inspection: it does not subscribe the blackboard to the
    /// topic, and own signals are still delivered.
    pub fn peek(self, slot: TopicSlot) -> Option<AnySample> {
        match self.blackboard.entries.get(slot.index())?.inbox(self.host) {
            Some(reading) => self.newest(slot, reading).cloned(),
            None => self.newest(slot, &self.blackboard.attached_reading(self.channel(slot))?).cloned(),
        }
    }

    /// Subscribes to a topic, as a first read would.
    pub fn interest(self, slot: TopicSlot) {
        if let Some(reading) = self.blackboard.attach(self.channel(slot)) {
            reading.set_is_read(true);
        }
    }

    /// Like [`lost`](HostView::lost), by slot.
    pub fn lost_at(self, slot: TopicSlot) -> u64 {
        let entry = self.blackboard.entries.get(slot.index());
        entry.and_then(|entry| entry.inbox(self.host)).map_or(0, Inbox::lost)
    }

    /// The topics of the messages of the last delivery, one per message, in order of arrival.
    pub fn arrivals(self) -> impl Iterator<Item = TopicSlot> + use<'a> {
        let arrivals = self.blackboard.delivery.arrivals.iter();
        arrivals.filter(move |(_, _, host)| *host == self.host).map(|(_, slot, _)| *slot)
    }

    #[inline]
    fn channel(self, slot: TopicSlot) -> Channel {
        Channel { topic: slot, host: self.host }
    }

    /// The inbox of a topic, marked as read.
    #[inline]
    fn read_from_now_on(self, slot: TopicSlot) -> Option<&'a Inbox> {
        let reading = self.blackboard.attach(self.channel(slot))?;
        reading.set_is_read(true);
        if self.host == HostId::LOCAL
            && let Some(writing) = &self.blackboard.entries[slot.index()].writing
        {
            writing.mark_seen();
        }
        Some(reading)
    }

    /// The newest message of the topic with this inbox.
    #[inline]
    pub(super) fn newest<'b>(self, slot: TopicSlot, reading: &'b Inbox) -> Option<&'b AnySample>
    where
        'a: 'b,
    {
        let entries: &'a [_] = &self.blackboard.entries;
        let writing = entries[slot.index()].writing.as_ref().filter(|_| self.host == HostId::LOCAL);
        let own = writing.and_then(|writing| writing.visible().next_back());
        let newest = own.or_else(|| reading.samples().back());
        newest.filter(|sample| sample.header.local >= reading.oldest(self.blackboard.now))
    }

    /// All messages of a topic, oldest first.
    #[inline]
    fn history(self, slot: TopicSlot) -> Option<History<'a>> {
        let reading = self.read_from_now_on(slot)?;
        let writing = self.blackboard.entries[slot.index()].writing.as_deref();
        let writing = writing.filter(|_| self.host == HostId::LOCAL);
        Some(History::new(reading, writing, self.blackboard.now))
    }
}

impl fmt::Debug for HostView<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "HostView({:?} of host {})", self.blackboard, self.host.index())
    }
}
