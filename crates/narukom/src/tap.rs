//! Reading bytes: for links and recorders.

use std::collections::VecDeque;
use std::fmt;
use std::sync::Arc;

use crate::cursors::Cursors;
use crate::encoding::Encoded;
use crate::hub::Narukom;
use crate::ring::Entry;
use crate::sample::{Channel, HostId, TopicSlot};

/// Reads what is published here on one or several topics, in the order of publication, as bytes.
///
/// However many taps there are, a message is encoded once, on the thread of the tap that first looks at its bytes, and not at all
/// if none does; publishers and typed readers encode nothing. As with a [`Subscriber`](crate::Subscriber), the latest
/// message of each `state` topic comes first, and what left the hub's ring before it was fetched is [lost](Tap::lost) and counted.
pub struct Tap {
    hub: Narukom,
    cursors: Cursors,
    fetched: VecDeque<(u64, Encoded)>,
}

impl Tap {
    pub(crate) fn new(hub: Narukom, slots: Vec<TopicSlot>) -> Tap {
        let mut fetched = VecDeque::new();
        let mut exchange = hub.exchange();
        for slot in &slots {
            exchange.ring_mut(Channel::local(*slot)).into_iter().for_each(|ring| ring.add_tap());
        }
        let take = |entry: &Entry| fetched.push_back(encoded(entry));
        let cursors = Cursors::new(&hub, &exchange, HostId::LOCAL, slots, take);
        drop(exchange);
        sort(&mut fetched);
        Tap { hub, cursors, fetched }
    }

    /// The next message, if one was published.
    pub fn next_encoded(&mut self) -> Option<Encoded> {
        if self.fetched.is_empty() && !self.cursors.is_up_to_date(&self.hub) {
            let exchange = self.hub.exchange();
            self.cursors.fetch(&exchange, |entry| self.fetched.push_back(encoded(entry)));
            drop(exchange);
            sort(&mut self.fetched);
        }
        self.fetched.pop_front().map(|(_, encoded)| encoded)
    }

    /// How many messages were gone before they were fetched.
    pub fn lost(&self) -> u64 {
        self.cursors.lost()
    }

    /// The topics that it reads.
    pub fn topics(&self) -> impl Iterator<Item = TopicSlot> {
        self.cursors.topics()
    }
}

/// What was published before its topic was tapped has an encoding of its own.
fn encoded(entry: &Entry) -> (u64, Encoded) {
    let encoding = entry.encoding.as_ref().map(Arc::clone).unwrap_or_default();
    (entry.order, Encoded::new(entry.sample.clone(), encoding))
}

fn sort(fetched: &mut VecDeque<(u64, Encoded)>) {
    fetched.make_contiguous().sort_unstable_by_key(|(order, _)| *order);
}

impl Drop for Tap {
    fn drop(&mut self) {
        let mut exchange = self.hub.exchange();
        for slot in self.cursors.topics() {
            exchange.ring_mut(Channel::local(slot)).into_iter().for_each(|ring| ring.remove_tap());
        }
    }
}

impl fmt::Debug for Tap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Tap({} topics, {} lost)", self.cursors.topics().count(), self.lost())
    }
}
