//! Sending of events, immediate or delayed.

use std::time::Duration;

use super::event::{ScxmlEvent, ScxmlEventKind};
use super::event_router::{DelayedEvent, EventRouter, RouterItem, SendTarget, SessionNumber, session_id};
use super::execute::{Completion, ContentExecutor, ExecutionAbort};
use super::{EVENT_PROCESSOR, Platform, Session};
use crate::content::Send;
use crate::language::EvalError;
use crate::time::delay;

/// Minimum delay: with a shorter one, time might never advance.
const SHORTEST_DELAY: Duration = Duration::from_millis(1);

/// An evaluated `<send>`.
struct SendRequest {
    event: ScxmlEvent,
    target: SendTarget,
    delay: Duration,
}

impl ContentExecutor<'_> {
    pub(crate) fn send(&mut self, send: &Send) -> Completion {
        let id = match (&send.id, &send.id_location) {
            (Some(id), _) => Some(id.clone()),
            (None, Some(location)) => {
                let id = self.state.new_id("send");
                self.store(location, &id)?;
                Some(id)
            }
            (None, None) => None,
        };
        let request = match self.send_request(send, id.clone()) {
            Ok(request) => request,
            Err(fault) => {
                let error = ScxmlEvent { send_id: id, ..ScxmlEvent::error("error.execution", fault.message) };
                self.raise(error)?;
                return Err(ExecutionAbort::AlreadyReported);
            }
        };
        self.send_event(request)
    }

    fn send_request(&mut self, send: &Send, id: Option<String>) -> Result<SendRequest, EvalError> {
        let name = send.event.as_ref().map(|event| self.text(event)).transpose()?.unwrap_or_default();
        let kind = send.kind.as_ref().map(|kind| self.text(kind)).transpose()?;
        let target = send.target.as_ref().map(|target| self.text(target)).transpose()?;
        let delay = match &send.delay {
            None => Duration::ZERO,
            Some(given) => {
                let text = self.text(given)?;
                delay(&text).ok_or_else(|| EvalError::new(format!("`{text}` is not a delay")))?
            }
        };
        let target = address(kind, target)?;
        if target == SendTarget::Internal && !delay.is_zero() {
            return Err(EvalError::new("an event that goes to `#_internal` cannot be delayed"));
        }
        let internal = target == SendTarget::Internal;
        let event = ScxmlEvent {
            name,
            kind: if internal { ScxmlEventKind::Internal } else { ScxmlEventKind::External },
            send_id: id,
            origin: (!internal).then(|| format!("#_scxml_{}", session_id(self.state.number))),
            origin_type: (!internal).then(|| EVENT_PROCESSOR.to_owned()),
            invoke_id: None,
            data: self.payload(&send.payload)?,
        };
        Ok(SendRequest { event, target, delay })
    }

    fn send_event(&mut self, request: SendRequest) -> Completion {
        let SendRequest { event, target, delay } = request;
        if target == SendTarget::Internal {
            return Ok(self.raise(event)?);
        }
        if self.exchange.is_full() {
            let message = "more events are in transit than a session may have";
            self.state.fatal.get_or_insert(message.into());
            return Err(EvalError::new(message).into());
        }
        let delayed = DelayedEvent { from: self.state.number, target, event };
        if !delay.is_zero() {
            self.exchange.delay(self.state.now + delay.max(SHORTEST_DELAY), delayed);
            return Ok(());
        }
        let (invoke_id, invoked) = (self.state.invoke_id.as_deref(), |id: &str| {
            self.state.invocations.get(id).map(|invocation| invocation.session)
        });
        if let Some(error) = deliver(self.exchange, self.platform, delayed, invoke_id, invoked) {
            self.raise(error)?;
        }
        Ok(())
    }
}

/// The target that a type and a target attribute denote.
fn address(kind: Option<String>, target: Option<String>) -> Result<SendTarget, EvalError> {
    match kind.as_deref() {
        None | Some("scxml") => {}
        Some(known) if known == EVENT_PROCESSOR || known == EVENT_PROCESSOR.trim_end_matches('/') => {}
        Some(_) => return Ok(SendTarget::Elsewhere { kind: kind.unwrap_or_default(), target }),
    }
    let Some(target) = target else { return Ok(SendTarget::Own) };
    let Some(location) = target.strip_prefix("#_") else {
        return Err(EvalError::new(format!("`{target}` is not a target")));
    };
    Ok(match location {
        "internal" => SendTarget::Internal,
        "parent" => SendTarget::Parent,
        other => match other.strip_prefix("scxml_") {
            Some(session) => SendTarget::Session(session.to_owned()),
            None => SendTarget::Invoked(other.to_owned()),
        },
    })
}

/// Sends an event. Returns the error for its sender if the target cannot be reached.
fn deliver(
    exchange: &mut EventRouter,
    platform: &mut dyn Platform,
    delayed: DelayedEvent,
    invoke_id: Option<&str>,
    invoked: impl Fn(&str) -> Option<SessionNumber>,
) -> Option<ScxmlEvent> {
    let DelayedEvent { from, target, mut event } = delayed;
    let send_id = event.send_id.clone();
    let failed = |name: &str, reason: String| {
        Some(ScxmlEvent { send_id: send_id.clone(), ..ScxmlEvent::error(name, reason) })
    };
    let to = match &target {
        SendTarget::Own | SendTarget::Internal => Some(from),
        SendTarget::Parent => exchange.parent(from),
        SendTarget::Invoked(id) => invoked(id).filter(|&session| exchange.parent(session) == Some(from)),
        SendTarget::Session(id) => exchange.find(id),
        SendTarget::Elsewhere { kind, target } => {
            if platform.send(kind, target.as_deref(), &event) {
                return None;
            }
            return failed("error.execution", format!("events of type `{kind}` cannot be sent"));
        }
    };
    let Some(to) = to else {
        return failed("error.communication", format!("there is no session to send `{}` to", event.name));
    };
    if exchange.parent(from) == Some(to) {
        event.invoke_id = invoke_id.map(str::to_owned);
    }
    exchange.push(RouterItem::Deliver { to, event });
    None
}

impl<P: Platform> Session<P> {
    /// Sends the events that are due.
    pub(crate) fn release_due(&mut self) {
        while let Some(delayed) = self.exchange.take_due(self.now) {
            let from = delayed.from;
            let Some(process) = self.processes.get_mut(&from) else { continue };
            let book = &process.state;
            let invoked = |id: &str| book.invocations.get(id).map(|invocation| invocation.session);
            let error =
                deliver(&mut self.exchange, &mut self.platform, delayed, book.invoke_id.as_deref(), invoked);
            if let Some(error) = error {
                process.state.raised.push(error);
                process.raise_all();
                self.exchange.push(RouterItem::Wake(from));
            }
        }
    }
}
