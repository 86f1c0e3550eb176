//! Everything that a chart can do, found by the machine's own steps.
//!
//! [`explore`] runs a chart against all that its surroundings may do, breadth first: events come, activities return, timers expire, messages arrive. What a
//! script of the host's says is free to be true or false, as far as [`Surroundings`] allow, and stays so for the step; what the chart leaves open is taken each
//! way. States of the machine that will do the same are one. What it finds is an [`Exploration`]: its states, the steps between them, which
//! transitions were taken, and the shortest way to each, as a [`Trace`] that [`replay`] plays again.
//!
//! "The same" is what the chart can tell: a timer that was never set is one that is over to a chart that only asks whether it must still wait. Which of them a
//! state was found with first is left open by it, but no step from there hangs on that.
//!
//! Time is left out: any timer that is set may expire next, whatever its length. So a chart does no more than what is found here, and may do less.
//!
//! An exploration is bounded. One that was not finished says so ([`Exploration::is_finished`]): what it has not found may be there all the same.
//!
//! ```
//! use std::sync::Arc;
//! use yase::explore::{Surroundings, explore};
//! use yase::expression::parse_transition;
//! use yase::{Node, NodeKind, Statechart, Transition, Vocabulary};
//!
//! let mut door = Statechart::new("door");
//! let start = door.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let shut = door.add(Statechart::ROOT, Node::new(NodeKind::Basic, "shut"));
//! let open = door.add(Statechart::ROOT, Node::new(NodeKind::Basic, "open"));
//! let broken = door.add(Statechart::ROOT, Node::new(NodeKind::Basic, "broken"));
//! for (source, target, text) in
//!     [(start, shut, ""), (shut, open, "push / raise(creak)"), (open, shut, "creak"), (open, broken, "creak")]
//! {
//!     let expression = parse_transition(text).0;
//!     door.connect(Transition { expression, ..Transition::new(source, target) });
//! }
//! let chart = Arc::new(door.compile(&Vocabulary::default()).expect("the chart is in order"));
//!
//! let found = explore(&chart, &mut Surroundings { events: vec!["push".into()], ..Surroundings::default() }, 1_000);
//! assert!(found.is_finished());
//! assert!(found.was_entered(open) && !found.was_entered(broken), "the first of the two always wins");
//! let way = found.trace_to(found.first(|state| state.is_active(shut)).expect("it is reached"));
//! assert_eq!(way.to_string(), "start\n");
//! ```

mod host;
mod numbers;
mod permits;
mod search;
#[cfg(test)]
mod tests;
mod trace;
mod watch;

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::bits::BitSet;
use crate::chart::Chart;
use crate::expression::ScriptId;
use crate::machine::{MachineErrorKind, Status};
use crate::statechart::{NodeId, TransitionId};

pub(crate) use numbers::Numbers;
pub use search::explore;
pub(crate) use search::go;
pub use trace::{Move, ParseError, Step, Trace, replay};
pub use watch::{Pace, Pending, Seen, Watch, Watched, WatchedState, WatchedStep, watch};

/// Whether a condition may have a value, given those that others have in the same step.
pub type Allows<'a> = dyn FnMut(ScriptId, bool, &[(ScriptId, bool)]) -> bool + 'a;

/// What the surroundings of a chart may do.
pub struct Surroundings<'a> {
    /// The events that come from outside.
    pub events: Vec<String>,
    /// Whether messages arrive: then a step may happen without any other cause.
    pub messages: bool,
    /// Which values conditions may have, given others: asked once for each combination. Any, if there is nothing that says it.
    pub allows: Box<Allows<'a>>,
}

impl Default for Surroundings<'_> {
    fn default() -> Self {
        Surroundings { events: Vec::new(), messages: false, allows: Box::new(|_, _, _| true) }
    }
}

/// A state of the machine, at rest.
#[derive(Clone, Debug)]
pub struct State {
    /// The active nodes, composites before what is in them.
    pub configuration: Vec<NodeId>,
    /// What the machine does.
    pub status: Status,
    /// The states whose activities run.
    pub running: Vec<NodeId>,
    /// The step that led here first, by its number, and from where; that from which the chart was started leads from nowhere.
    came: (Option<usize>, usize),
}

impl State {
    /// Whether a node is active.
    pub fn is_active(&self, node: NodeId) -> bool {
        self.configuration.contains(&node)
    }
}

/// A step from one state to another.
#[derive(Clone, Debug)]
pub struct Edge {
    /// Where it begins, by the state's number.
    pub from: usize,
    /// Where it ends.
    pub to: usize,
    /// Whether it took any transition.
    pub does_something: bool,
    /// The state whose activity returned, if that was its cause.
    pub returned: Option<NodeId>,
    step: usize,
}

/// A step that the machine did not come back from.
#[derive(Clone, Debug)]
pub struct Failure {
    /// The state that it began in; none if the chart was just started.
    pub from: Option<usize>,
    /// The step.
    pub step: Step,
    /// What went wrong.
    pub kind: MachineErrorKind,
    /// The transitions that were taken again and again.
    pub cycle: Vec<TransitionId>,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Exploration {
    chart: Arc<Chart>,
    is_finished: bool,
    states: Vec<State>,
    initial: BTreeSet<usize>,
    edges: Vec<Edge>,
    /// Each different step once.
    steps: Vec<Step>,
    failures: Vec<Failure>,
    seen: Happened,
}

/// What was seen to happen at any time.
#[derive(Clone, Debug)]
struct Happened {
    entered: BitSet,
    left: BitSet,
    taken: BitSet,
    held: BitSet,
}

impl Exploration {
    /// Whether all there is was found.
    pub fn is_finished(&self) -> bool {
        self.is_finished
    }

    /// The states, in the order in which they were found; the first is the one after the start.
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// The states in which the chart may be when it has been started, by number.
    pub fn initial(&self) -> impl Iterator<Item = usize> {
        self.initial.iter().copied()
    }

    /// The steps between states: one for each way in which two are connected, those that do something and lead back to where they began too.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The steps that failed: one for each kind and cycle.
    pub fn failures(&self) -> &[Failure] {
        &self.failures
    }

    /// Whether a node was active at any time.
    pub fn was_entered(&self, node: NodeId) -> bool {
        self.seen.entered.contains(node.0 as usize)
    }

    /// Whether a node was left at any time.
    pub fn was_left(&self, node: NodeId) -> bool {
        self.seen.left.contains(node.0 as usize)
    }

    /// Whether a segment was taken at any time.
    pub fn was_taken(&self, transition: TransitionId) -> bool {
        self.seen.taken.contains(transition.0 as usize)
    }

    /// Whether an event had to wait for running activities at a segment at any time.
    pub fn was_held(&self, transition: TransitionId) -> bool {
        self.seen.held.contains(transition.0 as usize)
    }

    /// The first state of which something is true.
    pub fn first(&self, is_meant: impl Fn(&State) -> bool) -> Option<usize> {
        self.states.iter().position(is_meant)
    }

    /// How many different configurations there are.
    pub fn configurations(&self) -> usize {
        let configurations: BTreeSet<&[NodeId]> =
            self.states.iter().map(|state| state.configuration.as_slice()).collect();
        configurations.len()
    }

    /// The shortest way to a state.
    pub fn trace_to(&self, state: usize) -> Trace {
        Trace::new(self.chart.clone(), self.steps_to(Some(state)))
    }

    fn steps_to(&self, mut state: Option<usize>) -> Vec<Step> {
        let mut steps = Vec::new();
        while let Some(at) = state.and_then(|state| self.states.get(state)) {
            let (from, step) = at.came;
            steps.extend(self.steps.get(step).cloned());
            state = from;
        }
        steps.reverse();
        steps
    }

    /// The shortest way to a step that failed, and that step.
    pub fn trace_of(&self, failure: &Failure) -> Trace {
        let mut steps = self.steps_to(failure.from);
        steps.push(failure.step.clone());
        Trace::new(self.chart.clone(), steps)
    }

    /// The way to a state, and on along edges, by their places among [all](Exploration::edges).
    pub fn trace_along(&self, state: usize, edges: &[usize]) -> Trace {
        let mut steps = self.steps_to(Some(state));
        let along = edges.iter().filter_map(|&edge| self.steps.get(self.edges.get(edge)?.step));
        steps.extend(along.cloned());
        Trace::new(self.chart.clone(), steps)
    }
}
