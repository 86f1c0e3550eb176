//! Exploration of the reachable states of a chart, by the steps of the machine itself.
//!
//! [`explore`] runs a chart breadth-first against all behaviour of its environment: events occur,
//! activities return, timers expire, messages arrive. A script of the host may be true or false, as
//! far as the [`Environment`] allows, and keeps its value for the step; nondeterministic choices
//! are explored with each outcome. States of the machine with equal future behaviour are merged.
//! The result is an [`Exploration`]: its states, the steps between them, the transitions taken, and
//! a shortest path to each as a [`Trace`] that [`replay`] executes again.
//!
//! States are distinguished as far as the chart can: a timer that was never started equals an
//! expired one for a chart that only tests whether it still has to wait. Either may be the one with
//! which a state was discovered; no later step depends on it.
//!
//! Time is ignored: any timer that is set may expire next, regardless of its delay. The result is
//! therefore an over-approximation: a chart may do less.
//!
//! An exploration is bounded in states, in memory and by its caller ([`ExplorationLimits`]). It
//! counts at most [`QUEUED`] waiting occurrences of an event and treats larger numbers as that
//! many. If it is incomplete ([`Exploration::is_finished`]), further behaviour may exist.
//!
//! ```
//! use std::sync::Arc;
//! use yase_explore::{Environment, explore};
//! use yase::expression::parse_transition;
//! use yase::{Node, NodeKind, Statechart, Transition, TypeEnvironment};
//!
//! let mut door = Statechart::new("door");
//! let start = door.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let shut = door.add(Statechart::ROOT, Node::new(NodeKind::Basic, "shut"));
//! let open = door.add(Statechart::ROOT, Node::new(NodeKind::Basic, "open"));
//! let broken = door.add(Statechart::ROOT, Node::new(NodeKind::Basic, "broken"));
//! let transitions =
//!     [(start, shut, ""), (shut, open, "push / raise(creak)"), (open, shut, "creak"), (open, broken, "creak")];
//! for (source, target, text) in transitions {
//!     let expression = parse_transition(text).0;
//!     door.connect(Transition { expression, ..Transition::new(source, target) });
//! }
//! let chart = Arc::new(door.compile(&TypeEnvironment::default()).expect("the chart is in order"));
//!
//! let mut environment = Environment { events: vec!["push".into()], ..Environment::default() };
//! let found = explore(&chart, &mut environment, 1_000);
//! assert!(found.is_finished());
//! // Of the two transitions that `creak` enables, the first always wins.
//! assert!(found.was_entered(open) && !found.was_entered(broken));
//! let state = found.first(|state| state.is_active(shut)).expect("it is reached");
//! assert_eq!(found.trace_to(state).to_string(), "start\n");
//! ```

mod constraint_cache;
mod exploration_limits;
mod host;
mod labelled;
mod row_interner;
mod search;
#[cfg(test)]
mod tests;
mod trace;

use std::collections::BTreeSet;
use std::sync::Arc;

use yase::CompiledChart;
use yase::expression::{EventId, ScriptId};
use yase::statechart::{NodeId, TransitionId};
use yase::{MachineErrorKind, Status};

pub use exploration_limits::{ExplorationLimits, ExplorationProgress, ExplorationStop, QUEUED};
pub use labelled::{
    ClockModel, LabelledGraph, LabelledState, LabelledStep, PendingEvent, StepLabeler, StepObservation,
    explore_labelled, idle_regions,
};
pub use row_interner::RowInterner;
pub use search::{advance_and_step, explore};
pub use trace::{ParseError, StepCause, Trace, TraceStep, replay};

/// Whether a condition may have a value, given the values of others in the same step and the
/// actions whose effects still hold.
pub type ConditionConstraint<'a> = dyn FnMut(ScriptId, bool, &[(ScriptId, bool)]) -> bool + 'a;

/// The effects of actions in the host's language on the data that conditions read.
///
/// An executed action is a fact, like a condition that holds: it is among the known conditions, as
/// true, until another action changes its effect.
pub struct WriteEffects<'a> {
    /// Whether an action may change the value of a condition, or what an earlier action has
    /// written.
    pub changes: Box<dyn Fn(ScriptId, ScriptId) -> bool + 'a>,
    /// Whether the blackboard of a region that is entered shows what the action has written on the
    /// one around it.
    pub is_inherited: Box<dyn Fn(ScriptId) -> bool + 'a>,
}

impl Default for WriteEffects<'_> {
    /// Any action may change anything.
    fn default() -> Self {
        WriteEffects { changes: Box::new(|_, _| true), is_inherited: Box::new(|_| false) }
    }
}

/// The possible behaviour of a chart's environment.
pub struct Environment<'a> {
    /// The external events.
    pub events: Vec<String>,
    /// Whether messages arrive: then a step may happen without any other cause.
    pub messages: bool,
    /// Whether a condition may have a value, given others; called once per combination. The default
    /// allows all values.
    pub allows: Box<ConditionConstraint<'a>>,
    /// The writes of actions.
    pub effects: WriteEffects<'a>,
}

impl Default for Environment<'_> {
    fn default() -> Self {
        Environment {
            events: Vec::new(),
            messages: false,
            allows: Box::new(|_, _, _| true),
            effects: WriteEffects::default(),
        }
    }
}

/// A stable state of the machine.
#[derive(Clone, Debug)]
pub struct ExploredState {
    /// The active nodes, composites before their children.
    pub configuration: Vec<NodeId>,
    /// Status of the machine.
    pub status: Status,
    /// The states whose activities are running.
    pub running: Vec<NodeId>,
    /// Whether the trace to it leads there exactly: on the way no queue was cut short.
    pub is_exact: bool,
    /// The step that reached this state first, by index, and its source; `None` for the initial
    /// step.
    predecessor: (Option<usize>, usize),
}

impl ExploredState {
    /// Whether a node is active.
    pub fn is_active(&self, node: NodeId) -> bool {
        self.configuration.contains(&node)
    }
}

/// A step between two states.
#[derive(Clone, Debug)]
pub struct Edge {
    /// Its source state, by index.
    pub from: usize,
    /// Its target state, by index.
    pub to: usize,
    /// Whether it took a transition.
    pub does_something: bool,
    /// The state whose activity returned, if that was the cause.
    pub returned: Option<NodeId>,
    step: usize,
}

/// A step that failed.
#[derive(Clone, Debug)]
pub struct FailedStep {
    /// Its source state; `None` for the start of the chart.
    pub from: Option<usize>,
    /// The step.
    pub step: TraceStep,
    /// The error.
    pub kind: MachineErrorKind,
    /// The transitions that were taken repeatedly.
    pub cycle: Vec<TransitionId>,
}

/// The result of an exploration.
#[derive(Clone, Debug)]
pub struct Exploration {
    chart: Arc<CompiledChart>,
    stop: Option<ExplorationStop>,
    overflowing: BTreeSet<EventId>,
    states: Vec<ExploredState>,
    initial: BTreeSet<usize>,
    edges: Vec<Edge>,
    /// The distinct steps.
    steps: Vec<TraceStep>,
    failures: Vec<FailedStep>,
    coverage: Coverage,
}

/// Coverage of the exploration, by the index of the node or segment.
#[derive(Clone, Debug)]
struct Coverage {
    entered: Box<[bool]>,
    left: Box<[bool]>,
    taken: Box<[bool]>,
    held: Box<[bool]>,
}

impl Exploration {
    /// Whether the exploration is complete.
    pub fn is_finished(&self) -> bool {
        self.stop.is_none()
    }

    /// Why it is not complete.
    pub fn stop(&self) -> Option<ExplorationStop> {
        self.stop
    }

    /// The names of the events of which more may wait than are distinguished ([`QUEUED`]).
    pub fn overflowing(&self) -> Vec<&str> {
        self.overflowing.iter().map(|&event| self.chart.events().name(event)).collect()
    }

    /// The states in the order of their discovery; the first is the one after the start.
    pub fn states(&self) -> &[ExploredState] {
        &self.states
    }

    /// The possible states after the start, by index.
    pub fn initial(&self) -> impl Iterator<Item = usize> {
        self.initial.iter().copied()
    }

    /// The distinct steps between states, including those that take transitions and return to their
    /// source state.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The failed steps, one per kind of error and cycle.
    pub fn failures(&self) -> &[FailedStep] {
        &self.failures
    }

    /// Whether a node was ever active.
    pub fn was_entered(&self, node: NodeId) -> bool {
        self.coverage.entered.get(node.0 as usize) == Some(&true)
    }

    /// Whether a node was ever exited.
    pub fn was_left(&self, node: NodeId) -> bool {
        self.coverage.left.get(node.0 as usize) == Some(&true)
    }

    /// Whether a segment was ever taken.
    pub fn was_taken(&self, transition: TransitionId) -> bool {
        self.coverage.taken.get(transition.0 as usize) == Some(&true)
    }

    /// Whether an event ever waited for running activities at a segment.
    pub fn was_held(&self, transition: TransitionId) -> bool {
        self.coverage.held.get(transition.0 as usize) == Some(&true)
    }

    /// The first state that satisfies a predicate.
    pub fn first(&self, is_meant: impl Fn(&ExploredState) -> bool) -> Option<usize> {
        self.states.iter().position(is_meant)
    }

    /// The number of distinct configurations.
    pub fn configurations(&self) -> usize {
        let configurations: BTreeSet<&[NodeId]> =
            self.states.iter().map(|state| state.configuration.as_slice()).collect();
        configurations.len()
    }

    /// A shortest trace to a state.
    pub fn trace_to(&self, state: usize) -> Trace {
        Trace::new(self.chart.clone(), self.steps_to(Some(state)))
    }

    fn steps_to(&self, mut state: Option<usize>) -> Vec<TraceStep> {
        let mut steps = Vec::new();
        while let Some(at) = state.and_then(|state| self.states.get(state)) {
            let (from, step) = at.predecessor;
            steps.extend(self.steps.get(step).cloned());
            state = from;
        }
        steps.reverse();
        steps
    }

    /// A shortest trace to a failed step, including that step.
    pub fn trace_of(&self, failure: &FailedStep) -> Trace {
        let mut steps = self.steps_to(failure.from);
        steps.push(failure.step.clone());
        Trace::new(self.chart.clone(), steps)
    }

    /// The trace to a state and along edges, given by their indices in
    /// [`edges`](Exploration::edges).
    pub fn trace_along(&self, state: usize, edges: &[usize]) -> Trace {
        let mut steps = self.steps_to(Some(state));
        let along = edges.iter().filter_map(|&edge| self.steps.get(self.edges.get(edge)?.step));
        steps.extend(along.cloned());
        Trace::new(self.chart.clone(), steps)
    }
}
