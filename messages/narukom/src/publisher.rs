//! Publishing from outside of agents.

use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use crate::encoding::check_type;
use crate::error::Error;
use crate::hub::Hub;
use crate::hub_state::OutgoingMessage;
use crate::message::{AnyMessage, Message};
use crate::pool::MessagePool;
use crate::ring::WriterId;
use crate::sample::Sender;
use crate::sample::{AnySample, Header, TopicSlot};
use crate::timestamp::Timestamp;
use crate::topic::{Retention, Topic, TopicDeclaration};

/// Publishes messages of one type on one topic immediately, without a cycle: for bodies, links and
/// other code outside of agents.
pub struct Publisher<M> {
    core: PublisherCore,
    message: PhantomData<fn(M)>,
}

/// A [`Publisher`] for a topic known at run time. Messages that do not have the topic's type are
/// rejected.
pub struct AnyPublisher {
    core: PublisherCore,
    topic: TopicDeclaration,
}

/// The sender, and the pool of messages that left the hub.
struct PublisherCore {
    hub: Hub,
    sender: Sender,
    slot: TopicSlot,
    pool: MessagePool,
}

/// Constructors.
impl Hub {
    /// Creates a publisher on one topic under the name `publisher`, for code outside of agents.
    pub fn publisher<K: Retention>(
        &self,
        topic: Topic<K>,
        publisher: &str,
    ) -> Result<Publisher<K::Message>, Error> {
        let slot = self.topic_table().checked(topic)?;
        Ok(Publisher::new(self.clone(), self.sender(publisher), slot))
    }

    /// Like [`publisher`](Hub::publisher), for a topic known at run time: accepts messages of any
    /// type, or bytes, and rejects those that do not have the topic's type.
    pub fn publisher_by_name(&self, path: &str, publisher: &str) -> Result<AnyPublisher, Error> {
        let slot = self.topic_table().declared(path)?;
        let declaration = self.topic_table().topics()[slot.index()];
        Ok(AnyPublisher::new(self.clone(), self.sender(publisher), slot, declaration))
    }
}

impl<M: Message> Publisher<M> {
    pub(crate) fn new(hub: Hub, sender: Sender, slot: TopicSlot) -> Publisher<M> {
        Publisher {
            core: PublisherCore { hub, sender, slot, pool: MessagePool::default() },
            message: PhantomData,
        }
    }

    /// Sets the part number of one of several publishers under one name: see
    /// [`Blackboard::of_part`](crate::Blackboard::of_part).
    pub fn of_part(mut self, part: u16) -> Publisher<M> {
        self.core.sender.part = part;
        self
    }

    /// Publishes a message.
    pub fn publish(&mut self, message: M, now: Timestamp) {
        let message = self.core.pool.wrap(message);
        self.core.publish(message, now);
    }

    /// Publishes a message that `make` fills in place, starting from a default message: large
    /// messages need not be moved, and strings, bytes and lists reuse the memory of earlier ones.
    pub fn publish_with(&mut self, make: impl FnOnce(&mut M), now: Timestamp) {
        let message = self.core.pool.build(make);
        self.core.publish(message, now);
    }
}

impl AnyPublisher {
    pub(crate) fn new(hub: Hub, sender: Sender, slot: TopicSlot, topic: TopicDeclaration) -> AnyPublisher {
        AnyPublisher { core: PublisherCore { hub, sender, slot, pool: MessagePool::default() }, topic }
    }

    /// Sets the part number of one of several publishers under one name: see
    /// [`Blackboard::of_part`](crate::Blackboard::of_part).
    pub fn of_part(mut self, part: u16) -> AnyPublisher {
        self.core.sender.part = part;
        self
    }

    /// The topic.
    pub fn topic(&self) -> &TopicDeclaration {
        &self.topic
    }

    /// Publishes a message.
    ///
    /// # Errors
    /// The message does not have the topic's type.
    pub fn publish(&mut self, message: Box<dyn AnyMessage>, now: Timestamp) -> Result<(), Error> {
        check_type(&self.topic, &*message)?;
        self.core.publish(Arc::from(message), now);
        Ok(())
    }

    /// Publishes an encoded message; it is decoded once, here.
    ///
    /// # Errors
    /// The bytes do not encode a message of the topic's type, or are longer than
    /// [`ENCODED_LIMIT`](crate::ENCODED_LIMIT).
    pub fn publish_bytes(&mut self, bytes: &[u8], now: Timestamp) -> Result<(), Error> {
        let message = self.core.pool.decoded(&self.topic, bytes)?;
        self.core.publish(message, now);
        Ok(())
    }
}

impl PublisherCore {
    fn publish(&mut self, message: Arc<dyn AnyMessage>, now: Timestamp) {
        let header = Header::local(&self.sender, self.slot, now);
        let mut outgoing = OutgoingMessage::new(AnySample { message, header }, WriterId::OUTSIDE);
        self.hub.send(&self.sender, std::slice::from_mut(&mut outgoing), now);
        self.pool.take_back(outgoing.evicted);
    }
}

impl<M> fmt::Debug for Publisher<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Publisher({}, topic {})", self.core.sender.name, self.core.slot.number())
    }
}

impl fmt::Debug for AnyPublisher {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AnyPublisher({}, {})", self.core.sender.name, self.topic.path())
    }
}
