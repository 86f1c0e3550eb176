//! Sessions inside sessions: how they begin, are cancelled and end; and the steps of all of them.

use std::sync::Arc;

use super::event::{Event, EventKind};
use super::exchange::{Item, SessionNumber, session_id};
use super::execute::{Executed, Execution};
use super::prepare::Prepared;
use super::process::{Invocation, Process};
use super::{MAX_NESTING, Platform, Session};
use crate::diagnostic::{Diagnostic, Source};
use crate::machine::Status;
use crate::scxml::content::{Inner, Invoke};
use crate::scxml::language::{Data, Fault, Value};
use crate::statechart::NodeId;

/// An invocation, evaluated.
pub(super) struct Order {
    id: String,
    text: String,
    name: String,
    given: Vec<(String, Data)>,
}

/// Why a session stopped, and which.
type Stepped = Result<(), (SessionNumber, String)>;

impl Execution<'_> {
    /// The state is left: what was not begun does not begin, what was begun is cancelled.
    pub(super) fn cancel_invocations(&mut self, state: NodeId) {
        self.book.to_invoke.remove(&state);
        let invokes = &self.prepared.document.invokes;
        let exchange = &mut *self.exchange;
        self.book.invocations.retain(|_, invocation| {
            let left = invokes[invocation.index].0 == state;
            if left {
                exchange.disown(invocation.session);
            }
            !left
        });
    }

    /// An empty `<finalize>`: variables take the values of the event's data that are named like them.
    pub(super) fn take_over(&mut self, invoke: &Invoke) -> Executed {
        use crate::scxml::content::ParameterValue::Location;
        let parameters = invoke.parameters.iter().filter_map(|parameter| match &parameter.value {
            Location(location) => Some((parameter.name.as_str(), location)),
            _ => None,
        });
        let names = invoke.names.iter().map(|name| (name.text.as_str(), name));
        for (name, location) in names.chain(parameters) {
            if let Some(value) = self.event_data(name) {
                let location = location.get()?;
                self.evaluation().assign(location, value, true)?;
            }
        }
        Ok(())
    }

    /// A member of the data of `_event`, if it is there.
    fn event_data(&mut self, name: &str) -> Option<Value> {
        let data = self.memory.member_of("_event", "data")?;
        self.memory.heap.member(&data, name)
    }

    fn order(&mut self, state: NodeId, invoke: &Invoke) -> Result<Order, Fault> {
        let kind = invoke.kind.as_ref().map(|kind| self.text(kind)).transpose()?;
        if !kind.as_deref().is_none_or(is_session) {
            return Err(Fault::new(format!("`{}` cannot be invoked", kind.unwrap_or_default())));
        }
        let mut given = self.named(&invoke.names)?;
        self.parameters(&invoke.parameters, &mut given);
        let (name, text) = match (&invoke.source, &invoke.content) {
            (Some(source), _) => {
                let uri = self.text(source)?;
                let text = self.platform.read(&uri);
                let text = text.map_err(|why| Fault::new(format!("`{uri}` cannot be had: {why}")))?;
                (uri, text)
            }
            (None, Some(Inner::Document(text))) => ("content".into(), text.clone()),
            (None, Some(Inner::Expression(code))) => {
                let value = self.value(code)?;
                ("content".into(), self.memory.heap.text_of(&value)?.to_string())
            }
            (None, None) => return Err(Fault::new("nothing is invoked")),
        };
        let id = match &invoke.id {
            Some(id) => id.clone(),
            None => {
                let state = &self.prepared.chart.statechart().node(state).name;
                self.book.new_id(state)
            }
        };
        if let Some(location) = &invoke.id_location {
            self.store(location, &id)?;
        }
        Ok(Order { id, text, name, given })
    }
}

/// Whether a type of invocation is an SCXML session.
fn is_session(kind: &str) -> bool {
    matches!(kind, "scxml" | "http://www.w3.org/TR/scxml" | "http://www.w3.org/TR/scxml/")
}

impl<P: Platform> Session<P> {
    /// Makes the next step of whichever session is due.
    pub(super) fn step(&mut self, item: Item) -> Stepped {
        let (number, event) = match item {
            Item::Start(number) => (number, None),
            Item::Wake(number) => return self.settle(number),
            Item::Deliver { to, event } => (to, Some(event)),
        };
        let Some(process) = self.processes.get_mut(&number) else { return Ok(()) };
        process.book.now = self.now;
        match event {
            None => process.start(self.now, &mut self.exchange, &mut self.platform),
            Some(event) => process.receive(event, &mut self.exchange, &mut self.platform),
        }
        self.settle(number)
    }

    /// Runs a session to completion, begins what it invokes, and goes on as long as that raises errors.
    fn settle(&mut self, number: SessionNumber) -> Stepped {
        loop {
            let Some(process) = self.processes.get_mut(&number) else { return Ok(()) };
            process.book.now = self.now;
            let (machine, mut world) = process.parts(&mut self.exchange, &mut self.platform);
            let run = machine.run_to_completion(self.now, &mut world);
            run.map_err(|error| (number, error.to_string()))?;
            process.memory.refresh();
            if let Some(fatal) = process.book.fatal.take() {
                return Err((number, fatal));
            }
            self.end_cancelled()?;
            let Some(process) = self.processes.get_mut(&number) else { return Ok(()) };
            if process.status() == Status::Running && !process.book.raised.is_empty() {
                process.raise_all();
                continue;
            }
            if process.status() != Status::Running {
                self.finish(number);
                return self.end_cancelled();
            }
            if !self.begin_invocations(number) {
                return Ok(());
            }
        }
    }

    /// Begins what the states that were entered invoke. Says whether that raised anything.
    fn begin_invocations(&mut self, number: SessionNumber) -> bool {
        let Some(process) = self.processes.get_mut(&number) else { return false };
        let states = std::mem::take(&mut process.book.to_invoke);
        let prepared = process.prepared.clone();
        let mut raised = false;
        for state in states {
            let invokes = prepared.document.invokes.iter().enumerate();
            for (index, (_, invoke)) in invokes.filter(|(_, (owner, _))| *owner == state) {
                self.begin_invocation(number, state, index, invoke);
            }
        }
        if let Some(process) = self.processes.get_mut(&number) {
            raised = !process.book.raised.is_empty();
            process.raise_all();
        }
        raised
    }

    fn begin_invocation(&mut self, number: SessionNumber, state: NodeId, index: usize, invoke: &Invoke) {
        let Some(process) = self.processes.get_mut(&number) else { return };
        let mut order = None;
        process.with_execution(&mut self.exchange, &mut self.platform, |execution| {
            order = Some(execution.order(state, invoke)?);
            Ok(())
        });
        let Some(order) = order else { return };
        let prepared = match self.document_of(number, &order) {
            Ok(prepared) => prepared,
            Err(reason) => {
                if let Some(process) = self.processes.get_mut(&number) {
                    let error = Event::error("error.communication", reason);
                    process.book.raised.push(Event { invoke_id: Some(order.id), ..error });
                }
                return;
            }
        };
        let child = self.exchange.begin(Some(number));
        let inner = Process::new(child, prepared, Some(order.id.clone()), order.given);
        self.processes.insert(child, inner);
        self.exchange.push(Item::Start(child));
        if let Some(process) = self.processes.get_mut(&number) {
            let replaced = process.book.invocations.insert(order.id, Invocation { session: child, index });
            if let Some(replaced) = replaced {
                self.exchange.disown(replaced.session);
            }
        }
    }

    fn document_of(&mut self, number: SessionNumber, order: &Order) -> Result<Arc<Prepared>, String> {
        if self.exchange.nesting(number) >= MAX_NESTING {
            return Err(format!("sessions nest deeper than {MAX_NESTING}"));
        }
        if self.processes.len() >= MAX_SESSIONS {
            return Err(format!("more than {MAX_SESSIONS} sessions run at once"));
        }
        let first =
            |found: Vec<Diagnostic>| found.iter().find(|found| found.is_error()).map(ToString::to_string);
        let (document, found) = crate::scxml::read(&Source::new(order.name.as_str(), order.text.as_str()));
        if let Some(error) = first(found) {
            return Err(error);
        }
        let document = document.ok_or("there is no document")?;
        match Prepared::new(&document, self.semantics, &mut self.platform) {
            Ok(prepared) => Ok(Arc::new(prepared)),
            Err(found) => Err(first(found).unwrap_or_default()),
        }
    }

    /// Ends the sessions whose invocations were cancelled: they leave their states, and nobody hears of them any more.
    fn end_cancelled(&mut self) -> Stepped {
        while let Some(number) = self.exchange.next_cancelled() {
            if let Some(mut process) = self.processes.remove(&number) {
                process.memory.refresh();
                process.book.now = self.now;
                let (machine, mut world) = process.parts(&mut self.exchange, &mut self.platform);
                machine.leave(&mut world);
                if let Some(fatal) = process.book.fatal.take() {
                    return Err((number, fatal));
                }
            }
            self.exchange.end(number);
        }
        Ok(())
    }

    /// A session has come to its end: whoever invoked it hears of it.
    fn finish(&mut self, number: SessionNumber) {
        let Some(process) = self.processes.remove(&number) else { return };
        for invocation in process.book.invocations.values() {
            self.exchange.disown(invocation.session);
        }
        if number == self.root {
            self.last = process.configuration().into_iter().map(str::to_owned).collect();
        }
        if let (Some(parent), Some(id)) = (self.exchange.parent(number), &process.book.invoke_id) {
            let event = Event {
                name: format!("done.invoke.{id}"),
                kind: EventKind::External,
                send_id: None,
                origin: Some(format!("#_scxml_{}", session_id(number))),
                origin_type: Some(super::EVENT_PROCESSOR.into()),
                invoke_id: Some(id.clone()),
                data: process.book.end.map(|(_, data)| data).unwrap_or_default(),
            };
            self.exchange.push(Item::Deliver { to: parent, event });
        }
        self.exchange.end(number);
    }
}

/// How many sessions may run at once.
const MAX_SESSIONS: usize = 1000;
