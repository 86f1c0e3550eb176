//! One running document: its machine, its variables, and its state between steps.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use super::Platform;
use super::event::ScxmlEvent;
use super::event_router::{EventRouter, RouterItem, SessionNumber, session_id};
use super::execute::ContentExecutor;
use super::prepare::PreparedDocument;
use super::session_host::{ActiveNodes, SessionHost};
use crate::language::{DataValue, PropertyMap, ScriptMemory, StepBudget};
use yase::Timestamp;
use yase::statechart::{NodeId, Statechart};
use yase::{Machine, Status};

/// One running document.
#[derive(Debug)]
pub(crate) struct Process {
    pub(crate) prepared: Arc<PreparedDocument>,
    pub(crate) machine: Machine,
    pub(crate) memory: ScriptMemory,
    pub(crate) state: SessionState,
}

/// State of a session other than its variables.
#[derive(Debug)]
pub(crate) struct SessionState {
    pub(crate) number: SessionNumber,
    pub(crate) now: Timestamp,
    /// The id of the invocation that started it.
    pub(crate) invoke_id: Option<String>,
    /// Initial values of variables given by the invoking session.
    pub(crate) given: Vec<(String, DataValue)>,
    /// Events to raise after the current content.
    pub(crate) raised: Vec<ScxmlEvent>,
    /// Events in the queues of the machine, by token.
    events: BTreeMap<u64, ScxmlEvent>,
    next_token: u64,
    next_id: u32,
    /// Entered states whose invocations have not started.
    pub(crate) to_invoke: BTreeSet<NodeId>,
    /// Running invocations, by id.
    pub(crate) invocations: BTreeMap<String, Invocation>,
    /// States whose variables are initialised.
    pub(crate) bound: BTreeSet<NodeId>,
    /// Data of completion events, by the names of their composites.
    pub(crate) completion_data: BTreeMap<String, VecDeque<DataValue>>,
    /// The final state of the document once it is reached, with the data for the invoking session.
    pub(crate) end: Option<(NodeId, DataValue)>,
    /// The error that ended the session.
    pub(crate) fatal: Option<String>,
}

/// An invoked session.
#[derive(Clone, Debug)]
pub(crate) struct Invocation {
    pub(crate) session: SessionNumber,
    /// Its index among the invocations of the document.
    pub(crate) index: usize,
}

impl SessionState {
    /// A unique id for an invocation or a sent event.
    pub(crate) fn new_id(&mut self, prefix: &str) -> String {
        self.next_id += 1;
        format!("{prefix}.{}", self.next_id)
    }

    /// Stores an event until the machine offers it.
    pub(crate) fn keep(&mut self, event: ScxmlEvent) -> u64 {
        self.next_token += 1;
        self.events.insert(self.next_token, event);
        self.next_token
    }

    pub(crate) fn take(&mut self, token: u64) -> Option<ScxmlEvent> {
        self.events.remove(&token)
    }
}

impl Process {
    pub(crate) fn new(
        number: SessionNumber,
        prepared: Arc<PreparedDocument>,
        invoke_id: Option<String>,
        given: Vec<(String, DataValue)>,
    ) -> Process {
        let book = SessionState {
            number,
            now: Timestamp::ZERO,
            invoke_id,
            given,
            raised: Vec::new(),
            events: BTreeMap::new(),
            next_token: 0,
            next_id: 0,
            to_invoke: BTreeSet::new(),
            invocations: BTreeMap::new(),
            bound: BTreeSet::new(),
            completion_data: BTreeMap::new(),
            end: None,
            fatal: None,
        };
        let machine = Machine::new(prepared.chart.clone());
        Process { prepared, machine, memory: ScriptMemory::new(), state: book }
    }

    pub(crate) fn status(&self) -> Status {
        self.machine.status()
    }

    /// The names of the active states.
    pub(crate) fn configuration(&self) -> Vec<&str> {
        let chart = self.prepared.chart.statechart();
        let active = self.machine.configuration();
        let end = self.state.end.as_ref().map(|(end, _)| *end).filter(|_| active.is_empty());
        let nodes = active.into_iter().chain(end).filter(|&node| node != Statechart::ROOT);
        nodes.map(|node| chart.node(node).name.as_str()).filter(|name| !name.is_empty()).collect()
    }

    pub(crate) fn value(&mut self, variable: &str) -> Option<DataValue> {
        let value = self.memory.get(variable)?.clone();
        self.memory.heap.export(&value, &mut StepBudget::default()).ok()
    }

    /// Starts the document.
    pub(crate) fn start(&mut self, now: Timestamp, exchange: &mut EventRouter, platform: &mut dyn Platform) {
        self.state.now = now;
        if let Err(fault) = self.set_system_variables() {
            self.state.fatal = Some(fault);
        }
        let (machine, mut world) = self.parts(exchange, platform);
        machine.start(now, &mut world);
    }

    fn set_system_variables(&mut self) -> Result<(), String> {
        let id = session_id(self.state.number);
        let heap = &mut self.memory.heap;
        let make = |heap: &mut crate::language::Heap| {
            let mut processor = PropertyMap::default();
            processor.set("location", heap.text(format!("#_scxml_{id}"))?);
            let processor = heap.record(processor, true)?;
            let mut processors = PropertyMap::default();
            processors.set(super::EVENT_PROCESSOR, processor.clone());
            processors.set("scxml", processor);
            heap.record(processors, true)
        };
        let processors = make(heap).map_err(|fault| fault.message)?;
        let name = self.prepared.document.name.clone().unwrap_or_default();
        let texts = [("_sessionid", id.clone()), ("_name", name)];
        for (variable, text) in texts {
            let text = self.memory.heap.text(text).map_err(|fault| fault.message)?;
            self.memory.set_system(variable, text);
        }
        self.memory.set_system("_ioprocessors", processors);
        self.memory.set_system("_event", crate::language::ScriptValue::Undefined);
        Ok(())
    }

    /// Processes an external event: first the invocations, then the machine.
    pub(crate) fn receive(
        &mut self,
        event: ScxmlEvent,
        exchange: &mut EventRouter,
        platform: &mut dyn Platform,
    ) {
        self.memory.refresh();
        self.finalize(&event, exchange, platform);
        self.forward(&event, exchange);
        let name = event.name.clone();
        let token = self.state.keep(event);
        self.machine.dispatch_with(&name, token);
    }

    /// Executes the `<finalize>` of the invocation that an event comes from.
    fn finalize(&mut self, event: &ScxmlEvent, exchange: &mut EventRouter, platform: &mut dyn Platform) {
        let Some(id) = event.invoke_id.as_deref() else { return };
        let Some(invocation) = self.state.invocations.get(id).cloned() else { return };
        if exchange.parent(invocation.session).is_none() {
            self.state.invocations.remove(id);
        }
        let prepared = self.prepared.clone();
        let (_, invoke) = &prepared.document.invokes[invocation.index];
        let Some(block) = &invoke.finalize else { return };
        if let Err(fault) = event.show(&mut self.memory) {
            self.state.fatal = Some(fault.message);
            return;
        }
        self.with_execution(exchange, platform, |execution| match block.is_empty() {
            true => execution.assign_event_data(invoke),
            false => execution.block(block),
        });
        // Errors are raised after the event itself has been offered, with the first content that it
        // triggers or after it.
    }

    fn forward(&self, event: &ScxmlEvent, exchange: &mut EventRouter) {
        for invocation in self.state.invocations.values() {
            let (_, invoke) = &self.prepared.document.invokes[invocation.index];
            if invoke.autoforward && exchange.parent(invocation.session).is_some() {
                exchange.push(RouterItem::Deliver { to: invocation.session, event: event.clone() });
            }
        }
    }

    /// Passes the events that contents raised outside a step to the machine.
    pub(crate) fn raise_all(&mut self) {
        for event in std::mem::take(&mut self.state.raised) {
            let name = event.name.clone();
            let token = self.state.keep(event);
            self.machine.raise_with(&name, token);
        }
    }

    /// Executes contents outside a step; a failure raises `error.execution`.
    pub(crate) fn with_execution(
        &mut self,
        exchange: &mut EventRouter,
        platform: &mut dyn Platform,
        execute: impl FnOnce(&mut ContentExecutor<'_>) -> super::execute::Completion,
    ) {
        let states =
            ActiveNodes { names: &self.prepared.states, is_active: &|node| self.machine.is_active(node) };
        let mut execution = ContentExecutor {
            prepared: &self.prepared,
            memory: &mut self.memory,
            state: &mut self.state,
            exchange,
            platform,
            states: &states,
        };
        let executed = execute(&mut execution);
        execution.raise_execution_error(executed);
    }

    /// The machine and its host.
    pub(crate) fn parts<'a>(
        &'a mut self,
        exchange: &'a mut EventRouter,
        platform: &'a mut dyn Platform,
    ) -> (&'a mut Machine, SessionHost<'a>) {
        let world = SessionHost::new(&self.prepared, &mut self.memory, &mut self.state, exchange, platform);
        (&mut self.machine, world)
    }
}
