//! The access of scripts in the host's own language to the machine.

use std::fmt;

use crate::bits::BitSet;
use crate::compile::{CompiledChart, NodeIndex};
use crate::statechart::NodeId;
use crate::timestamp::Timestamp;

/// The active states, as visible to a condition in the host's own language.
#[derive(Clone, Copy, Debug)]
pub struct ActiveStates<'a> {
    pub(crate) chart: &'a CompiledChart,
    pub(crate) active: &'a BitSet,
}

impl ActiveStates<'_> {
    /// Whether a node is active.
    pub fn is_active(&self, node: NodeId) -> bool {
        self.chart.layout.find_index(node).is_some_and(|index: NodeIndex| self.active.contains(index.index()))
    }
}

/// The operations of the machine that an action in the host's own language may use.
pub(crate) trait ScriptMachine: fmt::Debug {
    fn active_states(&self) -> ActiveStates<'_>;
    fn is_complete(&self, node: NodeId) -> bool;
    fn now(&self) -> Timestamp;
    fn raise(&mut self, name: &str, token: u64) -> bool;
}

/// The machine, as visible to an action in the host's own language.
#[derive(Debug)]
pub struct ScriptContext<'a> {
    machine: &'a mut dyn ScriptMachine,
}

impl<'a> ScriptContext<'a> {
    #[inline]
    pub(crate) fn new(machine: &'a mut dyn ScriptMachine) -> ScriptContext<'a> {
        ScriptContext { machine }
    }

    /// Whether a node is active.
    pub fn is_active(&self, node: NodeId) -> bool {
        self.machine.active_states().is_active(node)
    }

    /// Whether a node is active and has completed.
    pub fn is_complete(&self, node: NodeId) -> bool {
        self.machine.is_complete(node)
    }

    /// The time of the step.
    pub fn now(&self) -> Timestamp {
        self.machine.now()
    }

    /// Raises an event, which is offered in the same step, with a token that is passed to
    /// [`Host::event_taken_from_queue`](crate::Host::event_taken_from_queue). Returns whether any
    /// expression of the chart names the event.
    pub fn raise(&mut self, name: &str, token: u64) -> bool {
        self.machine.raise(name, token)
    }
}
