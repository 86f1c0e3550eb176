//! Reading a blackboard.

use std::time::Duration;

use super::{Blackboard, View};
use crate::history::Neighbours;
use crate::message::Message;
use crate::moment::Moment;
use crate::reading::Reading;
use crate::sample::{Channel, HostId, Sample};
use crate::topic::{Keep, Signal, Timed, Topic};

/// Reading what is published on this host.
impl Blackboard {
    /// What another host published, as far as it was delivered here; with [`HostId::LOCAL`], what this one did.
    /// [`Narukom::host_id`](crate::Narukom::host_id) gives the number for a name.
    #[inline]
    pub fn from(&self, host: HostId) -> View<'_> {
        View { blackboard: self, host }
    }

    /// The newest message of a topic: of a signal topic, of this cycle only. None too if the hub was made without the topic.
    pub fn read<K: Keep>(&self, topic: Topic<K>) -> Option<&K::Message> {
        self.from(HostId::LOCAL).read(topic)
    }

    /// As [`read`](Blackboard::read), with the header.
    pub fn sample<K: Keep>(&self, topic: Topic<K>) -> Option<Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).sample(topic)
    }

    /// The signals of this cycle, oldest first.
    ///
    /// Each blackboard sees a signal in one cycle. Its own it sees at once or, if nobody here has looked by the next
    /// delivery, then, as everybody else does.
    pub fn signals<M: Message>(&self, topic: Topic<Signal<M>>) -> impl Iterator<Item = Sample<'_, M>> {
        self.from(HostId::LOCAL).signals(topic)
    }

    /// The messages of a history that are at most `age` old, oldest first.
    pub fn recent<K: Timed>(
        &self,
        topic: Topic<K>,
        age: Duration,
    ) -> impl Iterator<Item = Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).recent(topic, age)
    }

    /// The message of a history that was published nearest to `moment`; of two equally near the earlier. Of several published at
    /// one moment it is the one that is nearest in the order of the history.
    pub fn nearest<K: Timed>(&self, topic: Topic<K>, moment: Moment) -> Option<Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).nearest(topic, moment)
    }

    /// The last message of a history that was published at `moment` or before.
    pub fn nearest_not_newer<K: Timed>(
        &self,
        topic: Topic<K>,
        moment: Moment,
    ) -> Option<Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).nearest_not_newer(topic, moment)
    }

    /// The first message of a history that was published at `moment` or after.
    pub fn nearest_not_older<K: Timed>(
        &self,
        topic: Topic<K>,
        moment: Moment,
    ) -> Option<Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).nearest_not_older(topic, moment)
    }

    /// The two messages of a history between which `moment` lies, for whoever interpolates; none if it lies outside, since nothing
    /// is known there.
    pub fn around<K: Timed>(&self, topic: Topic<K>, moment: Moment) -> Option<Neighbours<'_, K::Message>> {
        self.from(HostId::LOCAL).around(topic, moment)
    }

    /// How many messages of a topic were gone before they could be delivered here. States lose none: only the latest counts.
    pub fn lost<K: Keep>(&self, topic: Topic<K>) -> u64 {
        self.from(HostId::LOCAL).lost(topic)
    }

    /// The reading of a topic of a host, made if need be.
    #[inline]
    pub(super) fn attach(&self, channel: Channel) -> Option<&Reading> {
        let place = self.places.get(channel.topic.index())?;
        match place.reading(channel.host) {
            Some(reading) => Some(reading),
            None => Some(self.keep(channel, self.attached_reading(channel)?)),
        }
    }

    /// The reading of a topic as if it had been read from the start.
    pub(super) fn attached_reading(&self, channel: Channel) -> Option<Reading> {
        let topic = self.hub.declaration(channel.topic)?;
        let exchange = self.hub.exchange();
        Some(Reading::attach(topic, exchange.ring(channel), self.reader(channel), self.window))
    }

    /// Puts a reading in its empty place.
    pub(super) fn keep(&self, channel: Channel, reading: Reading) -> &Reading {
        if reading.is_open() {
            self.open.borrow_mut().push(channel);
        }
        self.attached.borrow_mut().push(channel);
        self.places[channel.topic.index()].keep(channel.host, reading)
    }
}
