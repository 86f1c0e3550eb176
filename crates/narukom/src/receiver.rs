//! Taking in what other hosts publish.

use std::fmt;
use std::sync::Arc;

use crate::encoding::check_type;
use crate::error::Error;
use crate::exchange::{Outgoing, Sender};
use crate::hub::Narukom;
use crate::message::AnyMessage;
use crate::moment::Moment;
use crate::pool::Pool;
use crate::ring::Origin;
use crate::sample::{AnySample, Header, HostId, TopicSlot};
use crate::topic::TopicDeclaration;

/// What is known of a message that comes from another host.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Arrival {
    /// Its number among its publisher's messages on the topic.
    pub sequence: u64,
    /// When it was published, by the sender's clock.
    pub published: Moment,
    /// The same moment by this hub's clock, as well as the link knows.
    pub local: Moment,
    /// When it came, by this hub's clock.
    pub received: Moment,
}

/// Takes in what one publisher publishes on one topic of another host: for links. It is read through
/// [`Blackboard::from`](crate::Blackboard::from) the host, and by nobody who reads this host's topic of that name.
pub struct Receiver {
    hub: Narukom,
    host: (HostId, Arc<str>),
    sender: Sender,
    slot: TopicSlot,
    topic: TopicDeclaration,
    pool: Pool,
}

impl Receiver {
    pub(crate) fn new(
        hub: Narukom,
        host: (HostId, Arc<str>),
        sender: Sender,
        slot: TopicSlot,
        topic: TopicDeclaration,
    ) -> Receiver {
        Receiver { hub, host, sender, slot, topic, pool: Pool::default() }
    }

    /// The number by which this hub knows the host.
    pub fn host(&self) -> HostId {
        self.host.0
    }

    /// Takes in a message.
    ///
    /// # Errors
    /// The message is not of the topic's type.
    pub fn receive(&mut self, message: Box<dyn AnyMessage>, arrival: Arrival) -> Result<(), Error> {
        check_type(&self.topic, &*message)?;
        self.take_in(Arc::from(message), arrival);
        Ok(())
    }

    /// Takes in the message that `bytes` encode; they are decoded once, here.
    ///
    /// # Errors
    /// The bytes encode no message of the topic's type, or are more than [`ENCODED_LIMIT`](crate::ENCODED_LIMIT).
    pub fn receive_bytes(&mut self, bytes: &[u8], arrival: Arrival) -> Result<(), Error> {
        let message = self.pool.decoded(&self.topic, bytes)?;
        self.take_in(message, arrival);
        Ok(())
    }

    fn take_in(&mut self, message: Arc<dyn AnyMessage>, arrival: Arrival) {
        let Arrival { sequence, published, local, received } = arrival;
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
        let mut message = Outgoing::new(AnySample { message, header }, Origin::OUTSIDE);
        self.hub.take_in(name, &self.sender, &mut message);
        self.pool.take_back(message.left);
    }
}

impl fmt::Debug for Receiver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Receiver({} of {}, {})", self.sender.name, self.host.1, self.topic.path())
    }
}
