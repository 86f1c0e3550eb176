//! Typed charts, written down statement by statement.

use std::any::Any;
use std::sync::Arc;
use std::time::Duration;

use super::binding::{Assigned, Program, TypedChart};
use super::world::{Change, Function, Source, Test, Timer, Valuation};
use crate::diagnostic::{Diagnostic, Span};
use crate::expression::{CallError, GuardError, Origin, parse_actions, parse_transition};
use crate::host::ActionPlace;
use crate::statechart::{
    Constant, ConstantValue, Node, NodeId, NodeKind, Statechart, Transition, TransitionId,
};
use crate::vocabulary::Value;

/// The messages behind a [`Source`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Reads {
    /// The path of their topic.
    pub topic: &'static str,
    /// The name of their type in the vocabulary.
    pub message: &'static str,
    /// Who must have published them, if not everybody's count.
    pub publisher: Option<&'static str>,
    /// On which host, if not on this one.
    pub host: Option<&'static str>,
}

impl Reads {
    /// The messages of a topic on this host, whoever publishes them.
    pub const fn own(topic: &'static str, message: &'static str) -> Reads {
        Reads { topic, message, publisher: None, host: None }
    }

    /// Those of one publisher.
    pub const fn by(self, publisher: &'static str) -> Reads {
        Reads { publisher: Some(publisher), ..self }
    }

    /// Those of another host.
    pub const fn on(self, host: &'static str) -> Reads {
        Reads { host: Some(host), ..self }
    }

    pub(super) fn origin(&self) -> Origin {
        match (self.host, self.publisher) {
            (None, None) => Origin::Own,
            (Some(host), None) => Origin::Host(host.into()),
            (None, Some(publisher)) => Origin::Publisher(publisher.into()),
            (Some(host), Some(publisher)) => {
                Origin::HostPublisher { host: host.into(), publisher: publisher.into() }
            }
        }
    }
}

/// A typed chart while it is written down.
///
/// Whatever is wrong is said at the [end](Draft::finish), and what is wrong is left out until then.
#[derive(Debug)]
pub struct Draft {
    chart: Statechart,
    program: Program,
    /// What [`Draft::value`] speaks of.
    place: Option<ActionPlace>,
    found: Vec<Diagnostic>,
}

impl Draft {
    /// A chart with nothing but its root, an OR of the chart's name.
    pub fn new(name: &str) -> Draft {
        Draft { chart: Statechart::new(name), program: Program::default(), place: None, found: Vec::new() }
    }

    /// Gives the root a name other than the chart's.
    pub fn call_root(&mut self, name: &str) {
        name.clone_into(&mut self.chart.node_mut(Statechart::ROOT).name);
    }

    /// Declares the messages behind a source.
    pub fn reads<M>(&mut self, source: Source<M>, reads: Reads) {
        let next = self.program.sources.len();
        self.expect(source.number() == next, || {
            format!("source {} is declared as number {next}", source.number())
        });
        self.program.sources.push(reads);
    }

    /// Declares the name of a timer.
    pub fn starts(&mut self, timer: Timer, name: &'static str) {
        let next = self.program.timers.len();
        self.expect(timer.0 == next, || format!("timer {} is declared as number {next}", timer.0));
        self.program.timers.push(name);
    }

    /// Declares the name of a function.
    pub fn calls(&mut self, function: Function, name: &'static str) {
        let next = self.program.functions.len();
        self.expect(function.0 == next, || format!("function {} is declared as number {next}", function.0));
        self.program.functions.push(name);
    }

    /// Declares which number a value of an enumeration was taken for.
    pub fn means(&mut self, enumeration: &'static str, value: &'static str, number: i32) {
        self.program.enumerations.push((enumeration, value, number));
    }

    /// Adds a constant of the model.
    pub fn constant(&mut self, name: &str, value: impl Into<ConstantValue>) {
        self.chart.constants.push(Constant { name: name.to_owned(), value: value.into() });
    }

    /// Adds a node as the last child of another. Nodes are numbered from the root's 0 in the order in which they are added.
    pub fn add(&mut self, id: impl Into<NodeId>, parent: impl Into<NodeId>, kind: NodeKind, name: &str) {
        let (id, parent) = (id.into(), parent.into());
        let next = NodeId(self.chart.nodes().len() as u32);
        self.expect(id == next, || format!("node {} is added as number {}", id.0, next.0));
        let parent = self.known(parent);
        self.chart.add(parent, Node::new(kind, name));
    }

    /// Says what a BASIC state does while it is active.
    pub fn activity(&mut self, id: impl Into<NodeId>, name: &str) {
        self.node(id).activity = Some(name.to_owned());
    }

    /// Says how urgent that is.
    pub fn priority(&mut self, id: impl Into<NodeId>, priority: i32) {
        self.node(id).priority = priority;
    }

    /// Says how long that takes in simulated time.
    pub fn duration(&mut self, id: impl Into<NodeId>, duration: Duration) {
        self.node(id).duration = Some(duration);
    }

    /// Says which events are kept for later while a state is active.
    pub fn defer(&mut self, id: impl Into<NodeId>, events: &[&str]) {
        self.node(id).defer = events.iter().map(|&event| event.to_owned()).collect();
    }

    /// Says what happens when a state is entered.
    pub fn entry(&mut self, id: impl Into<NodeId>, actions: &str) {
        let id = self.known(id.into());
        let (actions, found) = parse_actions(actions);
        self.found.extend(found);
        self.chart.node_mut(id).entry = actions;
        self.place = Some(ActionPlace::Entry(id));
    }

    /// Says what happens when a state is left.
    pub fn exit(&mut self, id: impl Into<NodeId>, actions: &str) {
        let id = self.known(id.into());
        let (actions, found) = parse_actions(actions);
        self.found.extend(found);
        self.chart.node_mut(id).exit = actions;
        self.place = Some(ActionPlace::Exit(id));
    }

    /// Adds a transition, written as in models. What follows, up to the next one, is about this transition.
    pub fn connect(&mut self, source: impl Into<NodeId>, target: impl Into<NodeId>, expression: &str) {
        let (source, target) = (self.known(source.into()), self.known(target.into()));
        let (expression, found) = parse_transition(expression);
        self.found.extend(found);
        let id = self.chart.connect(Transition { expression, ..Transition::new(source, target) });
        self.place = Some(ActionPlace::Transition(id));
    }

    /// Which function its guard is.
    pub fn guard(&mut self, guard: Test) {
        if let Some(id) = self.transition() {
            self.program.guards.insert(id, guard);
        }
    }

    /// Which function gives the value that action number `index` (from 0) of the last transition, entry or exit assigns, and which
    /// puts it into the message.
    pub fn value<M: Any>(
        &mut self,
        index: usize,
        target: Source<M>,
        value: Valuation,
        put: fn(&mut M, Value<'_>) -> Result<(), CallError>,
    ) {
        let Some(place) = self.place else {
            return self.expect(false, || "a value belongs to no action".to_owned());
        };
        let change = move |message: &mut dyn Any, value: Value<'_>| match message.downcast_mut::<M>() {
            Some(message) => put(message, value),
            None => Err(CallError::new(GuardError::WrongType.to_string())),
        };
        let assigned = Assigned { target: target.number(), value, change: Change(Arc::new(change)) };
        self.program.values.insert((place, index), assigned);
    }

    /// Says that it is tried before those of lower numbers.
    pub fn prefer(&mut self, priority: i32) {
        self.change(|transition| transition.priority = priority);
    }

    /// Says how often it is drawn, among the branches beside it.
    pub fn weight(&mut self, weight: f64) {
        self.change(|transition| transition.weight = Some(weight));
    }

    /// Says that it may leave states whose activities still run.
    pub fn interrupts(&mut self) {
        self.change(|transition| transition.interrupts = true);
    }

    /// Says that it happens inside its source.
    pub fn internal(&mut self) {
        self.change(|transition| transition.internal = true);
    }

    /// The chart.
    ///
    /// # Errors
    /// Everything that is wrong with what was written down.
    pub fn finish(self) -> Result<TypedChart, Vec<Diagnostic>> {
        match self.found.is_empty() {
            true => Ok(TypedChart::new(self.chart, self.program)),
            false => Err(self.found),
        }
    }

    fn node(&mut self, id: impl Into<NodeId>) -> &mut Node {
        let id = self.known(id.into());
        self.chart.node_mut(id)
    }

    fn transition(&mut self) -> Option<TransitionId> {
        let id = match self.place {
            Some(ActionPlace::Transition(id)) => Some(id),
            _ => None,
        };
        self.expect(id.is_some(), || "what belongs to a transition follows none".to_owned());
        id
    }

    fn change(&mut self, change: impl FnOnce(&mut Transition)) {
        if let Some(id) = self.transition() {
            change(self.chart.transition_mut(id));
        }
    }

    /// The node, if there is one of that number; the root, and a finding, if not.
    fn known(&mut self, id: NodeId) -> NodeId {
        let is_known = (id.0 as usize) < self.chart.nodes().len();
        self.expect(is_known, || format!("there is no node {} so far", id.0));
        if is_known { id } else { Statechart::ROOT }
    }

    fn expect(&mut self, holds: bool, message: impl FnOnce() -> String) {
        if !holds {
            self.found.push(Diagnostic::error("E0150", Span::default(), message()));
        }
    }
}
