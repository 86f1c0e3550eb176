//! The hub: where everything that is published on one host passes.

use std::collections::VecDeque;
use std::fmt;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::blackboard::Blackboard;
use crate::catalogue::Catalogue;
use crate::error::Error;
use crate::moment::Moment;
use crate::observer::{Observer, Publication, Waker};
use crate::publisher::Publisher;
use crate::ring::{Entry, Origin, Ring};
use crate::sample::{AnySample, HostId, PublisherId, TopicSlot};
use crate::subscriber::Subscriber;
use crate::topic::{Keep, TOPICS, Topic, TopicDeclaration};

/// How many publications the hub remembers by topic, for readers that look for what moved.
const JOURNAL_LENGTH: usize = 1024;

/// The hub of one host. Cloning it gives another handle to the same hub.
///
/// Everyone who publishes or reads holds a handle: agents through a [`Blackboard`], others through a [`Publisher`] or a
/// [`Subscriber`]. The hub holds a bounded ring of messages for each topic; readers fetch from it when they choose, so
/// one that never does slows nobody.
#[derive(Clone)]
pub struct Narukom {
    shared: Arc<Shared>,
}

struct Shared {
    host: Arc<str>,
    catalogue: Catalogue,
    blackboards: AtomicU32,
    /// The number of the last publication; readers compare it before they take a lock.
    head: AtomicU64,
    /// Held from the numbering of a message to the end of its observation, so that observers see them in order.
    observers: Mutex<Vec<Box<dyn Observer>>>,
    exchange: Mutex<Exchange>,
}

/// What is copied in and out under the lock.
pub(crate) struct Exchange {
    rings: Vec<Ring>,
    order: u64,
    /// The topics of the last publications, oldest first.
    journal: VecDeque<TopicSlot>,
    publishers: Vec<Arc<str>>,
    waker: Option<Arc<dyn Waker>>,
}

/// Who publishes.
#[derive(Clone)]
pub(crate) struct Sender {
    pub(crate) publisher: PublisherId,
    pub(crate) name: Arc<str>,
}

/// A message on its way to the hub.
pub(crate) struct Outgoing {
    pub(crate) sample: AnySample,
    pub(crate) origin: Origin,
}

impl Narukom {
    /// A hub with the given topics. Start fails if a topic is declared with two types or two ways of keeping, if a
    /// path is not well formed, or if two names have the same hash; the error names both declarations.
    pub fn new<'a>(
        host: &str,
        declarations: impl IntoIterator<Item = &'a TopicDeclaration>,
    ) -> Result<Narukom, Error> {
        let catalogue = Catalogue::new(declarations.into_iter().copied().collect())?;
        let exchange = Exchange::new(catalogue.topics());
        let shared = Shared {
            host: host.into(),
            catalogue,
            blackboards: AtomicU32::new(0),
            head: AtomicU64::new(0),
            observers: Mutex::new(Vec::new()),
            exchange: Mutex::new(exchange),
        };
        Ok(Narukom { shared: Arc::new(shared) })
    }

    /// A hub with every topic that a linked crate declares with [`topic!`](crate::topic!).
    pub fn with_linked_topics(host: &str) -> Result<Narukom, Error> {
        Narukom::new(host, TOPICS.iter())
    }

    /// The host's name.
    pub fn host(&self) -> &str {
        &self.shared.host
    }

    /// The topics, sorted by path; the place of each is its slot's number.
    pub fn topics(&self) -> &[TopicDeclaration] {
        self.shared.catalogue.topics()
    }

    /// The slot of the topic at `path`.
    pub fn topic(&self, path: &str) -> Option<TopicSlot> {
        self.shared.catalogue.by_path(path)
    }

    /// What is declared of a topic.
    pub fn declaration(&self, slot: TopicSlot) -> Option<&TopicDeclaration> {
        self.shared.catalogue.get(slot)
    }

    /// The name of a host.
    pub fn host_name(&self, host: HostId) -> Option<Arc<str>> {
        (host == HostId::LOCAL).then(|| self.shared.host.clone())
    }

    /// The name of a publisher.
    pub fn publisher_name(&self, publisher: PublisherId) -> Option<Arc<str>> {
        self.exchange().publishers.get(publisher.index()).cloned()
    }

    /// A blackboard for an agent, or for a region of one, that publishes under the name `publisher`. Several may share a name.
    pub fn blackboard(&self, publisher: &str) -> Blackboard {
        let number = self.shared.blackboards.fetch_add(1, Ordering::Relaxed) + 1;
        Blackboard::new(self.clone(), self.sender(publisher), number)
    }

    /// For those outside agents: publishes on one topic under the name `publisher`.
    pub fn publisher<K: Keep>(
        &self,
        topic: Topic<K>,
        publisher: &str,
    ) -> Result<Publisher<K::Message>, Error> {
        let slot = self.shared.catalogue.checked(topic)?;
        Ok(Publisher::new(self.clone(), self.sender(publisher), slot))
    }

    /// For those outside agents: reads one topic (`soccer/ball`), those directly under a path (`soccer/*`), or all
    /// under it (`soccer/**`, `**`). A pattern that fits no topic is an error.
    pub fn subscriber(&self, pattern: &str) -> Result<Subscriber, Error> {
        Subscriber::new(self.clone(), pattern)
    }

    /// Lets `observer` see everything that is published from now on.
    pub fn observe(&self, observer: Box<dyn Observer>) {
        self.observers().push(observer);
    }

    /// Lets `waker` know of publications from now on, in place of the one before.
    pub fn set_waker(&self, waker: Arc<dyn Waker>) {
        self.exchange().waker = Some(waker);
    }

    /// Whether both are handles to one hub.
    pub(crate) fn is(&self, other: &Narukom) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    pub(crate) fn catalogue(&self) -> &Catalogue {
        &self.shared.catalogue
    }

    /// The number of the last publication.
    pub(crate) fn head(&self) -> u64 {
        self.shared.head.load(Ordering::Acquire)
    }

    pub(crate) fn exchange(&self) -> MutexGuard<'_, Exchange> {
        self.shared.exchange.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn observers(&self) -> MutexGuard<'_, Vec<Box<dyn Observer>>> {
        self.shared.observers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn sender(&self, name: &str) -> Sender {
        self.exchange().sender(name)
    }

    /// Publishes messages at once: a reader sees all of them or none. Their headers are completed.
    pub(crate) fn send(&self, sender: &Sender, outgoing: &mut [Outgoing], now: Moment) {
        if outgoing.is_empty() {
            return;
        }
        let mut observers = self.observers();
        let waker = self.enter(sender, outgoing, now);
        for observer in observers.iter_mut() {
            self.show(observer.as_mut(), sender, outgoing);
        }
        drop(observers);
        if let Some(waker) = waker {
            outgoing.iter().for_each(|message| waker.wake(message.sample.header.topic));
        }
    }

    fn enter(&self, sender: &Sender, outgoing: &mut [Outgoing], now: Moment) -> Option<Arc<dyn Waker>> {
        let mut exchange = self.exchange();
        for message in outgoing {
            exchange.enter(sender.publisher, message, now);
        }
        self.shared.head.store(exchange.order, Ordering::Release);
        exchange.waker.clone()
    }

    fn show(&self, observer: &mut dyn Observer, sender: &Sender, outgoing: &[Outgoing]) {
        for Outgoing { sample, .. } in outgoing {
            if let Some(topic) = self.declaration(sample.header.topic) {
                observer.observe(Publication { host: self.host(), publisher: &sender.name, topic, sample });
            }
        }
    }
}

impl fmt::Debug for Narukom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Narukom({}, {} topics)", self.host(), self.topics().len())
    }
}

impl Exchange {
    fn new(topics: &[TopicDeclaration]) -> Exchange {
        Exchange {
            rings: topics.iter().map(|topic| Ring::new(topic.depth())).collect(),
            order: 0,
            journal: VecDeque::with_capacity(JOURNAL_LENGTH),
            publishers: Vec::new(),
            waker: None,
        }
    }

    fn sender(&mut self, name: &str) -> Sender {
        let known = self.publishers.iter().position(|other| &**other == name);
        let index = known.unwrap_or_else(|| {
            self.publishers.push(name.into());
            self.publishers.len() - 1
        });
        Sender { publisher: PublisherId(index as u32), name: self.publishers[index].clone() }
    }

    fn enter(&mut self, publisher: PublisherId, message: &mut Outgoing, now: Moment) {
        let topic = message.sample.header.topic;
        let Some(ring) = self.rings.get_mut(topic.index()) else { return };
        self.order += 1;
        message.sample.header.publisher = publisher;
        message.sample.header.sequence = ring.next_sequence(publisher);
        message.sample.header.published = now;
        message.sample.header.received = now;
        ring.push(Entry { sample: message.sample.clone(), order: self.order, origin: message.origin });
        if self.journal.len() == JOURNAL_LENGTH {
            self.journal.pop_front();
        }
        self.journal.push_back(topic);
    }

    pub(crate) fn ring(&self, slot: TopicSlot) -> Option<&Ring> {
        self.rings.get(slot.index())
    }

    /// The number of the last publication.
    pub(crate) fn order(&self) -> u64 {
        self.order
    }

    /// The topics of the publications later than number `order`, if so many are remembered.
    pub(crate) fn journal_since(&self, order: u64) -> Option<impl Iterator<Item = TopicSlot>> {
        let count = usize::try_from(self.order - order).ok()?;
        let start = self.journal.len().checked_sub(count)?;
        Some(self.journal.range(start..).copied())
    }
}
