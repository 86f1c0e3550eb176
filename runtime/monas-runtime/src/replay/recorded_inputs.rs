//! The inputs of an agent that repeats its turns: the publications of others, up to its position in
//! the recording.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use narukom::{AnyPublisher, Header, Observer, Publication, Receiver, RemoteHeader, Timestamp, TopicSlot};

use monas_core::chart_runner::ReplayGuide;
use monas_core::error::Error;

/// A message that was published in the replay.
pub(crate) struct ThreadOutput {
    pub(crate) topic: TopicSlot,
    pub(crate) bytes: Vec<u8>,
}

/// Observes what a thread of an agent publishes, except messages under its name from the recording.
#[derive(Clone)]
pub(crate) struct OwnOutputTap {
    agent: String,
    /// The part of the agent for this thread.
    part: u16,
    state: Arc<Mutex<TapState>>,
}

#[derive(Default)]
struct TapState {
    produced: Vec<ThreadOutput>,
    /// Whether present publications come from the recording.
    ignores_publications: bool,
}

impl OwnOutputTap {
    pub(crate) fn new(agent: &str, part: u16) -> OwnOutputTap {
        OwnOutputTap { agent: agent.to_owned(), part, state: Arc::default() }
    }

    fn heard(&self) -> MutexGuard<'_, TapState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the observed messages since the last call.
    pub(crate) fn take(&self) -> Vec<ThreadOutput> {
        std::mem::take(&mut self.heard().produced)
    }
}

impl Observer for OwnOutputTap {
    fn observe(&mut self, publication: Publication<'_>) {
        let mut heard = self.heard();
        let Header { topic, part, .. } = publication.sample.header;
        if publication.publisher == self.agent && part == self.part && !heard.ignores_publications {
            heard.produced.push(ThreadOutput { topic, bytes: publication.bytes().to_vec() });
        }
    }
}

/// The endpoint at which recorded messages of others are published.
pub(crate) enum InputEndpoint {
    Published(AnyPublisher),
    Received(Receiver),
}

/// A recorded message of another publisher.
pub(crate) struct ExternalMessage {
    /// Its number among all messages of the host's hub, from 1.
    pub(crate) position: u64,
    /// Index of its endpoint.
    pub(crate) endpoint: usize,
    pub(crate) arrival: RemoteHeader,
    /// Shared with the other agents of the host.
    pub(crate) bytes: Arc<[u8]>,
}

/// The messages of others that an agent has not received yet. Clones share the same messages.
#[derive(Clone)]
pub(crate) struct RecordedInputs(Arc<Mutex<RecordedInputState>>);

struct RecordedInputState {
    endpoints: Vec<InputEndpoint>,
    /// Sorted by position.
    waiting: VecDeque<ExternalMessage>,
    /// For each fetch of this turn: the number of the hub's messages by then.
    fetches: VecDeque<u64>,
    /// The positions of the agent's own messages in this turn.
    own: Vec<u64>,
    own_outputs: OwnOutputTap,
    failure: Option<narukom::Error>,
}

impl RecordedInputs {
    pub(crate) fn new(outputs: OwnOutputTap) -> RecordedInputs {
        let (inlets, waiting, fetches, own) = Default::default();
        RecordedInputs(Arc::new(Mutex::new(RecordedInputState {
            endpoints: inlets,
            waiting,
            fetches,
            own,
            own_outputs: outputs,
            failure: None,
        })))
    }

    fn state(&self) -> MutexGuard<'_, RecordedInputState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds an endpoint and returns its index.
    pub(crate) fn add_endpoint(&self, endpoint: InputEndpoint) -> usize {
        let mut state = self.state();
        state.endpoints.push(endpoint);
        state.endpoints.len() - 1
    }

    /// Adds a message for delivery at its position.
    pub(crate) fn add(&self, message: ExternalMessage) {
        self.state().waiting.push_back(message);
    }

    /// Begins a turn with these fetches and positions of the agent's own messages.
    pub(crate) fn begin(&self, fetches: &[u64], own: impl Iterator<Item = u64>) {
        let mut state = self.state();
        state.fetches.clear();
        state.fetches.extend(fetches);
        state.own.clear();
        state.own.extend(own);
    }

    /// Publishes the messages up to a position before which the agent does not read.
    pub(crate) fn publish_until(&self, until: u64) {
        self.state().deliver_until(until);
    }

    /// Begins a turn that was not recorded: messages that had arrived by `now` can be fetched.
    pub(crate) fn begin_unrecorded(&self, now: Timestamp) {
        self.begin(&[], std::iter::empty());
        let mut state = self.state();
        let come = state.waiting.iter().take_while(|message| message.arrival.received <= now);
        if let Some(last) = come.last().map(|message| message.position) {
            state.deliver_until(last);
        }
    }

    /// The error of a delivery, if one failed.
    pub(crate) fn failure(&self) -> Result<(), Error> {
        self.state().failure.take().map_or(Ok(()), |error| Err(Error::hub(error)))
    }
}

impl RecordedInputState {
    /// Delivers the messages up to a position.
    fn deliver_until(&mut self, until: u64) {
        self.own_outputs.heard().ignores_publications = true;
        self.publish_waiting(until);
        self.own_outputs.heard().ignores_publications = false;
    }

    fn publish_waiting(&mut self, until: u64) {
        while self.waiting.front().is_some_and(|message| message.position <= until) {
            let Some(message) = self.waiting.pop_front() else { return };
            let given = match self.endpoints.get_mut(message.endpoint) {
                Some(InputEndpoint::Published(publisher)) => {
                    publisher.publish_bytes(&message.bytes, message.arrival.local)
                }
                Some(InputEndpoint::Received(receiver)) => {
                    receiver.receive_bytes(&message.bytes, message.arrival)
                }
                None => Ok(()),
            };
            self.failure = self.failure.take().or(given.err());
        }
    }
}

impl ReplayGuide for RecordedInputs {
    /// An agent that fetches more often than it did finds nothing new then.
    fn fetching(&mut self) {
        let mut state = self.state();
        if let Some(until) = state.fetches.pop_front() {
            state.deliver_until(until);
        }
    }

    fn publishing(&mut self) {
        let mut state = self.state();
        let published = state.own_outputs.heard().produced.len();
        if let Some(index) = state.own.get(published).copied() {
            state.deliver_until(index.saturating_sub(1));
        }
    }
}
