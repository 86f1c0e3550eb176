//! The blackboard: what one agent, or one region of a statechart, knows during a cycle.

mod adopt;
mod read;
mod write;

use std::cell::{OnceCell, RefCell};
use std::fmt;

use crate::cancellation::Cancellation;
use crate::hub::{Narukom, Outgoing, Sender};
use crate::message::AnyMessage;
use crate::moment::Moment;
use crate::random::Random;
use crate::reading::{Reader, Reading, Window};
use crate::ring::{Origin, Ring};
use crate::sample::{AnySample, TopicSlot};
use crate::topic;
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
    cancellation: Cancellation,
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
            cancellation: Cancellation::default(),
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

    fn deliver_topic(&mut self, slot: TopicSlot, ring: Option<&Ring>) {
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

    /// As [`latest_sample`](Blackboard::latest_sample), for those who only look on: that is no read, so it makes the blackboard no
    /// reader of the topic, and an own signal that nobody else has looked at still comes back.
    pub fn shown(&self, slot: TopicSlot) -> Option<&AnySample> {
        let reading = self.places.get(slot.index())?.reading.get()?;
        self.peek(slot, reading)
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
