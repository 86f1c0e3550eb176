//! The blackboard: what one agent, or one region of a statechart, knows during a cycle.

use std::cell::{OnceCell, RefCell};
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use crate::error::{Error, ErrorKind};
use crate::history::{self, History};
use crate::hub::{Narukom, Outgoing, Sender};
use crate::message::{AnyMessage, Message};
use crate::moment::Moment;
use crate::random::Random;
use crate::reading::{Reader, Reading, Window};
use crate::ring::Origin;
use crate::sample::{AnySample, Header, HostId, Sample, TopicSlot};
use crate::topic::{self, Data, Keep, Kind, Signal, Topic};
use crate::writing::Writing;

/// More messages than this between two calls of `publish_all` are refused.
pub const OUTBOX_LIMIT: usize = 65_536;

/// What one agent, or one region of a statechart, knows during a cycle, and what it has to say.
///
/// A cycle begins with [`process_messages`](Blackboard::process_messages), which delivers what others have published, and ends with
/// [`publish_all`](Blackboard::publish_all), which publishes what was written. Between the two nothing moves but by the owner's own
/// writing, which it reads at once.
///
/// The first read of a topic makes the blackboard a reader of it, as though it had been one from the start: it finds what the
/// last `process_messages` would have delivered.
pub struct Blackboard {
    hub: Narukom,
    sender: Sender,
    number: u32,
    places: Box<[Place]>,
    /// The topics with a reading, in order of first read.
    attached: RefCell<Vec<TopicSlot>>,
    /// The topics with a writing, in order of first write.
    written: Vec<TopicSlot>,
    /// The topics of the messages that wait for `publish_all`, in order.
    outbox: Vec<TopicSlot>,
    /// Where `publish_all` collects them; kept for its memory.
    outgoing: Vec<Outgoing>,
    /// The topics on which something ends with the cycle.
    open: RefCell<Vec<TopicSlot>>,
    /// The messages of the last delivery: number and topic.
    arrivals: Vec<(u64, TopicSlot)>,
    window: Window,
    now: Moment,
    random: Random,
    events: Vec<String>,
}

/// What a blackboard has of one topic.
#[derive(Default)]
struct Place {
    reading: OnceCell<Box<Reading>>,
    writing: Option<Box<Writing>>,
}

/// The edges of a cycle.
impl Blackboard {
    pub(crate) fn new(hub: Narukom, sender: Sender, number: u32) -> Blackboard {
        let places = hub.topics().iter().map(|_| Place::default()).collect();
        let random = Random::from_seed(default_seed(hub.host(), &sender.name));
        let head = hub.head();
        Blackboard {
            hub,
            sender,
            number,
            places,
            attached: RefCell::default(),
            written: Vec::new(),
            outbox: Vec::new(),
            outgoing: Vec::new(),
            open: RefCell::default(),
            arrivals: Vec::new(),
            // Signals from before its time are not for it; states and histories are.
            window: Window { since: head, delivered: 0 },
            now: Moment::ZERO,
            random,
            events: Vec::new(),
        }
    }

    /// Begins a cycle: signals of the last one end, and what was published on the hub since then is delivered.
    pub fn process_messages(&mut self, now: Moment) {
        self.now = now;
        self.close();
        self.arrivals.clear();
        self.window.since = self.window.since.max(self.window.delivered);
        if self.hub.head() != self.window.delivered {
            self.deliver();
        }
    }

    /// Ends a cycle: everything written since the last time is published, at `now`, in the order in which it was
    /// written. Readers see all of it or none.
    pub fn publish_all(&mut self, now: Moment) {
        for slot in self.outbox.drain(..) {
            let Some(writing) = self.places[slot.index()].writing.as_mut() else { continue };
            let Some((sample, nth)) = writing.take_next() else { continue };
            self.outgoing.push(Outgoing { sample, origin: Origin { blackboard: self.number, nth } });
        }
        self.hub.send(&self.sender, &mut self.outgoing, now);
        for Outgoing { sample, origin } in self.outgoing.drain(..) {
            if let Some(writing) = self.places[sample.header.topic.index()].writing.as_mut() {
                writing.complete(origin.nth, sample.header);
            }
        }
    }

    /// The moment at which the cycle began.
    pub fn now(&self) -> Moment {
        self.now
    }

    /// The topics of the messages of the last delivery, one for each message, in order of publication. Own messages
    /// are among them when they come back.
    pub fn arrivals(&self) -> impl ExactSizeIterator<Item = TopicSlot> {
        self.arrivals.iter().map(|(_, slot)| *slot)
    }

    /// Takes over what `other` reads at this point: what was delivered to it, and its own unpublished states and data (its
    /// unpublished signals come as to everybody, when they are published). What is written here and unpublished remains to be
    /// published, but is no longer read. Both must be of one hub; else nothing happens.
    pub fn adopt(&mut self, other: &Blackboard) {
        if !self.hub.is(&other.hub) {
            return;
        }
        self.now = other.now;
        self.window = other.window;
        self.adopt_readings(other);
        self.adopt_writings(other);
    }

    fn adopt_readings(&mut self, other: &Blackboard) {
        for slot in other.attached.borrow().iter() {
            if self.places[slot.index()].reading.get().is_none() {
                self.attached.get_mut().push(*slot);
            }
        }
        for slot in self.attached.take() {
            let interest = self.is_read(slot);
            self.places[slot.index()].reading = OnceCell::new();
            if let Some(theirs) = other.places[slot.index()].reading.get() {
                self.keep(slot, theirs.clone());
            }
            let Some(reading) = self.attach(slot) else { continue };
            reading.set_interest(interest);
        }
    }

    fn adopt_writings(&mut self, other: &Blackboard) {
        for place in 0..self.written.len() {
            if let Some(writing) = self.places[self.written[place].index()].writing.as_mut() {
                writing.inherit([].into_iter());
            }
        }
        for slot in &other.written {
            let is_signal = self.hub.declaration(*slot).is_some_and(|topic| topic.kind() == Kind::Signal);
            let theirs = other.places[slot.index()].writing.as_ref().filter(|writing| writing.is_open());
            let (false, Some(theirs)) = (is_signal, theirs) else { continue };
            if let Some(writing) = self.writing(*slot) {
                writing.inherit(theirs.visible());
                self.open.get_mut().push(*slot);
            }
        }
    }

    /// What ends with the cycle ends.
    fn close(&mut self) {
        let mut open = self.open.take();
        open.retain(|slot| {
            let place = &mut self.places[slot.index()];
            if let Some(reading) = place.reading.get_mut() {
                reading.close();
            }
            place.writing.as_mut().is_some_and(|writing| {
                writing.close();
                writing.is_open()
            })
        });
        self.open = RefCell::new(open);
    }

    fn deliver(&mut self) {
        let hub = self.hub.clone();
        let exchange = hub.exchange();
        match exchange.journal_since(self.window.delivered) {
            Some(moved) => moved.for_each(|slot| self.deliver_topic(slot, exchange.ring(slot))),
            None => {
                let attached = self.attached.take();
                attached.iter().for_each(|slot| self.deliver_topic(*slot, exchange.ring(*slot)));
                self.attached = RefCell::new(attached);
            }
        }
        self.window.delivered = exchange.order();
        drop(exchange);
        self.arrivals.sort_unstable();
    }

    fn deliver_topic(&mut self, slot: TopicSlot, ring: Option<&crate::ring::Ring>) {
        let reader = self.reader(slot);
        let (Some(reading), Some(ring)) = (self.places[slot.index()].reading.get_mut(), ring) else { return };
        let was_open = reading.is_open();
        reading.deliver(ring, reader, &mut self.arrivals);
        if reading.is_open() && !was_open {
            self.open.get_mut().push(slot);
        }
    }

    fn reader(&self, slot: TopicSlot) -> Reader {
        let seen = self.places[slot.index()].writing.as_ref().map_or(0, |writing| writing.seen());
        Reader { blackboard: self.number, seen }
    }
}

/// Reading.
impl Blackboard {
    /// The newest message of a topic: of a signal topic, of this cycle only.
    pub fn read<K: Keep>(&self, topic: Topic<K>) -> Option<&K::Message> {
        self.sample(topic).map(|sample| sample.message)
    }

    /// As [`read`](Blackboard::read), with the header.
    pub fn sample<K: Keep>(&self, topic: Topic<K>) -> Option<Sample<'_, K::Message>> {
        self.newest(self.slot_of(topic)?)?.downcast()
    }

    /// The signals of this cycle, oldest first.
    ///
    /// Each blackboard sees a signal in one cycle. Its own it sees at once or, if nobody here has looked by the next
    /// delivery, then, as everybody else does.
    pub fn signals<M: Message>(&self, topic: Topic<Signal<M>>) -> impl Iterator<Item = Sample<'_, M>> {
        self.history_of(topic).filter_map(AnySample::downcast)
    }

    /// The messages of a history that are at most `age` old, oldest first.
    pub fn recent<M: Message, const DEPTH: usize>(
        &self,
        topic: Topic<Data<M, DEPTH>>,
        age: Duration,
    ) -> impl Iterator<Item = Sample<'_, M>> {
        let oldest = self.now - age;
        let recent = self.history_of(topic).filter(move |sample| sample.header.published >= oldest);
        recent.filter_map(AnySample::downcast)
    }

    /// The message of a history that was published nearest to `moment`; of two equally near the earlier, of several at one
    /// moment the last.
    pub fn nearest<M: Message, const DEPTH: usize>(
        &self,
        topic: Topic<Data<M, DEPTH>>,
        moment: Moment,
    ) -> Option<Sample<'_, M>> {
        let history = self.history(self.slot_of(topic)?)?;
        history::nearer(history.not_newer(moment), history.not_older(moment), moment)?.downcast()
    }

    /// The last message of a history that was published at `moment` or before.
    pub fn nearest_not_newer<M: Message, const DEPTH: usize>(
        &self,
        topic: Topic<Data<M, DEPTH>>,
        moment: Moment,
    ) -> Option<Sample<'_, M>> {
        self.history(self.slot_of(topic)?)?.not_newer(moment)?.downcast()
    }

    /// The first message of a history that was published at `moment` or after.
    pub fn nearest_not_older<M: Message, const DEPTH: usize>(
        &self,
        topic: Topic<Data<M, DEPTH>>,
        moment: Moment,
    ) -> Option<Sample<'_, M>> {
        self.history(self.slot_of(topic)?)?.not_older(moment)?.downcast()
    }

    /// How many messages of a topic were gone before they could be delivered here. States lose none: only the latest counts.
    pub fn lost<K: Keep>(&self, topic: Topic<K>) -> u64 {
        self.slot_of(topic).map_or(0, |slot| self.lost_at(slot))
    }

    fn slot_of<K: Keep>(&self, topic: Topic<K>) -> Option<TopicSlot> {
        self.hub.catalogue().by_hash(topic.hash())
    }

    fn newest(&self, slot: TopicSlot) -> Option<&AnySample> {
        let reading = self.attach(slot)?;
        reading.set_interest(true);
        self.peek(slot, reading)
    }

    fn peek<'a>(&'a self, slot: TopicSlot, reading: &'a Reading) -> Option<&'a AnySample> {
        let own = self.places[slot.index()].writing.as_ref().and_then(|writing| {
            writing.mark_seen();
            writing.visible().next_back()
        });
        own.or_else(|| reading.samples().back())
    }

    /// All messages of a topic, oldest first.
    fn history(&self, slot: TopicSlot) -> Option<History<'_>> {
        let topic = self.hub.declaration(slot)?;
        let depth = if topic.kind() == Kind::Data { topic.depth() } else { usize::MAX };
        let reading = self.attach(slot)?;
        reading.set_interest(true);
        let writing = self.places[slot.index()].writing.as_deref();
        writing.inspect(|writing| writing.mark_seen());
        Some(History::new(reading, writing, depth))
    }

    fn history_of<K: Keep>(&self, topic: Topic<K>) -> impl Iterator<Item = &AnySample> {
        let history = self.slot_of(topic).and_then(|slot| self.history(slot));
        history.into_iter().flat_map(History::iter)
    }

    /// The reading of a topic, made if need be.
    fn attach(&self, slot: TopicSlot) -> Option<&Reading> {
        let reading = &self.places.get(slot.index())?.reading;
        if reading.get().is_none() {
            let topic = self.hub.declaration(slot)?;
            let exchange = self.hub.exchange();
            let attached = Reading::attach(topic, exchange.ring(slot)?, self.reader(slot), self.window);
            drop(exchange);
            self.keep(slot, Box::new(attached));
        }
        reading.get().map(|reading| &**reading)
    }

    fn keep(&self, slot: TopicSlot, reading: Box<Reading>) {
        if reading.is_open() {
            self.open.borrow_mut().push(slot);
        }
        if self.places[slot.index()].reading.set(reading).is_ok() {
            self.attached.borrow_mut().push(slot);
        }
    }
}

/// Writing.
impl Blackboard {
    /// Writes a message, to be published by [`publish_all`](Blackboard::publish_all) and readable here at once. It is an error
    /// if the hub was made without the topic, or too many messages wait.
    pub fn publish<K: Keep>(&mut self, topic: Topic<K>, message: K::Message) -> Result<(), Error> {
        let slot = self.hub.catalogue().checked(topic)?;
        self.room()?;
        self.queue(slot, |writing, header| {
            let message = writing.pool().wrap(message);
            writing.write(AnySample { message, header });
        });
        Ok(())
    }

    /// As [`publish`](Blackboard::publish), for a topic known at run time.
    pub fn publish_by_name(&mut self, path: &str, message: Box<dyn AnyMessage>) -> Result<(), Error> {
        let slot = self.hub.topic(path).ok_or_else(|| self.hub.catalogue().undeclared(path))?;
        self.room()?;
        if let Some(topic) = self.hub.declaration(slot)
            && topic.message_type() != message.as_any().type_id()
        {
            return Err(crate::catalogue::wrong_type(topic, message.descriptor().full_name));
        }
        self.queue(slot, |writing, header| writing.write(AnySample { message: Arc::from(message), header }));
        Ok(())
    }

    /// Changes a topic's message: the newest is copied (or one with nothing set) and handed to `change`; more changes of the topic
    /// before [`publish_all`](Blackboard::publish_all) go into the same copy, which is published once.
    pub fn edit(&mut self, slot: TopicSlot, change: impl FnOnce(&mut dyn AnyMessage)) -> Result<(), Error> {
        if self.hub.declaration(slot).is_none() {
            let text = format!("there is no topic of number {}", slot.number());
            return Err(Error::new(ErrorKind::UndeclaredTopic, text));
        }
        if !self.writing(slot).is_some_and(|writing| writing.has_draft()) {
            self.room()?;
            let source = self.attach(slot).and_then(|reading| self.peek(slot, reading)).cloned();
            self.queue(slot, |writing, header| writing.begin_draft(source.as_ref(), header));
        }
        if let Some(writing) = self.writing(slot) {
            writing.change_draft(change);
        }
        Ok(())
    }

    fn room(&self) -> Result<(), Error> {
        if self.outbox.len() < OUTBOX_LIMIT {
            return Ok(());
        }
        let text = format!("`{}` has {OUTBOX_LIMIT} messages that wait for `publish_all`", self.sender.name);
        Err(Error::new(ErrorKind::OutboxFull, text))
    }

    fn header(&self, topic: TopicSlot) -> Header {
        let publisher = self.sender.publisher;
        Header { host: HostId::LOCAL, publisher, topic, sequence: 0, published: self.now, received: self.now }
    }

    fn writing(&mut self, slot: TopicSlot) -> Option<&mut Writing> {
        let topic = self.hub.declaration(slot)?;
        let writing = &mut self.places.get_mut(slot.index())?.writing;
        if writing.is_none() {
            self.written.push(slot);
        }
        Some(writing.get_or_insert_with(|| Box::new(Writing::new(topic))))
    }

    fn queue(&mut self, slot: TopicSlot, write: impl FnOnce(&mut Writing, Header)) {
        let header = self.header(slot);
        let Some(writing) = self.writing(slot) else { return };
        let was_open = writing.is_open();
        write(writing, header);
        self.outbox.push(slot);
        if !was_open {
            self.open.get_mut().push(slot);
        }
    }
}

/// Access by slot or name, for runtimes and tools.
impl Blackboard {
    /// The hub.
    pub fn hub(&self) -> &Narukom {
        &self.hub
    }

    /// The name under which it publishes.
    pub fn publisher(&self) -> &str {
        &self.sender.name
    }

    /// The slot of the topic at `path`.
    pub fn slot(&self, path: &str) -> Option<TopicSlot> {
        self.hub.topic(path)
    }

    /// The newest message of a topic: of a signal topic, of this cycle only.
    pub fn latest(&self, slot: TopicSlot) -> Option<&dyn AnyMessage> {
        self.newest(slot).map(|sample| &*sample.message)
    }

    /// As [`latest`](Blackboard::latest), with the header.
    pub fn latest_sample(&self, slot: TopicSlot) -> Option<&AnySample> {
        self.newest(slot)
    }

    /// As [`latest`](Blackboard::latest), for a topic known by its path.
    pub fn read_by_name(&self, path: &str) -> Option<&dyn AnyMessage> {
        self.latest(self.slot(path)?)
    }

    /// Reads a topic from now on, as a first read would.
    pub fn interest(&self, slot: TopicSlot) {
        if let Some(reading) = self.attach(slot) {
            reading.set_interest(true);
        }
    }

    /// Whether the topic has been read here.
    pub fn is_read(&self, slot: TopicSlot) -> bool {
        let reading = self.places.get(slot.index()).and_then(|place| place.reading.get());
        reading.is_some_and(|reading| reading.interest())
    }

    /// The topics that have been read here.
    pub fn topics_read(&self) -> Vec<TopicSlot> {
        let mut slots = self.attached.borrow().clone();
        slots.retain(|slot| self.is_read(*slot));
        slots
    }

    /// As [`lost`](Blackboard::lost), by slot.
    pub fn lost_at(&self, slot: TopicSlot) -> u64 {
        let reading = self.places.get(slot.index()).and_then(|place| place.reading.get());
        reading.map_or(0, |reading| reading.lost())
    }
}

/// Chance and events.
impl Blackboard {
    /// The agent's stream of random numbers.
    pub fn random(&mut self) -> &mut Random {
        &mut self.random
    }

    /// Begins the stream of random numbers that belongs to `seed`. Until then it belongs to the names of host and publisher.
    pub fn set_random(&mut self, seed: [u8; 32]) {
        self.random = Random::from_seed(seed);
    }

    /// Raises an event in the statechart whose activity this is; the runtime collects it.
    pub fn raise(&mut self, event: &str) {
        self.events.push(event.to_owned());
    }

    /// The events raised since the last call, oldest first.
    pub fn take_events(&mut self) -> Vec<String> {
        std::mem::take(&mut self.events)
    }
}

impl fmt::Debug for Blackboard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Blackboard({} on {} at {})", self.sender.name, self.hub.host(), self.now)
    }
}

/// A seed made of names, so that a blackboard without a seed of its own still behaves the same in each run.
fn default_seed(host: &str, publisher: &str) -> [u8; 32] {
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&topic::hash(host).to_le_bytes());
    seed[8..16].copy_from_slice(&topic::hash(publisher).to_le_bytes());
    seed
}
