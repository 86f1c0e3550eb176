//! Read positions of a subscriber in the rings of its topics.

use crate::hub::Hub;
use crate::hub_state::HubState;
use crate::ring::{Ring, RingEntry};
use crate::sample::{Channel, HostId, TopicSlot};
use crate::topic::RetentionKind;

/// The topics of a subscriber and, for each, the index of the next message to fetch.
pub(crate) struct Cursors {
    host: HostId,
    /// Sorted by topic.
    positions: Vec<(TopicSlot, u64)>,
    /// The number of the last publication that was checked.
    seen: u64,
    lost: u64,
}

impl Cursors {
    /// Cursors after everything published so far, except that the latest message of each state is
    /// still to be fetched.
    pub(crate) fn new(
        hub: &Hub,
        exchange: &HubState,
        host: HostId,
        mut slots: Vec<TopicSlot>,
        mut take: impl FnMut(&RingEntry),
    ) -> Cursors {
        slots.sort_unstable();
        let ring = |slot: TopicSlot| exchange.ring(Channel { topic: slot, host });
        let is_state = |slot: &TopicSlot| {
            hub.declaration(*slot).is_some_and(|topic| topic.kind() == RetentionKind::State)
        };
        let states = slots.iter().filter(|slot| is_state(slot));
        states.filter_map(|slot| ring(*slot)?.newest()).for_each(&mut take);
        let positions = slots.iter().map(|slot| (*slot, ring(*slot).map_or(0, Ring::next)));
        Cursors { host, positions: positions.collect(), seen: exchange.last_publication(), lost: 0 }
    }

    /// Whether no publication since the last check is on one of its topics.
    pub(crate) fn is_up_to_date(&mut self, hub: &Hub) -> bool {
        let last = hub.last_publication();
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
        host == self.host && self.positions.binary_search_by_key(&topic, |(slot, _)| *slot).is_ok()
    }

    /// The number of the last publication that was checked.
    pub(crate) fn seen(&self) -> u64 {
        self.seen
    }

    pub(crate) fn lost(&self) -> u64 {
        self.lost
    }

    pub(crate) fn topics(&self) -> impl Iterator<Item = TopicSlot> {
        self.positions.iter().map(|(slot, _)| *slot)
    }

    /// Fetches what was published since the last call, topic by topic. Unchanged topics cost
    /// nothing.
    pub(crate) fn fetch(&mut self, exchange: &HubState, mut take: impl FnMut(&RingEntry)) {
        match exchange.channels_since(self.seen) {
            Some(moved) => {
                let host = self.host;
                for Channel { topic, .. } in moved.filter(|channel| channel.host == host) {
                    if let Ok(index) = self.positions.binary_search_by_key(&topic, |(slot, _)| *slot) {
                        self.fetch_topic(exchange, index, &mut take);
                    }
                }
            }
            None => {
                (0..self.positions.len()).for_each(|position| self.fetch_topic(exchange, position, &mut take))
            }
        }
        self.seen = exchange.last_publication();
    }

    fn fetch_topic(&mut self, exchange: &HubState, index: usize, take: &mut impl FnMut(&RingEntry)) {
        let (topic, cursor) = &mut self.positions[index];
        let Some(ring) = exchange.ring(Channel { topic: *topic, host: self.host }) else { return };
        self.lost += ring.missed(*cursor);
        ring.from(*cursor).for_each(take);
        *cursor = ring.next();
    }
}
