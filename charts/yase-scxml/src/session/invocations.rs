//! Nested sessions: their start, cancellation and end, and the steps of all of them.

use std::sync::Arc;

use super::event::{ScxmlEvent, ScxmlEventKind};
use super::event_router::{RouterItem, SessionNumber, session_id};
use super::execute::{Completion, ContentExecutor};
use super::prepare::PreparedDocument;
use super::process::{Invocation, Process};
use super::{MAX_NESTING, Platform, Session};
use crate::content::{InlineDocument, Invoke};
use crate::language::{DataValue, EvalError, ScriptValue};
use yase::Status;
use yase::diagnostic::{Diagnostic, Source};
use yase::statechart::NodeId;

/// An evaluated invocation.
pub(crate) struct InvokeRequest {
    id: String,
    text: String,
    name: String,
    given: Vec<(String, DataValue)>,
}

/// The session that failed, and why.
type SessionResult = Result<(), (SessionNumber, String)>;

impl ContentExecutor<'_> {
    /// The state is exited: pending invocations do not start, running ones are cancelled.
    pub(crate) fn cancel_invocations(&mut self, state: NodeId) {
        self.state.to_invoke.remove(&state);
        let invokes = &self.prepared.document.invokes;
        let exchange = &mut *self.exchange;
        self.state.invocations.retain(|_, invocation| {
            let left = invokes[invocation.index].0 == state;
            if left {
                exchange.cancel_session(invocation.session);
            }
            !left
        });
    }

    /// An empty `<finalize>`: assigns the event's data to the variables of the same names.
    pub(crate) fn assign_event_data(&mut self, invoke: &Invoke) -> Completion {
        use crate::content::ParameterValue::Location;
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

    /// A member of the data of `_event`, if it exists.
    fn event_data(&mut self, name: &str) -> Option<ScriptValue> {
        let data = self.memory.member_of("_event", "data")?;
        self.memory.heap.member(&data, name)
    }

    fn order(&mut self, state: NodeId, invoke: &Invoke) -> Result<InvokeRequest, EvalError> {
        let kind = invoke.kind.as_ref().map(|kind| self.text(kind)).transpose()?;
        if !kind.as_deref().is_none_or(is_session) {
            return Err(EvalError::new(format!("`{}` cannot be invoked", kind.unwrap_or_default())));
        }
        let mut given = self.named(&invoke.names)?;
        self.parameters(&invoke.parameters, &mut given);
        let (name, text) = match (&invoke.source, &invoke.content) {
            (Some(source), _) => {
                let uri = self.text(source)?;
                let text = self.platform.read(&uri);
                let text = text.map_err(|why| EvalError::new(format!("`{uri}` cannot be had: {why}")))?;
                (uri, text)
            }
            (None, Some(InlineDocument::Document(text))) => ("content".into(), text.clone()),
            (None, Some(InlineDocument::Expression(code))) => {
                let value = self.value(code)?;
                ("content".into(), self.memory.text_of(&value)?.to_string())
            }
            (None, None) => return Err(EvalError::new("nothing is invoked")),
        };
        let id = match &invoke.id {
            Some(id) => id.clone(),
            None => {
                let state = &self.prepared.chart.statechart().node(state).name;
                self.state.new_id(state)
            }
        };
        if let Some(location) = &invoke.id_location {
            self.store(location, &id)?;
        }
        Ok(InvokeRequest { id, text, name, given })
    }
}

/// Whether a type of invocation denotes an SCXML session.
fn is_session(kind: &str) -> bool {
    matches!(kind, "scxml" | "http://www.w3.org/TR/scxml" | "http://www.w3.org/TR/scxml/")
}

impl<P: Platform> Session<P> {
    /// Processes the next item of the router.
    pub(crate) fn step(&mut self, item: RouterItem) -> SessionResult {
        let (number, event) = match item {
            RouterItem::Start(number) => (number, None),
            RouterItem::Wake(number) => return self.run_session_to_completion(number),
            RouterItem::Deliver { to, event } => (to, Some(event)),
        };
        let Some(process) = self.processes.get_mut(&number) else { return Ok(()) };
        process.state.now = self.now;
        match event {
            None => process.start(self.now, &mut self.exchange, &mut self.platform),
            Some(event) => process.receive(event, &mut self.exchange, &mut self.platform),
        }
        self.run_session_to_completion(number)
    }

    /// Runs a session to completion, starts its invocations, and repeats while that raises errors.
    fn run_session_to_completion(&mut self, number: SessionNumber) -> SessionResult {
        loop {
            let Some(process) = self.processes.get_mut(&number) else { return Ok(()) };
            process.state.now = self.now;
            let (machine, mut world) = process.parts(&mut self.exchange, &mut self.platform);
            let run = machine.run_to_completion(self.now, &mut world);
            run.map_err(|error| (number, error.to_string()))?;
            process.memory.refresh();
            if let Some(fatal) = process.state.fatal.take() {
                return Err((number, fatal));
            }
            self.end_cancelled()?;
            let Some(process) = self.processes.get_mut(&number) else { return Ok(()) };
            if process.status() == Status::Running && !process.state.raised.is_empty() {
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

    /// Starts the invocations of entered states. Returns whether that raised events.
    fn begin_invocations(&mut self, number: SessionNumber) -> bool {
        let Some(process) = self.processes.get_mut(&number) else { return false };
        let states = std::mem::take(&mut process.state.to_invoke);
        let prepared = process.prepared.clone();
        let mut raised = false;
        for state in states {
            let invokes = prepared.document.invokes.iter().enumerate();
            for (index, (_, invoke)) in invokes.filter(|(_, (owner, _))| *owner == state) {
                self.begin_invocation(number, state, index, invoke);
            }
        }
        if let Some(process) = self.processes.get_mut(&number) {
            raised = !process.state.raised.is_empty();
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
                    let error = ScxmlEvent::error("error.communication", reason);
                    process.state.raised.push(ScxmlEvent { invoke_id: Some(order.id), ..error });
                }
                return;
            }
        };
        let child = self.exchange.begin(Some(number));
        let inner = Process::new(child, prepared, Some(order.id.clone()), order.given);
        self.processes.insert(child, inner);
        self.exchange.push(RouterItem::Start(child));
        if let Some(process) = self.processes.get_mut(&number) {
            let replaced = process.state.invocations.insert(order.id, Invocation { session: child, index });
            if let Some(replaced) = replaced {
                self.exchange.cancel_session(replaced.session);
            }
        }
    }

    fn document_of(
        &mut self,
        number: SessionNumber,
        order: &InvokeRequest,
    ) -> Result<Arc<PreparedDocument>, String> {
        if self.exchange.nesting(number) >= MAX_NESTING {
            return Err(format!("sessions nest deeper than {MAX_NESTING}"));
        }
        if self.processes.len() >= MAX_SESSIONS {
            return Err(format!("more than {MAX_SESSIONS} sessions run at once"));
        }
        let first =
            |found: Vec<Diagnostic>| found.iter().find(|found| found.is_error()).map(ToString::to_string);
        let (document, found) = crate::read(&Source::new(order.name.as_str(), order.text.as_str()));
        if let Some(error) = first(found) {
            return Err(error);
        }
        let document = document.ok_or("there is no document")?;
        match PreparedDocument::new(&document, self.semantics, &mut self.platform) {
            Ok(prepared) => Ok(Arc::new(prepared)),
            Err(found) => Err(first(found).unwrap_or_default()),
        }
    }

    /// Ends the sessions whose invocations were cancelled: they exit their states without notifying
    /// their parents.
    fn end_cancelled(&mut self) -> SessionResult {
        while let Some(number) = self.exchange.next_cancelled() {
            if let Some(mut process) = self.processes.remove(&number) {
                process.memory.refresh();
                process.state.now = self.now;
                let (machine, mut world) = process.parts(&mut self.exchange, &mut self.platform);
                machine.leave(&mut world);
                if let Some(fatal) = process.state.fatal.take() {
                    return Err((number, fatal));
                }
            }
            self.exchange.end(number);
        }
        Ok(())
    }

    /// Ends a finished session and notifies its parent.
    fn finish(&mut self, number: SessionNumber) {
        let Some(process) = self.processes.remove(&number) else { return };
        for invocation in process.state.invocations.values() {
            self.exchange.cancel_session(invocation.session);
        }
        if number == self.root {
            self.last = process.configuration().into_iter().map(str::to_owned).collect();
        }
        if let (Some(parent), Some(id)) = (self.exchange.parent(number), &process.state.invoke_id) {
            let event = ScxmlEvent {
                name: format!("done.invoke.{id}"),
                kind: ScxmlEventKind::External,
                send_id: None,
                origin: Some(format!("#_scxml_{}", session_id(number))),
                origin_type: Some(super::EVENT_PROCESSOR.into()),
                invoke_id: Some(id.clone()),
                data: process.state.end.map(|(_, data)| data).unwrap_or_default(),
            };
            self.exchange.push(RouterItem::Deliver { to: parent, event });
        }
        self.exchange.end(number);
    }
}

/// Maximum number of running sessions.
const MAX_SESSIONS: usize = 1000;
