//! Documents that run.

mod event;
mod exchange;
mod execute;
mod invocations;
mod payload;
mod prepare;
mod process;
mod send;
mod world;

use std::collections::BTreeMap;
use std::sync::Arc;

use super::document::Document;
use super::language::Data;
use crate::diagnostic::Diagnostic;
use crate::machine::Status;
use crate::moment::Moment;
use crate::semantics::Semantics;

pub use event::{Event, EventKind};
use exchange::{Exchange, Item, SessionNumber};
use prepare::Prepared;
use process::Process;

/// The kind of targets and senders that sessions are to one another.
pub(super) const EVENT_PROCESSOR: &str = "http://www.w3.org/TR/scxml/#SCXMLEventProcessor";
/// How many sessions may run inside one another.
const MAX_NESTING: usize = 16;
/// How many steps all sessions together may make at one moment.
const MAX_STEPS: usize = 100_000;

/// What is around a session: other documents and files, somebody who reads its log, and whoever it sends events to that is no session.
pub trait Platform {
    /// The text that a URI names: a document to invoke, a script, or data.
    ///
    /// # Errors
    /// Why there is none.
    fn read(&mut self, uri: &str) -> Result<String, String> {
        Err(format!("nothing is known of `{uri}`"))
    }

    /// A session logs something.
    fn log(&mut self, session: &str, label: &str, text: &str) {
        let _ = (session, label, text);
    }

    /// A session sends an event of a kind that is not that of sessions. Says whether such events can be sent.
    fn send(&mut self, kind: &str, target: Option<&str>, event: &Event) -> bool {
        let _ = (kind, target, event);
        false
    }
}

/// A platform on which there is nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPlatform;

impl Platform for NoPlatform {}

/// Why a session stopped by itself.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("session `{session}`: {text}")]
pub struct SessionError {
    session: String,
    text: String,
}

impl SessionError {
    /// The session that stopped: this one, or one inside it.
    pub fn session(&self) -> &str {
        &self.session
    }
}

/// A document that runs, with the sessions it has invoked, on a clock that the caller holds.
///
/// Events are taken one at a time, in the order in which they were sent, whichever session they go to. After each, the session that took it
/// runs to completion; then invocations of states that were entered and not left begin. Sessions inside belong to this one: nothing runs beside it,
/// and two runs that are told the same do the same.
#[derive(Debug)]
pub struct Session<P> {
    platform: P,
    processes: BTreeMap<SessionNumber, Process>,
    exchange: Exchange,
    semantics: Semantics,
    root: SessionNumber,
    now: Moment,
    started: bool,
    steps_now: usize,
    failed: Option<SessionError>,
    last: Vec<String>,
}

impl<P: Platform> Session<P> {
    /// A session that has not been started.
    ///
    /// # Errors
    /// What is wrong with the document's chart, or with a script that it takes from elsewhere.
    pub fn new(document: &Document, platform: P) -> Result<Session<P>, Vec<Diagnostic>> {
        Session::with_semantics(document, platform, Semantics::scxml())
    }

    /// A session that reads its chart another way than SCXML does.
    ///
    /// # Errors
    /// What is wrong with the document's chart, or with a script that it takes from elsewhere.
    pub fn with_semantics(
        document: &Document,
        mut platform: P,
        semantics: Semantics,
    ) -> Result<Session<P>, Vec<Diagnostic>> {
        let prepared = Arc::new(Prepared::new(document, semantics, &mut platform)?);
        let mut exchange = Exchange::default();
        let root = exchange.register();
        let process = Process::new(root, prepared, None, Vec::new());
        Ok(Session {
            platform,
            processes: BTreeMap::from([(root, process)]),
            exchange,
            semantics,
            root,
            now: Moment::ZERO,
            started: false,
            steps_now: 0,
            failed: None,
            last: Vec::new(),
        })
    }

    /// Starts the document; a session is started once.
    ///
    /// # Errors
    /// When a document never comes to rest, or needs more than a session may have.
    pub fn start(&mut self, now: Moment) -> Result<(), SessionError> {
        if self.started {
            return self.run();
        }
        self.started = true;
        self.now = now;
        self.exchange.push_front(Item::Start(self.root));
        self.run()
    }

    /// Sends an event from outside and runs until nothing is left to do now.
    ///
    /// # Errors
    /// When a document never comes to rest, or needs more than a session may have.
    pub fn send(&mut self, event: Event) -> Result<(), SessionError> {
        if self.is_running() {
            let event = Event { kind: EventKind::External, ..event };
            self.exchange.push(Item::Deliver { to: self.root, event });
        }
        self.run()
    }

    /// Lets the time pass: what was to be sent until then is sent, each at its moment. A clock that runs backwards stands still.
    ///
    /// # Errors
    /// When a document never comes to rest, or needs more than a session may have.
    pub fn advance_to(&mut self, moment: Moment) -> Result<(), SessionError> {
        self.run()?;
        while let Some(due) = self.exchange.next_deadline().filter(|&due| due <= moment) {
            self.set_now(due);
            self.release_due();
            self.run()?;
        }
        self.set_now(moment);
        Ok(())
    }

    /// When the next event is due that was sent with a delay.
    pub fn next_deadline(&self) -> Option<Moment> {
        if self.failed.is_some() { None } else { self.exchange.next_deadline() }
    }

    /// The names of the active states in the order of the document, composites before what is in them. Of a session that is over: those
    /// it was in at last.
    pub fn configuration(&self) -> Vec<&str> {
        match self.processes.get(&self.root) {
            Some(process) => process.configuration(),
            None => self.last.iter().map(String::as_str).collect(),
        }
    }

    /// Whether a state is active.
    pub fn is_active(&self, state: &str) -> bool {
        self.configuration().contains(&state)
    }

    /// Whether the document runs: it was started, has not come to its end, and did not fail.
    pub fn is_running(&self) -> bool {
        let status = self.processes.get(&self.root).map(Process::status);
        self.failed.is_none() && status == Some(Status::Running)
    }

    /// Whether the document has come to its end.
    pub fn is_finished(&self) -> bool {
        self.started && self.failed.is_none() && !self.processes.contains_key(&self.root)
    }

    /// What a variable of the document holds; none, if it has none of that name, or is over.
    pub fn value(&mut self, variable: &str) -> Option<Data> {
        self.processes.get_mut(&self.root)?.value(variable)
    }

    /// How many sessions run inside this one, at whatever depth.
    pub fn inner_sessions(&self) -> usize {
        self.processes.keys().filter(|&&number| number != self.root).count()
    }

    /// What is around the session.
    pub fn platform(&self) -> &P {
        &self.platform
    }

    /// What is around the session, to be changed.
    pub fn platform_mut(&mut self) -> &mut P {
        &mut self.platform
    }

    fn set_now(&mut self, moment: Moment) {
        if moment > self.now {
            self.now = moment;
            self.steps_now = 0;
        }
    }

    /// Runs until nothing is left to do at this moment.
    fn run(&mut self) -> Result<(), SessionError> {
        if let Some(error) = &self.failed {
            return Err(error.clone());
        }
        while let Some(item) = self.exchange.pop() {
            self.steps_now += 1;
            let result = match self.steps_now > MAX_STEPS {
                true => Err((self.root, format!("more than {MAX_STEPS} steps at one moment"))),
                false => self.step(item),
            };
            if let Err((number, text)) = result {
                return Err(self.fail(number, text));
            }
        }
        Ok(())
    }

    fn fail(&mut self, number: SessionNumber, text: String) -> SessionError {
        let error = SessionError { session: exchange::session_id(number), text };
        self.last = self.configuration().into_iter().map(str::to_owned).collect();
        self.failed = Some(error.clone());
        error
    }
}
