//! The blackboard: what one agent, or one region of a statechart, knows during a cycle.

mod adopt;
mod erased;
mod place;
mod read;
mod view;
mod write;

use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt;

use crate::cancellation::Cancellation;
use crate::exchange::{Exchange, Outgoing, Sender};
use crate::hub::Narukom;
use crate::moment::Moment;
use crate::random::Random;
use crate::reading::{Delivery, Reader, Window};
use crate::ring::Origin;
use crate::sample::{AnySample, Channel, Header, HostId, TopicSlot};
use crate::topic;

use place::Place;

pub use view::View;

/// More messages than this between two calls of `publish_all` are refused.
pub const OUTBOX_LIMIT: usize = 65_536;

/// Of more events than this that nobody collects the oldest are lost.
pub const EVENT_LIMIT: usize = 4096;

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
    /// The topics with a reading, of each host, in order of first read.
    attached: RefCell<Vec<Channel>>,
    /// The topics with a writing, in order of first write.
    written: Vec<TopicSlot>,
    /// The topics of the messages that wait for `publish_all`, in order.
    outbox: Vec<TopicSlot>,
    /// Where `publish_all` collects them; kept for its memory.
    outgoing: Vec<Outgoing>,
    /// The topics on which something ends with the cycle.
    open: RefCell<Vec<Channel>>,
    delivery: Delivery,
    window: Window,
    now: Moment,
    random: Random,
    events: VecDeque<String>,
    events_lost: u64,
    cancellation: Cancellation,
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
            delivery: Delivery::default(),
            // Signals from before its time are not for it; states and histories are.
            window: Window { since: head, delivered: 0 },
            now: Moment::ZERO,
            random,
            events: VecDeque::new(),
            events_lost: 0,
            cancellation: Cancellation::default(),
        }
    }

    /// The same, as another of those that publish under one name: [`Header::part`](crate::Header::part) then tells their messages apart, which
    /// share their numbers. That is for recordings of agents with several threads.
    pub fn of_part(mut self, part: u16) -> Blackboard {
        self.sender.part = part;
        self
    }

    /// Which of those that publish under its name it is, from 0.
    pub fn part(&self) -> u16 {
        self.sender.part
    }

    /// Begins a cycle: signals of the last one end, and what was published on the hub since then is delivered.
    pub fn process_messages(&mut self, now: Moment) {
        self.now = now;
        self.close();
        self.delivery.arrivals.clear();
        self.window.since = self.window.since.max(self.window.delivered);
        let last = self.hub.head();
        if last != self.window.delivered {
            self.deliver(last);
        }
    }

    /// Ends a cycle: everything written since the last time is published, at `now`, in the order in which it was
    /// written. Readers see all of it or none.
    pub fn publish_all(&mut self, now: Moment) {
        for slot in self.outbox.drain(..) {
            let Some(writing) = self.places[slot.index()].writing.as_mut() else { continue };
            let Some((message, nth)) = writing.take_next() else { continue };
            let header = Header::local(&self.sender, slot, now);
            let origin = Origin { blackboard: self.number, nth };
            self.outgoing.push(Outgoing::new(AnySample { message, header }, origin));
        }
        self.hub.send(&self.sender, &mut self.outgoing, now);
        for Outgoing { header, origin, left, .. } in self.outgoing.drain(..) {
            if let Some(writing) = self.places[header.topic.index()].writing.as_mut() {
                writing.complete(origin.nth, header, left);
            }
        }
    }

    /// How many publications of the hub, of whatever topic, had happened when messages were last delivered here, or when it was made.
    pub fn position(&self) -> u64 {
        self.window.since.max(self.window.delivered)
    }

    /// Whether something was written that [`publish_all`](Blackboard::publish_all) has yet to publish.
    pub fn has_unpublished(&self) -> bool {
        !self.outbox.is_empty()
    }

    /// The moment at which the cycle began.
    pub fn now(&self) -> Moment {
        self.now
    }

    /// The topics of the messages of the last delivery that were published on this host, one for each message, in order of publication.
    /// Own messages are among them when they come back.
    pub fn arrivals(&self) -> impl Iterator<Item = TopicSlot> {
        self.from(HostId::LOCAL).arrivals()
    }

    /// What ends with the cycle ends.
    fn close(&mut self) {
        if self.open.get_mut().is_empty() {
            return;
        }
        let mut open = self.open.take();
        open.retain(|channel| self.places[channel.topic.index()].close(channel.host));
        self.open = RefCell::new(open);
    }

    /// Delivers what was published up to number `last` and later. If none of it is read here, the hub is not asked for it.
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
        let exchange = self.hub.exchange();
        // More may have come in between.
        let recent = recent.filter(|_| exchange.order() == last);
        let mut delivering = Delivering {
            exchange: &exchange,
            number: self.number,
            now: self.now,
            places: &mut self.places,
            open: self.open.get_mut(),
            delivery: &mut self.delivery,
        };
        if let Some(moved) = recent {
            moved.channels().for_each(|channel| delivering.channel(channel));
        } else if let Some(moved) = exchange.journal_since(self.window.delivered) {
            moved.for_each(|channel| delivering.channel(channel));
        } else {
            self.attached.get_mut().iter().for_each(|channel| delivering.channel(*channel));
        }
        self.window.delivered = exchange.order();
        drop(exchange);
        self.delivery.leaving.clear();
        self.delivery.arrivals.sort_unstable();
    }

    /// Delivers the only publication since the last delivery, if it is still at the front.
    #[inline]
    fn deliver_last(&mut self, last: u64, channel: Channel) -> bool {
        // What was published before the blackboard was made may be read already, and be no signal for it.
        if self.window.delivered < self.window.since {
            return false;
        }
        let place = &mut self.places[channel.topic.index()];
        let reader = place.reader(self.number, channel.host);
        let Some(reading) = place.reading_mut(channel.host) else { return false };
        let was_open = reading.is_open();
        let exchange = self.hub.unshelved();
        let Some(entry) = exchange.at_front(last) else { return false };
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
        self.places.get(channel.topic.index()).is_some_and(|place| place.reading(channel.host).is_some())
    }

    fn reader(&self, channel: Channel) -> Reader {
        self.places[channel.topic.index()].reader(self.number, channel.host)
    }
}

/// What a delivery works on, beside the hub whose lock it holds.
struct Delivering<'a> {
    exchange: &'a Exchange,
    number: u32,
    now: Moment,
    places: &'a mut [Place],
    open: &'a mut Vec<Channel>,
    delivery: &'a mut Delivery,
}

impl Delivering<'_> {
    /// Delivers what was published on a channel, if it is read here.
    fn channel(&mut self, channel: Channel) {
        let place = &mut self.places[channel.topic.index()];
        let reader = place.reader(self.number, channel.host);
        let Some(reading) = place.reading_mut(channel.host) else { return };
        let Some(ring) = self.exchange.ring(channel) else { return };
        let was_open = reading.is_open();
        reading.deliver(ring, reader, self.delivery);
        reading.expire(self.now, &mut self.delivery.leaving);
        if reading.is_open() && !was_open {
            self.open.push(channel);
        }
    }
}

/// Requests to whoever works on it.
impl Blackboard {
    /// Whether whoever works on it is asked to return soon: the state whose activity it is waits to be left, or the run ends. Work
    /// that takes long looks here now and then.
    pub fn is_cancelled(&self) -> bool {
        self.cancellation.is_requested()
    }

    /// What asks, and takes requests back.
    pub fn cancellation(&self) -> &Cancellation {
        &self.cancellation
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

    /// Raises an event in the statechart whose activity this is; the runtime collects it. Of more than [`EVENT_LIMIT`] that it does
    /// not collect the oldest are [lost](Blackboard::events_lost).
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

    /// How many events were gone before they were collected.
    pub fn events_lost(&self) -> u64 {
        self.events_lost
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
