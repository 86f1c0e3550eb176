//! Reading a blackboard.

use std::time::Duration;

use super::Blackboard;
use crate::history::{self, History};
use crate::message::Message;
use crate::moment::Moment;
use crate::reading::Reading;
use crate::sample::{AnySample, Sample, TopicSlot};
use crate::topic::{Data, Keep, Kind, Signal, Topic};

/// Reading.
impl Blackboard {
    /// The newest message of a topic: of a signal topic, of this cycle only. None too if the hub was made without the topic.
    pub fn read<K: Keep>(&self, topic: Topic<K>) -> Option<&K::Message> {
        self.sample(topic).map(|sample| sample.message)
    }

    /// As [`read`](Blackboard::read), with the header.
    pub fn sample<K: Keep>(&self, topic: Topic<K>) -> Option<Sample<'_, K::Message>> {
        self.newest(self.slot_of(topic)?)?.downcast()
    }

    /// The signals of this cycle, oldest first.
    ///
    /// Each blackboard sees a signal in one cycle. Its own it sees at once or, if nobody here has looked by the next
    /// delivery, then, as everybody else does.
    pub fn signals<M: Message>(&self, topic: Topic<Signal<M>>) -> impl Iterator<Item = Sample<'_, M>> {
        self.history_of(topic).filter_map(AnySample::downcast)
    }

    /// The messages of a history that are at most `age` old, oldest first.
    pub fn recent<M: Message, const DEPTH: usize>(
        &self,
        topic: Topic<Data<M, DEPTH>>,
        age: Duration,
    ) -> impl Iterator<Item = Sample<'_, M>> {
        let oldest = self.now - age;
        let recent = self.history_of(topic).filter(move |sample| sample.header.published >= oldest);
        recent.filter_map(AnySample::downcast)
    }

    /// The message of a history that was published nearest to `moment`; of two equally near the earlier, of several at one
    /// moment the last.
    pub fn nearest<M: Message, const DEPTH: usize>(
        &self,
        topic: Topic<Data<M, DEPTH>>,
        moment: Moment,
    ) -> Option<Sample<'_, M>> {
        let history = self.history(self.slot_of(topic)?)?;
        history::nearer(history.not_newer(moment), history.not_older(moment), moment)?.downcast()
    }

    /// The last message of a history that was published at `moment` or before.
    pub fn nearest_not_newer<M: Message, const DEPTH: usize>(
        &self,
        topic: Topic<Data<M, DEPTH>>,
        moment: Moment,
    ) -> Option<Sample<'_, M>> {
        self.history(self.slot_of(topic)?)?.not_newer(moment)?.downcast()
    }

    /// The first message of a history that was published at `moment` or after.
    pub fn nearest_not_older<M: Message, const DEPTH: usize>(
        &self,
        topic: Topic<Data<M, DEPTH>>,
        moment: Moment,
    ) -> Option<Sample<'_, M>> {
        self.history(self.slot_of(topic)?)?.not_older(moment)?.downcast()
    }

    /// How many messages of a topic were gone before they could be delivered here. States lose none: only the latest counts.
    pub fn lost<K: Keep>(&self, topic: Topic<K>) -> u64 {
        self.slot_of(topic).map_or(0, |slot| self.lost_at(slot))
    }

    fn slot_of<K: Keep>(&self, topic: Topic<K>) -> Option<TopicSlot> {
        self.hub.catalogue().by_hash(topic.hash())
    }

    /// The newest message of a topic, which is read with that.
    pub(super) fn newest(&self, slot: TopicSlot) -> Option<&AnySample> {
        let reading = self.attach(slot)?;
        reading.set_interest(true);
        if let Some(writing) = &self.places[slot.index()].writing {
            writing.mark_seen();
        }
        self.peek(slot, reading)
    }

    /// The newest message of a topic.
    pub(super) fn peek<'a>(&'a self, slot: TopicSlot, reading: &'a Reading) -> Option<&'a AnySample> {
        let writing = self.places[slot.index()].writing.as_ref();
        let own = writing.and_then(|writing| writing.visible().next_back());
        own.or_else(|| reading.samples().back())
    }

    /// All messages of a topic, oldest first.
    fn history(&self, slot: TopicSlot) -> Option<History<'_>> {
        let topic = self.hub.declaration(slot)?;
        let depth = if topic.kind() == Kind::Data { topic.depth() } else { usize::MAX };
        let reading = self.attach(slot)?;
        reading.set_interest(true);
        let writing = self.places[slot.index()].writing.as_deref();
        writing.inspect(|writing| writing.mark_seen());
        Some(History::new(reading, writing, depth))
    }

    fn history_of<K: Keep>(&self, topic: Topic<K>) -> impl Iterator<Item = &AnySample> {
        let history = self.slot_of(topic).and_then(|slot| self.history(slot));
        history.into_iter().flat_map(History::iter)
    }

    /// The reading of a topic, made if need be.
    pub(super) fn attach(&self, slot: TopicSlot) -> Option<&Reading> {
        let reading = &self.places.get(slot.index())?.reading;
        if reading.get().is_none() {
            self.keep(slot, Box::new(self.attached_reading(slot)?));
        }
        reading.get().map(|reading| &**reading)
    }

    /// The reading of a topic as if it had been read from the start.
    pub(super) fn attached_reading(&self, slot: TopicSlot) -> Option<Reading> {
        let topic = self.hub.declaration(slot)?;
        let exchange = self.hub.exchange();
        Some(Reading::attach(topic, exchange.ring(slot)?, self.reader(slot), self.window))
    }

    /// Puts a reading in its empty place.
    pub(super) fn keep(&self, slot: TopicSlot, reading: Box<Reading>) {
        if reading.is_open() {
            self.open.borrow_mut().push(slot);
        }
        if self.places[slot.index()].reading.set(reading).is_ok() {
            self.attached.borrow_mut().push(slot);
        }
    }
}
