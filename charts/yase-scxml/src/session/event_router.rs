//! Routing of events between sessions.

use std::collections::{BTreeMap, VecDeque};

use super::event::ScxmlEvent;
use yase::Timestamp;

/// A session, numbered in the order of their starts.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct SessionNumber(u32);

/// Maximum number of undelivered events.
const MAX_EVENTS: usize = 1 << 16;

/// The next item to process.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum RouterItem {
    /// A session begins.
    Start(SessionNumber),
    /// A session has raised something outside a step.
    Wake(SessionNumber),
    /// An event reaches a session.
    Deliver { to: SessionNumber, event: ScxmlEvent },
}

/// Target of a `<send>`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum SendTarget {
    /// The session itself.
    Own,
    /// Its internal queue.
    Internal,
    /// The session that invoked it.
    Parent,
    /// A session that it has invoked.
    Invoked(String),
    /// A session by its id.
    Session(String),
    /// A target that is not a session.
    Elsewhere { kind: String, target: Option<String> },
}

/// A delayed event.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct DelayedEvent {
    pub(crate) from: SessionNumber,
    pub(crate) target: SendTarget,
    pub(crate) event: ScxmlEvent,
}

/// All undelivered events and pending starts.
#[derive(Clone, Debug, Default)]
pub(crate) struct EventRouter {
    queue: VecDeque<RouterItem>,
    delayed: BTreeMap<(Timestamp, u64), DelayedEvent>,
    count: u64,
    sessions: u32,
    /// Sessions with a cancelled invocation, which end after the step.
    cancelled: VecDeque<SessionNumber>,
    /// Live sessions with their parents.
    live: BTreeMap<SessionNumber, Option<SessionNumber>>,
}

/// The id of a session.
pub(crate) fn session_id(number: SessionNumber) -> String {
    format!("session.{}", number.0)
}

impl EventRouter {
    /// The number of a new session.
    pub(crate) fn register(&mut self) -> SessionNumber {
        self.begin(None)
    }

    /// The number of a session that another invokes.
    pub(crate) fn begin(&mut self, parent: Option<SessionNumber>) -> SessionNumber {
        self.sessions += 1;
        let number = SessionNumber(self.sessions);
        self.live.insert(number, parent);
        number
    }

    /// The live session with this id.
    pub(crate) fn find(&self, id: &str) -> Option<SessionNumber> {
        let number = SessionNumber(id.strip_prefix("session.")?.parse().ok()?);
        (self.live.contains_key(&number) && session_id(number) == id).then_some(number)
    }

    /// The session that invoked another and has not cancelled it.
    pub(crate) fn parent(&self, number: SessionNumber) -> Option<SessionNumber> {
        self.live.get(&number).copied().flatten().filter(|parent| self.live.contains_key(parent))
    }

    /// The nesting depth of a session.
    pub(crate) fn nesting(&self, number: SessionNumber) -> usize {
        std::iter::successors(Some(number), |&number| self.parent(number)).count()
    }

    pub(crate) fn push(&mut self, item: RouterItem) {
        self.queue.push_back(item);
    }

    pub(crate) fn push_front(&mut self, item: RouterItem) {
        self.queue.push_front(item);
    }

    pub(crate) fn pop(&mut self) -> Option<RouterItem> {
        self.queue.pop_front()
    }

    /// Whether the maximum number of events is reached.
    pub(crate) fn is_full(&self) -> bool {
        self.queue.len() + self.delayed.len() >= MAX_EVENTS
    }

    pub(crate) fn delay(&mut self, due: Timestamp, delayed: DelayedEvent) {
        self.count += 1;
        self.delayed.insert((due, self.count), delayed);
    }

    /// The number of delayed events of all sessions.
    pub(crate) fn delayed_count(&self) -> usize {
        self.delayed.len()
    }

    pub(crate) fn next_deadline(&self) -> Option<Timestamp> {
        self.delayed.keys().next().map(|&(due, _)| due)
    }

    /// The oldest event that is due.
    pub(crate) fn take_due(&mut self, now: Timestamp) -> Option<DelayedEvent> {
        let entry = self.delayed.first_entry().filter(|entry| entry.key().0 <= now)?;
        Some(entry.remove())
    }

    /// Cancels the delayed events that a session has sent under an id.
    pub(crate) fn cancel(&mut self, from: SessionNumber, send_id: &str) {
        self.delayed
            .retain(|_, delayed| delayed.from != from || delayed.event.send_id.as_deref() != Some(send_id));
    }

    /// Cancels the invocation of a session: it loses its parent, and ends after the step.
    pub(crate) fn cancel_session(&mut self, number: SessionNumber) {
        if let Some(parent) = self.live.get_mut(&number) {
            *parent = None;
            self.cancelled.push_back(number);
        }
    }

    /// The next session to end.
    pub(crate) fn next_cancelled(&mut self) -> Option<SessionNumber> {
        self.cancelled.pop_front()
    }

    /// Removes a session and its delayed events.
    pub(crate) fn end(&mut self, number: SessionNumber) {
        self.live.remove(&number);
        self.delayed.retain(|_, delayed| delayed.from != number);
    }
}
