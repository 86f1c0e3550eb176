//! The protocol state machine of one host.

mod control;
mod receive;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use narukom::{RetentionKind, Timestamp};
use prost::Message as _;

use super::access::AccessList;
use super::budget::{BudgetUsage, BudgetWindow, SendBudget};
use super::clock::ClockOffset;
use super::counters::{Counters, ReceivedCounters};
use super::outgoing::OutgoingStream;
use super::payload::MessageBytes;
use super::peers::{OFFER_LIMIT, Peer, PeerTopicState};
use super::schema::Schema;
use super::wire;
use crate::error::{Error, ErrorKind};

use control::Handshake;

/// Longest control packet, unless the budget is smaller. Longer ones are ignored.
const CONTROL_BYTES: usize = 60 << 10;

/// Longest message of a topic: what Narukom decodes.
const MESSAGE_BYTES: usize = narukom::ENCODED_LIMIT;

/// Longest name of a host or publisher, in bytes.
const NAME_BYTES: usize = 128;

/// The most hosts without a link that may send messages.
const GUEST_LIMIT: usize = 256;

/// The number of differences of which the text is kept.
const MISMATCH_LIMIT: usize = 256;

/// Whether messages lost by the network are retransmitted.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub enum Reliability {
    /// Each message is delivered once and in order, or counted as a gap.
    #[default]
    Reliable,
    /// A message is delivered on arrival; one that a newer has overtaken is not. The last value of
    /// a state is still guaranteed to arrive.
    BestEffort,
}

/// A topic as a link sends or receives it.
#[derive(Clone, Debug)]
pub struct LinkTopic {
    /// The path.
    pub path: Arc<str>,
    /// The retention kind.
    pub kind: RetentionKind,
    /// The number of messages that the hub keeps, which can be retransmitted.
    pub depth: usize,
    /// Full name of the message type.
    pub type_name: Arc<str>,
    /// The schema of the message type.
    pub schema: Schema,
    /// Whether lost messages are retransmitted. The sender decides.
    pub reliability: Reliability,
    /// From 1, sent first, to 7, sent last.
    pub priority: u8,
}

/// Settings of a [`Node`].
#[derive(Clone, Debug)]
pub struct NodeSettings {
    /// The host's name.
    pub host: String,
    /// Must differ from that of every earlier incarnation of this host.
    pub incarnation: u64,
    /// The topics to send.
    pub send: Vec<LinkTopic>,
    /// The topics to receive.
    pub receive: Vec<LinkTopic>,
    /// The access list.
    pub access: AccessList,
    /// Whether hosts without a link may send.
    pub accepts_unlinked: bool,
    /// The send budget.
    pub budget: Option<SendBudget>,
    /// Interval between heartbeats.
    pub beat: Duration,
}

/// The unit that a transport carries.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Packet {
    /// The sending host.
    pub from: Arc<str>,
    /// The receiving host; all hosts if `None`.
    pub to: Option<Arc<str>>,
    /// The topic; `None` for a control.
    pub path: Option<Arc<str>>,
    /// The metadata of the message; empty for guests and for controls.
    pub stamp: Arc<[u8]>,
    /// The message's encoding.
    pub payload: MessageBytes,
    /// From 1, first, to 7, last.
    pub priority: u8,
    /// Whether the transport should avoid losing it.
    pub is_reliable: bool,
}

/// A message to send.
#[derive(Clone, Debug)]
pub struct OutgoingPublication<'a> {
    /// Its publisher.
    pub publisher: &'a str,
    /// Its number among the publisher's messages on the topic.
    pub sequence: u64,
    /// The time of publication.
    pub published: Timestamp,
    /// The message's encoding.
    pub payload: MessageBytes,
}

/// A received message.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ReceivedMessage {
    /// The sending host.
    pub host: Arc<str>,
    /// The index of the topic in [`NodeSettings::receive`].
    pub topic: usize,
    /// Its publisher.
    pub publisher: String,
    /// Its number among the publisher's messages on the topic.
    pub sequence: u64,
    /// When it was published, by the other host's clock.
    pub published: Timestamp,
    /// The same time by this host's clock; the time of arrival as long as the clock offset is
    /// unknown.
    pub local: Timestamp,
    /// The time of arrival.
    pub received: Timestamp,
    /// The message's encoding.
    pub payload: MessageBytes,
}

/// A host or a topic that cannot be read, and the reason.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Mismatch {
    /// The other host.
    pub host: String,
    /// The topic; `None` if it is the protocol itself.
    pub path: Option<String>,
    /// The difference.
    pub text: String,
}

/// The protocol state machine of one host: its inputs are local publications and received packets,
/// its outputs packets to send.
///
/// It reads no clock and uses no sockets. The driver calls [`publish`](Node::publish) and
/// [`handle`](Node::handle), then fetches [deliveries](Node::next_delivery) and
/// [packets](Node::poll) until there are none, and polls again at [`poll_at`](Node::poll_at).
pub struct Node {
    host: Arc<str>,
    incarnation: u64,
    send: Vec<LinkTopic>,
    receive: Vec<LinkTopic>,
    /// Indexes into `receive`, by path.
    wanted: BTreeMap<Arc<str>, usize>,
    access: AccessList,
    admits_guests: bool,
    guests: BTreeMap<(Arc<str>, usize), ReceivedCounters>,
    outgoing: Vec<OutgoingStream>,
    /// The topics with something to send, in sending order: priority, turn, index.
    ready: BTreeSet<(u8, u64, usize)>,
    turn: u64,
    peers: Vec<Peer>,
    deliveries: VecDeque<ReceivedMessage>,
    mismatches: BTreeMap<(String, Option<String>), String>,
    introductions: Handshake,
    spending: Option<BudgetWindow>,
    /// Longest message, stamp included.
    largest: usize,
    beat: Duration,
    next_beat: Timestamp,
    /// The index of the offer with which the next Beat begins.
    next_head: usize,
    counters: Counters,
    was_waiting: bool,
}

impl Node {
    /// Creates the protocol state of a host.
    ///
    /// # Errors
    /// A name is too long, there are too many topics, or the budget is too small for the controls.
    pub fn new(settings: NodeSettings) -> Result<Node, Error> {
        let NodeSettings { host, incarnation, send, receive, access, accepts_unlinked: guests, budget, beat } =
            settings;
        if host.is_empty() || host.len() > NAME_BYTES {
            let text = format!("the host's name `{host}` is not 1 to {NAME_BYTES} bytes long");
            return Err(Error::new(ErrorKind::Settings, text));
        }
        if send.len() > OFFER_LIMIT {
            let text = format!("{} topics are to be sent, and a link takes {OFFER_LIMIT}", send.len());
            return Err(Error::new(ErrorKind::Settings, text));
        }
        let outgoing = send.iter().map(outgoing).collect();
        let spending = budget.map(BudgetWindow::new);
        let slowest = spending.as_ref().map_or(Duration::ZERO, BudgetWindow::shortest_beat);
        let wanted = receive.iter().enumerate().map(|(index, topic)| (topic.path.clone(), index)).collect();
        let node = Node {
            host: host.into(),
            incarnation,
            introductions: Handshake::new(send.len()),
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
            next_beat: Timestamp::ZERO,
            next_head: 0,
            counters: Counters::default(),
            was_waiting: false,
        };
        node.check_offers().map(|()| node)
    }

    /// Limits the length of a message, with its stamp, to what the transport carries.
    pub fn set_largest(&mut self, bytes: usize) {
        self.largest = bytes.min(MESSAGE_BYTES);
    }

    /// Publishes a message of the topic at index `topic` of [`NodeSettings::send`].
    pub fn publish(&mut self, topic: usize, publication: OutgoingPublication<'_>) {
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
        outgoing.push(stamp, publication.payload);
        self.mark_ready(topic);
    }

    /// Sets the number of messages of a topic that left the hub before they could be taken.
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

    /// The next packet to send, if there is one and the budget allows it. The caller must send it.
    pub fn poll(&mut self, now: Timestamp) -> Option<Packet> {
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

    /// Counts a wait when a packet is held back that was not held back before.
    fn count_wait(&mut self) {
        if !self.ready.is_empty() && !self.was_waiting {
            self.was_waiting = true;
            self.counters.waits += 1;
        }
    }

    fn next_message(&mut self, now: Timestamp) -> Option<Packet> {
        while let Some((priority, _, topic)) = self.ready.pop_first() {
            let batch = self.outgoing[topic].send(now);
            self.mark_ready(topic);
            if let Some(batch) = batch {
                return Some(Packet {
                    from: self.host.clone(),
                    to: batch.to,
                    path: Some(self.send[topic].path.clone()),
                    stamp: batch.stamp,
                    payload: batch.payload,
                    priority,
                    is_reliable: self.send[topic].reliability == Reliability::Reliable,
                });
            }
        }
        None
    }

    /// When [`poll`](Node::poll) may have something to send, if nothing is published and nothing
    /// arrives.
    pub fn poll_at(&self) -> Timestamp {
        let is_busy = !self.ready.is_empty() || self.introductions.is_ready();
        let due = if is_busy { Timestamp::ZERO } else { self.next_beat };
        self.spending.as_ref().map_or(due, |spending| due.max(spending.next()))
    }

    /// The next received message.
    pub fn next_delivery(&mut self) -> Option<ReceivedMessage> {
        self.deliveries.pop_front()
    }
}

/// Status and counters.
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

    /// The access list.
    pub fn access(&self) -> &AccessList {
        &self.access
    }

    /// The counters.
    pub fn counters(&self) -> Counters {
        let sent = self.send.iter().zip(&self.outgoing);
        let mut counters = Counters {
            sent: sent.map(|(topic, outgoing)| (topic.path.to_string(), outgoing.counted())).collect(),
            ..self.counters.clone()
        };
        for peer in &self.peers {
            for reading in peer.topics.iter().flatten() {
                let counted = match &reading.state {
                    PeerTopicState::Unwanted => continue,
                    PeerTopicState::Forbidden(counted) | PeerTopicState::Different { counted, .. } => {
                        *counted
                    }
                    PeerTopicState::Read { incoming, .. } => incoming.counted(),
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

    /// Use of the budget; `None` without a budget.
    pub fn spent(&self, now: Timestamp) -> Option<BudgetUsage> {
        self.spending.as_ref().map(|spending| spending.spent(now))
    }

    /// Declarations that differ from those of other hosts.
    pub fn mismatches(&self) -> Vec<Mismatch> {
        let all = self.mismatches.iter();
        all.map(|((host, path), text)| Mismatch {
            host: host.clone(),
            path: path.clone(),
            text: text.clone(),
        })
        .collect()
    }

    /// The clock offset of another host, once it was measured.
    pub fn clock_offset(&self, host: &str) -> Option<ClockOffset> {
        self.peers.iter().find(|peer| &*peer.name == host)?.clock.offset()
    }

    /// The hosts that have sent a Hello, and when each was last heard.
    pub fn peers(&self) -> impl Iterator<Item = (&Arc<str>, Timestamp)> {
        let known = self.peers.iter().filter(|peer| peer.incarnation.is_some());
        known.map(|peer| (&peer.name, peer.last_received))
    }

    /// Counts a packet that the transport rejected.
    pub fn count_failed(&mut self) {
        self.counters.failed += 1;
    }

    /// Counts a delivered message that did not have its topic's type.
    pub fn reject_delivered(&mut self, delivery: &ReceivedMessage) {
        if let Some(counted) = self.guests.get_mut(&(delivery.host.clone(), delivery.topic)) {
            let Some(delivered) = counted.delivered.checked_sub(1) else { return };
            counted.delivered = delivered;
            counted.refused += 1;
            counted.gaps += 1;
            return;
        }
        let peer = self.peers.iter_mut().find(|peer| peer.name == delivery.host);
        for reading in peer.into_iter().flat_map(|peer| peer.topics.iter_mut().flatten()) {
            if let PeerTopicState::Read { topic, incoming } = &mut reading.state
                && *topic == delivery.topic
                && incoming.reject_delivered()
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

/// Sent messages of a reliable topic are retained for retransmission; of a state at least the last.
fn outgoing(topic: &LinkTopic) -> OutgoingStream {
    match (topic.reliability, topic.kind) {
        (Reliability::Reliable, _) => OutgoingStream::new(topic.depth, true),
        (Reliability::BestEffort, RetentionKind::State) => OutgoingStream::new(1, true),
        (Reliability::BestEffort, _) => OutgoingStream::new(topic.depth, false),
    }
}

impl std::fmt::Debug for Node {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Node({}, {} peers)", self.host, self.peers.len())
    }
}
