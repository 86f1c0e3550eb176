//! Controls that a link sends: Hello, Beat and refusals.

use std::collections::VecDeque;
use std::sync::Arc;

use narukom::Timestamp;
use prost::Message as _;

use super::{CONTROL_BYTES, Node, Packet, Reliability};
use crate::error::{Error, ErrorKind};
use crate::protocol::VERSION;
use crate::protocol::budget::BudgetWindow;
use crate::protocol::peers::PeerTopicState;
use crate::protocol::wire::{Beat, Control, Echo, Head, Hello, Missing, Offer, Refusal};

/// The most bytes of a control besides its parts, and of a part besides its content.
const CONTROL_OVERHEAD: usize = 24;
const PART_OVERHEAD: usize = 6;

/// The most missing ranges of one topic in a Beat.
const MAX_MISSING_RANGES: usize = 64;

/// The most refusals that wait.
const REFUSAL_LIMIT: usize = 256;

/// The state of the introduction, and the pending refusals.
pub(super) struct Handshake {
    offers: usize,
    /// The next offer to send, if the introduction is not complete.
    next: Option<usize>,
    /// Whether a Hello was requested since the last Beat.
    pub(super) is_asked: bool,
    refusals: VecDeque<Refusal>,
}

impl Handshake {
    /// Begins with an introduction.
    pub(super) fn new(offers: usize) -> Handshake {
        Handshake { offers, next: Some(0), is_asked: false, refusals: VecDeque::new() }
    }

    pub(super) fn is_ready(&self) -> bool {
        self.next.is_some() || !self.refusals.is_empty()
    }

    pub(super) fn refuse(&mut self, refusal: Refusal) {
        if self.refusals.len() < REFUSAL_LIMIT && !self.refusals.contains(&refusal) {
            self.refusals.push_back(refusal);
        }
    }

    /// At most once per beat, however many hosts request it.
    fn restart_if_requested(&mut self) {
        if std::mem::take(&mut self.is_asked) && self.next.is_none() {
            self.next = Some(0);
        }
    }

    /// Continues the introduction with the offer at `index`, or ends it.
    fn set_next_offer(&mut self, index: usize) {
        self.next = (index < self.offers).then_some(index);
    }
}

/// The remaining room of a packet to which parts are added.
struct PacketBuilder(usize);

impl PacketBuilder {
    fn takes(&mut self, part: &impl prost::Message) -> bool {
        let size = part.encoded_len() + PART_OVERHEAD;
        let fits = size <= self.0;
        self.0 -= if fits { size } else { 0 };
        fits
    }
}

impl Node {
    fn room(&self) -> PacketBuilder {
        let limit =
            self.spending.as_ref().map_or(CONTROL_BYTES, |spending| spending.payload().min(CONTROL_BYTES));
        PacketBuilder(limit.saturating_sub(CONTROL_OVERHEAD))
    }

    /// Whether each offer fits into a Hello.
    pub(super) fn check_offers(&self) -> Result<(), Error> {
        let limit = self.spending.as_ref().map_or(CONTROL_BYTES, BudgetWindow::payload);
        for index in 0..self.send.len() {
            let offer = Offer { last: u64::MAX, ..self.offer(index) };
            if !self.room().takes(&offer) {
                let path = &offer.path;
                let needed = offer.encoded_len() + PART_OVERHEAD + CONTROL_OVERHEAD;
                let text =
                    format!("to offer `{path}` takes {needed} bytes, and the budget has packets of {limit}");
                return Err(Error::new(ErrorKind::Settings, text));
            }
        }
        Ok(())
    }

    /// The next control, if one is due.
    pub(super) fn next_control(&mut self, now: Timestamp) -> Option<Packet> {
        if let Some(first) = self.introductions.next {
            let hello = self.hello(first);
            return Some(self.control(Control { hello: Some(hello), ..Control::default() }));
        }
        if now >= self.next_beat {
            self.next_beat = now + self.beat;
            self.introductions.restart_if_requested();
            self.repeat_refusals();
            let beat = self.make_beat(now);
            return Some(self.control(Control { beat: Some(beat), ..Control::default() }));
        }
        let refusal = self.introductions.refusals.pop_front()?;
        Some(self.control(Control { refusal: Some(refusal), ..Control::default() }))
    }

    fn control(&self, control: Control) -> Packet {
        let control = Control { version: VERSION, incarnation: self.incarnation, ..control };
        Packet {
            from: self.host.clone(),
            to: None,
            path: None,
            stamp: Arc::default(),
            payload: control.encode_to_vec().into(),
            priority: 2,
            is_reliable: true,
        }
    }

    fn hello(&mut self, first: usize) -> Hello {
        let mut room = self.room();
        let mut hello = Hello { first: first as u32, total: self.send.len() as u32, offers: Vec::new() };
        let mut index = first;
        while index < self.send.len() {
            let offer = self.offer(index);
            if !room.takes(&offer) {
                break;
            }
            hello.offers.push(offer);
            index += 1;
        }
        self.introductions.set_next_offer(index);
        hello
    }

    fn offer(&self, index: usize) -> Offer {
        let topic = &self.send[index];
        Offer {
            path: topic.path.to_string(),
            kind: topic.kind.to_string(),
            r#type: topic.type_name.to_string(),
            schema: topic.schema.hash().to_vec(),
            reliable: topic.reliability == Reliability::Reliable,
            last: self.outgoing[index].head().1,
        }
    }

    /// Requests for missing messages come first; the progress of the topics fills the rest, in
    /// turn.
    fn make_beat(&mut self, now: Timestamp) -> Beat {
        let mut room = self.room();
        let mut beat = Beat { sent: now.as_nanos(), ..Beat::default() };
        let unknown = self.peers.iter().filter(|peer| peer.is_incomplete()).map(|peer| peer.name.to_string());
        beat.unknown.extend(unknown.filter(|name| room.takes(name)));
        beat.missing.extend(self.missing().into_iter().filter(|missing| room.takes(missing)));
        for peer in &mut self.peers {
            let Some((sent, received)) = peer.beat else { continue };
            let echo = Echo { host: peer.name.to_string(), sent, received: received.as_nanos() };
            if room.takes(&echo) {
                beat.echoes.push(echo);
                peer.beat = None;
            }
        }
        for _ in 0..self.send.len() {
            let index = self.next_head % self.send.len();
            let (first, last) = self.outgoing[index].head();
            let head = Head { offer: index as u32, first, last };
            // A topic without messages has no progress to report.
            if last > 0 && !room.takes(&head) {
                break;
            }
            beat.heads.extend((last > 0).then_some(head));
            self.next_head = index + 1;
        }
        beat
    }

    fn missing(&self) -> Vec<Missing> {
        let mut all = Vec::new();
        for peer in &self.peers {
            for (offer, reading) in peer.topics.iter().enumerate() {
                let Some(PeerTopicState::Read { incoming, .. }) =
                    reading.as_ref().map(|reading| &reading.state)
                else {
                    continue;
                };
                let spans = incoming.missing(MAX_MISSING_RANGES).into_iter();
                all.extend(spans.map(|(first, last)| Missing {
                    host: peer.name.to_string(),
                    offer: offer as u32,
                    first,
                    last,
                }));
            }
        }
        all
    }

    /// Repeats refusals that were not acknowledged.
    fn repeat_refusals(&mut self) {
        for peer in &mut self.peers {
            for (offer, reading) in peer.topics.iter_mut().enumerate() {
                let Some(reading) = reading else { continue };
                let PeerTopicState::Different { tries, .. } = &mut reading.state else { continue };
                let topic = self.wanted.get(&reading.path).map(|index| &self.receive[*index]);
                let Some(topic) = topic.filter(|_| *tries > 0) else { continue };
                *tries -= 1;
                self.introductions.refuse(Refusal {
                    host: peer.name.to_string(),
                    offer: offer as u32,
                    kind: topic.kind.to_string(),
                    schema: topic.schema.lines().to_owned(),
                    is_answer: false,
                });
            }
        }
    }
}
