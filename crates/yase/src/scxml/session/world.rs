//! The world as the machine of a session sees it: contents are executed, conditions evaluated, events shown.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::Platform;
use super::event::Event;
use super::exchange::Exchange;
use super::execute::Execution;
use super::prepare::Prepared;
use super::process::Book;
use crate::chart::RegionId;
use crate::expression::{CallError, EventId, ScriptId};
use crate::host::{Activation, Host};
use crate::machine::{Performance, States};
use crate::scxml::language::{ActiveStates, Evaluation, Memory};
use crate::statechart::NodeId;

/// The world of a session's machine, for one step.
pub(super) struct World<'a> {
    prepared: &'a Prepared,
    /// Conditions are evaluated on a shared borrow, and may make values that nobody keeps.
    memory: RefCell<&'a mut Memory>,
    book: &'a mut Book,
    exchange: &'a mut Exchange,
    platform: &'a mut dyn Platform,
}

/// Which states are active, by name.
pub(super) struct ActiveNodes<'a> {
    pub(super) names: &'a BTreeMap<String, NodeId>,
    pub(super) is_active: &'a dyn Fn(NodeId) -> bool,
}

impl ActiveStates for ActiveNodes<'_> {
    fn is_in(&self, state: &str) -> bool {
        self.names.get(state).is_some_and(|&node| (self.is_active)(node))
    }
}

impl<'a> World<'a> {
    pub(super) fn new(
        prepared: &'a Prepared,
        memory: &'a mut Memory,
        book: &'a mut Book,
        exchange: &'a mut Exchange,
        platform: &'a mut dyn Platform,
    ) -> World<'a> {
        World { prepared, memory: RefCell::new(memory), book, exchange, platform }
    }

    /// The event that the machine made by itself: an error, or the end of a state.
    fn own_event(&mut self, name: &str) -> Event {
        let event = Event::platform(name);
        let data =
            name.strip_prefix("done.state.").and_then(|state| self.book.done.get_mut(state)?.pop_front());
        event.with_data(data.unwrap_or_default())
    }
}

impl Host for World<'_> {
    fn condition(&self, script: ScriptId, _: RegionId, states: &States<'_>) -> Result<bool, CallError> {
        let Some(code) = self.prepared.condition(script) else {
            return Err(CallError::new("the condition is unknown"));
        };
        let active = ActiveNodes { names: &self.prepared.states, is_active: &|node| states.is_active(node) };
        let mut memory = self.memory.borrow_mut();
        let holds = code.get().and_then(|code| Evaluation::new(&mut memory, &active).holds(code));
        holds.map_err(|fault| CallError::new(fault.message))
    }

    fn perform(
        &mut self,
        script: ScriptId,
        _: RegionId,
        performance: &mut Performance<'_>,
    ) -> Result<(), CallError> {
        let prepared = self.prepared;
        let Some(task) = prepared.task_of(script) else {
            return Err(CallError::new("the content is unknown"));
        };
        let states = ActiveNodes { names: &prepared.states, is_active: &|node| performance.is_active(node) };
        let mut execution = Execution {
            prepared,
            memory: self.memory.get_mut(),
            book: self.book,
            exchange: self.exchange,
            platform: self.platform,
            states: &states,
        };
        let executed = execution.task(task);
        execution.tell(executed);
        for event in std::mem::take(&mut self.book.raised) {
            let name = event.name.clone();
            let token = self.book.keep(event);
            performance.raise(&name, token);
        }
        Ok(())
    }

    fn offered(&mut self, event: EventId, _: bool, token: u64) {
        let event = match self.book.take(token) {
            Some(event) => event,
            None => self.own_event(self.prepared.chart.events().name(event)),
        };
        if let Err(fault) = event.show(self.memory.get_mut()) {
            self.book.fatal.get_or_insert(fault.message);
        }
    }

    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}
}
