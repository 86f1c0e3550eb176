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

/// The state behind the lock. What every reader needs comes first, beside the lock itself.
#[repr(C)]
pub(crate) struct Exchange {
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
        Sender { publisher: PublisherId(index as u32), name: self.publishers[index].clone() }
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
        let header = &mut message.header;
        let topic = header.topic;
        let Some(shelf) = self.shelves.get_mut(topic.index()) else { return };
        header.sequence = shelf.local.next_sequence(header.publisher);
        (header.published, header.local, header.received) = (now, now, now);
        self.order += 1;
        shelf.local.push(message, self.order, is_observed);
        self.note(Channel::local(topic));
    }

    /// Takes a message that another host published.
    pub(crate) fn receive(&mut self, message: &mut Outgoing, is_observed: bool) {
        let channel = message.header.channel();
        let order = self.order + 1;
        let Some(ring) = self.ring_mut(channel) else { return };
        ring.push(message, order, is_observed);
        self.order = order;
        self.note(channel);
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
