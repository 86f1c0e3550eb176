//! A chart as one `enum` and one `match`.
//!
//! [`flatten`] executes the machine itself: from each configuration it takes a step for each event
//! and each combination of condition values, and records the conditions read, the actions executed
//! and the target. A [`FlatMachine`] is thus equivalent to the chart, with regions, history,
//! connectors, raised events and priorities. [`FlatMachine::to_rust`] writes it as Rust code that
//! needs no library, allocates nothing, and is about as fast as a `match` written by hand.
//!
//! Conditions and actions become methods of a trait, which the program implements. `In(state)` and
//! `raise(event)` do not: they are resolved during flattening. A method has one result for all
//! regions. A condition that reads a message that has not arrived does not hold; `!Ball.found` is a
//! separate condition from `Ball.found`.
//!
//! Features with unknown results prevent flattening: activities, timers and durations, deferred
//! events, random choice, values that depend on active states. Such a chart is refused with the
//! reason, and runs on a [`Machine`](yase::Machine). So is a chart with too many configurations;
//! three regions of ten states have a thousand.
//!
//! ```
//! use yase::expression::parse_transition;
//! use yase_codegen::flatten::flatten;
//! use yase::{Node, NodeKind, Semantics, Statechart, Transition};
//!
//! let mut lamp = Statechart::new("lamp");
//! let start = lamp.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let off = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "off"));
//! let on = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "on"));
//! for (source, target, text) in [(start, off, ""), (off, on, "button [!broken]"), (on, off, "button")] {
//!     lamp.connect(Transition { expression: parse_transition(text).0, ..Transition::new(source, target) });
//! }
//! let flat = flatten(&lamp, Semantics::yase(), 100).expect("it is simple enough");
//! assert_eq!((flat.states.len(), flat.conditions.as_slice()), (2, ["!broken".to_owned()].as_slice()));
//! assert!(flat.to_rust().contains("
//!             (State::Off, Event::Button) => {
//!                 if host.not_broken() {
//!                     *self = State::On;
//!                 }
//!             }
//!             (State::On, Event::Button) => *self = State::Off,
//! "));
//! ```
//!
//! | code | what is wrong |
//! |---|---|
//! | E0160 | a feature whose result is not known beforehand |
//! | E0161 | too many configurations or paths, or conditions on a path |
//! | E0162 | a livelock |

mod emit_rust;
mod merge_states;
mod names;
mod recording_host;
mod search;
mod symbols;
mod unused;

use std::sync::Arc;

use yase::Semantics;
use yase::diagnostic::Diagnostic;
use yase::statechart::{NodeId, Statechart};

/// A flattened chart: its behaviour in each configuration for each event.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct FlatMachine {
    /// The chart's name.
    pub name: String,
    /// Its stable states.
    pub states: Vec<FlatState>,
    /// The external events: those that expressions name, in the order of their first occurrence.
    pub events: Vec<FlatEvent>,
    /// The conditions, as text.
    pub conditions: Vec<String>,
    /// The actions, as text.
    pub actions: Vec<String>,
    /// The path at the start.
    pub start: FlatPath,
    /// The paths, by state and by event.
    pub paths: Vec<Vec<FlatPath>>,
}

/// A configuration, with the rest of the chart's state.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct FlatState {
    /// The active nodes, composites before their children; empty when the chart has ended.
    pub configuration: Vec<NodeId>,
    /// The paths of the innermost active nodes.
    pub leaves: Vec<String>,
    /// Whether the chart has ended.
    pub is_over: bool,
}

/// An event.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum FlatEvent {
    /// An event that expressions name.
    Named(String),
    /// Any other event, for charts with transitions for such events.
    Other,
    /// No event, but conditions may have changed, for charts with transitions that wait only for a
    /// condition.
    Nothing,
}

/// The operations of a step in order, and its target.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FlatPath {
    /// Actions and conditions.
    pub pieces: Vec<FlatOp>,
    /// The state at its end, by index.
    pub to: usize,
}

/// An operation of a path.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum FlatOp {
    /// Execute this action, by index.
    Do(usize),
    /// If this condition holds, by index, continue with the given path instead.
    If(usize, FlatPath),
}

/// Flattens a chart with at most `limit` states.
///
/// # Errors
/// All errors of the chart, and all features that prevent flattening.
pub fn flatten(
    chart: &Statechart,
    semantics: Semantics,
    limit: usize,
) -> Result<FlatMachine, Vec<Diagnostic>> {
    let found = symbols::not_known_beforehand(chart);
    if !found.is_empty() {
        return Err(found);
    }
    let words = symbols::SymbolTable::of(chart);
    let vocabulary = yase::TypeEnvironment { scripts: true, ..yase::TypeEnvironment::default() };
    let compiled = Arc::new(words.chart.compile_with(&vocabulary, semantics)?);
    search::search(&compiled, words, limit).map_err(|found| vec![found])
}
