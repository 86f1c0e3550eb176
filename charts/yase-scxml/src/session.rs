//! Running documents.

mod event;
mod event_router;
mod execute;
mod invocations;
mod payload;
mod prepare;
mod process;
mod send;
mod session_host;

use std::collections::BTreeMap;
use std::sync::Arc;

use super::document::Document;
use super::language::DataValue;
use yase::Semantics;
use yase::Status;
use yase::Timestamp;
use yase::diagnostic::Diagnostic;

pub use event::{ScxmlEvent, ScxmlEventKind};
use event_router::{EventRouter, RouterItem, SessionNumber};
use prepare::PreparedDocument;
use process::Process;

/// Type of the event processor that connects sessions.
pub(crate) const EVENT_PROCESSOR: &str = "http://www.w3.org/TR/scxml/#SCXMLEventProcessor";
/// Maximum nesting of sessions.
const MAX_NESTING: usize = 16;
/// Maximum number of steps of all sessions together at one time.
const MAX_STEPS: usize = 100_000;

/// The environment of a session: access to other documents and files, the log, and targets of
/// events that are not sessions.
pub trait Platform {
    /// The text at a URI: a document to invoke, a script, or data.
    ///
    /// # Errors
    /// The reason why it cannot be read.
    fn read(&mut self, uri: &str) -> Result<String, String> {
        Err(format!("nothing is known of `{uri}`"))
    }

    /// Receives a log entry of a session.
    fn log(&mut self, session: &str, label: &str, text: &str) {
        let _ = (session, label, text);
    }

    /// Sends an event to a target that is not a session. Returns whether such events are supported.
    fn send(&mut self, kind: &str, target: Option<&str>, event: &ScxmlEvent) -> bool {
        let _ = (kind, target, event);
        false
    }
}

/// A platform without files, log and other targets.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPlatform;

impl Platform for NoPlatform {}

/// Why a session stopped with an error.
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

/// A running document with the sessions that it has invoked. The caller supplies the time.
///
/// Events are processed one at a time in the order in which they were sent, to whichever session.
/// After each event the receiving session runs to completion; then the invocations of states that
/// were entered and not left begin. Invoked sessions belong to this one: nothing runs concurrently,
/// and two runs with equal inputs are equal.
#[derive(Debug)]
pub struct Session<P> {
    platform: P,
    processes: BTreeMap<SessionNumber, Process>,
    exchange: EventRouter,
    semantics: Semantics,
    root: SessionNumber,
    now: Timestamp,
    started: bool,
    steps_now: usize,
    failed: Option<SessionError>,
    last: Vec<String>,
}

impl<P: Platform> Session<P> {
    /// Creates a session without starting it.
    ///
    /// # Errors
    /// All errors of the document's chart, or of external scripts.
    pub fn new(document: &Document, platform: P) -> Result<Session<P>, Vec<Diagnostic>> {
        Session::with_semantics(document, platform, Semantics::scxml())
    }

    /// Creates a session with other semantics than those of SCXML.
    ///
    /// # Errors
    /// All errors of the document's chart, or of external scripts.
    pub fn with_semantics(
        document: &Document,
        mut platform: P,
        semantics: Semantics,
    ) -> Result<Session<P>, Vec<Diagnostic>> {
        let prepared = Arc::new(PreparedDocument::new(document, semantics, &mut platform)?);
        let mut exchange = EventRouter::default();
        let root = exchange.register();
        let process = Process::new(root, prepared, None, Vec::new());
        Ok(Session {
            platform,
            processes: BTreeMap::from([(root, process)]),
            exchange,
            semantics,
            root,
            now: Timestamp::ZERO,
            started: false,
            steps_now: 0,
            failed: None,
            last: Vec::new(),
        })
    }

    /// Starts the document. A session is started once.
    ///
    /// # Errors
    /// A document never becomes stable, or a session exceeds a limit.
    pub fn start(&mut self, now: Timestamp) -> Result<(), SessionError> {
        if self.started {
            return self.run();
        }
        self.started = true;
        self.now = now;
        self.exchange.push_front(RouterItem::Start(self.root));
        self.run()
    }

    /// Sends an external event and runs until nothing is left to do at the current time.
    ///
    /// # Errors
    /// A document never becomes stable, or a session exceeds a limit.
    pub fn send(&mut self, event: ScxmlEvent) -> Result<(), SessionError> {
        if self.is_running() {
            let event = ScxmlEvent { kind: ScxmlEventKind::External, ..event };
            self.exchange.push(RouterItem::Deliver { to: self.root, event });
        }
        self.run()
    }

    /// Advances the time; delayed events are sent at their times. A time in the past does not
    /// change the clock.
    ///
    /// # Errors
    /// A document never becomes stable, or a session exceeds a limit.
    pub fn advance_to(&mut self, moment: Timestamp) -> Result<(), SessionError> {
        self.run()?;
        while let Some(due) = self.exchange.next_deadline().filter(|&due| due <= moment) {
            self.set_now(due);
            self.release_due();
            self.run()?;
        }
        self.set_now(moment);
        Ok(())
    }

    /// The time of the next delayed event.
    pub fn next_deadline(&self) -> Option<Timestamp> {
        if self.failed.is_some() { None } else { self.exchange.next_deadline() }
    }

    /// The names of the active states in document order, composites before their children. For a
    /// finished session these are the last ones.
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

    /// Whether the document is running: started, not finished and without an error.
    pub fn is_running(&self) -> bool {
        let status = self.processes.get(&self.root).map(Process::status);
        self.failed.is_none() && status == Some(Status::Running)
    }

    /// Whether the document has finished.
    pub fn is_finished(&self) -> bool {
        self.started && self.failed.is_none() && !self.processes.contains_key(&self.root)
    }

    /// The value of a variable of the document; `None` if there is none with that name, or the
    /// session has ended.
    pub fn value(&mut self, variable: &str) -> Option<DataValue> {
        self.processes.get_mut(&self.root)?.value(variable)
    }

    /// The number of sessions nested in this one, at any depth.
    pub fn inner_sessions(&self) -> usize {
        self.processes.keys().filter(|&&number| number != self.root).count()
    }

    /// The platform of the session.
    pub fn platform(&self) -> &P {
        &self.platform
    }

    /// The platform of the session, mutable.
    pub fn platform_mut(&mut self) -> &mut P {
        &mut self.platform
    }

    fn set_now(&mut self, moment: Timestamp) {
        if moment > self.now {
            self.now = moment;
            self.steps_now = 0;
        }
    }

    /// Runs until nothing is left to do at the current time.
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
        let error = SessionError { session: event_router::session_id(number), text };
        self.last = self.configuration().into_iter().map(str::to_owned).collect();
        self.failed = Some(error.clone());
        error
    }
}
