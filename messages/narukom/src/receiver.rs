//! Receiving what other hosts publish.

use std::fmt;
use std::sync::Arc;

use crate::encoding::check_type;
use crate::error::{Error, ErrorKind};
use crate::hub::Hub;
use crate::hub_state::OutgoingMessage;
use crate::message::AnyMessage;
use crate::pool::MessagePool;
use crate::ring::WriterId;
use crate::sample::Sender;
use crate::sample::{AnySample, Header, HostId, TopicSlot};
use crate::timestamp::Timestamp;
use crate::topic::TopicDeclaration;

/// Header of a message from another host.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RemoteHeader {
    /// Its number among its publisher's messages on the topic.
    pub sequence: u64,
    /// When it was published, by the sender's clock.
    pub published: Timestamp,
    /// The same time by this hub's clock, as estimated by the link.
    pub local: Timestamp,
    /// When it arrived, by this hub's clock.
    pub received: Timestamp,
}

/// Receives what one publisher publishes on one topic of another host: for links. The messages are
/// read through [`Blackboard::from`](crate::Blackboard::from) and are not delivered to readers of
/// this host's topic of the same name.
pub struct Receiver {
    hub: Hub,
    host: (HostId, Arc<str>),
    sender: Sender,
    slot: TopicSlot,
    topic: TopicDeclaration,
    pool: MessagePool,
}

/// Constructors.
impl Hub {
    /// Creates a receiver, used by links, for what `publisher` publishes at `path` on another host.
    ///
    /// # Errors
    /// The topic is not declared here, `host` is this host, or there are too many hosts or
    /// publishers.
    pub fn receiver(&self, host: &str, publisher: &str, path: &str) -> Result<Receiver, Error> {
        let slot = self.topic_table().declared(path)?;
        let declaration = self.topic_table().topics()[slot.index()];
        let mut exchange = self.state();
        let id = exchange.host(host)?;
        if id == HostId::LOCAL {
            let text =
                format!("`{path}` of `{publisher}` comes from elsewhere, but names this host, `{host}`");
            return Err(Error::new(ErrorKind::OwnHost, text));
        }
        let sender = exchange.remote_sender(publisher)?;
        let name = exchange.hosts()[id.index()].clone();
        drop(exchange);
        Ok(Receiver::new(self.clone(), (id, name), sender, slot, declaration))
    }
}

impl Receiver {
    pub(crate) fn new(
        hub: Hub,
        host: (HostId, Arc<str>),
        sender: Sender,
        slot: TopicSlot,
        topic: TopicDeclaration,
    ) -> Receiver {
        Receiver { hub, host, sender, slot, topic, pool: MessagePool::default() }
    }

    /// The number of the host in this hub.
    pub fn host(&self) -> HostId {
        self.host.0
    }

    /// Receives a message.
    ///
    /// # Errors
    /// The message does not have the topic's type.
    pub fn receive(&mut self, message: Box<dyn AnyMessage>, arrival: RemoteHeader) -> Result<(), Error> {
        check_type(&self.topic, &*message)?;
        self.take_in(Arc::from(message), arrival);
        Ok(())
    }

    /// Receives an encoded message; it is decoded once, here.
    ///
    /// # Errors
    /// The bytes do not encode a message of the topic's type, or are longer than
    /// [`ENCODED_LIMIT`](crate::ENCODED_LIMIT).
    pub fn receive_bytes(&mut self, bytes: &[u8], arrival: RemoteHeader) -> Result<(), Error> {
        let message = self.pool.decoded(&self.topic, bytes)?;
        self.take_in(message, arrival);
        Ok(())
    }

    fn take_in(&mut self, message: Arc<dyn AnyMessage>, arrival: RemoteHeader) {
        let RemoteHeader { sequence, published, local, received } = arrival;
        let (host, name) = &self.host;
        let publisher = self.sender.publisher;
        let header = Header {
            host: *host,
            publisher,
            part: 0,
            topic: self.slot,
            sequence,
            published,
            local,
            received,
        };
        let mut message = OutgoingMessage::new(AnySample { message, header }, WriterId::OUTSIDE);
        self.hub.receive(name, &self.sender, &mut message);
        self.pool.take_back(message.evicted);
    }
}

impl fmt::Debug for Receiver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Receiver({} of {}, {})", self.sender.name, self.host.1, self.topic.path())
    }
}
