//! One host's side of all conversations.

mod control;
mod receive;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use narukom::{Kind, Moment};
use prost::Message as _;

use super::access::AccessList;
use super::budget::{Budget, Spending, Spent};
use super::clock::ClockOffset;
use super::counters::{Counters, Received};
use super::outgoing::Outgoing;
use super::payload::MessageBytes;
use super::peers::{OFFER_LIMIT, Peer, ReadingState};
use super::schema::Schema;
use super::wire;
use crate::error::{Error, ErrorKind};

use control::Introductions;

/// Controls are not longer than this, if no budget says less. Packets that are longer are not looked at.
const CONTROL_BYTES: usize = 60 << 10;

/// A message of a topic is not longer than this: what Narukom decodes.
const MESSAGE_BYTES: usize = narukom::ENCODED_LIMIT;

/// Names of hosts and publishers are not longer than this.
const NAME_BYTES: usize = 128;

/// So many hosts that have no link of their own may send messages.
const GUEST_LIMIT: usize = 256;

/// Of so many differences the text is kept.
const MISMATCH_LIMIT: usize = 256;

/// Whether messages that are lost on the way are sent again.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub enum Reliability {
    /// Each message comes once and in order, or is counted as a gap.
    #[default]
    Reliable,
    /// A message that comes is delivered at once; one that a newer has overtaken is not. Of a state the last value comes all the same.
    BestEffort,
}

/// A topic as a link sends or receives it.
#[derive(Clone, Debug)]
pub struct LinkTopic {
    /// The path.
    pub path: Arc<str>,
    /// The way of keeping.
    pub kind: Kind,
    /// How many messages the hub keeps; so many can be sent again.
    pub depth: usize,
    /// Full name of the message type.
    pub type_name: Arc<str>,
    /// The message type.
    pub schema: Schema,
    /// Whether lost messages are sent again. The sender decides.
    pub reliability: Reliability,
    /// From 1, sent first, to 7, sent last.
    pub priority: u8,
}

/// What a [`Node`] is made of.
#[derive(Clone, Debug)]
pub struct NodeSettings {
    /// The host's name.
    pub host: String,
    /// Unlike that of every earlier life of this host.
    pub incarnation: u64,
    /// What is sent.
    pub send: Vec<LinkTopic>,
    /// What is received.
    pub receive: Vec<LinkTopic>,
    /// Who may publish.
    pub access: AccessList,
    /// Whether hosts without a link of their own may send.
    pub guests: bool,
    /// How much may be sent.
    pub budget: Option<Budget>,
    /// How often a link says how far it is.
    pub beat: Duration,
}

/// What a transport carries.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Packet {
    /// Who sends it.
    pub from: Arc<str>,
    /// For whom it is; for all, if that is not said.
    pub to: Option<Arc<str>>,
    /// The topic; none for what links say to each other.
    pub path: Option<Arc<str>>,
    /// What is said of the message; empty for guests and for what links say to each other.
    pub stamp: Arc<[u8]>,
    /// The message's encoding.
    pub payload: MessageBytes,
    /// From 1, first, to 7, last.
    pub priority: u8,
    /// Whether the transport may not lose it lightly.
    pub is_reliable: bool,
}

/// A message that is to be sent.
#[derive(Clone, Debug)]
pub struct Publication<'a> {
    /// Who published it.
    pub publisher: &'a str,
    /// Its number among the publisher's messages on the topic.
    pub sequence: u64,
    /// When.
    pub published: Moment,
    /// The message's encoding.
    pub payload: MessageBytes,
}

/// A message that has come.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Delivery {
    /// From which host.
    pub host: Arc<str>,
    /// The place of the topic among [`NodeSettings::receive`].
    pub topic: usize,
    /// Who published it.
    pub publisher: String,
    /// Its number among the publisher's messages on the topic.
    pub sequence: u64,
    /// When it was published, by the other host's clock.
    pub published: Moment,
    /// The same moment by this host's clock; when it came, as long as the clocks have not been compared.
    pub local: Moment,
    /// When it came.
    pub received: Moment,
    /// The message's encoding.
    pub payload: MessageBytes,
}

/// A host or a topic that cannot be read, and why.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Mismatch {
    /// The other host.
    pub host: String,
    /// The topic; none if it is the protocol itself.
    pub path: Option<String>,
    /// What differs.
    pub text: String,
}

/// One host's side of all conversations: it is told what is published here and what has come, and says what is to be sent.
///
/// It reads no clock and knows no sockets. Whoever drives it calls [`publish`](Node::publish) and [`handle`](Node::handle), then
/// fetches [deliveries](Node::next_delivery) and [packets](Node::poll) until there are none, and comes again at
/// [`poll_at`](Node::poll_at).
pub struct Node {
    host: Arc<str>,
    incarnation: u64,
    send: Vec<LinkTopic>,
    receive: Vec<LinkTopic>,
    /// Places among `receive`, by path.
    wanted: BTreeMap<Arc<str>, usize>,
    access: AccessList,
    admits_guests: bool,
    guests: BTreeMap<(Arc<str>, usize), Received>,
    outgoing: Vec<Outgoing>,
    /// The topics with something to send, those to be served first in front: priority, turn, place.
    ready: BTreeSet<(u8, u64, usize)>,
    turn: u64,
    peers: Vec<Peer>,
    deliveries: VecDeque<Delivery>,
    mismatches: BTreeMap<(String, Option<String>), String>,
    introductions: Introductions,
    spending: Option<Spending>,
    /// Messages are not longer than this, stamps included.
    largest: usize,
    beat: Duration,
    next_beat: Moment,
    /// The place among the offers with which the next Beat begins.
    next_head: usize,
    counters: Counters,
    was_waiting: bool,
}

impl Node {
    /// A host's side.
    ///
    /// # Errors
    /// A name is too long, there are too many topics, or the budget has no room for what must be said.
    pub fn new(settings: NodeSettings) -> Result<Node, Error> {
        let NodeSettings { host, incarnation, send, receive, access, guests, budget, beat } = settings;
        if host.is_empty() || host.len() > NAME_BYTES {
            let text = format!("the host's name `{host}` is not 1 to {NAME_BYTES} bytes long");
            return Err(Error::new(ErrorKind::Settings, text));
        }
        if send.len() > OFFER_LIMIT {
            let text = format!("{} topics are to be sent, and a link takes {OFFER_LIMIT}", send.len());
            return Err(Error::new(ErrorKind::Settings, text));
        }
        let outgoing = send.iter().map(outgoing).collect();
        let spending = budget.map(Spending::new);
        let slowest = spending.as_ref().map_or(Duration::ZERO, Spending::shortest_beat);
        let wanted = receive.iter().enumerate().map(|(place, topic)| (topic.path.clone(), place)).collect();
        let node = Node {
            host: host.into(),
            incarnation,
            introductions: Introductions::new(send.len()),
            send,
            receive,
            wanted,
            access,
            admits_guests: guests,
            guests: BTreeMap::new(),
            outgoing,
            ready: BTreeSet::new(),
            turn: 0,
            peers: Vec::new(),
            deliveries: VecDeque::new(),
            mismatches: BTreeMap::new(),
            spending,
            largest: MESSAGE_BYTES,
            beat: beat.max(slowest).max(Duration::from_millis(1)),
            next_beat: Moment::ZERO,
            next_head: 0,
            counters: Counters::default(),
            was_waiting: false,
        };
        node.check_offers().map(|()| node)
    }

    /// Lets no message out that is longer, with its stamp, than what the transport carries.
    pub fn set_largest(&mut self, bytes: usize) {
        self.largest = bytes.min(MESSAGE_BYTES);
    }

    /// Takes a message of the topic at a place among [`NodeSettings::send`].
    pub fn publish(&mut self, topic: usize, publication: Publication<'_>) {
        let limit =
            self.spending.as_ref().map_or(self.largest, |spending| spending.payload().min(self.largest));
        let Some(outgoing) = self.outgoing.get_mut(topic) else { return };
        let stamp = wire::Stamp {
            incarnation: self.incarnation,
            offer: topic as u32,
            number: outgoing.next_number(),
            publisher: publication.publisher.to_owned(),
            sequence: publication.sequence,
            published: publication.published.as_nanos(),
        };
        let stamp: Arc<[u8]> = stamp.encode_to_vec().into();
        if stamp.len() + publication.payload.len() > limit || publication.publisher.len() > NAME_BYTES {
            return outgoing.refuse_oversize();
        }
        outgoing.take(stamp, publication.payload);
        self.mark_ready(topic);
    }

    /// Tells how many messages of a topic the hub no longer had when they should have been sent.
    pub fn set_lost(&mut self, topic: usize, lost: u64) {
        if let Some(outgoing) = self.outgoing.get_mut(topic) {
            outgoing.set_lost(lost);
        }
    }

    fn mark_ready(&mut self, topic: usize) {
        let priority = self.send[topic].priority;
        if !self.ready.iter().any(|entry| entry.2 == topic) && self.outgoing[topic].is_ready() {
            self.turn += 1;
            self.ready.insert((priority, self.turn, topic));
        }
    }

    /// The next packet to be sent, if there is one and the budget allows it. Its sender must send it.
    pub fn poll(&mut self, now: Moment) -> Option<Packet> {
        self.spending.iter_mut().for_each(|spending| spending.begin(now));
        if self.spending.as_ref().is_some_and(|spending| spending.next() > now) {
            self.count_wait();
            return None;
        }
        let packet = self.next_control(now).or_else(|| self.next_message(now))?;
        self.was_waiting = false;
        self.counters.packets += 1;
        if let Some(spending) = &mut self.spending {
            spending.spend(now);
        }
        Some(packet)
    }

    /// One more wait, when something was held back that was not held back before.
    fn count_wait(&mut self) {
        if !self.ready.is_empty() && !self.was_waiting {
            self.was_waiting = true;
            self.counters.waits += 1;
        }
    }

    fn next_message(&mut self, now: Moment) -> Option<Packet> {
        while let Some((priority, _, topic)) = self.ready.pop_first() {
            let parcel = self.outgoing[topic].send(now);
            self.mark_ready(topic);
            if let Some(parcel) = parcel {
                return Some(Packet {
                    from: self.host.clone(),
                    to: parcel.to,
                    path: Some(self.send[topic].path.clone()),
                    stamp: parcel.stamp,
                    payload: parcel.payload,
                    priority,
                    is_reliable: self.send[topic].reliability == Reliability::Reliable,
                });
            }
        }
        None
    }

    /// When [`poll`](Node::poll) may have something to send, if nothing is published and nothing comes.
    pub fn poll_at(&self) -> Moment {
        let is_busy = !self.ready.is_empty() || self.introductions.is_ready();
        let due = if is_busy { Moment::ZERO } else { self.next_beat };
        self.spending.as_ref().map_or(due, |spending| due.max(spending.next()))
    }

    /// The next message that has come.
    pub fn next_delivery(&mut self) -> Option<Delivery> {
        self.deliveries.pop_front()
    }
}

/// What is known and counted.
impl Node {
    /// The host's name.
    pub fn host(&self) -> &Arc<str> {
        &self.host
    }

    /// The topics that are received.
    pub fn receives(&self) -> &[LinkTopic] {
        &self.receive
    }

    /// The topics that are sent.
    pub fn sends(&self) -> &[LinkTopic] {
        &self.send
    }

    /// Who may publish, and who may manage agents.
    pub fn access(&self) -> &AccessList {
        &self.access
    }

    /// What has been counted.
    pub fn counters(&self) -> Counters {
        let sent = self.send.iter().zip(&self.outgoing);
        let mut counters = Counters {
            sent: sent.map(|(topic, outgoing)| (topic.path.to_string(), outgoing.counted())).collect(),
            ..self.counters.clone()
        };
        for peer in &self.peers {
            for reading in peer.topics.iter().flatten() {
                let counted = match &reading.state {
                    ReadingState::Unwanted => continue,
                    ReadingState::Forbidden(counted) | ReadingState::Different { counted, .. } => *counted,
                    ReadingState::Read { incoming, .. } => incoming.counted(),
                };
                counters.received.push((peer.name.to_string(), reading.path.to_string(), counted));
            }
        }
        let guests = self.guests.iter().map(|((host, topic), counted)| {
            (host.to_string(), self.receive[*topic].path.to_string(), *counted)
        });
        counters.received.extend(guests);
        counters.received.sort_by(|a, b| (&a.0, &a.1).cmp(&(&b.0, &b.1)));
        counters
    }

    /// How much of the budget is used up; none without one.
    pub fn spent(&self, now: Moment) -> Option<Spent> {
        self.spending.as_ref().map(|spending| spending.spent(now))
    }

    /// What differs from what other hosts know.
    pub fn mismatches(&self) -> Vec<Mismatch> {
        let all = self.mismatches.iter();
        all.map(|((host, path), text)| Mismatch {
            host: host.clone(),
            path: path.clone(),
            text: text.clone(),
        })
        .collect()
    }

    /// How far the clock of another host is from this one, as soon as that was measured.
    pub fn clock_offset(&self, host: &str) -> Option<ClockOffset> {
        self.peers.iter().find(|peer| &*peer.name == host)?.clock.offset()
    }

    /// The hosts that have introduced themselves, and when each was last heard.
    pub fn peers(&self) -> impl Iterator<Item = (&Arc<str>, Moment)> {
        let known = self.peers.iter().filter(|peer| peer.incarnation.is_some());
        known.map(|peer| (&peer.name, peer.heard))
    }

    /// Notes that the transport did not take a packet.
    pub fn count_failed(&mut self) {
        self.counters.failed += 1;
    }

    /// Notes that a delivered message was not of its topic's type after all.
    pub fn take_back(&mut self, delivery: &Delivery) {
        if let Some(counted) = self.guests.get_mut(&(delivery.host.clone(), delivery.topic)) {
            let Some(delivered) = counted.delivered.checked_sub(1) else { return };
            counted.delivered = delivered;
            counted.refused += 1;
            counted.gaps += 1;
            return;
        }
        let peer = self.peers.iter_mut().find(|peer| peer.name == delivery.host);
        for reading in peer.into_iter().flat_map(|peer| peer.topics.iter_mut().flatten()) {
            if let ReadingState::Read { topic, incoming } = &mut reading.state
                && *topic == delivery.topic
                && incoming.take_back()
            {
                return;
            }
        }
    }

    fn note_mismatch(&mut self, host: &str, path: Option<&str>, text: String) {
        let key = (host.to_owned(), path.map(str::to_owned));
        if self.mismatches.len() < MISMATCH_LIMIT || self.mismatches.contains_key(&key) {
            self.mismatches.insert(key, text);
        }
    }
}

/// What was sent is kept to be sent again, if it is to be reliable; of a state at least the last.
fn outgoing(topic: &LinkTopic) -> Outgoing {
    match (topic.reliability, topic.kind) {
        (Reliability::Reliable, _) => Outgoing::new(topic.depth, true),
        (Reliability::BestEffort, Kind::State) => Outgoing::new(1, true),
        (Reliability::BestEffort, _) => Outgoing::new(topic.depth, false),
    }
}

impl std::fmt::Debug for Node {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Node({}, {} peers)", self.host, self.peers.len())
    }
}
