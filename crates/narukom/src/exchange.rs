//! What a hub holds, copied in and out under its lock.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::encoding::Encoding;
use crate::error::{Error, ErrorKind};
use crate::message::AnyMessage;
use crate::moment::Moment;
use crate::observer::Waker;
use crate::ring::{Entry, Origin, Ring};
use crate::sample::{AnySample, Channel, Header, HostId, PublisherId, TopicSlot};
use crate::topic::TopicDeclaration;

/// How many publications the hub remembers by topic, for readers that look for what moved.
const JOURNAL_LENGTH: usize = 1024;

/// How many hosts a hub numbers, its own included.
pub const HOST_LIMIT: usize = 256;

/// How many names of publishers of other hosts a hub numbers.
pub const REMOTE_PUBLISHER_LIMIT: usize = 4096;

/// Who publishes.
#[derive(Clone)]
pub(crate) struct Sender {
    pub(crate) publisher: PublisherId,
    pub(crate) name: Arc<str>,
    /// Which of those who publish under the name.
    pub(crate) part: u16,
}

/// A message on its way to the hub.
pub(crate) struct Outgoing {
    pub(crate) header: Header,
    /// Gone when it has entered, unless observers are to see it.
    pub(crate) message: Option<Arc<dyn AnyMessage>>,
    pub(crate) origin: Origin,
    /// What left the ring in its place.
    pub(crate) left: Option<Arc<dyn AnyMessage>>,
    /// Where taps share its encoding, if there are any.
    pub(crate) encoding: Option<Arc<Encoding>>,
}

impl Outgoing {
    pub(crate) fn new(sample: AnySample, origin: Origin) -> Outgoing {
        let AnySample { message, header } = sample;
        Outgoing { header, message: Some(message), origin, left: None, encoding: None }
    }
}

/// The state behind the lock.
///
/// The last publication lies beside the lock itself, and is put on its shelf when the next one comes or somebody looks there. Whoever
/// reads in step with what is published finds it here, in the two cache lines that the lock begins: each line that one core wrote costs
/// another one the same wait, and the way over the shelves is twice as long.
#[repr(C)]
pub(crate) struct Exchange {
    front: Option<Entry>,
    order: u64,
    shelves: Vec<Shelf>,
    pub(crate) waker: Option<Arc<dyn Waker>>,
    /// What moved in the last publications, oldest first.
    journal: VecDeque<Channel>,
    hosts: Vec<Arc<str>>,
    publishers: Vec<Arc<str>>,
    /// How many of the publishers' names came from other hosts.
    remote_publishers: usize,
}

/// The rings of one topic.
struct Shelf {
    local: Ring,
    /// Those of other hosts, made by their first message.
    others: Vec<(HostId, Ring)>,
}

impl Exchange {
    pub(crate) fn new(host: Arc<str>, topics: &[TopicDeclaration]) -> Exchange {
        let shelf = |topic: &TopicDeclaration| Shelf { local: Ring::new(topic.depth()), others: Vec::new() };
        Exchange {
            front: None,
            order: 0,
            shelves: topics.iter().map(shelf).collect(),
            journal: VecDeque::with_capacity(JOURNAL_LENGTH),
            hosts: vec![host],
            publishers: Vec::new(),
            remote_publishers: 0,
            waker: None,
        }
    }

    /// The publisher of that name on this host.
    pub(crate) fn sender(&mut self, name: &str) -> Sender {
        self.known_sender(name).unwrap_or_else(|| {
            self.publishers.push(name.into());
            self.named_sender(self.publishers.len() - 1)
        })
    }

    /// The publisher of that name on another host, which may have invented it.
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

    /// The host of that name, which gets a number if it has none.
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

    /// Takes a message that is published here; its header is completed.
    #[inline]
    pub(crate) fn publish(&mut self, message: &mut Outgoing, now: Moment, is_observed: bool) {
        self.shelve();
        let Header { host, publisher, part, topic, .. } = message.header;
        let Some(shelf) = self.shelves.get_mut(topic.index()) else { return };
        let sequence = shelf.local.next_sequence(publisher);
        let (published, local, received) = (now, now, now);
        let header = Header { host, publisher, part, topic, sequence, published, local, received };
        self.put(message, header, is_observed);
    }

    /// Takes a message that another host published.
    pub(crate) fn receive(&mut self, message: &mut Outgoing, is_observed: bool) {
        self.shelve();
        self.put(message, message.header, is_observed);
    }

    /// Puts a message with its header at the front, which is free.
    #[inline]
    fn put(&mut self, message: &mut Outgoing, header: Header, is_observed: bool) {
        let content = if is_observed { message.message.clone() } else { message.message.take() };
        let (origin, channel) = (message.origin, header.channel());
        let (Some(content), Some(ring)) = (content, self.ring_mut(channel)) else { return };
        message.header = header;
        message.left = ring.make_room();
        message.encoding = ring.next_encoding();
        self.order += 1;
        let sample = AnySample { message: content, header };
        self.front = Some(Entry { sample, order: self.order, origin, encoding: message.encoding.clone() });
        self.note(channel);
    }

    /// Puts the last publication on its shelf. Until then nobody looks there.
    #[inline]
    pub(crate) fn shelve(&mut self) {
        if let Some(entry) = self.front.take()
            && let Some(ring) = self.ring_mut(entry.sample.header.channel())
        {
            ring.push(entry);
        }
    }

    /// The publication of that number, if it is the last one and nobody has looked at the shelves since.
    #[inline]
    pub(crate) fn at_front(&self, number: u64) -> Option<&Entry> {
        self.front.as_ref().filter(|entry| entry.order == number)
    }

    #[inline]
    fn note(&mut self, channel: Channel) {
        if self.journal.len() == JOURNAL_LENGTH {
            self.journal.pop_front();
        }
        self.journal.push_back(channel);
    }

    /// The ring of a channel; none before the other host's first message.
    #[inline]
    pub(crate) fn ring(&self, channel: Channel) -> Option<&Ring> {
        let shelf = self.shelves.get(channel.topic.index())?;
        if channel.host == HostId::LOCAL {
            return Some(&shelf.local);
        }
        shelf.others.iter().find(|(host, _)| *host == channel.host).map(|(_, ring)| ring)
    }

    /// As [`ring`](Exchange::ring), made if it is not there.
    #[inline]
    pub(crate) fn ring_mut(&mut self, channel: Channel) -> Option<&mut Ring> {
        let shelf = self.shelves.get_mut(channel.topic.index())?;
        if channel.host == HostId::LOCAL {
            return Some(&mut shelf.local);
        }
        let known = shelf.others.iter().position(|(host, _)| *host == channel.host);
        let place = known.unwrap_or_else(|| {
            shelf.others.push((channel.host, Ring::new(shelf.local.capacity())));
            shelf.others.len() - 1
        });
        Some(&mut shelf.others[place].1)
    }

    /// The newest message of a channel.
    pub(crate) fn newest(&self, channel: Channel) -> Option<&Entry> {
        self.ring(channel)?.newest()
    }

    /// The hosts other than its own that have published on a topic.
    pub(crate) fn hosts_of(&self, topic: TopicSlot) -> impl Iterator<Item = HostId> {
        let shelf = self.shelves.get(topic.index());
        shelf.into_iter().flat_map(|shelf| shelf.others.iter().map(|(host, _)| *host))
    }

    /// The number of the last publication.
    pub(crate) fn order(&self) -> u64 {
        self.order
    }

    /// What moved in the publications later than number `order`, if so many are remembered.
    #[inline]
    pub(crate) fn journal_since(&self, order: u64) -> Option<impl Iterator<Item = Channel>> {
        let count = usize::try_from(self.order - order).ok()?;
        let start = self.journal.len().checked_sub(count)?;
        Some(self.journal.range(start..).copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::Ball;
    use crate::{Moment, Narukom, Signal, State, Topic, TopicDeclaration};

    const SEEN: Topic<State<Ball>> = Topic::new("test/seen");
    const KICKED: Topic<Signal<Ball>> = Topic::new("test/kicked");

    fn hub() -> Narukom {
        let declared = [
            TopicDeclaration::new::<State<Ball>>("test/seen", "test"),
            TopicDeclaration::new::<Signal<Ball>>("test/kicked", "test"),
        ];
        Narukom::new("robot", &declared).unwrap()
    }

    fn ball(distance: f64) -> Ball {
        Ball { distance, bearing: 0.0 }
    }

    #[test]
    fn the_last_publication_lies_beside_the_lock() {
        let hub = hub();
        let mut publisher = hub.publisher(SEEN, "body").unwrap();
        publisher.publish(ball(1.0), Moment::ZERO);
        publisher.publish(ball(2.0), Moment::ZERO);
        {
            let exchange = hub.unshelved();
            let front = exchange.at_front(2).unwrap();
            let beside = |field: usize| field - std::ptr::from_ref(&*exchange).addr() <= 96;
            assert!(beside(std::ptr::from_ref(&front.sample.header).addr()));
            assert!(exchange.at_front(1).is_none());
        }
        // Who looks at the shelves finds it there.
        let slot = hub.topic("test/seen").unwrap();
        let exchange = hub.exchange();
        assert!(exchange.at_front(2).is_none());
        let held: Vec<u64> =
            exchange.ring(Channel::local(slot)).unwrap().from(0).map(|entry| entry.order).collect();
        assert_eq!(held, [1, 2]);
    }

    #[test]
    fn a_signal_at_the_front_is_seen_once_and_not_by_who_came_later() {
        let hub = hub();
        let mut publisher = hub.publisher(KICKED, "body").unwrap();
        let mut early = hub.blackboard("early");
        assert!(early.read(KICKED).is_none());
        publisher.publish(ball(1.0), Moment::ZERO);
        let mut late = hub.blackboard("late");
        assert!(late.read(KICKED).is_none());
        for (times, reader) in [(1, &mut early), (0, &mut late)] {
            for seen in [times, 0, 0] {
                reader.process_messages(Moment::ZERO);
                assert_eq!((reader.signals(KICKED).count(), reader.arrivals().count()), (seen, seen));
            }
        }
        // One that is behind by two fetches both.
        publisher.publish(ball(2.0), Moment::ZERO);
        publisher.publish(ball(3.0), Moment::ZERO);
        early.process_messages(Moment::ZERO);
        let far: Vec<f64> = early.signals(KICKED).map(|sample| sample.distance).collect();
        assert_eq!((far, early.lost(KICKED)), (vec![2.0, 3.0], 0));
    }
}
