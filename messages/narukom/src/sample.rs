//! A message with its header.

use std::ops::Deref;
use std::sync::Arc;

use crate::message::AnyMessage;
use crate::timestamp::Timestamp;

/// A publisher.
#[derive(Clone)]
pub(crate) struct Sender {
    pub(crate) publisher: PublisherId,
    pub(crate) name: Arc<str>,
    /// The part among the publishers that share the name.
    pub(crate) part: u16,
}

/// A host (a robot, a computer), numbered by a hub.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct HostId(pub(crate) u32);

impl HostId {
    /// The hub's own host.
    pub const LOCAL: HostId = HostId(0);

    /// Its number; the hub's own host has 0.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A publisher, numbered by a hub in the order in which publishers were first named.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PublisherId(pub(crate) u32);

impl PublisherId {
    /// Its number.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A topic, numbered by a hub: its index among the hub's topics sorted by path.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TopicSlot(u32);

impl TopicSlot {
    /// The topic with that number. A number unknown to the hub reads as a topic without messages.
    pub const fn new(number: u32) -> TopicSlot {
        TopicSlot(number)
    }

    /// Its number.
    pub const fn number(self) -> u32 {
        self.0
    }

    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Metadata of a message.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Header {
    /// The host on which it was published.
    pub host: HostId,
    /// Its publisher.
    pub publisher: PublisherId,
    /// The part among those who share the publisher's name, from 0: see
    /// [`Blackboard::of_part`](crate::Blackboard::of_part). 0 for messages of other hosts.
    pub part: u16,
    /// The topic.
    pub topic: TopicSlot,
    /// Sequence number among the publisher's messages on the topic, from 1; 0 until it is
    /// published.
    pub sequence: u64,
    /// Time of publication by the publisher's clock; until it is published, the time of writing.
    pub published: Timestamp,
    /// Time of publication by this hub's clock, by which histories are sorted and read. Equal to
    /// `published` if it was published here; otherwise corrected by the link's estimate of the
    /// clock offset.
    pub local: Timestamp,
    /// Time of arrival at this hub by its own clock; equal to `published` if it was published here.
    pub received: Timestamp,
}

impl Header {
    /// The channel: the topic of that host.
    pub(crate) fn channel(&self) -> Channel {
        Channel { topic: self.topic, host: self.host }
    }

    /// The header of a message that is published here, or will be.
    pub(crate) fn local(sender: &Sender, topic: TopicSlot, now: Timestamp) -> Header {
        Header {
            host: HostId::LOCAL,
            publisher: sender.publisher,
            part: sender.part,
            topic,
            sequence: 0,
            published: now,
            local: now,
            received: now,
        }
    }
}

/// A topic of one host: the unit of storage, delivery and reading.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Channel {
    pub(crate) topic: TopicSlot,
    pub(crate) host: HostId,
}

impl Channel {
    /// The topic as it is published on the hub's own host.
    pub(crate) const fn local(topic: TopicSlot) -> Channel {
        Channel { topic, host: HostId::LOCAL }
    }
}

/// A message on a blackboard, with its header. Dereferences to the message.
#[derive(Debug)]
pub struct Sample<'a, M: ?Sized> {
    /// The message.
    pub message: &'a M,
    /// Its header.
    pub header: &'a Header,
}

impl<M: ?Sized> Clone for Sample<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: ?Sized> Copy for Sample<'_, M> {}

impl<M: ?Sized> Deref for Sample<'_, M> {
    type Target = M;

    fn deref(&self) -> &M {
        self.message
    }
}

/// A message of any type, shared, with its header.
#[derive(Clone, Debug)]
pub struct AnySample {
    /// The message.
    pub message: Arc<dyn AnyMessage>,
    /// Its header.
    pub header: Header,
}

impl AnySample {
    /// The sample with a message of type `M`; `None` if its message has another type.
    pub fn downcast<M: 'static>(&self) -> Option<Sample<'_, M>> {
        let message = self.message.as_any().downcast_ref()?;
        Some(Sample { message, header: &self.header })
    }
}
