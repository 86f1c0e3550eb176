//! One running document: its machine, its variables, and what it has to remember between steps.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use super::Platform;
use super::event::Event;
use super::exchange::{Exchange, Item, SessionNumber, session_id};
use super::execute::Execution;
use super::prepare::Prepared;
use super::world::{ActiveNodes, World};
use crate::machine::{Machine, Status};
use crate::moment::Moment;
use crate::scxml::language::{Data, Memory, Record};
use crate::statechart::{NodeId, Statechart};

/// One running document.
#[derive(Debug)]
pub(super) struct Process {
    pub(super) prepared: Arc<Prepared>,
    pub(super) machine: Machine,
    pub(super) memory: Memory,
    pub(super) book: Book,
}

/// What a session remembers beside its variables.
#[derive(Debug)]
pub(super) struct Book {
    pub(super) number: SessionNumber,
    pub(super) now: Moment,
    /// The id of the invocation that began it.
    pub(super) invoke_id: Option<String>,
    /// First values that whoever invoked it gave its variables.
    pub(super) given: Vec<(String, Data)>,
    /// Events that are raised as soon as the content is executed.
    pub(super) raised: Vec<Event>,
    /// Events on their way through the machine, by token.
    events: BTreeMap<u64, Event>,
    next_token: u64,
    next_id: u32,
    /// States that were entered and whose invocations have not begun.
    pub(super) to_invoke: BTreeSet<NodeId>,
    /// Invocations that have begun, by their ids.
    pub(super) invocations: BTreeMap<String, Invocation>,
    /// States whose variables have their values.
    pub(super) bound: BTreeSet<NodeId>,
    /// What the events of reached ends carry, by the names of their composites.
    pub(super) done: BTreeMap<String, VecDeque<Data>>,
    /// The end of the document, once it is reached, and what it gives to whoever invoked it.
    pub(super) end: Option<(NodeId, Data)>,
    /// Why the session cannot go on.
    pub(super) fatal: Option<String>,
}

/// A session that was invoked.
#[derive(Clone, Debug)]
pub(super) struct Invocation {
    pub(super) session: SessionNumber,
    /// Its place among the invocations of the document.
    pub(super) index: usize,
}

impl Book {
    /// An id that no other has: of a state's invocation, or of a sent event.
    pub(super) fn new_id(&mut self, prefix: &str) -> String {
        self.next_id += 1;
        format!("{prefix}.{}", self.next_id)
    }

    /// Keeps an event until the machine offers it.
    pub(super) fn keep(&mut self, event: Event) -> u64 {
        self.next_token += 1;
        self.events.insert(self.next_token, event);
        self.next_token
    }

    pub(super) fn take(&mut self, token: u64) -> Option<Event> {
        self.events.remove(&token)
    }
}

impl Process {
    pub(super) fn new(
        number: SessionNumber,
        prepared: Arc<Prepared>,
        invoke_id: Option<String>,
        given: Vec<(String, Data)>,
    ) -> Process {
        let book = Book {
            number,
            now: Moment::ZERO,
            invoke_id,
            given,
            raised: Vec::new(),
            events: BTreeMap::new(),
            next_token: 0,
            next_id: 0,
            to_invoke: BTreeSet::new(),
            invocations: BTreeMap::new(),
            bound: BTreeSet::new(),
            done: BTreeMap::new(),
            end: None,
            fatal: None,
        };
        let machine = Machine::new(prepared.chart.clone());
        Process { prepared, machine, memory: Memory::new(), book }
    }

    pub(super) fn status(&self) -> Status {
        self.machine.status()
    }

    /// The names of the active states.
    pub(super) fn configuration(&self) -> Vec<&str> {
        let chart = self.prepared.chart.statechart();
        let active = self.machine.configuration();
        let end = self.book.end.as_ref().map(|(end, _)| *end).filter(|_| active.is_empty());
        let nodes = active.into_iter().chain(end).filter(|&node| node != Statechart::ROOT);
        nodes.map(|node| chart.node(node).name.as_str()).filter(|name| !name.is_empty()).collect()
    }

    pub(super) fn value(&mut self, variable: &str) -> Option<Data> {
        let value = self.memory.get(variable)?.clone();
        self.memory.heap.export(&value).ok()
    }

    /// Enters the document.
    pub(super) fn start(&mut self, now: Moment, exchange: &mut Exchange, platform: &mut dyn Platform) {
        self.book.now = now;
        if let Err(fault) = self.set_system_variables() {
            self.book.fatal = Some(fault);
        }
        let (machine, mut world) = self.parts(exchange, platform);
        machine.start(now, &mut world);
    }

    fn set_system_variables(&mut self) -> Result<(), String> {
        let id = session_id(self.book.number);
        let heap = &mut self.memory.heap;
        let make = |heap: &mut crate::scxml::language::Heap| {
            let mut processor = Record::default();
            processor.set("location", heap.text(format!("#_scxml_{id}"))?);
            let processor = heap.record(processor, true)?;
            let mut processors = Record::default();
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
        self.memory.set_system("_event", crate::scxml::language::Value::Undefined);
        Ok(())
    }

    /// Takes an event from outside: invocations have their say, then the machine is told.
    pub(super) fn receive(&mut self, event: Event, exchange: &mut Exchange, platform: &mut dyn Platform) {
        self.memory.refresh();
        self.finalize(&event, exchange, platform);
        self.forward(&event, exchange);
        let name = event.name.clone();
        let token = self.book.keep(event);
        self.machine.dispatch_with(&name, token);
    }

    /// Lets the invocation that an event comes from put the event's data in order.
    fn finalize(&mut self, event: &Event, exchange: &mut Exchange, platform: &mut dyn Platform) {
        let Some(id) = event.invoke_id.as_deref() else { return };
        let Some(invocation) = self.book.invocations.get(id).cloned() else { return };
        if exchange.parent(invocation.session).is_none() {
            self.book.invocations.remove(id);
        }
        let prepared = self.prepared.clone();
        let (_, invoke) = &prepared.document.invokes[invocation.index];
        let Some(block) = &invoke.finalize else { return };
        if let Err(fault) = event.show(&mut self.memory) {
            self.book.fatal = Some(fault.message);
            return;
        }
        self.with_execution(exchange, platform, |execution| match block.is_empty() {
            true => execution.take_over(invoke),
            false => execution.block(block),
        });
        // What failed is raised when the event itself has been offered, with the first content that it leads to or after it.
    }

    fn forward(&self, event: &Event, exchange: &mut Exchange) {
        for invocation in self.book.invocations.values() {
            let (_, invoke) = &self.prepared.document.invokes[invocation.index];
            if invoke.autoforward && exchange.parent(invocation.session).is_some() {
                exchange.push(Item::Deliver { to: invocation.session, event: event.clone() });
            }
        }
    }

    /// Hands the events that contents have raised outside a step to the machine.
    pub(super) fn raise_all(&mut self) {
        for event in std::mem::take(&mut self.book.raised) {
            let name = event.name.clone();
            let token = self.book.keep(event);
            self.machine.raise_with(&name, token);
        }
    }

    /// Executes contents outside a step; what fails is an `error.execution`.
    pub(super) fn with_execution(
        &mut self,
        exchange: &mut Exchange,
        platform: &mut dyn Platform,
        execute: impl FnOnce(&mut Execution<'_>) -> super::execute::Executed,
    ) {
        let states =
            ActiveNodes { names: &self.prepared.states, is_active: &|node| self.machine.is_active(node) };
        let mut execution = Execution {
            prepared: &self.prepared,
            memory: &mut self.memory,
            book: &mut self.book,
            exchange,
            platform,
            states: &states,
        };
        let executed = execute(&mut execution);
        execution.tell(executed);
    }

    /// The machine, and the world it runs in.
    pub(super) fn parts<'a>(
        &'a mut self,
        exchange: &'a mut Exchange,
        platform: &'a mut dyn Platform,
    ) -> (&'a mut Machine, World<'a>) {
        let world = World::new(&self.prepared, &mut self.memory, &mut self.book, exchange, platform);
        (&mut self.machine, world)
    }
}
