//! The state of a hub, copied in and out under its lock.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::encoding::EncodingSlot;
use crate::error::{Error, ErrorKind};
use crate::message::AnyMessage;
use crate::observer::Waker;
use crate::ring::{Ring, RingEntry, WriterId};
use crate::sample::{AnySample, Channel, Header, HostId, PublisherId, Sender, TopicSlot};
use crate::timestamp::Timestamp;
use crate::topic::TopicDeclaration;

/// The number of publications whose channels the hub remembers, so that readers find the topics
/// that changed.
const JOURNAL_LENGTH: usize = 1024;

/// The most hosts that a hub numbers, its own included.
pub const HOST_LIMIT: usize = 256;

/// The most names of publishers of other hosts that a hub numbers.
pub const REMOTE_PUBLISHER_LIMIT: usize = 4096;

/// A message on its way to the hub.
pub(crate) struct OutgoingMessage {
    pub(crate) header: Header,
    /// `None` after insertion, unless observers are to see it.
    pub(crate) message: Option<Arc<dyn AnyMessage>>,
    pub(crate) origin: WriterId,
    /// The message that left the ring in exchange.
    pub(crate) evicted: Option<Arc<dyn AnyMessage>>,
    /// The encoding shared by encoded subscribers, if there are any.
    pub(crate) encoding: Option<Arc<EncodingSlot>>,
}

impl OutgoingMessage {
    pub(crate) fn new(sample: AnySample, origin: WriterId) -> OutgoingMessage {
        let AnySample { message, header } = sample;
        OutgoingMessage { header, message: Some(message), origin, evicted: None, encoding: None }
    }
}

/// The state behind the lock.
///
/// The last publication is stored next to the lock and moves to its ring when the next one is
/// published or the ring is read. A reader that keeps pace with the publisher finds it in the two
/// cache lines that start with the lock: each line written by another core costs one transfer, and
/// the access through the rings takes twice as many.
#[repr(C)]
pub(crate) struct HubState {
    front: Option<RingEntry>,
    order: u64,
    topic_rings: Vec<TopicRings>,
    pub(crate) waker: Option<Arc<dyn Waker>>,
    /// The channels of the last publications, oldest first.
    recent_channels: VecDeque<Channel>,
    hosts: Vec<Arc<str>>,
    publishers: Vec<Arc<str>>,
    /// The number of publisher names that came from other hosts.
    remote_publishers: usize,
}

/// The rings of one topic.
struct TopicRings {
    local: Ring,
    /// Those of other hosts, created by their first message.
    remote_rings: Vec<(HostId, Ring)>,
}

impl HubState {
    pub(crate) fn new(host: Arc<str>, topics: &[TopicDeclaration]) -> HubState {
        let rings = |topic: &TopicDeclaration| TopicRings {
            local: Ring::new(topic.depth()),
            remote_rings: Vec::new(),
        };
        HubState {
            front: None,
            order: 0,
            topic_rings: topics.iter().map(rings).collect(),
            recent_channels: VecDeque::with_capacity(JOURNAL_LENGTH),
            hosts: vec![host],
            publishers: Vec::new(),
            remote_publishers: 0,
            waker: None,
        }
    }

    /// The publisher with that name on this host.
    pub(crate) fn sender(&mut self, name: &str) -> Sender {
        self.known_sender(name).unwrap_or_else(|| {
            self.publishers.push(name.into());
            self.named_sender(self.publishers.len() - 1)
        })
    }

    /// The publisher with that name on another host; the name is not trusted.
    pub(crate) fn remote_sender(&mut self, name: &str) -> Result<Sender, Error> {
        if let Some(known) = self.known_sender(name) {
            return Ok(known);
        }
        if self.remote_publishers == REMOTE_PUBLISHER_LIMIT {
            let text = format!(
                "`{name}` is one more than the {REMOTE_PUBLISHER_LIMIT} publishers on other hosts that are numbered"
            );
            return Err(Error::new(ErrorKind::TooMany, text));
        }
        self.remote_publishers += 1;
        Ok(self.sender(name))
    }

    fn known_sender(&self, name: &str) -> Option<Sender> {
        let index = self.publishers.iter().position(|other| &**other == name)?;
        Some(self.named_sender(index))
    }

    fn named_sender(&self, index: usize) -> Sender {
        Sender { publisher: PublisherId(index as u32), name: self.publishers[index].clone(), part: 0 }
    }

    pub(crate) fn publisher_name(&self, publisher: PublisherId) -> Option<&Arc<str>> {
        self.publishers.get(publisher.index())
    }

    /// The number of the host with that name; assigned if it has none.
    pub(crate) fn host(&mut self, name: &str) -> Result<HostId, Error> {
        if let Some(index) = self.hosts.iter().position(|other| &**other == name) {
            return Ok(HostId(index as u32));
        }
        if self.hosts.len() == HOST_LIMIT {
            let text = format!("`{name}` is one more than the {HOST_LIMIT} hosts that are numbered");
            return Err(Error::new(ErrorKind::TooMany, text));
        }
        self.hosts.push(name.into());
        Ok(HostId(self.hosts.len() as u32 - 1))
    }

    pub(crate) fn hosts(&self) -> &[Arc<str>] {
        &self.hosts
    }

    /// Inserts a message that is published here; completes its header.
    #[inline]
    pub(crate) fn publish(&mut self, message: &mut OutgoingMessage, now: Timestamp, is_observed: bool) {
        self.move_front_to_ring();
        let Header { host, publisher, part, topic, .. } = message.header;
        let Some(rings) = self.topic_rings.get_mut(topic.index()) else { return };
        let sequence = rings.local.next_sequence(publisher);
        let (published, local, received) = (now, now, now);
        let header = Header { host, publisher, part, topic, sequence, published, local, received };
        self.put(message, header, is_observed);
    }

    /// Inserts a message that another host published.
    pub(crate) fn receive(&mut self, message: &mut OutgoingMessage, is_observed: bool) {
        self.move_front_to_ring();
        self.put(message, message.header, is_observed);
    }

    /// Stores a message with its header as the front entry, which must be empty.
    #[inline]
    fn put(&mut self, message: &mut OutgoingMessage, header: Header, is_observed: bool) {
        let content = if is_observed { message.message.clone() } else { message.message.take() };
        let (origin, channel) = (message.origin, header.channel());
        let (Some(content), Some(ring)) = (content, self.ring_mut(channel)) else { return };
        message.header = header;
        message.evicted = ring.make_room();
        message.encoding = ring.next_encoding();
        self.order += 1;
        let sample = AnySample { message: content, header };
        self.front =
            Some(RingEntry { sample, order: self.order, origin, encoding: message.encoding.clone() });
        self.note(channel);
    }

    /// Moves the front entry to its ring. Until then the rings are not read.
    #[inline]
    pub(crate) fn move_front_to_ring(&mut self) {
        if let Some(entry) = self.front.take()
            && let Some(ring) = self.ring_mut(entry.sample.header.channel())
        {
            ring.push(entry);
        }
    }

    /// The publication with that number, if it is the last one and still the front entry.
    #[inline]
    pub(crate) fn front_entry(&self, number: u64) -> Option<&RingEntry> {
        self.front.as_ref().filter(|entry| entry.order == number)
    }

    #[inline]
    fn note(&mut self, channel: Channel) {
        if self.recent_channels.len() == JOURNAL_LENGTH {
            self.recent_channels.pop_front();
        }
        self.recent_channels.push_back(channel);
    }

    /// The ring of a channel; `None` before the first message of another host.
    #[inline]
    pub(crate) fn ring(&self, channel: Channel) -> Option<&Ring> {
        let rings = self.topic_rings.get(channel.topic.index())?;
        if channel.host == HostId::LOCAL {
            return Some(&rings.local);
        }
        rings.remote_rings.iter().find(|(host, _)| *host == channel.host).map(|(_, ring)| ring)
    }

    /// Like [`ring`](HubState::ring), created if necessary.
    #[inline]
    pub(crate) fn ring_mut(&mut self, channel: Channel) -> Option<&mut Ring> {
        let rings = self.topic_rings.get_mut(channel.topic.index())?;
        if channel.host == HostId::LOCAL {
            return Some(&mut rings.local);
        }
        let known = rings.remote_rings.iter().position(|(host, _)| *host == channel.host);
        let index = known.unwrap_or_else(|| {
            rings.remote_rings.push((channel.host, Ring::new(rings.local.capacity())));
            rings.remote_rings.len() - 1
        });
        Some(&mut rings.remote_rings[index].1)
    }

    /// The newest message of a channel.
    pub(crate) fn newest(&self, channel: Channel) -> Option<&RingEntry> {
        self.ring(channel)?.newest()
    }

    /// The hosts other than its own that have published on a topic.
    pub(crate) fn hosts_of(&self, topic: TopicSlot) -> impl Iterator<Item = HostId> {
        let rings = self.topic_rings.get(topic.index());
        rings.into_iter().flat_map(|rings| rings.remote_rings.iter().map(|(host, _)| *host))
    }

    /// The number of the last publication.
    pub(crate) fn last_publication(&self) -> u64 {
        self.order
    }

    /// The remembered publications with their numbers, in order.
    pub(crate) fn numbered_journal(&self) -> impl Iterator<Item = (u64, Channel)> {
        (self.order + 1 - self.recent_channels.len() as u64..).zip(self.recent_channels.iter().copied())
    }

    /// The channels of the publications with numbers after `order`, if that many are remembered.
    #[inline]
    pub(crate) fn channels_since(&self, order: u64) -> Option<impl Iterator<Item = Channel>> {
        let count = usize::try_from(self.order - order).ok()?;
        let start = self.recent_channels.len().checked_sub(count)?;
        Some(self.recent_channels.range(start..).copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::Ball;
    use crate::{Hub, Signal, State, Timestamp, Topic, TopicDeclaration};

    const SEEN: Topic<State<Ball>> = Topic::new("test/seen");
    const KICKED: Topic<Signal<Ball>> = Topic::new("test/kicked");

    fn hub() -> Hub {
        let declared = [
            TopicDeclaration::new::<State<Ball>>("test/seen", "test"),
            TopicDeclaration::new::<Signal<Ball>>("test/kicked", "test"),
        ];
        Hub::new("robot", &declared).unwrap()
    }

    fn ball(distance: f64) -> Ball {
        Ball { distance, bearing: 0.0 }
    }

    #[test]
    fn the_last_publication_is_read_without_the_lock() {
        let hub = hub();
        let mut publisher = hub.publisher(SEEN, "body").unwrap();
        publisher.publish(ball(1.0), Timestamp::ZERO);
        publisher.publish(ball(2.0), Timestamp::ZERO);
        {
            let exchange = hub.state_with_front();
            let front = exchange.front_entry(2).unwrap();
            let beside = |field: usize| field - std::ptr::from_ref(&*exchange).addr() <= 96;
            assert!(beside(std::ptr::from_ref(&front.sample.header).addr()));
            assert!(exchange.front_entry(1).is_none());
        }
        // A read of the rings finds the publication there.
        let slot = hub.topic("test/seen").unwrap();
        let exchange = hub.state();
        assert!(exchange.front_entry(2).is_none());
        let held: Vec<u64> =
            exchange.ring(Channel::local(slot)).unwrap().from(0).map(|entry| entry.order).collect();
        assert_eq!(held, [1, 2]);
    }

    #[test]
    fn a_signal_is_seen_once_and_not_by_later_readers() {
        let hub = hub();
        let mut publisher = hub.publisher(KICKED, "body").unwrap();
        let mut early = hub.blackboard("early");
        assert!(early.read(KICKED).is_none());
        publisher.publish(ball(1.0), Timestamp::ZERO);
        let mut late = hub.blackboard("late");
        assert!(late.read(KICKED).is_none());
        for (times, reader) in [(1, &mut early), (0, &mut late)] {
            for seen in [times, 0, 0] {
                reader.process_messages(Timestamp::ZERO);
                assert_eq!((reader.signals(KICKED).count(), reader.arrivals().count()), (seen, seen));
            }
        }
        // A reader that is two behind fetches both.
        publisher.publish(ball(2.0), Timestamp::ZERO);
        publisher.publish(ball(3.0), Timestamp::ZERO);
        early.process_messages(Timestamp::ZERO);
        let far: Vec<f64> = early.signals(KICKED).map(|sample| sample.distance).collect();
        assert_eq!((far, early.lost(KICKED)), (vec![2.0, 3.0], 0));
    }
}
