//! A chart as one `enum` and one `match`.
//!
//! [`flatten`] has the machine itself find out all that a chart does: it steps from each configuration for each event, once for each way in which the conditions may turn out, and takes
//! note of what is asked, what is done and where that leads. So a [`Flat`] means what the chart means, with regions, history, connectors, raised events and priorities: it decides nothing anew.
//! [`Flat::to_rust`] writes it down as Rust that needs no library, allocates nothing, and takes as long as a `match` that a person wrote.
//!
//! Conditions and actions become methods of a trait, which whoever uses the chart writes. `In(state)` and `raise(event)` do not: they are known beforehand.
//! A method has one answer for all regions. Where a message has not come that a condition reads, the answer is no; `!Ball.found` is asked for as such, and
//! `Ball.found` is another question.
//!
//! What is not known beforehand keeps a chart from being flat: activities, timers and durations, deferred events, random choice, values that say whether a state
//! is active. Such a chart is refused, with the reason, and runs on a
//! [`Machine`](crate::Machine). So is one with very many configurations; three regions of ten states have a thousand.
//!
//! ```
//! use yase::expression::parse_transition;
//! use yase::flatten::flatten;
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
//!                 if world.not_broken() {
//!                     *self = State::On;
//!                 }
//!             }
//!             (State::On, Event::Button) => *self = State::Off,
//! "));
//! ```
//!
//! | code | what is wrong |
//! |---|---|
//! | E0160 | something in the chart is not known beforehand |
//! | E0161 | there are too many configurations or ways |
//! | E0162 | a step has no end |

mod merged;
mod names;
mod print;
mod record;
mod search;
mod unused;
mod words;

use std::sync::Arc;

use crate::diagnostic::Diagnostic;
use crate::semantics::Semantics;
use crate::statechart::{NodeId, Statechart};

/// A chart without depth: what it does from each configuration for each event.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Flat {
    /// The chart's name.
    pub name: String,
    /// What it may be in, when it rests.
    pub states: Vec<FlatState>,
    /// What comes from outside: the events that expressions name, in the order in which they do.
    pub events: Vec<FlatEvent>,
    /// The conditions that are asked, as text.
    pub conditions: Vec<String>,
    /// What is done, as text.
    pub actions: Vec<String>,
    /// What happens when it is started.
    pub start: Way,
    /// What happens, by state and by event.
    pub ways: Vec<Vec<Way>>,
}

/// A configuration, and what else the chart remembers there.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct FlatState {
    /// The active nodes, composites before what is in them; none when it is over.
    pub configuration: Vec<NodeId>,
    /// The paths of the innermost of them.
    pub leaves: Vec<String>,
    /// Whether nothing happens any more.
    pub is_over: bool,
}

/// An event.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum FlatEvent {
    /// One that expressions name.
    Named(String),
    /// Any that they do not: for charts that have transitions for such.
    Other,
    /// None, but conditions may hold that did not: for charts that have transitions which wait for a condition alone.
    Nothing,
}

/// What happens in a step: one after the other, and where it ends.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Way {
    /// What is done and asked.
    pub pieces: Vec<Piece>,
    /// The state at its end, by number.
    pub to: usize,
}

/// A part of a way.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Piece {
    /// This is done, by the number of the action.
    Do(usize),
    /// If this condition holds, by its number, the rest is that way instead.
    If(usize, Way),
}

/// Finds out all that a chart does, if it has no more than `limit` states.
///
/// # Errors
/// Everything that is wrong with the chart, or that keeps it from being flat.
pub fn flatten(chart: &Statechart, semantics: Semantics, limit: usize) -> Result<Flat, Vec<Diagnostic>> {
    let found = words::not_known_beforehand(chart);
    if !found.is_empty() {
        return Err(found);
    }
    let words = words::Words::of(chart);
    let vocabulary = crate::Vocabulary { scripts: true, ..crate::Vocabulary::default() };
    let compiled = Arc::new(words.chart.compile_with(&vocabulary, semantics)?);
    search::search(&compiled, words, limit).map_err(|found| vec![found])
}
