//! Events that are sent, now or later.

use std::time::Duration;

use super::event::{Event, EventKind};
use super::exchange::{Delayed, Exchange, Item, SessionNumber, Target, session_id};
use super::execute::{Executed, Execution, Stopped};
use super::{EVENT_PROCESSOR, Platform, Session};
use crate::scxml::content::Send;
use crate::scxml::language::Fault;
use crate::scxml::time::delay;

/// A delay is at least this long: a shorter one would keep the time from advancing.
const SHORTEST_DELAY: Duration = Duration::from_millis(1);

/// A `<send>`, evaluated.
struct Letter {
    event: Event,
    target: Target,
    delay: Duration,
}

impl Execution<'_> {
    pub(super) fn send(&mut self, send: &Send) -> Executed {
        let id = match (&send.id, &send.id_location) {
            (Some(id), _) => Some(id.clone()),
            (None, Some(location)) => {
                let id = self.book.new_id("send");
                self.store(location, &id)?;
                Some(id)
            }
            (None, None) => None,
        };
        let letter = match self.letter(send, id.clone()) {
            Ok(letter) => letter,
            Err(fault) => {
                let error = Event { send_id: id, ..Event::error("error.execution", fault.message) };
                self.raise(error)?;
                return Err(Stopped::Told);
            }
        };
        self.post(letter)
    }

    fn letter(&mut self, send: &Send, id: Option<String>) -> Result<Letter, Fault> {
        let name = send.event.as_ref().map(|event| self.text(event)).transpose()?.unwrap_or_default();
        let kind = send.kind.as_ref().map(|kind| self.text(kind)).transpose()?;
        let target = send.target.as_ref().map(|target| self.text(target)).transpose()?;
        let delay = match &send.delay {
            None => Duration::ZERO,
            Some(given) => {
                let text = self.text(given)?;
                delay(&text).ok_or_else(|| Fault::new(format!("`{text}` is no delay")))?
            }
        };
        let target = address(kind, target)?;
        if target == Target::Internal && !delay.is_zero() {
            return Err(Fault::new("an event that goes to `#_internal` cannot be delayed"));
        }
        let internal = target == Target::Internal;
        let event = Event {
            name,
            kind: if internal { EventKind::Internal } else { EventKind::External },
            send_id: id,
            origin: (!internal).then(|| format!("#_scxml_{}", session_id(self.book.number))),
            origin_type: (!internal).then(|| EVENT_PROCESSOR.to_owned()),
            invoke_id: None,
            data: self.payload(&send.payload)?,
        };
        Ok(Letter { event, target, delay })
    }

    fn post(&mut self, letter: Letter) -> Executed {
        let Letter { event, target, delay } = letter;
        if target == Target::Internal {
            return Ok(self.raise(event)?);
        }
        if self.exchange.is_full() {
            let message = "more events are on their way than a session may have";
            self.book.fatal.get_or_insert(message.into());
            return Err(Fault::new(message).into());
        }
        let delayed = Delayed { from: self.book.number, target, event };
        if !delay.is_zero() {
            self.exchange.delay(self.book.now + delay.max(SHORTEST_DELAY), delayed);
            return Ok(());
        }
        let (invoke_id, invoked) = (self.book.invoke_id.as_deref(), |id: &str| {
            self.book.invocations.get(id).map(|invocation| invocation.session)
        });
        if let Some(error) = deliver(self.exchange, self.platform, delayed, invoke_id, invoked) {
            self.raise(error)?;
        }
        Ok(())
    }
}

/// What a type and a target mean.
fn address(kind: Option<String>, target: Option<String>) -> Result<Target, Fault> {
    match kind.as_deref() {
        None | Some("scxml") => {}
        Some(known) if known == EVENT_PROCESSOR || known == EVENT_PROCESSOR.trim_end_matches('/') => {}
        Some(_) => return Ok(Target::Elsewhere { kind: kind.unwrap_or_default(), target }),
    }
    let Some(target) = target else { return Ok(Target::Own) };
    let Some(place) = target.strip_prefix("#_") else {
        return Err(Fault::new(format!("`{target}` is no target")));
    };
    Ok(match place {
        "internal" => Target::Internal,
        "parent" => Target::Parent,
        other => match other.strip_prefix("scxml_") {
            Some(session) => Target::Session(session.to_owned()),
            None => Target::Invoked(other.to_owned()),
        },
    })
}

/// Puts an event on its way. If it cannot reach its target, the error that its sender is to be told.
fn deliver(
    exchange: &mut Exchange,
    platform: &mut dyn Platform,
    delayed: Delayed,
    invoke_id: Option<&str>,
    invoked: impl Fn(&str) -> Option<SessionNumber>,
) -> Option<Event> {
    let Delayed { from, target, mut event } = delayed;
    let send_id = event.send_id.clone();
    let failed =
        |name: &str, reason: String| Some(Event { send_id: send_id.clone(), ..Event::error(name, reason) });
    let to = match &target {
        Target::Own | Target::Internal => Some(from),
        Target::Parent => exchange.parent(from),
        Target::Invoked(id) => invoked(id).filter(|&session| exchange.parent(session) == Some(from)),
        Target::Session(id) => exchange.find(id),
        Target::Elsewhere { kind, target } => {
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
    exchange.push(Item::Deliver { to, event });
    None
}

impl<P: Platform> Session<P> {
    /// Sends what is due now.
    pub(super) fn release_due(&mut self) {
        while let Some(delayed) = self.exchange.take_due(self.now) {
            let from = delayed.from;
            let Some(process) = self.processes.get_mut(&from) else { continue };
            let book = &process.book;
            let invoked = |id: &str| book.invocations.get(id).map(|invocation| invocation.session);
            let error =
                deliver(&mut self.exchange, &mut self.platform, delayed, book.invoke_id.as_deref(), invoked);
            if let Some(error) = error {
                process.book.raised.push(error);
                process.raise_all();
                self.exchange.push(Item::Wake(from));
            }
        }
    }
}
