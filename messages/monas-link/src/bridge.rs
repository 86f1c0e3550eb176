//! Connects a hub with the protocol: forwards publications and delivers received messages.

use std::collections::BTreeMap;
use std::sync::Arc;

use narukom::{AnyPublisher, EncodedSubscriber, Hub, Receiver, RemoteHeader, Timestamp};

use crate::error::{Error, ErrorKind};
use crate::protocol::{MessageBytes, Node, OutgoingPublication, Packet, ReceivedMessage};
use crate::settings::{LinkSettings, PublishAs, ResolvedSettings};

/// The most publishers of other hosts; messages of further ones are rejected.
const RECEIVER_LIMIT: usize = 4096;

/// One hub's end of a link, without thread and transport: the driver passes packets and the time in
/// and fetches packets.
pub struct HubBridge {
    hub: Hub,
    node: Node,
    /// One subscriber per topic that is sent.
    taps: Vec<EncodedSubscriber>,
    publish_as: Vec<PublishAs>,
    receivers: BTreeMap<(Arc<str>, usize, String), Receiver>,
    publishers: BTreeMap<(usize, String), AnyPublisher>,
}

impl HubBridge {
    /// Creates an end of a link. `incarnation` must differ from that of every earlier link of this
    /// name.
    ///
    /// # Errors
    /// The settings do not fit the hub's topics.
    pub fn new(hub: &Hub, settings: LinkSettings, incarnation: u64) -> Result<HubBridge, Error> {
        let ResolvedSettings { node, publish_as } = ResolvedSettings::new(settings, hub, incarnation)?;
        let node = Node::new(node)?;
        let tap = |path: &str| {
            hub.encoded_subscriber(path).map_err(|error| Error::new(ErrorKind::Settings, error.to_string()))
        };
        let taps = node.sends().iter().map(|topic| tap(&topic.path)).collect::<Result<_, _>>()?;
        let (receivers, publishers) = (BTreeMap::new(), BTreeMap::new());
        Ok(HubBridge { hub: hub.clone(), node, taps, publish_as, receivers, publishers })
    }

    /// The protocol state with its counters.
    pub fn node(&self) -> &Node {
        &self.node
    }

    /// Limits the length of a message, with its stamp, to what the transport carries.
    pub fn set_largest(&mut self, bytes: usize) {
        self.node.set_largest(bytes);
    }

    /// Handles a received packet.
    pub fn handle(&mut self, packet: &Packet, now: Timestamp) {
        self.node.handle(packet, now);
        self.bring_in();
    }

    /// The next packet to send, if there is one.
    pub fn poll(&mut self, now: Timestamp) -> Option<Packet> {
        self.take_out();
        self.node.poll(now)
    }

    /// When to poll again if nothing is published and nothing arrives.
    pub fn poll_at(&self) -> Timestamp {
        self.node.poll_at()
    }

    /// Counts a packet that the transport rejected.
    pub fn count_failed(&mut self) {
        self.node.count_failed();
    }

    /// Forwards what was published since the last call.
    fn take_out(&mut self) {
        for (topic, tap) in self.taps.iter_mut().enumerate() {
            while let Some(encoded) = tap.next_encoded() {
                let Some(publisher) = self.hub.publisher_name(encoded.header.publisher) else { continue };
                self.node.publish(
                    topic,
                    OutgoingPublication {
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
                && match self.publish_as[delivery.topic] {
                    PublishAs::Other => self.receive(&delivery),
                    PublishAs::Own => self.publish(&delivery),
                }
                .is_some();
            if !is_taken {
                self.node.reject_delivered(&delivery);
            }
        }
    }

    /// `None` if the hub rejects it.
    fn receive(&mut self, delivery: &ReceivedMessage) -> Option<()> {
        let key = (delivery.host.clone(), delivery.topic, delivery.publisher.clone());
        if !self.receivers.contains_key(&key) {
            let path = &self.node.receives()[delivery.topic].path;
            let receiver = self.hub.receiver(&delivery.host, &delivery.publisher, path).ok()?;
            (self.receivers.len() < RECEIVER_LIMIT).then(|| self.receivers.insert(key.clone(), receiver))?;
        }
        let ReceivedMessage { sequence, published, local, received, .. } = *delivery;
        let arrival = RemoteHeader { sequence, published, local, received };
        self.receivers.get_mut(&key)?.receive_bytes(&delivery.payload, arrival).ok()
    }

    fn publish(&mut self, delivery: &ReceivedMessage) -> Option<()> {
        let key = (delivery.topic, delivery.publisher.clone());
        if !self.publishers.contains_key(&key) {
            let path = &self.node.receives()[delivery.topic].path;
            let publisher = self.hub.publisher_by_name(path, &delivery.publisher).ok()?;
            (self.publishers.len() < RECEIVER_LIMIT)
                .then(|| self.publishers.insert(key.clone(), publisher))?;
        }
        self.publishers.get_mut(&key)?.publish_bytes(&delivery.payload, delivery.local).ok()
    }
}

impl std::fmt::Debug for HubBridge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "HubBridge({:?}, {:?})", self.hub, self.node)
    }
}
