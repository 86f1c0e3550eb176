//! Publishing from outside agents.

use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use crate::encoding::check_type;
use crate::error::Error;
use crate::exchange::{Outgoing, Sender};
use crate::hub::Narukom;
use crate::message::{AnyMessage, Message};
use crate::moment::Moment;
use crate::pool::Pool;
use crate::ring::Origin;
use crate::sample::{AnySample, Header, TopicSlot};
use crate::topic::TopicDeclaration;

/// Publishes messages of one type on one topic at once, without a cycle: for bodies, links, and whoever else is no agent.
pub struct Publisher<M> {
    outlet: Outlet,
    message: PhantomData<fn(M)>,
}

/// A [`Publisher`] for a topic known at run time. What is not of the topic's type is refused.
pub struct AnyPublisher {
    outlet: Outlet,
    topic: TopicDeclaration,
}

/// Where messages leave, and what comes back in their place.
struct Outlet {
    hub: Narukom,
    sender: Sender,
    slot: TopicSlot,
    pool: Pool,
}

impl<M: Message> Publisher<M> {
    pub(crate) fn new(hub: Narukom, sender: Sender, slot: TopicSlot) -> Publisher<M> {
        Publisher { outlet: Outlet { hub, sender, slot, pool: Pool::default() }, message: PhantomData }
    }

    /// The same, as another of those that publish under one name: see [`Blackboard::of_part`](crate::Blackboard::of_part).
    pub fn of_part(mut self, part: u16) -> Publisher<M> {
        self.outlet.sender.part = part;
        self
    }

    /// Publishes a message.
    pub fn publish(&mut self, message: M, now: Moment) {
        let message = self.outlet.pool.wrap(message);
        self.outlet.publish(message, now);
    }

    /// Publishes a message that `make` builds in place, beginning with nothing set: large ones need not be moved, and their texts,
    /// bytes and lists use the memory of earlier ones.
    pub fn publish_with(&mut self, make: impl FnOnce(&mut M), now: Moment) {
        let message = self.outlet.pool.build(make);
        self.outlet.publish(message, now);
    }
}

impl AnyPublisher {
    pub(crate) fn new(
        hub: Narukom,
        sender: Sender,
        slot: TopicSlot,
        topic: TopicDeclaration,
    ) -> AnyPublisher {
        AnyPublisher { outlet: Outlet { hub, sender, slot, pool: Pool::default() }, topic }
    }

    /// The same, as another of those that publish under one name: see [`Blackboard::of_part`](crate::Blackboard::of_part).
    pub fn of_part(mut self, part: u16) -> AnyPublisher {
        self.outlet.sender.part = part;
        self
    }

    /// The topic.
    pub fn topic(&self) -> &TopicDeclaration {
        &self.topic
    }

    /// Publishes a message.
    ///
    /// # Errors
    /// The message is not of the topic's type.
    pub fn publish(&mut self, message: Box<dyn AnyMessage>, now: Moment) -> Result<(), Error> {
        check_type(&self.topic, &*message)?;
        self.outlet.publish(Arc::from(message), now);
        Ok(())
    }

    /// Publishes the message that `bytes` encode; they are decoded once, here.
    ///
    /// # Errors
    /// The bytes encode no message of the topic's type, or are more than [`ENCODED_LIMIT`](crate::ENCODED_LIMIT).
    pub fn publish_bytes(&mut self, bytes: &[u8], now: Moment) -> Result<(), Error> {
        let message = self.outlet.pool.decoded(&self.topic, bytes)?;
        self.outlet.publish(message, now);
        Ok(())
    }
}

impl Outlet {
    fn publish(&mut self, message: Arc<dyn AnyMessage>, now: Moment) {
        let header = Header::local(&self.sender, self.slot, now);
        let mut outgoing = Outgoing::new(AnySample { message, header }, Origin::OUTSIDE);
        self.hub.send(&self.sender, std::slice::from_mut(&mut outgoing), now);
        self.pool.take_back(outgoing.left);
    }
}

impl<M> fmt::Debug for Publisher<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Publisher({}, topic {})", self.outlet.sender.name, self.outlet.slot.number())
    }
}

impl fmt::Debug for AnyPublisher {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AnyPublisher({}, {})", self.outlet.sender.name, self.topic.path())
    }
}
