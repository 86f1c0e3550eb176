//! The hub: where everything that is published on one host passes.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::blackboard::Blackboard;
use crate::catalogue::Catalogue;
use crate::encoding::Encoding;
use crate::error::{Error, ErrorKind};
use crate::exchange::{Exchange, Outgoing, Sender};
use crate::head::{Head, Recent};
use crate::moment::Moment;
use crate::observer::{Observer, Publication, Waker};
use crate::publisher::{AnyPublisher, Publisher};
use crate::receiver::Receiver;
use crate::sample::{AnySample, Channel, HostId, PublisherId, TopicSlot};
use crate::subscriber::{self, Subscriber};
use crate::tap::Tap;
use crate::topic::{Keep, TOPICS, Topic, TopicDeclaration};

/// The hub of one host. Cloning it gives another handle to the same hub.
///
/// Everyone who publishes or reads holds a handle: agents through a [`Blackboard`], others through a [`Publisher`] or a
/// [`Subscriber`], links through a [`Tap`] and a [`Receiver`]. The hub holds a bounded ring of messages for each topic; readers fetch
/// from it when they choose, so one that never does slows nobody.
#[derive(Clone)]
pub struct Narukom {
    shared: Arc<Shared>,
}

struct Shared {
    host: Arc<str>,
    catalogue: Catalogue,
    blackboards: AtomicU32,
    /// Whether there is an observer; without one its lock is not taken.
    is_observed: AtomicBool,
    observers: Mutex<Observers>,
    exchange: Apart<Mutex<Exchange>>,
    head: Head,
}

/// What begins a cache line: what is written under the lock is beside the lock.
#[repr(align(128))]
struct Apart<T>(T);

/// Held from the numbering of a message to the end of its observation, so that observers see them in order.
#[derive(Default)]
struct Observers {
    all: Vec<Box<dyn Observer>>,
    /// Where a message is encoded that no tap shares.
    encoding: Encoding,
}

impl Narukom {
    /// A hub with the given topics. Start fails if a topic is declared with two types or two ways of keeping, if a
    /// path is not well formed, or if two names have the same hash; the error names both declarations.
    pub fn new<'a>(
        host: &str,
        declarations: impl IntoIterator<Item = &'a TopicDeclaration>,
    ) -> Result<Narukom, Error> {
        let catalogue = Catalogue::new(declarations.into_iter().copied().collect())?;
        let host: Arc<str> = host.into();
        let exchange = Exchange::new(host.clone(), catalogue.topics());
        let shared = Shared {
            host,
            catalogue,
            blackboards: AtomicU32::new(0),
            is_observed: AtomicBool::new(false),
            observers: Mutex::default(),
            exchange: Apart(Mutex::new(exchange)),
            head: Head::new(),
        };
        Ok(Narukom { shared: Arc::new(shared) })
    }

    /// A hub with every topic that a linked crate declares with [`topic!`](crate::topic!).
    pub fn with_linked_topics(host: &str) -> Result<Narukom, Error> {
        Narukom::new(host, TOPICS.iter())
    }

    /// The topics, sorted by path; the place of each is its slot's number.
    pub fn topics(&self) -> &[TopicDeclaration] {
        self.shared.catalogue.topics()
    }

    /// The slot of the topic at `path`.
    pub fn topic(&self, path: &str) -> Option<TopicSlot> {
        self.shared.catalogue.by_path(path)
    }

    /// The topics that a pattern fits, as [`subscriber`](Narukom::subscriber) has it.
    pub fn matching(&self, pattern: &str) -> Result<Vec<TopicSlot>, Error> {
        subscriber::matching(&self.shared.catalogue, pattern)
    }

    /// What is declared of a topic.
    pub fn declaration(&self, slot: TopicSlot) -> Option<&TopicDeclaration> {
        self.shared.catalogue.get(slot)
    }

    /// How many publications, of whatever topic, there have been.
    pub fn position(&self) -> u64 {
        self.head()
    }

    /// The newest message that was published on a topic. Nobody becomes a reader by it.
    pub fn latest(&self, slot: TopicSlot) -> Option<AnySample> {
        self.exchange().newest(Channel::local(slot)).map(|entry| entry.sample.clone())
    }
}

/// Names.
impl Narukom {
    /// The host's name.
    pub fn host(&self) -> &str {
        &self.shared.host
    }

    /// The number by which this hub knows a host, heard of or not.
    ///
    /// # Errors
    /// There are more hosts than [`HOST_LIMIT`](crate::HOST_LIMIT).
    pub fn host_id(&self, name: &str) -> Result<HostId, Error> {
        self.exchange().host(name)
    }

    /// The hosts that have a number, in the order of their numbers; the first is this one.
    pub fn hosts(&self) -> Vec<Arc<str>> {
        self.exchange().hosts().to_vec()
    }

    /// The other hosts from which messages of a topic have come.
    pub fn hosts_of(&self, slot: TopicSlot) -> Vec<HostId> {
        self.exchange().hosts_of(slot).collect()
    }

    /// The name of a host.
    pub fn host_name(&self, host: HostId) -> Option<Arc<str>> {
        self.exchange().hosts().get(host.index()).cloned()
    }

    /// The name of a publisher.
    pub fn publisher_name(&self, publisher: PublisherId) -> Option<Arc<str>> {
        self.exchange().publisher_name(publisher).cloned()
    }
}

/// Those who publish, read and look on.
impl Narukom {
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

    /// As [`publisher`](Narukom::publisher), for a topic known at run time: takes messages of any type, or bytes, and refuses what is
    /// not of the topic's.
    pub fn publisher_by_name(&self, path: &str, publisher: &str) -> Result<AnyPublisher, Error> {
        let slot = self.shared.catalogue.declared(path)?;
        let declaration = self.shared.catalogue.topics()[slot.index()];
        Ok(AnyPublisher::new(self.clone(), self.sender(publisher), slot, declaration))
    }

    /// For links: takes in what `publisher` published at `path` on another host.
    ///
    /// # Errors
    /// Nobody declared the topic here, `host` is this one, or there are too many hosts or publishers.
    pub fn receiver(&self, host: &str, publisher: &str, path: &str) -> Result<Receiver, Error> {
        let slot = self.shared.catalogue.declared(path)?;
        let declaration = self.shared.catalogue.topics()[slot.index()];
        let mut exchange = self.exchange();
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

    /// For those outside agents: reads what is published here on one topic (`soccer/ball`), those directly under a path
    /// (`soccer/*`), or all under it (`soccer/**`, `**`). A pattern that fits no topic is an error.
    pub fn subscriber(&self, pattern: &str) -> Result<Subscriber, Error> {
        self.subscriber_of(HostId::LOCAL, pattern)
    }

    /// As [`subscriber`](Narukom::subscriber), for what has come from another host.
    pub fn subscriber_of(&self, host: HostId, pattern: &str) -> Result<Subscriber, Error> {
        Ok(Subscriber::new(self.clone(), host, self.matching(pattern)?))
    }

    /// As [`subscriber`](Narukom::subscriber), for bytes: for links and recorders.
    pub fn tap(&self, pattern: &str) -> Result<Tap, Error> {
        Ok(Tap::new(self.clone(), self.matching(pattern)?))
    }

    /// Lets `observer` see everything that is published from now on.
    pub fn observe(&self, observer: Box<dyn Observer>) {
        self.observers().all.push(observer);
        self.shared.is_observed.store(true, Ordering::Release);
    }

    /// Whether anybody observes it.
    pub fn is_observed(&self) -> bool {
        self.shared.is_observed.load(Ordering::Acquire)
    }

    /// Lets `waker` know of publications from now on, in place of the one before.
    pub fn set_waker(&self, waker: Arc<dyn Waker>) {
        self.exchange().waker = Some(waker);
    }
}

/// The way in.
impl Narukom {
    /// Whether both are handles to one hub.
    pub(crate) fn is(&self, other: &Narukom) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    #[inline]
    pub(crate) fn catalogue(&self) -> &Catalogue {
        &self.shared.catalogue
    }

    /// The number of the last publication.
    #[inline]
    pub(crate) fn head(&self) -> u64 {
        self.shared.head.last()
    }

    /// On which channel the last publication was, if that is number `last`.
    #[inline]
    pub(crate) fn channel_of_last(&self, last: u64) -> Option<Channel> {
        self.shared.head.channel_of_last(last)
    }

    /// On which channels the publications later than number `since` were, up to `last`; none if that is no longer known.
    #[inline]
    pub(crate) fn recent(&self, since: u64, last: u64) -> Option<Recent> {
        self.shared.head.recent(since, last)
    }

    /// What the hub holds, each message in its ring.
    pub(crate) fn exchange(&self) -> MutexGuard<'_, Exchange> {
        let mut exchange = self.unshelved();
        exchange.shelve();
        exchange
    }

    /// As [`exchange`](Narukom::exchange), but the last publication may still be at the front.
    #[inline]
    pub(crate) fn unshelved(&self) -> MutexGuard<'_, Exchange> {
        self.shared.exchange.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn observers(&self) -> MutexGuard<'_, Observers> {
        self.shared.observers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn sender(&self, name: &str) -> Sender {
        self.exchange().sender(name)
    }

    /// Publishes messages at once: a reader sees all of them or none. Their headers are completed.
    pub(crate) fn send(&self, sender: &Sender, outgoing: &mut [Outgoing], now: Moment) {
        self.pass(self.host(), sender, outgoing, |exchange, message, is_observed| {
            exchange.publish(message, now, is_observed);
        });
    }

    /// Takes in what another host published.
    pub(crate) fn take_in(&self, host: &str, sender: &Sender, message: &mut Outgoing) {
        self.pass(host, sender, std::slice::from_mut(message), Exchange::receive);
    }

    /// Enters messages one by one under the lock, shows them to the observers, and wakes who waits for them.
    fn pass(
        &self,
        host: &str,
        sender: &Sender,
        outgoing: &mut [Outgoing],
        enter: impl Fn(&mut Exchange, &mut Outgoing, bool),
    ) {
        if outgoing.is_empty() {
            return;
        }
        let observers = self.is_observed().then(|| self.observers());
        let mut exchange = self.unshelved();
        let head = &self.shared.head;
        for message in &mut *outgoing {
            let before = exchange.order();
            enter(&mut exchange, message, observers.is_some());
            if exchange.order() != before {
                head.note(exchange.order(), message.header.channel());
            }
        }
        let waker = exchange.waker.clone();
        // The last thing before the lock is free: who polls the head wants the lock at once.
        head.move_to(exchange.order());
        drop(exchange);
        if let Some(mut observers) = observers {
            outgoing.iter_mut().for_each(|message| self.show(&mut observers, host, sender, message));
        }
        if let Some(waker) = waker {
            outgoing.iter().for_each(|message| waker.wake(message.header.topic, message.header.host));
        }
    }

    fn show(&self, observers: &mut Observers, host: &str, sender: &Sender, message: &mut Outgoing) {
        let header = message.header;
        let (Some(topic), Some(content)) = (self.declaration(header.topic), message.message.take()) else {
            return;
        };
        let Observers { all, encoding } = observers;
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

impl fmt::Debug for Narukom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Narukom({}, {} topics)", self.host(), self.topics().len())
    }
}
