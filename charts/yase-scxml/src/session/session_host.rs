//! Host of a session's machine: executes contents, evaluates conditions, exposes events.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::Platform;
use super::event::ScxmlEvent;
use super::event_router::EventRouter;
use super::execute::ContentExecutor;
use super::prepare::PreparedDocument;
use super::process::SessionState;
use crate::language::{Evaluator, InPredicate, ScriptMemory};
use yase::ScopeId;
use yase::expression::{CallError, EventId, ScriptId};
use yase::statechart::NodeId;
use yase::{Activation, Host};
use yase::{ActiveStates, ScriptContext};

/// The host of a session's machine, for one step.
pub(crate) struct SessionHost<'a> {
    prepared: &'a PreparedDocument,
    /// Conditions are evaluated through a shared borrow and may create temporary values.
    memory: RefCell<&'a mut ScriptMemory>,
    state: &'a mut SessionState,
    exchange: &'a mut EventRouter,
    platform: &'a mut dyn Platform,
}

/// Looks up active states by name.
pub(crate) struct ActiveNodes<'a> {
    pub(crate) names: &'a BTreeMap<String, NodeId>,
    pub(crate) is_active: &'a dyn Fn(NodeId) -> bool,
}

impl InPredicate for ActiveNodes<'_> {
    fn is_in(&self, state: &str) -> bool {
        self.names.get(state).is_some_and(|&node| (self.is_active)(node))
    }
}

impl<'a> SessionHost<'a> {
    pub(crate) fn new(
        prepared: &'a PreparedDocument,
        memory: &'a mut ScriptMemory,
        state: &'a mut SessionState,
        exchange: &'a mut EventRouter,
        platform: &'a mut dyn Platform,
    ) -> SessionHost<'a> {
        SessionHost { prepared, memory: RefCell::new(memory), state, exchange, platform }
    }

    /// An event created by the machine: an error, or the completion of a state.
    fn own_event(&mut self, name: &str) -> ScxmlEvent {
        let event = ScxmlEvent::platform(name);
        let data = name
            .strip_prefix("done.state.")
            .and_then(|state| self.state.completion_data.get_mut(state)?.pop_front());
        event.with_data(data.unwrap_or_default())
    }
}

impl Host for SessionHost<'_> {
    fn condition(&self, script: ScriptId, _: ScopeId, states: &ActiveStates<'_>) -> Result<bool, CallError> {
        let Some(code) = self.prepared.condition(script) else {
            return Err(CallError::new("the condition is unknown"));
        };
        let active = ActiveNodes { names: &self.prepared.states, is_active: &|node| states.is_active(node) };
        let mut memory = self.memory.borrow_mut();
        let holds = code.get().and_then(|code| Evaluator::new(&mut memory, &active).holds(code));
        holds.map_err(|fault| CallError::new(fault.message))
    }

    fn perform(
        &mut self,
        script: ScriptId,
        _: ScopeId,
        performance: &mut ScriptContext<'_>,
    ) -> Result<(), CallError> {
        let prepared = self.prepared;
        let Some(task) = prepared.task_of(script) else {
            return Err(CallError::new("the content is unknown"));
        };
        let states = ActiveNodes { names: &prepared.states, is_active: &|node| performance.is_active(node) };
        let mut execution = ContentExecutor {
            prepared,
            memory: self.memory.get_mut(),
            state: self.state,
            exchange: self.exchange,
            platform: self.platform,
            states: &states,
        };
        let executed = execution.task(task);
        execution.raise_execution_error(executed);
        for event in std::mem::take(&mut self.state.raised) {
            let name = event.name.clone();
            let token = self.state.keep(event);
            performance.raise(&name, token);
        }
        Ok(())
    }

    fn event_taken_from_queue(&mut self, event: EventId, _: bool, token: u64) {
        let event = match self.state.take(token) {
            Some(event) => event,
            None => self.own_event(self.prepared.chart.events().name(event)),
        };
        if let Err(fault) = event.show(self.memory.get_mut()) {
            self.state.fatal.get_or_insert(fault.message);
        }
    }

    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}
}
