//! Identifiers of the parts of a running chart, shared by compiler, host, machine and traces.

use crate::statechart::{NodeId, TransitionId};

/// A scope of a running chart, with its blackboard: number 0 is the root, and each region of an AND
/// has its own. Composites within a region share its scope.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ScopeId(pub u32);

impl ScopeId {
    /// The scope of the root.
    pub const ROOT: ScopeId = ScopeId(0);

    /// The number as an index.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A compound transition of a [`CompiledChart`](crate::CompiledChart): one path from a state
/// through connectors to a state, taken as a unit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CompoundTransitionId(pub(crate) u32);

/// One execution of an activity, from the entry of its state until its final return.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Activation {
    /// The BASIC state.
    pub node: NodeId,
    /// The scope whose blackboard it uses.
    pub region: ScopeId,
    /// The number of the activation, unique within a machine.
    pub number: u64,
}

/// The location of an action list.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum ActionLocation {
    /// On a segment of a transition.
    Transition(TransitionId),
    /// At the entry of a node.
    Entry(NodeId),
    /// At the exit of a node.
    Exit(NodeId),
}
