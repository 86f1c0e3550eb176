//! The data that selection reads of each node, in one compact entry.
//!
//! Most active nodes have no enabled transition in a micro-step, so the speed of selection depends
//! on how fast it rejects them. An entry identifies nodes whose transitions need not be examined:
//! those of which every transition waits for the completion of the node, or for a timer.

use crate::bits::BitSet;
use crate::compile::{
    BranchRange, CompiledNode, EnablingCondition, NodeIndex, NodeOrder, Scope, ScopedGuard, SegmentNode,
};
use crate::semantics::CompletionTrigger;
use crate::statechart::{NodeKind, TransitionId};

/// The data that selection reads of one node.
#[derive(Clone, Debug)]
pub(crate) struct SelectionEntry {
    /// The first node inside it, or the node itself.
    pub(crate) first: NodeIndex,
    pub(crate) gate: CompletionGate,
    /// If each of its transitions without a trigger has a guard that tests a timer first: those
    /// timers.
    pub(crate) timer_gates: Box<[TimerGate]>,
    /// The branches without a trigger, then those with one.
    pub(crate) eventless: BranchRange,
    pub(crate) triggered: BranchRange,
}

/// When the eventless transitions of an active node need to be examined.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum CompletionGate {
    /// Always: some of them do not wait for completion, or completion requires a longer test.
    Open,
    /// Once this activity, by number, has returned `Done`.
    Returned(usize),
    /// Once this END is active, or the node was left without an active child.
    End(NodeIndex),
}

/// The timer that a guard tests first.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct TimerGate {
    /// The index of the timer in the chart.
    pub(crate) timer: usize,
    /// Whether the guard may hold while the timer was never started.
    pub(crate) when_unset: bool,
    /// The segment with the guard.
    pub(crate) transition: TransitionId,
}

/// One entry for each node, by its index.
pub(super) fn entries(
    layout: &NodeOrder,
    states: &[CompiledNode],
    branches: &[SegmentNode],
    guards: &[ScopedGuard],
    regions: &[Scope],
) -> Box<[SelectionEntry]> {
    let entry = |(index, state): (usize, &CompiledNode)| {
        let gate = gate(state, branches);
        SelectionEntry {
            first: layout.first(NodeIndex(index as u32)),
            gate,
            timer_gates: timer_gates(state, gate, branches, guards, regions).unwrap_or_default(),
            eventless: state.eventless,
            triggered: state.triggered,
        }
    };
    states.iter().enumerate().map(entry).collect()
}

pub(super) fn gate(state: &CompiledNode, branches: &[SegmentNode]) -> CompletionGate {
    let waits = |branch: &SegmentNode| branch.condition == EnablingCondition::Completed;
    if state.eventless.is_empty() || !alternatives(state.eventless, branches).all(waits) {
        return CompletionGate::Open;
    }
    match (state.kind, state.activity, &*state.parts) {
        (NodeKind::Basic, Some(activity), _) => CompletionGate::Returned(activity),
        (NodeKind::Or, None, &[end]) => CompletionGate::End(end),
        _ => CompletionGate::Open,
    }
}

/// The timers that the guards of a node's first segments test first; `None` if one of them has
/// another guard, a weight, or a condition that is tested before its guard.
fn timer_gates(
    state: &CompiledNode,
    gate: CompletionGate,
    branches: &[SegmentNode],
    guards: &[ScopedGuard],
    regions: &[Scope],
) -> Option<Box<[TimerGate]>> {
    let mut gates = Vec::new();
    for branch in alternatives(state.eventless, branches) {
        let is_reached = match branch.condition {
            EnablingCondition::Always => true,
            EnablingCondition::Completed => gate != CompletionGate::Open,
            _ => false,
        };
        let ScopedGuard { transition, region, guard } = &guards[branch.guard?];
        if !is_reached || branch.weight.is_some() {
            return None;
        }
        // The literal `false` is tested without a trace.
        if !guard.is_literally_false() {
            let (timer, when_unset) = guard.leading_timer()?;
            let timer = regions[region.index()].timers + timer.0 as usize;
            gates.push(TimerGate { timer, when_unset, transition: *transition });
        }
    }
    Some(gates.into())
}

/// The first segments of the paths in a range.
fn alternatives(range: BranchRange, branches: &[SegmentNode]) -> impl Iterator<Item = &SegmentNode> {
    let mut index = range.start;
    std::iter::from_fn(move || {
        let branch = branches.get(index).filter(|_| index < range.end)?;
        index = branch.skip;
        Some(branch)
    })
}

/// The nodes with transitions without a trigger that may ever be taken. One with the guard
/// `[false]` never is; one with a weight is kept, since it takes part in random choices.
///
/// If completion triggers once, only a START is examined at other times than on its completion.
pub(super) fn eventless_nodes(
    states: &[CompiledNode],
    branches: &[SegmentNode],
    guards: &[ScopedGuard],
    trigger: CompletionTrigger,
) -> BitSet {
    let is_false = |guard: usize| guards[guard].guard.is_literally_false();
    let is_dead = |branch: &SegmentNode| branch.weight.is_none() && branch.guard.is_some_and(is_false);
    let mut nodes = BitSet::new(states.len());
    for (index, state) in states.iter().enumerate() {
        let is_examined = trigger != CompletionTrigger::Once || state.kind == NodeKind::Start;
        if is_examined && alternatives(state.eventless, branches).any(|branch| !is_dead(branch)) {
            nodes.insert(index);
        }
    }
    nodes
}
