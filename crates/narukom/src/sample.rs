//! A message and where it comes from.

use std::ops::Deref;
use std::sync::Arc;

use crate::exchange::Sender;
use crate::message::AnyMessage;
use crate::moment::Moment;

/// A host (a robot, a computer) as a hub numbers it.
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

/// A publisher as a hub numbers it, in the order in which publishers were first named.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PublisherId(pub(crate) u32);

impl PublisherId {
    /// Its number.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A topic as a hub numbers it: its place among the hub's topics sorted by path.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TopicSlot(u32);

impl TopicSlot {
    /// The topic with that number. A number that the hub does not know reads as a topic without messages.
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

/// What is known of a message besides its content.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Header {
    /// The host on which it was published.
    pub host: HostId,
    /// Who published it.
    pub publisher: PublisherId,
    /// Which of those who share the publisher's name, counted from 0: see [`Blackboard::of_part`](crate::Blackboard::of_part). What comes from
    /// another host has 0.
    pub part: u16,
    /// The topic.
    pub topic: TopicSlot,
    /// Counts the publisher's messages on the topic from 1; 0 until it is published.
    pub sequence: u64,
    /// When it was published, by the publisher's clock; until it is published, when it was written.
    pub published: Moment,
    /// When it was published, by this hub's clock: what histories are sorted and read by. Equal to `published` if it was
    /// published here; else whoever carried it knows how far the clocks are apart.
    pub local: Moment,
    /// When it came to this hub, by its own clock; equal to `published` if it was published here.
    pub received: Moment,
}

impl Header {
    /// The topic, of the host.
    pub(crate) fn channel(&self) -> Channel {
        Channel { topic: self.topic, host: self.host }
    }

    /// The header of a message that is published here, or will be.
    pub(crate) fn local(sender: &Sender, topic: TopicSlot, now: Moment) -> Header {
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

/// A topic of one host: what is held, delivered and read apart from others.
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

/// A message on a blackboard, with its header. Reads as the message itself.
#[derive(Debug)]
pub struct Sample<'a, M: ?Sized> {
    /// The message.
    pub message: &'a M,
    /// Where it comes from.
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
    /// Where it comes from.
    pub header: Header,
}

impl AnySample {
    /// The sample as one of messages of type `M`; none if its message is of another type.
    pub fn downcast<M: 'static>(&self) -> Option<Sample<'_, M>> {
        let message = self.message.as_any().downcast_ref()?;
        Some(Sample { message, header: &self.header })
    }
}
