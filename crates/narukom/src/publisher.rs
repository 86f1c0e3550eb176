//! Publishing from outside agents.

use std::fmt;
use std::marker::PhantomData;

use crate::hub::{Narukom, Outgoing, Sender};
use crate::message::Message;
use crate::moment::Moment;
use crate::pool::Pool;
use crate::ring::Origin;
use crate::sample::{AnySample, Header, HostId, TopicSlot};

/// Publishes messages of one type on one topic at once, without a cycle: for bodies, links, and whoever else is no agent.
pub struct Publisher<M> {
    hub: Narukom,
    sender: Sender,
    slot: TopicSlot,
    pool: Pool,
    message: PhantomData<fn(M)>,
}

impl<M: Message> Publisher<M> {
    pub(crate) fn new(hub: Narukom, sender: Sender, slot: TopicSlot) -> Publisher<M> {
        let depth = hub.declaration(slot).map_or(1, |topic| topic.depth());
        Publisher { hub, sender, slot, pool: Pool::new(depth), message: PhantomData }
    }

    /// Publishes a message.
    pub fn publish(&mut self, message: M, now: Moment) {
        let message = self.pool.wrap(message);
        self.pool.remember(&message);
        let header = Header {
            host: HostId::LOCAL,
            publisher: self.sender.publisher,
            topic: self.slot,
            sequence: 0,
            published: now,
            received: now,
        };
        let outgoing = Outgoing { sample: AnySample { message, header }, origin: Origin::OUTSIDE };
        self.hub.send(&self.sender, &mut [outgoing], now);
    }
}

impl<M> fmt::Debug for Publisher<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Publisher({}, topic {})", self.sender.name, self.slot.number())
    }
}
