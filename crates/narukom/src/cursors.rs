//! Where a reader outside agents stands in the rings of its topics.

use crate::exchange::Exchange;
use crate::hub::Narukom;
use crate::ring::{Entry, Ring};
use crate::sample::{Channel, HostId, TopicSlot};
use crate::topic::Kind;

/// The topics of a reader, and for each the index of the message that it wants next.
pub(crate) struct Cursors {
    host: HostId,
    /// Sorted by topic.
    places: Vec<(TopicSlot, u64)>,
    /// The number of the last publication that was looked at.
    seen: u64,
    lost: u64,
}

impl Cursors {
    /// A reader that stands behind all that was published so far; it is given the latest message of each state.
    pub(crate) fn new(
        hub: &Narukom,
        exchange: &Exchange,
        host: HostId,
        mut slots: Vec<TopicSlot>,
        mut take: impl FnMut(&Entry),
    ) -> Cursors {
        slots.sort_unstable();
        let ring = |slot: TopicSlot| exchange.ring(Channel { topic: slot, host });
        let is_state =
            |slot: &TopicSlot| hub.declaration(*slot).is_some_and(|topic| topic.kind() == Kind::State);
        let states = slots.iter().filter(|slot| is_state(slot));
        states.filter_map(|slot| ring(*slot)?.newest()).for_each(&mut take);
        let places = slots.iter().map(|slot| (*slot, ring(*slot).map_or(0, Ring::next)));
        Cursors { host, places: places.collect(), seen: exchange.order(), lost: 0 }
    }

    /// Whether nothing was published that it reads and has not looked at.
    pub(crate) fn is_up_to_date(&mut self, hub: &Narukom) -> bool {
        let last = hub.head();
        if last != self.seen {
            let Some(recent) = hub.recent(self.seen, last) else { return false };
            if recent.channels().any(|channel| self.reads(channel)) {
                return false;
            }
            self.seen = last;
        }
        true
    }

    fn reads(&self, Channel { topic, host }: Channel) -> bool {
        host == self.host && self.places.binary_search_by_key(&topic, |(slot, _)| *slot).is_ok()
    }

    /// The number of the last publication that was looked at.
    pub(crate) fn seen(&self) -> u64 {
        self.seen
    }

    pub(crate) fn lost(&self) -> u64 {
        self.lost
    }

    pub(crate) fn topics(&self) -> impl Iterator<Item = TopicSlot> {
        self.places.iter().map(|(slot, _)| *slot)
    }

    /// Takes what was published since the last time, topic by topic. Topics on which nothing moved cost nothing.
    pub(crate) fn fetch(&mut self, exchange: &Exchange, mut take: impl FnMut(&Entry)) {
        match exchange.journal_since(self.seen) {
            Some(moved) => {
                let host = self.host;
                for Channel { topic, .. } in moved.filter(|channel| channel.host == host) {
                    if let Ok(place) = self.places.binary_search_by_key(&topic, |(slot, _)| *slot) {
                        self.fetch_topic(exchange, place, &mut take);
                    }
                }
            }
            None => (0..self.places.len()).for_each(|place| self.fetch_topic(exchange, place, &mut take)),
        }
        self.seen = exchange.order();
    }

    fn fetch_topic(&mut self, exchange: &Exchange, place: usize, take: &mut impl FnMut(&Entry)) {
        let (topic, cursor) = &mut self.places[place];
        let Some(ring) = exchange.ring(Channel { topic: *topic, host: self.host }) else { return };
        self.lost += ring.missed(*cursor);
        ring.from(*cursor).for_each(take);
        *cursor = ring.next();
    }
}
