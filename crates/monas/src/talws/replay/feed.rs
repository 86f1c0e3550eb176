//! What an agent that repeats its turns is given: what others published, up to the points of the recording that it is at.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use narukom::{AnyPublisher, Arrival, Header, Moment, Observer, Publication, Receiver, TopicSlot};

use crate::chart::Lead;
use crate::error::Error;

/// A message that was published in the replay.
pub(super) struct Produced {
    pub(super) topic: TopicSlot,
    pub(super) bytes: Vec<u8>,
}

/// Hears what a thread of an agent publishes, but not what comes under its name from the recording.
#[derive(Clone)]
pub(super) struct Ear {
    agent: String,
    /// Which of the agent's threads it is.
    part: u16,
    heard: Arc<Mutex<Heard>>,
}

#[derive(Default)]
struct Heard {
    produced: Vec<Produced>,
    /// What is published now comes from the recording.
    is_deaf: bool,
}

impl Ear {
    pub(super) fn new(agent: &str, part: u16) -> Ear {
        Ear { agent: agent.to_owned(), part, heard: Arc::default() }
    }

    fn heard(&self) -> MutexGuard<'_, Heard> {
        self.heard.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What was heard since the last time.
    pub(super) fn take(&self) -> Vec<Produced> {
        std::mem::take(&mut self.heard().produced)
    }
}

impl Observer for Ear {
    fn observe(&mut self, publication: Publication<'_>) {
        let mut heard = self.heard();
        let Header { topic, part, .. } = publication.sample.header;
        if publication.publisher == self.agent && part == self.part && !heard.is_deaf {
            heard.produced.push(Produced { topic, bytes: publication.bytes().to_vec() });
        }
    }
}

/// Where messages of others come in again.
pub(super) enum Inlet {
    Published(AnyPublisher),
    Received(Receiver),
}

/// A recorded message of another publisher.
pub(super) struct Foreign {
    /// Its number among all messages of the host's hub, from 1.
    pub(super) position: u64,
    /// The number of its inlet.
    pub(super) inlet: usize,
    pub(super) arrival: Arrival,
    /// Shared with the other agents of the host.
    pub(super) bytes: Arc<[u8]>,
}

/// The messages of others that an agent has not been given yet. Cloning it gives another handle.
#[derive(Clone)]
pub(super) struct Feed(Arc<Mutex<State>>);

struct State {
    inlets: Vec<Inlet>,
    /// In the order of publication.
    waiting: VecDeque<Foreign>,
    /// What the fetches of this turn are to find: how many of the hub's messages.
    fetches: VecDeque<u64>,
    /// Where the agent's own messages of this turn stood.
    own: Vec<u64>,
    ear: Ear,
    failure: Option<narukom::Error>,
}

impl Feed {
    pub(super) fn new(ear: Ear) -> Feed {
        let (inlets, waiting, fetches, own) = Default::default();
        Feed(Arc::new(Mutex::new(State { inlets, waiting, fetches, own, ear, failure: None })))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds an inlet, and answers its number.
    pub(super) fn add_inlet(&self, inlet: Inlet) -> usize {
        let mut state = self.state();
        state.inlets.push(inlet);
        state.inlets.len() - 1
    }

    /// A message is to be given when it is its turn.
    pub(super) fn add(&self, message: Foreign) {
        self.state().waiting.push_back(message);
    }

    /// Begins a turn with these fetches, in which the agent published its messages at these places.
    pub(super) fn begin(&self, fetches: &[u64], own: impl Iterator<Item = u64>) {
        let mut state = self.state();
        state.fetches.clear();
        state.fetches.extend(fetches);
        state.own.clear();
        state.own.extend(own);
    }

    /// Nobody reads yet, nor will before a later message: what has come by now is published.
    pub(super) fn pass(&self, until: u64) {
        self.state().give(until);
    }

    /// Begins a turn that was not recorded, at a moment: what had come by then can be fetched.
    pub(super) fn begin_unrecorded(&self, now: Moment) {
        self.begin(&[], std::iter::empty());
        let mut state = self.state();
        let come = state.waiting.iter().take_while(|message| message.arrival.received <= now);
        if let Some(last) = come.last().map(|message| message.position) {
            state.give(last);
        }
    }

    /// What went wrong when messages were given.
    pub(super) fn failure(&self) -> Result<(), Error> {
        self.state().failure.take().map_or(Ok(()), |error| Err(Error::hub(error)))
    }
}

impl State {
    /// Gives the messages up to a position.
    fn give(&mut self, until: u64) {
        self.ear.heard().is_deaf = true;
        self.publish_waiting(until);
        self.ear.heard().is_deaf = false;
    }

    fn publish_waiting(&mut self, until: u64) {
        while self.waiting.front().is_some_and(|message| message.position <= until) {
            let Some(message) = self.waiting.pop_front() else { return };
            let given = match self.inlets.get_mut(message.inlet) {
                Some(Inlet::Published(publisher)) => {
                    publisher.publish_bytes(&message.bytes, message.arrival.local)
                }
                Some(Inlet::Received(receiver)) => receiver.receive_bytes(&message.bytes, message.arrival),
                None => Ok(()),
            };
            self.failure = self.failure.take().or(given.err());
        }
    }
}

impl Lead for Feed {
    /// An agent that fetches more often than it did finds nothing new then.
    fn fetching(&mut self) {
        let mut state = self.state();
        if let Some(until) = state.fetches.pop_front() {
            state.give(until);
        }
    }

    fn publishing(&mut self) {
        let mut state = self.state();
        let published = state.ear.heard().produced.len();
        if let Some(place) = state.own.get(published).copied() {
            state.give(place.saturating_sub(1));
        }
    }
}
