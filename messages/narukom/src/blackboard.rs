//! The blackboard: the messages that one agent, or one region of a statechart, reads in a cycle.

mod adopt;
mod erased;
mod topic_entry;
mod view;

use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use crate::cancellation::Cancellation;
use crate::encoding::check_type;
use crate::error::{Error, ErrorKind};
use crate::history::SurroundingSamples;
use crate::hub::Hub;
use crate::hub_state::{HubState, OutgoingMessage};
use crate::inbox::{Delivery, DeliveryWindow, Inbox, ReaderView};
use crate::message::{AnyMessage, Message};
use crate::outbox::Outbox;
use crate::random::Random;
use crate::ring::WriterId;
use crate::sample::Sender;
use crate::sample::{AnySample, Channel, Header, HostId, Sample, TopicSlot};
use crate::timestamp::Timestamp;
use crate::topic::{self, Retention, Signal, Timed, Topic};

use topic_entry::TopicEntry;

pub use view::HostView;

/// The most messages that can wait for one call of `publish_all`; more are refused.
pub const OUTBOX_LIMIT: usize = 65_536;

/// The most raised events that are kept until they are collected; older ones are dropped.
pub const EVENT_LIMIT: usize = 4096;

/// The consistent view of all topics during a cycle of one agent or one region of a statechart, and
/// the messages that it writes.
///
/// A cycle begins with [`process_messages`](Blackboard::process_messages), which delivers what
/// others have published, and ends with [`publish_all`](Blackboard::publish_all), which publishes
/// what was written. In between the view changes only by the owner's own writes, which are visible
/// at once.
///
/// The first read of a topic subscribes the blackboard to it, retroactively: the read returns what
/// the last `process_messages` would have delivered.
pub struct Blackboard {
    hub: Hub,
    sender: Sender,
    number: u32,
    entries: Box<[TopicEntry]>,
    /// The topics with an inbox, of each host, in order of first read.
    attached: RefCell<Vec<Channel>>,
    /// The topics with an outbox, in order of first write.
    written: Vec<TopicSlot>,
    /// The topics of the messages that wait for `publish_all`, in order of writing.
    outbox: Vec<TopicSlot>,
    /// Buffer in which `publish_all` collects messages; kept to reuse its memory.
    outgoing: Vec<OutgoingMessage>,
    /// The topics that have work to do at the end of the cycle.
    open: RefCell<Vec<Channel>>,
    delivery: Delivery,
    window: DeliveryWindow,
    now: Timestamp,
    random: Random,
    events: VecDeque<String>,
    events_lost: u64,
    cancellation: Cancellation,
}

/// Constructors.
impl Hub {
    /// Creates a blackboard for an agent, or for a region of one, that publishes under the name
    /// `publisher`. Several blackboards may share a name.
    pub fn blackboard(&self, publisher: &str) -> Blackboard {
        let number = self.next_blackboard();
        Blackboard::new(self.clone(), self.sender(publisher), number)
    }
}

impl Blackboard {
    pub(crate) fn new(hub: Hub, sender: Sender, number: u32) -> Blackboard {
        let entries = hub.topics().iter().map(|_| TopicEntry::default()).collect();
        let random = Random::from_seed(default_seed(hub.host(), &sender.name));
        let head = hub.last_publication();
        Blackboard {
            hub,
            sender,
            number,
            entries,
            attached: RefCell::default(),
            written: Vec::new(),
            outbox: Vec::new(),
            outgoing: Vec::new(),
            open: RefCell::default(),
            delivery: Delivery::default(),
            // Signals published before the blackboard existed are not delivered; states and
            // histories are.
            window: DeliveryWindow { since: head, delivered: 0 },
            now: Timestamp::ZERO,
            random,
            events: VecDeque::new(),
            events_lost: 0,
            cancellation: Cancellation::default(),
        }
    }

    /// Sets the part number of one of several blackboards that publish under one name. Their
    /// messages share sequence numbers; [`Header::part`](crate::Header::part) distinguishes them in
    /// recordings of agents with several threads.
    pub fn of_part(mut self, part: u16) -> Blackboard {
        self.sender.part = part;
        self
    }

    /// The part number among the blackboards of one publisher name, from 0.
    pub fn part(&self) -> u16 {
        self.sender.part
    }
}

/// Begin and end of a cycle.
impl Blackboard {
    /// Begins a cycle: drops the signals of the last cycle and delivers what was published on the
    /// hub since then.
    pub fn process_messages(&mut self, now: Timestamp) {
        self.now = now;
        self.close();
        self.delivery.arrivals.clear();
        self.window.since = self.window.since.max(self.window.delivered);
        let last = self.hub.last_publication();
        if last != self.window.delivered {
            self.deliver(last);
        }
    }

    /// Ends a cycle: publishes everything written since the last call, at time `now`, in the order
    /// in which it was written. Readers see all of it or none.
    pub fn publish_all(&mut self, now: Timestamp) {
        for slot in self.outbox.drain(..) {
            let Some(writing) = self.entries[slot.index()].writing.as_mut() else { continue };
            let Some((message, nth)) = writing.take_next() else { continue };
            let header = Header::local(&self.sender, slot, now);
            let origin = WriterId { blackboard: self.number, nth };
            self.outgoing.push(OutgoingMessage::new(AnySample { message, header }, origin));
        }
        self.hub.send(&self.sender, &mut self.outgoing, now);
        for OutgoingMessage { header, origin, evicted: left, .. } in self.outgoing.drain(..) {
            if let Some(writing) = self.entries[header.topic.index()].writing.as_mut() {
                writing.complete(origin.nth, header, left);
            }
        }
    }

    /// The number of publications on the hub, over all topics, at the last delivery (or at
    /// creation).
    pub fn position(&self) -> u64 {
        self.window.since.max(self.window.delivered)
    }

    /// Whether there are written messages that [`publish_all`](Blackboard::publish_all) has not
    /// published.
    pub fn has_unpublished(&self) -> bool {
        !self.outbox.is_empty()
    }

    /// The time at which the cycle began.
    pub fn now(&self) -> Timestamp {
        self.now
    }

    /// The topics of the messages of the last delivery that were published on this host, one per
    /// message, in order of publication. Own messages are included when the hub delivers them.
    pub fn arrivals(&self) -> impl Iterator<Item = TopicSlot> {
        self.from(HostId::LOCAL).arrivals()
    }

    /// Drops what is valid for one cycle only.
    fn close(&mut self) {
        if self.open.get_mut().is_empty() {
            return;
        }
        let mut open = self.open.take();
        open.retain(|channel| self.entries[channel.topic.index()].close(channel.host));
        self.open = RefCell::new(open);
    }

    /// Delivers publications up to at least number `last`. Takes no lock if none of them is read
    /// here.
    fn deliver(&mut self, last: u64) {
        if last == self.window.delivered + 1
            && let Some(channel) = self.hub.channel_of_last(last)
            && (!self.reads(channel) || self.deliver_last(last, channel))
        {
            self.window.delivered = last;
            return;
        }
        let recent = self.hub.recent(self.window.delivered, last);
        if recent.is_some_and(|recent| !recent.channels().any(|channel| self.reads(channel))) {
            self.window.delivered = last;
            return;
        }
        let exchange = self.hub.state();
        // More may have been published in between.
        let recent = recent.filter(|_| exchange.last_publication() == last);
        let mut delivering = DeliveryPass {
            exchange: &exchange,
            number: self.number,
            now: self.now,
            entries: &mut self.entries,
            open: self.open.get_mut(),
            delivery: &mut self.delivery,
        };
        if let Some(moved) = recent {
            moved.channels().for_each(|channel| delivering.channel(channel));
        } else if let Some(moved) = exchange.channels_since(self.window.delivered) {
            moved.for_each(|channel| delivering.channel(channel));
        } else {
            self.attached.get_mut().iter().for_each(|channel| delivering.channel(*channel));
        }
        self.window.delivered = exchange.last_publication();
        drop(exchange);
        self.delivery.leaving.clear();
        self.delivery.arrivals.sort_unstable();
    }

    /// Delivers the only publication since the last delivery if it is still the front entry.
    #[inline]
    fn deliver_last(&mut self, last: u64, channel: Channel) -> bool {
        // Messages published before the blackboard was created may already have been read, and
        // signals among them are not delivered.
        if self.window.delivered < self.window.since {
            return false;
        }
        let entry = &mut self.entries[channel.topic.index()];
        let reader = entry.reader(self.number, channel.host);
        let Some(reading) = entry.inbox_mut(channel.host) else { return false };
        let was_open = reading.is_open();
        let exchange = self.hub.state_with_front();
        let Some(entry) = exchange.front_entry(last) else { return false };
        let (sample, origin) = (entry.sample.clone(), entry.origin);
        drop(exchange);
        reading.deliver_next(last, sample, origin, reader, &mut self.delivery);
        reading.expire(self.now, &mut self.delivery.leaving);
        if reading.is_open() && !was_open {
            self.open.get_mut().push(channel);
        }
        self.delivery.leaving.clear();
        true
    }

    /// Whether messages of a channel are delivered here.
    fn reads(&self, channel: Channel) -> bool {
        self.entries.get(channel.topic.index()).is_some_and(|entry| entry.inbox(channel.host).is_some())
    }

    fn reader(&self, channel: Channel) -> ReaderView {
        self.entries[channel.topic.index()].reader(self.number, channel.host)
    }
}

/// The parts of a blackboard that a delivery changes while it holds the hub's lock.
struct DeliveryPass<'a> {
    exchange: &'a HubState,
    number: u32,
    now: Timestamp,
    entries: &'a mut [TopicEntry],
    open: &'a mut Vec<Channel>,
    delivery: &'a mut Delivery,
}

impl DeliveryPass<'_> {
    /// Delivers what was published on a channel if the channel is read here.
    fn channel(&mut self, channel: Channel) {
        let entry = &mut self.entries[channel.topic.index()];
        let reader = entry.reader(self.number, channel.host);
        let Some(reading) = entry.inbox_mut(channel.host) else { return };
        let Some(ring) = self.exchange.ring(channel) else { return };
        let was_open = reading.is_open();
        reading.deliver(ring, reader, self.delivery);
        reading.expire(self.now, &mut self.delivery.leaving);
        if reading.is_open() && !was_open {
            self.open.push(channel);
        }
    }
}

/// Cancellation of the activity that uses the blackboard.
impl Blackboard {
    /// Whether the activity that uses this blackboard should return soon, because its state is
    /// being left or the run ends. Long computations check this regularly.
    pub fn is_cancelled(&self) -> bool {
        self.cancellation.is_requested()
    }

    /// The cancellation token of this blackboard.
    pub fn cancellation(&self) -> &Cancellation {
        &self.cancellation
    }
}

/// Random numbers and events.
impl Blackboard {
    /// The agent's random number generator.
    pub fn random(&mut self) -> &mut Random {
        &mut self.random
    }

    /// Seeds the random number generator. Without a call, the seed is derived from the names of
    /// host and publisher.
    pub fn set_random(&mut self, seed: [u8; 32]) {
        self.random = Random::from_seed(seed);
    }

    /// Raises an event in the statechart whose activity uses this blackboard; the runtime collects
    /// it. If more than [`EVENT_LIMIT`] events are waiting, the oldest are
    /// [lost](Blackboard::events_lost).
    pub fn raise(&mut self, event: &str) {
        if self.events.len() == EVENT_LIMIT {
            self.events.pop_front();
            self.events_lost += 1;
        }
        self.events.push_back(event.to_owned());
    }

    /// The events raised since the last call, oldest first.
    pub fn take_events(&mut self) -> Vec<String> {
        std::mem::take(&mut self.events).into()
    }

    /// The number of events dropped before they were collected.
    pub fn events_lost(&self) -> u64 {
        self.events_lost
    }
}

impl fmt::Debug for Blackboard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Blackboard({} on {} at {})", self.sender.name, self.hub.host(), self.now)
    }
}

/// A seed derived from names, so that a blackboard without an explicit seed behaves the same in
/// each run.
fn default_seed(host: &str, publisher: &str) -> [u8; 32] {
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&topic::hash(host).to_le_bytes());
    seed[8..16].copy_from_slice(&topic::hash(publisher).to_le_bytes());
    seed
}

/// Reading what is published on this host.
impl Blackboard {
    /// The topics of another host as delivered here; with [`HostId::LOCAL`], those of this host.
    /// [`Hub::host_id`](crate::Hub::host_id) maps a name to its number.
    #[inline]
    pub fn from(&self, host: HostId) -> HostView<'_> {
        HostView { blackboard: self, host }
    }

    /// The newest message of a topic; of a signal topic, the newest of this cycle. `None` also if
    /// the hub was created without the topic.
    pub fn read<K: Retention>(&self, topic: Topic<K>) -> Option<&K::Message> {
        self.from(HostId::LOCAL).read(topic)
    }

    /// Like [`read`](Blackboard::read), with the header.
    pub fn sample<K: Retention>(&self, topic: Topic<K>) -> Option<Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).sample(topic)
    }

    /// The signals of this cycle, oldest first.
    ///
    /// Each blackboard sees a signal in exactly one cycle. It sees its own signals at once, or, if
    /// it has not read the topic by the next delivery, together with all other readers.
    pub fn signals<M: Message>(&self, topic: Topic<Signal<M>>) -> impl Iterator<Item = Sample<'_, M>> {
        self.from(HostId::LOCAL).signals(topic)
    }

    /// The messages of a history that are at most `age` old, oldest first.
    pub fn recent<K: Timed>(
        &self,
        topic: Topic<K>,
        age: Duration,
    ) -> impl DoubleEndedIterator<Item = Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).recent(topic, age)
    }

    /// The message of a history that was published nearest to `moment`; the earlier one if two are
    /// equally near. Of several published at that time it is the nearest in the order of the
    /// history.
    pub fn nearest<K: Timed>(&self, topic: Topic<K>, moment: Timestamp) -> Option<Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).nearest(topic, moment)
    }

    /// The last message of a history that was published at or before `moment`.
    pub fn nearest_not_newer<K: Timed>(
        &self,
        topic: Topic<K>,
        moment: Timestamp,
    ) -> Option<Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).nearest_not_newer(topic, moment)
    }

    /// The first message of a history that was published at or after `moment`.
    pub fn nearest_not_older<K: Timed>(
        &self,
        topic: Topic<K>,
        moment: Timestamp,
    ) -> Option<Sample<'_, K::Message>> {
        self.from(HostId::LOCAL).nearest_not_older(topic, moment)
    }

    /// The two messages of a history between which `moment` lies, for interpolation. `None` if it
    /// lies outside of the history.
    pub fn around<K: Timed>(
        &self,
        topic: Topic<K>,
        moment: Timestamp,
    ) -> Option<SurroundingSamples<'_, K::Message>> {
        self.from(HostId::LOCAL).around(topic, moment)
    }

    /// The number of messages of a topic that left the hub before they were delivered here. A state
    /// topic loses none, since only the latest message counts.
    pub fn lost<K: Retention>(&self, topic: Topic<K>) -> u64 {
        self.from(HostId::LOCAL).lost(topic)
    }

    /// The inbox of a channel, created if necessary.
    #[inline]
    fn attach(&self, channel: Channel) -> Option<&Inbox> {
        let entry = self.entries.get(channel.topic.index())?;
        match entry.inbox(channel.host) {
            Some(reading) => Some(reading),
            None => Some(self.keep(channel, self.attached_reading(channel)?)),
        }
    }

    /// The inbox of a channel as if it had been read from the start.
    fn attached_reading(&self, channel: Channel) -> Option<Inbox> {
        let topic = self.hub.declaration(channel.topic)?;
        let exchange = self.hub.state();
        Some(Inbox::attach(topic, exchange.ring(channel), self.reader(channel), self.window))
    }

    /// Inserts a new inbox.
    fn keep(&self, channel: Channel, reading: Inbox) -> &Inbox {
        if reading.is_open() {
            self.open.borrow_mut().push(channel);
        }
        self.attached.borrow_mut().push(channel);
        self.entries[channel.topic.index()].insert_inbox(channel.host, reading)
    }
}

/// Writing.
impl Blackboard {
    /// Writes a message. It is readable here at once and published by
    /// [`publish_all`](Blackboard::publish_all).
    ///
    /// # Errors
    /// The hub was created without the topic, or more than [`OUTBOX_LIMIT`] messages wait.
    pub fn publish<K: Retention>(&mut self, topic: Topic<K>, message: K::Message) -> Result<(), Error> {
        let slot = self.hub.topic_table().checked(topic)?;
        self.room()?;
        self.queue(slot, |writing, header| {
            let message = writing.pool().wrap(message);
            writing.write(AnySample { message, header });
        });
        Ok(())
    }

    /// Like [`publish`](Blackboard::publish), but `make` fills a default message in place: large
    /// messages need not be moved, and strings, bytes and lists reuse the memory of earlier ones.
    ///
    /// # Errors
    /// As for [`publish`](Blackboard::publish).
    pub fn publish_with<K: Retention>(
        &mut self,
        topic: Topic<K>,
        make: impl FnOnce(&mut K::Message),
    ) -> Result<(), Error> {
        let slot = self.hub.topic_table().checked(topic)?;
        self.room()?;
        self.queue(slot, |writing, header| {
            let message = writing.pool().build(make);
            writing.write(AnySample { message, header });
        });
        Ok(())
    }

    /// Like [`publish`](Blackboard::publish), for a topic known at run time.
    ///
    /// # Errors
    /// As for [`publish`](Blackboard::publish); also if the message does not have the topic's type.
    pub fn publish_by_name(&mut self, path: &str, message: Box<dyn AnyMessage>) -> Result<(), Error> {
        let slot = self.hub.topic_table().declared(path)?;
        self.room()?;
        self.hub.declaration(slot).map_or(Ok(()), |topic| check_type(topic, &*message))?;
        self.queue(slot, |writing, header| writing.write(AnySample { message: Arc::from(message), header }));
        Ok(())
    }

    /// Like [`publish_by_name`](Blackboard::publish_by_name), for an encoded message; it is decoded
    /// once, here.
    ///
    /// # Errors
    /// As for [`publish`](Blackboard::publish); also if the bytes do not encode a message of the
    /// topic's type or are longer than [`ENCODED_LIMIT`](crate::ENCODED_LIMIT).
    pub fn publish_bytes(&mut self, path: &str, bytes: &[u8]) -> Result<(), Error> {
        let slot = self.hub.topic_table().declared(path)?;
        self.room()?;
        let Some(writing) = self.outbox(slot) else { return Ok(()) };
        let message = writing.decoded(bytes)?;
        self.queue(slot, |writing, header| writing.write(AnySample { message, header }));
        Ok(())
    }

    /// Changes a topic's message: `change` is called with a copy of the newest message, or with a
    /// default message. Further edits of the topic before [`publish_all`](Blackboard::publish_all)
    /// change the same copy, which is published once.
    ///
    /// # Errors
    /// There is no such topic, or more than [`OUTBOX_LIMIT`] messages wait.
    pub fn edit(&mut self, slot: TopicSlot, change: impl FnOnce(&mut dyn AnyMessage)) -> Result<(), Error> {
        if self.hub.declaration(slot).is_none() {
            let text = format!("there is no topic of number {}", slot.number());
            return Err(Error::new(ErrorKind::UndeclaredTopic, text));
        }
        if !self.outbox(slot).is_some_and(|writing| writing.has_draft()) {
            self.room()?;
            let local = self.from(HostId::LOCAL);
            let reading = self.attach(Channel::local(slot));
            let source = reading.and_then(|reading| local.newest(slot, reading)).cloned();
            self.queue(slot, |writing, header| writing.begin_draft(source.as_ref(), header));
        }
        if let Some(writing) = self.outbox(slot) {
            writing.change_draft(change);
        }
        Ok(())
    }

    /// Fails if no more messages may wait.
    fn room(&self) -> Result<(), Error> {
        if self.outbox.len() < OUTBOX_LIMIT {
            return Ok(());
        }
        let text = format!("`{}` has {OUTBOX_LIMIT} messages that wait for `publish_all`", self.sender.name);
        Err(Error::new(ErrorKind::OutboxFull, text))
    }

    fn outbox(&mut self, slot: TopicSlot) -> Option<&mut Outbox> {
        let topic = self.hub.declaration(slot)?;
        let writing = &mut self.entries.get_mut(slot.index())?.writing;
        if writing.is_none() {
            self.written.push(slot);
        }
        Some(writing.get_or_insert_with(|| Box::new(Outbox::new(topic))))
    }

    /// Writes a message and queues its topic for publication.
    fn queue(&mut self, slot: TopicSlot, write: impl FnOnce(&mut Outbox, Header)) {
        let header = Header::local(&self.sender, slot, self.now);
        let Some(writing) = self.outbox(slot) else { return };
        let was_open = writing.is_open();
        write(writing, header);
        self.outbox.push(slot);
        if !was_open {
            self.open.get_mut().push(Channel::local(slot));
        }
    }
}
