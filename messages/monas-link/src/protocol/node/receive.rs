//! Handling of received packets. They are not trusted: numbers, names and lengths are checked
//! before use.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use narukom::Timestamp;
use prost::Message as _;

use super::{CONTROL_BYTES, GUEST_LIMIT, MESSAGE_BYTES, NAME_BYTES, Node, Packet, ReceivedMessage};
use crate::protocol::VERSION;
use crate::protocol::clock::ClockOffset;
use crate::protocol::counters::ReceivedCounters;
use crate::protocol::incoming::{HIGHEST_NUMBER, IncomingStream, StampedMessage};
use crate::protocol::peers::{OFFER_LIMIT, PEER_LIMIT, Peer, PeerTopic, PeerTopicState, REFUSAL_TRIES};
use crate::protocol::schema::differences;
use crate::protocol::wire::{Beat, Control, Hello, Offer, Refusal, Stamp};

/// The most bytes of all hosts together that wait for earlier messages.
const MAX_HELD_BYTES: usize = 64 << 20;

/// The most missing ranges of a Beat that are handled.
const ASKED_SPANS: usize = 1024;

/// The most lines of a difference that are reported.
const REPORTED_LINES: usize = 8;

impl Node {
    /// Handles a received packet.
    pub fn handle(&mut self, packet: &Packet, now: Timestamp) {
        let is_for_us = packet.to.as_ref().is_none_or(|to| *to == self.host);
        if packet.from == self.host || !is_for_us {
            return;
        }
        if packet.from.is_empty() || packet.from.len() > NAME_BYTES {
            self.counters.malformed += 1;
            return;
        }
        match &packet.path {
            None => self.handle_control(packet, now),
            Some(path) if packet.stamp.is_empty() => self.handle_unlinked_host(path, packet, now),
            Some(path) => self.handle_message(path, packet, now),
        }
    }

    /// The index of the peer with that name, added if necessary.
    fn peer(&mut self, name: &Arc<str>, now: Timestamp) -> usize {
        if let Some(index) = self.peers.iter().position(|peer| peer.name == *name) {
            self.peers[index].last_received = now;
            return index;
        }
        if self.peers.len() == PEER_LIMIT {
            self.forget_most_silent(now);
        }
        self.peers.push(Peer::new(name.clone(), now));
        self.peers.len() - 1
    }

    fn forget_most_silent(&mut self, now: Timestamp) {
        let silent = (0..self.peers.len()).min_by_key(|index| self.peers[*index].last_received);
        if let Some(position) = silent {
            let mut peer = self.peers.swap_remove(position);
            let name = peer.name.clone();
            let mut context = DeliveryContext::new(&name, peer.clock.offset(), now, &mut self.deliveries);
            peer.end(&mut |topic, message| context.deliver(topic, message));
        }
    }

    fn handle_control(&mut self, packet: &Packet, now: Timestamp) {
        let control = (packet.payload.len() <= CONTROL_BYTES).then(|| Control::decode(&*packet.payload));
        let Some(Ok(control)) = control else {
            self.counters.malformed += 1;
            return;
        };
        if control.version != VERSION {
            self.counters.foreign += 1;
            let text = format!(
                "speaks version {} of the protocol, and this link version {VERSION}",
                control.version
            );
            return self.note_mismatch(&packet.from, None, text);
        }
        let index = self.peer(&packet.from, now);
        if let Some(hello) = control.hello {
            self.handle_hello(index, control.incarnation, hello, now);
        }
        // The requesting host may be unknown too.
        let is_asked = |beat: &Beat| beat.unknown.iter().any(|host| **host == *self.host);
        if control.beat.as_ref().is_some_and(is_asked) {
            self.introductions.is_asked = true;
            self.schedule_beat(now);
        }
        let silence = self.silence();
        if !self.peers[index].is_current(control.incarnation, now, silence) {
            // Its Hello is requested.
            return self.schedule_beat(now);
        }
        if let Some(beat) = control.beat {
            self.handle_beat(index, beat, now);
        }
        if let Some(refusal) = control.refusal {
            self.handle_refusal(&packet.from, index, refusal);
        }
    }

    fn handle_hello(&mut self, index: usize, incarnation: u64, hello: Hello, now: Timestamp) {
        let (first, total) = (hello.first as usize, hello.total as usize);
        if total > OFFER_LIMIT || first > total || hello.offers.len() > total - first {
            self.counters.malformed += 1;
            return;
        }
        let silence = self.silence();
        let peer = &mut self.peers[index];
        if peer.is_stale(incarnation, now, silence) {
            return;
        }
        if peer.incarnation != Some(incarnation) {
            let name = peer.name.clone();
            let mut context = DeliveryContext::new(&name, peer.clock.offset(), now, &mut self.deliveries);
            peer.begin(incarnation, total, now, &mut |topic, message| context.deliver(topic, message));
            self.mismatches.retain(|(host, _), _| **host != *name);
            // A host that has just started does not know this one.
            self.introductions.is_asked = true;
            self.schedule_beat(now);
        }
        for (place_of_offer, offer) in (first..).zip(hello.offers) {
            self.take_offer(index, place_of_offer, offer);
        }
        self.schedule_beat_if_missing(index, now);
    }

    fn take_offer(&mut self, index: usize, place_of_offer: usize, offer: Offer) {
        let known = self.peers[index].topics.get(place_of_offer);
        if known.is_none_or(Option::is_some) || offer.path.len() > NAME_BYTES || offer.last > HIGHEST_NUMBER {
            return;
        }
        let path: Arc<str> = offer.path.as_str().into();
        let host = self.peers[index].name.clone();
        let state = self.compare_offer(&host, &path, &offer);
        self.peers[index].topics[place_of_offer] = Some(PeerTopic { path, state });
    }

    fn compare_offer(&mut self, host: &str, path: &str, offer: &Offer) -> PeerTopicState {
        let Some(&topic) = self.wanted.get(path) else { return PeerTopicState::Unwanted };
        if !self.access.may_publish(host, path) {
            self.note_mismatch(host, Some(path), "the access list does not let it publish this".to_owned());
            return PeerTopicState::Forbidden(ReceivedCounters::default());
        }
        let ours = &self.receive[topic];
        let kind = ours.kind.to_string();
        if kind != offer.kind
            || *ours.type_name != *offer.r#type
            || ours.schema.hash()[..] != offer.schema[..]
        {
            let what = if kind == offer.kind && *ours.type_name == *offer.r#type {
                ", with other fields"
            } else {
                ""
            };
            let text = format!(
                "is {} of `{}` there{what}, and {kind} of `{}` here",
                offer.kind, offer.r#type, ours.type_name
            );
            self.note_mismatch(host, Some(path), text);
            return PeerTopicState::Different { counted: ReceivedCounters::default(), tries: REFUSAL_TRIES };
        }
        // A late reader gets the last value of a state; for the other kinds, messages from now on.
        let is_state = ours.kind == narukom::RetentionKind::State;
        let start = if is_state { offer.last.saturating_sub(1) } else { offer.last };
        let mut incoming = IncomingStream::new(offer.reliable, start);
        incoming.head(start + 1, offer.last, &mut |_| ());
        PeerTopicState::Read { topic, incoming }
    }

    fn handle_beat(&mut self, index: usize, beat: Beat, now: Timestamp) {
        let peer = &mut self.peers[index];
        peer.beat = Some((beat.sent, now));
        for echo in beat.echoes.iter().filter(|echo| *echo.host == *self.host) {
            let [sent, heard, answered] = [echo.sent, echo.received, beat.sent].map(Timestamp::from_nanos);
            peer.clock.measure(sent, heard, answered, now);
        }
        let (name, offset) = (peer.name.clone(), peer.clock.offset());
        let mut context = DeliveryContext::new(&name, offset, now, &mut self.deliveries);
        for head in &beat.heads {
            if let Some(Some(PeerTopic { state: PeerTopicState::Read { topic, incoming }, .. })) =
                peer.topics.get_mut(head.offer as usize)
            {
                incoming.head(head.first, head.last, &mut |message| context.deliver(*topic, message));
            }
        }
        self.schedule_beat_if_missing(index, now);
        let host = self.host.clone();
        for missing in beat.missing.iter().filter(|missing| *missing.host == *host).take(ASKED_SPANS) {
            let topic = missing.offer as usize;
            if let Some(outgoing) = self.outgoing.get_mut(topic) {
                outgoing.request_resend(missing.first, missing.last, &name, now, self.beat / 4);
                self.mark_ready(topic);
            }
        }
    }

    /// Brings the next beat forward, but not to now: a missing message may only have been
    /// overtaken. Does nothing with a budget, which has no room for extra beats.
    fn schedule_beat(&mut self, now: Timestamp) {
        if self.spending.is_none() {
            self.next_beat = self.next_beat.min(now + self.beat / 8);
        }
    }

    /// The time of silence after which a host is considered gone.
    fn silence(&self) -> Duration {
        self.beat * 3
    }

    fn schedule_beat_if_missing(&mut self, index: usize, now: Timestamp) {
        let is_missing = |reading: &PeerTopic| matches!(&reading.state, PeerTopicState::Read { incoming, .. } if incoming.is_missing());
        if self.peers[index].topics.iter().flatten().any(is_missing) {
            self.schedule_beat(now);
        }
    }

    fn handle_refusal(&mut self, from: &str, index: usize, refusal: Refusal) {
        if *refusal.host != *self.host {
            return;
        }
        let offer = refusal.offer as usize;
        if refusal.is_answer {
            return self.handle_answer(from, index, offer, &refusal);
        }
        let Some(topic) = self.send.get(offer) else { return };
        let text =
            format!("is not read there, since it differs: {}", declaration_differences(topic, &refusal));
        let path = topic.path.clone();
        self.introductions.refuse(Refusal {
            host: from.to_owned(),
            offer: refusal.offer,
            kind: topic.kind.to_string(),
            schema: topic.schema.lines().to_owned(),
            is_answer: true,
        });
        self.note_mismatch(from, Some(&path), text);
    }

    fn handle_answer(&mut self, from: &str, index: usize, offer: usize, refusal: &Refusal) {
        let Some(Some(reading)) = self.peers[index].topics.get_mut(offer) else { return };
        let PeerTopicState::Different { tries, .. } = &mut reading.state else { return };
        *tries = 0;
        let path = reading.path.clone();
        let Some(topic) = self.wanted.get(&path).map(|position| &self.receive[*position]) else { return };
        let text = format!("is not read here, since it differs: {}", declaration_differences(topic, refusal));
        self.note_mismatch(from, Some(&path), text);
    }

    fn handle_message(&mut self, path: &Arc<str>, packet: &Packet, now: Timestamp) {
        let Ok(stamp) = Stamp::decode(&*packet.stamp) else {
            self.counters.malformed += 1;
            return;
        };
        let is_sound = stamp.publisher.len() <= NAME_BYTES
            && (1..=HIGHEST_NUMBER).contains(&stamp.number)
            && packet.payload.len() <= MESSAGE_BYTES;
        if !is_sound {
            self.counters.malformed += 1;
            return;
        }
        let index = self.peer(&packet.from, now);
        let (held, silence) = (self.held_bytes(), self.silence());
        let peer = &mut self.peers[index];
        let is_current = peer.is_current(stamp.incarnation, now, silence);
        let reading = peer.topics.get_mut(stamp.offer as usize).and_then(Option::as_mut);
        let Some(reading) = reading.filter(|reading| is_current && reading.path == *path) else {
            self.counters.strangers += 1;
            return;
        };
        let (number, message) = (stamp.number, message(stamp, packet));
        match &mut reading.state {
            PeerTopicState::Unwanted => {}
            PeerTopicState::Forbidden(counted) | PeerTopicState::Different { counted, .. } => {
                counted.arrived += 1;
                counted.refused += 1;
                counted.bytes += packet.payload.len() as u64;
            }
            PeerTopicState::Read { topic, incoming } => {
                let mut context =
                    DeliveryContext::new(&packet.from, peer.clock.offset(), now, &mut self.deliveries);
                let mut deliver = |message| context.deliver(*topic, message);
                incoming.arrive(number, message, &mut deliver);
                if held + packet.payload.len() > MAX_HELD_BYTES {
                    incoming.end(&mut deliver);
                }
            }
        }
        self.schedule_beat_if_missing(index, now);
    }

    fn held_bytes(&self) -> usize {
        let readings = self.peers.iter().flat_map(|peer| peer.topics.iter().flatten());
        readings
            .map(|reading| match &reading.state {
                PeerTopicState::Read { incoming, .. } => incoming.held_bytes(),
                _ => 0,
            })
            .sum()
    }

    /// A message of a host without a link: it is delivered on arrival.
    fn handle_unlinked_host(&mut self, path: &str, packet: &Packet, now: Timestamp) {
        let Some(&topic) = self.wanted.get(path).filter(|_| self.admits_guests) else {
            self.counters.strangers += 1;
            return;
        };
        let key = (packet.from.clone(), topic);
        if packet.payload.len() > MESSAGE_BYTES
            || (self.guests.len() == GUEST_LIMIT && !self.guests.contains_key(&key))
        {
            self.counters.malformed += 1;
            return;
        }
        let is_allowed = self.access.may_publish(&packet.from, path);
        let counted = self.guests.entry(key).or_default();
        counted.arrived += 1;
        counted.last += 1;
        counted.bytes += packet.payload.len() as u64;
        if !is_allowed {
            counted.refused += 1;
            counted.gaps += 1;
            return;
        }
        counted.delivered += 1;
        self.deliveries.push_back(ReceivedMessage {
            host: packet.from.clone(),
            topic,
            publisher: "guest".to_owned(),
            sequence: counted.last,
            published: now,
            local: now,
            received: now,
            payload: packet.payload.clone(),
        });
    }
}

fn message(stamp: Stamp, packet: &Packet) -> StampedMessage {
    StampedMessage {
        publisher: stamp.publisher,
        sequence: stamp.sequence,
        published: stamp.published,
        payload: packet.payload.clone(),
    }
}

/// The differences between another link's declaration of a topic and ours.
fn declaration_differences(topic: &super::LinkTopic, theirs: &Refusal) -> String {
    let kinds = format!("{} there, {} here", theirs.kind, topic.kind);
    let lines = differences(topic.schema.lines(), &theirs.schema, REPORTED_LINES);
    match (theirs.kind == topic.kind.to_string(), lines.is_empty()) {
        (false, true) => kinds,
        (false, false) => format!("{kinds}; {}", lines.join("; ")),
        (true, _) => lines.join("; "),
    }
}

/// Converts messages of a host to deliveries.
struct DeliveryContext<'a> {
    host: &'a Arc<str>,
    offset: Option<ClockOffset>,
    now: Timestamp,
    deliveries: &'a mut VecDeque<ReceivedMessage>,
}

impl<'a> DeliveryContext<'a> {
    fn new(
        host: &'a Arc<str>,
        offset: Option<ClockOffset>,
        now: Timestamp,
        deliveries: &'a mut VecDeque<ReceivedMessage>,
    ) -> DeliveryContext<'a> {
        DeliveryContext { host, offset, now, deliveries }
    }

    fn deliver(&mut self, topic: usize, message: StampedMessage) {
        let published = Timestamp::from_nanos(message.published);
        // No message arrives before it was sent, whatever the clocks say.
        let local = self.offset.map_or(self.now, |offset| offset.local(published).min(self.now));
        self.deliveries.push_back(ReceivedMessage {
            host: self.host.clone(),
            topic,
            publisher: message.publisher,
            sequence: message.sequence,
            published,
            local,
            received: self.now,
            payload: message.payload,
        });
    }
}
