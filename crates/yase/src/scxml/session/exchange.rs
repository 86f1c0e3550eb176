//! Events on their way between sessions.

use std::collections::{BTreeMap, VecDeque};

use super::event::Event;
use crate::moment::Moment;

/// A session, by the order in which they were begun.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct SessionNumber(u32);

/// How many events may be on their way at once.
const MAX_EVENTS: usize = 1 << 16;

/// What happens next.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Item {
    /// A session begins.
    Start(SessionNumber),
    /// A session has raised something outside a step.
    Wake(SessionNumber),
    /// An event reaches a session.
    Deliver { to: SessionNumber, event: Event },
}

/// Where a `<send>` sends to.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Target {
    /// The session itself.
    Own,
    /// Its own internal queue.
    Internal,
    /// The session that invoked it.
    Parent,
    /// A session that it has invoked.
    Invoked(String),
    /// A session by its id.
    Session(String),
    /// Something that is no session.
    Elsewhere { kind: String, target: Option<String> },
}

/// An event that waits for its moment.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Delayed {
    pub(super) from: SessionNumber,
    pub(super) target: Target,
    pub(super) event: Event,
}

/// Everything that is on its way.
#[derive(Clone, Debug, Default)]
pub(super) struct Exchange {
    queue: VecDeque<Item>,
    delayed: BTreeMap<(Moment, u64), Delayed>,
    count: u64,
    sessions: u32,
    /// Sessions whose invocation was cancelled, to be ended when the step is over.
    cancelled: VecDeque<SessionNumber>,
    /// Sessions that live, with those that invoked them.
    live: BTreeMap<SessionNumber, Option<SessionNumber>>,
}

/// The id of a session.
pub(super) fn session_id(number: SessionNumber) -> String {
    format!("session.{}", number.0)
}

impl Exchange {
    /// The number of a new session.
    pub(super) fn register(&mut self) -> SessionNumber {
        self.begin(None)
    }

    /// The number of a session that another invokes.
    pub(super) fn begin(&mut self, parent: Option<SessionNumber>) -> SessionNumber {
        self.sessions += 1;
        let number = SessionNumber(self.sessions);
        self.live.insert(number, parent);
        number
    }

    /// The session of an id, if it lives.
    pub(super) fn find(&self, id: &str) -> Option<SessionNumber> {
        let number = SessionNumber(id.strip_prefix("session.")?.parse().ok()?);
        (self.live.contains_key(&number) && session_id(number) == id).then_some(number)
    }

    /// The session that invoked another and has not cancelled it.
    pub(super) fn parent(&self, number: SessionNumber) -> Option<SessionNumber> {
        self.live.get(&number).copied().flatten().filter(|parent| self.live.contains_key(parent))
    }

    /// How many sessions a session lies in.
    pub(super) fn nesting(&self, number: SessionNumber) -> usize {
        std::iter::successors(Some(number), |&number| self.parent(number)).count()
    }

    pub(super) fn push(&mut self, item: Item) {
        self.queue.push_back(item);
    }

    pub(super) fn push_front(&mut self, item: Item) {
        self.queue.push_front(item);
    }

    pub(super) fn pop(&mut self) -> Option<Item> {
        self.queue.pop_front()
    }

    /// Whether no more events may be sent.
    pub(super) fn is_full(&self) -> bool {
        self.queue.len() + self.delayed.len() >= MAX_EVENTS
    }

    pub(super) fn delay(&mut self, due: Moment, delayed: Delayed) {
        self.count += 1;
        self.delayed.insert((due, self.count), delayed);
    }

    pub(super) fn next_deadline(&self) -> Option<Moment> {
        self.delayed.keys().next().map(|&(due, _)| due)
    }

    /// The oldest event that is due.
    pub(super) fn take_due(&mut self, now: Moment) -> Option<Delayed> {
        let entry = self.delayed.first_entry().filter(|entry| entry.key().0 <= now)?;
        Some(entry.remove())
    }

    /// Withdraws what a session has sent under an id and is not due.
    pub(super) fn cancel(&mut self, from: SessionNumber, send_id: &str) {
        self.delayed
            .retain(|_, delayed| delayed.from != from || delayed.event.send_id.as_deref() != Some(send_id));
    }

    /// Cancels the invocation of a session: it has no parent any more, and ends when the step is over.
    pub(super) fn disown(&mut self, number: SessionNumber) {
        if let Some(parent) = self.live.get_mut(&number) {
            *parent = None;
            self.cancelled.push_back(number);
        }
    }

    /// The next session that is to end.
    pub(super) fn next_cancelled(&mut self) -> Option<SessionNumber> {
        self.cancelled.pop_front()
    }

    /// Forgets a session: what it wanted to send later is not sent.
    pub(super) fn end(&mut self, number: SessionNumber) {
        self.live.remove(&number);
        self.delayed.retain(|_, delayed| delayed.from != number);
    }
}
