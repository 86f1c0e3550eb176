//! The hub: the in-process message broker of one host.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::encoding::EncodingSlot;
use crate::error::Error;
use crate::hub_state::{HubState, OutgoingMessage};
use crate::observer::{Observer, Publication, Waker};
use crate::publication_index::{PublicationIndex, RecentChannels};
use crate::sample::{AnySample, Channel, HostId, PublisherId, Sender, TopicSlot};
use crate::timestamp::Timestamp;
use crate::topic::{TOPICS, TopicDeclaration};
use crate::topic_table::TopicTable;

/// The hub of one host. Cloning it gives another handle to the same hub.
///
/// All publishers and readers hold a handle: agents through a [`Blackboard`](crate::Blackboard),
/// other code through a [`Publisher`](crate::Publisher) or a [`Subscriber`](crate::Subscriber),
/// links through an [`EncodedSubscriber`](crate::EncodedSubscriber) and a
/// [`Receiver`](crate::Receiver).
/// The hub holds a bounded ring of messages per topic; readers poll it, so a reader that never does
/// slows down no publisher.
#[derive(Clone)]
pub struct Hub {
    shared: Arc<HubShared>,
}

struct HubShared {
    host: Arc<str>,
    catalogue: TopicTable,
    blackboards: AtomicU32,
    /// Whether there is an observer; if not, the lock of the observers is not taken.
    is_observed: AtomicBool,
    observers: Mutex<ObserverSet>,
    exchange: CacheAligned<Mutex<HubState>>,
    publication_index: PublicationIndex,
}

/// Aligned to a cache line, so that data written under the lock shares the line of the lock.
#[repr(align(128))]
struct CacheAligned<T>(T);

/// Locked from the numbering of a message to the end of its observation, so that observers see
/// messages in order.
#[derive(Default)]
struct ObserverSet {
    all: Vec<Box<dyn Observer>>,
    /// Encoding of messages that have no encoded subscriber.
    encoding: EncodingSlot,
}

impl Hub {
    /// Creates a hub with the given topics. Fails if a topic is declared with two types or two
    /// retention kinds, if a path is not well formed, or if two names have the same hash; the error
    /// names both declarations.
    pub fn new<'a>(
        host: &str,
        declarations: impl IntoIterator<Item = &'a TopicDeclaration>,
    ) -> Result<Hub, Error> {
        let catalogue = TopicTable::new(declarations.into_iter().copied().collect())?;
        let host: Arc<str> = host.into();
        let exchange = HubState::new(host.clone(), catalogue.topics());
        let shared = HubShared {
            host,
            catalogue,
            blackboards: AtomicU32::new(0),
            is_observed: AtomicBool::new(false),
            observers: Mutex::default(),
            exchange: CacheAligned(Mutex::new(exchange)),
            publication_index: PublicationIndex::new(),
        };
        Ok(Hub { shared: Arc::new(shared) })
    }

    /// Creates a hub with every topic that a linked crate declares with [`topic!`](crate::topic!).
    pub fn with_linked_topics(host: &str) -> Result<Hub, Error> {
        Hub::new(host, TOPICS.iter())
    }

    /// The topics, sorted by path; the index of each is its slot number.
    pub fn topics(&self) -> &[TopicDeclaration] {
        self.shared.catalogue.topics()
    }

    /// The slot of the topic at `path`.
    pub fn topic(&self, path: &str) -> Option<TopicSlot> {
        self.shared.catalogue.by_path(path)
    }

    /// The slot of the topic with that [`topic_hash`](crate::topic_hash).
    pub fn topic_by_hash(&self, hash: u64) -> Option<TopicSlot> {
        self.shared.catalogue.by_hash(hash)
    }

    /// The declaration of a topic.
    pub fn declaration(&self, slot: TopicSlot) -> Option<&TopicDeclaration> {
        self.shared.catalogue.get(slot)
    }

    /// The number of publications so far, over all topics.
    pub fn position(&self) -> u64 {
        self.last_publication()
    }

    /// The newest message that was published on a topic. Does not subscribe to the topic.
    pub fn latest(&self, slot: TopicSlot) -> Option<AnySample> {
        self.state().newest(Channel::local(slot)).map(|entry| entry.sample.clone())
    }
}

/// Names.
impl Hub {
    /// The host's name.
    pub fn host(&self) -> &str {
        &self.shared.host
    }

    /// The number of a host in this hub; assigned if the host is unknown.
    ///
    /// # Errors
    /// There are more hosts than [`HOST_LIMIT`](crate::HOST_LIMIT).
    pub fn host_id(&self, name: &str) -> Result<HostId, Error> {
        self.state().host(name)
    }

    /// The numbered hosts, in order of their numbers; the first is this one.
    pub fn hosts(&self) -> Vec<Arc<str>> {
        self.state().hosts().to_vec()
    }

    /// The other hosts from which messages of a topic have come.
    pub fn hosts_of(&self, slot: TopicSlot) -> Vec<HostId> {
        self.state().hosts_of(slot).collect()
    }

    /// The name of a host.
    pub fn host_name(&self, host: HostId) -> Option<Arc<str>> {
        self.state().hosts().get(host.index()).cloned()
    }

    /// The name of a publisher.
    pub fn publisher_name(&self, publisher: PublisherId) -> Option<Arc<str>> {
        self.state().publisher_name(publisher).cloned()
    }
}

/// Observers. The constructors of publishers and readers are in the modules of these.
impl Hub {
    /// Registers an observer for everything that is published from now on.
    pub fn observe(&self, observer: Box<dyn Observer>) {
        self.observers().all.push(observer);
        self.shared.is_observed.store(true, Ordering::Release);
    }

    /// Whether the hub has an observer.
    pub fn is_observed(&self) -> bool {
        self.shared.is_observed.load(Ordering::Acquire)
    }

    /// Sets the waker that is notified of publications, replacing the previous one.
    pub fn set_waker(&self, waker: Arc<dyn Waker>) {
        self.state().waker = Some(waker);
    }

    /// Sets the waker, and returns the publications with numbers after `since` of which it is not
    /// notified: number, topic and host of each, in order. Of the last 1024 publications none is
    /// missing.
    pub fn set_waker_since(&self, since: u64, waker: Arc<dyn Waker>) -> Vec<(u64, TopicSlot, HostId)> {
        let mut state = self.state();
        state.waker = Some(waker);
        let numbered = state.numbered_journal().filter(|(number, _)| *number > since);
        numbered.map(|(number, channel)| (number, channel.topic, channel.host)).collect()
    }
}

/// Internal access.
impl Hub {
    /// Whether both are handles to one hub.
    pub(crate) fn is_same_hub(&self, other: &Hub) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    #[inline]
    pub(crate) fn topic_table(&self) -> &TopicTable {
        &self.shared.catalogue
    }

    /// The number of the last publication.
    #[inline]
    pub(crate) fn last_publication(&self) -> u64 {
        self.shared.publication_index.last()
    }

    /// The channel of the last publication if its number is `last`.
    #[inline]
    pub(crate) fn channel_of_last(&self, last: u64) -> Option<Channel> {
        self.shared.publication_index.channel_of_last(last)
    }

    /// The channels of the publications with numbers from after `since` to `last`; `None` if they
    /// are no longer known.
    #[inline]
    pub(crate) fn recent(&self, since: u64, last: u64) -> Option<RecentChannels> {
        self.shared.publication_index.recent(since, last)
    }

    /// Locks the state of the hub, with every message in its ring.
    pub(crate) fn state(&self) -> MutexGuard<'_, HubState> {
        let mut exchange = self.state_with_front();
        exchange.move_front_to_ring();
        exchange
    }

    /// Like [`state`](Hub::state), but the last publication may still be the front entry.
    #[inline]
    pub(crate) fn state_with_front(&self) -> MutexGuard<'_, HubState> {
        self.shared.exchange.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn observers(&self) -> MutexGuard<'_, ObserverSet> {
        self.shared.observers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A new number for a blackboard.
    pub(crate) fn next_blackboard(&self) -> u32 {
        self.shared.blackboards.fetch_add(1, Ordering::Relaxed) + 1
    }

    pub(crate) fn sender(&self, name: &str) -> Sender {
        self.state().sender(name)
    }

    /// Publishes messages atomically: a reader sees all of them or none. Completes their headers.
    pub(crate) fn send(&self, sender: &Sender, outgoing: &mut [OutgoingMessage], now: Timestamp) {
        self.insert_and_notify(self.host(), sender, outgoing, |exchange, message, is_observed| {
            exchange.publish(message, now, is_observed);
        });
    }

    /// Receives a message that another host published.
    pub(crate) fn receive(&self, host: &str, sender: &Sender, message: &mut OutgoingMessage) {
        self.insert_and_notify(host, sender, std::slice::from_mut(message), HubState::receive);
    }

    /// Inserts messages one by one under the lock, shows them to the observers, and notifies the
    /// waker.
    fn insert_and_notify(
        &self,
        host: &str,
        sender: &Sender,
        outgoing: &mut [OutgoingMessage],
        enter: impl Fn(&mut HubState, &mut OutgoingMessage, bool),
    ) {
        if outgoing.is_empty() {
            return;
        }
        let observers = self.is_observed().then(|| self.observers());
        let mut exchange = self.state_with_front();
        let head = &self.shared.publication_index;
        for message in &mut *outgoing {
            let before = exchange.last_publication();
            enter(&mut exchange, message, observers.is_some());
            if exchange.last_publication() != before {
                head.record(exchange.last_publication(), message.header.channel());
            }
        }
        let waker = exchange.waker.clone();
        // Done last before the lock is released: readers that poll the index take the lock at once.
        head.advance_to(exchange.last_publication());
        drop(exchange);
        if let Some(mut observers) = observers {
            outgoing
                .iter_mut()
                .for_each(|message| self.notify_observers(&mut observers, host, sender, message));
        }
        if let Some(waker) = waker {
            outgoing.iter().for_each(|message| waker.wake(message.header.topic, message.header.host));
        }
    }

    fn notify_observers(
        &self,
        observers: &mut ObserverSet,
        host: &str,
        sender: &Sender,
        message: &mut OutgoingMessage,
    ) {
        let header = message.header;
        let (Some(topic), Some(content)) = (self.declaration(header.topic), message.message.take()) else {
            return;
        };
        let ObserverSet { all, encoding } = observers;
        encoding.clear();
        let encoding = message.encoding.as_deref().unwrap_or(encoding);
        let sample = &AnySample { message: content, header };
        let hub = self.host();
        let publication = Publication { hub, host, publisher: &sender.name, topic, sample, encoding };
        for observer in all {
            if header.host == HostId::LOCAL {
                observer.observe(publication);
            } else {
                observer.observe_received(publication);
            }
        }
    }
}

impl fmt::Debug for Hub {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Hub({}, {} topics)", self.host(), self.topics().len())
    }
}
