//! Between a hub and the protocol: takes what is published, and brings in what has come.

use std::collections::BTreeMap;
use std::sync::Arc;

use narukom::{AnyPublisher, Arrival, Moment, Narukom, Receiver, Tap};

use crate::error::{Error, ErrorKind};
use crate::protocol::{Delivery, MessageBytes, Node, Packet, Publication};
use crate::settings::{LinkSettings, Place, Plan};

/// So many publishers of other hosts are told apart; messages of more are refused.
const RECEIVER_LIMIT: usize = 4096;

/// One hub's end of a link, without thread and transport: whoever drives it hands packets and the time in and fetches packets.
pub struct Bridge {
    hub: Narukom,
    node: Node,
    /// One for each topic that is sent.
    taps: Vec<Tap>,
    places: Vec<Place>,
    others: BTreeMap<(Arc<str>, usize, String), Receiver>,
    own: BTreeMap<(usize, String), AnyPublisher>,
}

impl Bridge {
    /// An end of a link. `incarnation` is unlike that of every earlier one of this name.
    ///
    /// # Errors
    /// The settings do not fit the hub's topics.
    pub fn new(hub: &Narukom, settings: LinkSettings, incarnation: u64) -> Result<Bridge, Error> {
        let Plan { node, places } = Plan::new(settings, hub, incarnation)?;
        let node = Node::new(node)?;
        let tap =
            |path: &str| hub.tap(path).map_err(|error| Error::new(ErrorKind::Settings, error.to_string()));
        let taps = node.sends().iter().map(|topic| tap(&topic.path)).collect::<Result<_, _>>()?;
        let (others, own) = (BTreeMap::new(), BTreeMap::new());
        Ok(Bridge { hub: hub.clone(), node, taps, places, others, own })
    }

    /// What it knows and has counted.
    pub fn node(&self) -> &Node {
        &self.node
    }

    /// Lets no message out that is longer, with its stamp, than what the transport carries.
    pub fn set_largest(&mut self, bytes: usize) {
        self.node.set_largest(bytes);
    }

    /// Takes a packet that has come.
    pub fn handle(&mut self, packet: &Packet, now: Moment) {
        self.node.handle(packet, now);
        self.bring_in();
    }

    /// The next packet to be sent, if there is one.
    pub fn poll(&mut self, now: Moment) -> Option<Packet> {
        self.take_out();
        self.node.poll(now)
    }

    /// When to come again, if nothing is published and nothing comes.
    pub fn poll_at(&self) -> Moment {
        self.node.poll_at()
    }

    /// Notes that the transport did not take a packet.
    pub fn count_failed(&mut self) {
        self.node.count_failed();
    }

    /// Takes what was published since the last time.
    fn take_out(&mut self) {
        for (topic, tap) in self.taps.iter_mut().enumerate() {
            while let Some(encoded) = tap.next_encoded() {
                let Some(publisher) = self.hub.publisher_name(encoded.header.publisher) else { continue };
                self.node.publish(
                    topic,
                    Publication {
                        publisher: &publisher,
                        sequence: encoded.header.sequence,
                        published: encoded.header.published,
                        payload: MessageBytes::of(encoded),
                    },
                );
            }
            self.node.set_lost(topic, tap.lost());
        }
    }

    fn bring_in(&mut self) {
        while let Some(delivery) = self.node.next_delivery() {
            let is_taken = delivery.payload.is_whole()
                && match self.places[delivery.topic] {
                    Place::Other => self.receive(&delivery),
                    Place::Own => self.publish(&delivery),
                }
                .is_some();
            if !is_taken {
                self.node.take_back(&delivery);
            }
        }
    }

    /// None if the hub does not take it.
    fn receive(&mut self, delivery: &Delivery) -> Option<()> {
        let key = (delivery.host.clone(), delivery.topic, delivery.publisher.clone());
        if !self.others.contains_key(&key) {
            let path = &self.node.receives()[delivery.topic].path;
            let receiver = self.hub.receiver(&delivery.host, &delivery.publisher, path).ok()?;
            (self.others.len() < RECEIVER_LIMIT).then(|| self.others.insert(key.clone(), receiver))?;
        }
        let Delivery { sequence, published, local, received, .. } = *delivery;
        let arrival = Arrival { sequence, published, local, received };
        self.others.get_mut(&key)?.receive_bytes(&delivery.payload, arrival).ok()
    }

    fn publish(&mut self, delivery: &Delivery) -> Option<()> {
        let key = (delivery.topic, delivery.publisher.clone());
        if !self.own.contains_key(&key) {
            let path = &self.node.receives()[delivery.topic].path;
            let publisher = self.hub.publisher_by_name(path, &delivery.publisher).ok()?;
            (self.own.len() < RECEIVER_LIMIT).then(|| self.own.insert(key.clone(), publisher))?;
        }
        self.own.get_mut(&key)?.publish_bytes(&delivery.payload, delivery.local).ok()
    }
}

impl std::fmt::Debug for Bridge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Bridge({:?}, {:?})", self.hub, self.node)
    }
}
