//! Subscriber to encoded messages, for links and recorders.

use std::collections::VecDeque;
use std::fmt;
use std::sync::Arc;

use crate::cursors::Cursors;
use crate::encoding::EncodedMessage;
use crate::error::Error;
use crate::hub::Hub;
use crate::ring::RingEntry;
use crate::sample::{Channel, HostId, TopicSlot};

/// Reads the messages of one or several topics, encoded, in order of publication.
///
/// A message is encoded at most once, however many encoded subscribers there are, on the thread of
/// the first that accesses its bytes; publishers and typed readers encode nothing. As with a
/// [`Subscriber`](crate::Subscriber), the latest message of each `state` topic comes first, and
/// messages that left the hub's ring before they were fetched are counted as
/// [lost](EncodedSubscriber::lost).
pub struct EncodedSubscriber {
    hub: Hub,
    cursors: Cursors,
    fetched: VecDeque<(u64, EncodedMessage)>,
}

/// Constructors.
impl Hub {
    /// Like [`subscriber`](Hub::subscriber), for encoded messages: for links and recorders.
    pub fn encoded_subscriber(&self, pattern: &str) -> Result<EncodedSubscriber, Error> {
        Ok(EncodedSubscriber::new(self.clone(), self.matching(pattern)?))
    }
}

impl EncodedSubscriber {
    pub(crate) fn new(hub: Hub, slots: Vec<TopicSlot>) -> EncodedSubscriber {
        let mut fetched = VecDeque::new();
        let mut exchange = hub.state();
        for slot in &slots {
            exchange.ring_mut(Channel::local(*slot)).into_iter().for_each(|ring| ring.add_tap());
        }
        let take = |entry: &RingEntry| fetched.push_back(encoded(entry));
        let cursors = Cursors::new(&hub, &exchange, HostId::LOCAL, slots, take);
        drop(exchange);
        sort(&mut fetched);
        EncodedSubscriber { hub, cursors, fetched }
    }

    /// The next message, if there is one.
    pub fn next_encoded(&mut self) -> Option<EncodedMessage> {
        if self.fetched.is_empty() && !self.cursors.is_up_to_date(&self.hub) {
            let exchange = self.hub.state();
            self.cursors.fetch(&exchange, |entry| self.fetched.push_back(encoded(entry)));
            drop(exchange);
            sort(&mut self.fetched);
        }
        self.fetched.pop_front().map(|(_, encoded)| encoded)
    }

    /// The number of messages that left the hub before they were fetched.
    pub fn lost(&self) -> u64 {
        self.cursors.lost()
    }

    /// The subscribed topics.
    pub fn topics(&self) -> impl Iterator<Item = TopicSlot> {
        self.cursors.topics()
    }
}

/// A message published before its topic had an encoded subscriber gets an encoding that is not
/// shared.
fn encoded(entry: &RingEntry) -> (u64, EncodedMessage) {
    let encoding = entry.encoding.as_ref().map(Arc::clone).unwrap_or_default();
    (entry.order, EncodedMessage::new(entry.sample.clone(), encoding))
}

fn sort(fetched: &mut VecDeque<(u64, EncodedMessage)>) {
    fetched.make_contiguous().sort_unstable_by_key(|(order, _)| *order);
}

impl Drop for EncodedSubscriber {
    fn drop(&mut self) {
        let mut exchange = self.hub.state();
        for slot in self.cursors.topics() {
            exchange.ring_mut(Channel::local(slot)).into_iter().for_each(|ring| ring.remove_tap());
        }
    }
}

impl fmt::Debug for EncodedSubscriber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "EncodedSubscriber({} topics, {} lost)", self.cursors.topics().count(), self.lost())
    }
}
