//! Builder of typed charts.

use std::any::Any;
use std::sync::Arc;
use std::time::Duration;

use super::chart::TypedChart;
use yase::ActionLocation;
use yase::diagnostic::{Diagnostic, Span};
use yase::expression::{CallError, GuardError, parse_actions, parse_transition};
use yase::native::{
    FieldSetter, Function, GuardFn, NativeAssignment, NativeProgram, Source, SourceDeclaration, Timer,
    ValueFn,
};
use yase::statechart::{
    Constant, ConstantValue, Node, NodeId, NodeKind, Statechart, Transition, TransitionId,
};
use yase::vocabulary::Value;

/// Builds a typed chart statement by statement.
///
/// Errors are reported at the [end](TypedChartBuilder::finish); invalid statements are ignored.
#[derive(Debug)]
pub struct TypedChartBuilder {
    chart: Statechart,
    program: NativeProgram,
    /// The actions to which [`TypedChartBuilder::value`] refers.
    location: Option<ActionLocation>,
    found: Vec<Diagnostic>,
}

impl TypedChartBuilder {
    /// A chart with only a root, an OR with the name of the chart.
    pub fn new(name: &str) -> TypedChartBuilder {
        TypedChartBuilder {
            chart: Statechart::new(name),
            program: NativeProgram::default(),
            location: None,
            found: Vec::new(),
        }
    }

    /// Names the root differently from the chart.
    pub fn call_root(&mut self, name: &str) {
        name.clone_into(&mut self.chart.node_mut(Statechart::ROOT).name);
    }

    /// Declares the messages of a source.
    pub fn reads<M>(&mut self, source: Source<M>, reads: SourceDeclaration) {
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

    /// Declares the number assumed for a value of an enumeration.
    pub fn means(&mut self, enumeration: &'static str, value: &'static str, number: i32) {
        self.program.enumerations.push((enumeration, value, number));
    }

    /// Adds a constant of the model.
    pub fn constant(&mut self, name: &str, value: impl Into<ConstantValue>) {
        self.chart.constants.push(Constant { name: name.to_owned(), value: value.into() });
    }

    /// Adds a node as the last child of another. Nodes are numbered in the order of their addition;
    /// the root is 0.
    pub fn add(&mut self, id: impl Into<NodeId>, parent: impl Into<NodeId>, kind: NodeKind, name: &str) {
        let (id, parent) = (id.into(), parent.into());
        let next = NodeId(self.chart.nodes().len() as u32);
        self.expect(id == next, || format!("node {} is added as number {}", id.0, next.0));
        let parent = self.known(parent);
        self.chart.add(parent, Node::new(kind, name));
    }

    /// Sets the activity of a BASIC state.
    pub fn activity(&mut self, id: impl Into<NodeId>, name: &str) {
        self.node(id).activity = Some(name.to_owned());
    }

    /// Sets the priority of the activity.
    pub fn priority(&mut self, id: impl Into<NodeId>, priority: i32) {
        self.node(id).priority = priority;
    }

    /// Sets the duration of the activity in simulated time.
    pub fn duration(&mut self, id: impl Into<NodeId>, duration: Duration) {
        self.node(id).duration = Some(duration);
    }

    /// Sets the deferred events of a state.
    pub fn defer(&mut self, id: impl Into<NodeId>, events: &[&str]) {
        self.node(id).defer = events.iter().map(|&event| event.to_owned()).collect();
    }

    /// Sets the entry actions of a state.
    pub fn entry(&mut self, id: impl Into<NodeId>, actions: &str) {
        let id = self.known(id.into());
        let (actions, found) = parse_actions(actions);
        self.found.extend(found);
        self.chart.node_mut(id).entry = actions;
        self.location = Some(ActionLocation::Entry(id));
    }

    /// Sets the exit actions of a state.
    pub fn exit(&mut self, id: impl Into<NodeId>, actions: &str) {
        let id = self.known(id.into());
        let (actions, found) = parse_actions(actions);
        self.found.extend(found);
        self.chart.node_mut(id).exit = actions;
        self.location = Some(ActionLocation::Exit(id));
    }

    /// Adds a transition in the notation of models. The following calls up to the next one refer to
    /// it.
    pub fn connect(&mut self, source: impl Into<NodeId>, target: impl Into<NodeId>, expression: &str) {
        let (source, target) = (self.known(source.into()), self.known(target.into()));
        let (expression, found) = parse_transition(expression);
        self.found.extend(found);
        let id = self.chart.connect(Transition { expression, ..Transition::new(source, target) });
        self.location = Some(ActionLocation::Transition(id));
    }

    /// Sets the guard function of the transition.
    pub fn guard(&mut self, guard: GuardFn) {
        if let Some(id) = self.transition() {
            self.program.guards.insert(id, guard);
        }
    }

    /// Sets the functions of action number `index` (from 0) of the last transition, entry or exit:
    /// one computes the assigned value, the other stores it in the message.
    pub fn value<M: Any>(
        &mut self,
        index: usize,
        target: Source<M>,
        value: ValueFn,
        put: fn(&mut M, Value<'_>) -> Result<(), CallError>,
    ) {
        let Some(location) = self.location else {
            return self.expect(false, || "a value belongs to no action".to_owned());
        };
        let change = move |message: &mut dyn Any, value: Value<'_>| match message.downcast_mut::<M>() {
            Some(message) => put(message, value),
            None => Err(CallError::new(GuardError::WrongType.to_string())),
        };
        let assigned =
            NativeAssignment { target: target.number(), value, change: FieldSetter(Arc::new(change)) };
        self.program.values.insert((location, index), assigned);
    }

    /// Sets the priority of the transition; higher ones are tried first.
    pub fn prefer(&mut self, priority: i32) {
        self.change(|transition| transition.priority = priority);
    }

    /// Sets the weight of the transition among the branches beside it.
    pub fn weight(&mut self, weight: f64) {
        self.change(|transition| transition.weight = Some(weight));
    }

    /// Lets the transition exit states whose activities are running.
    pub fn interrupts(&mut self) {
        self.change(|transition| transition.interrupts = true);
    }

    /// Makes the transition internal.
    pub fn internal(&mut self) {
        self.change(|transition| transition.internal = true);
    }

    /// Builds the chart.
    ///
    /// # Errors
    /// All errors of the statements.
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
        let id = match self.location {
            Some(ActionLocation::Transition(id)) => Some(id),
            _ => None,
        };
        self.expect(id.is_some(), || "the call must follow a transition".to_owned());
        id
    }

    fn change(&mut self, change: impl FnOnce(&mut Transition)) {
        if let Some(id) = self.transition() {
            change(self.chart.transition_mut(id));
        }
    }

    /// The node with this number; the root, with a diagnostic, if there is none.
    fn known(&mut self, id: NodeId) -> NodeId {
        let is_known = (id.0 as usize) < self.chart.nodes().len();
        self.expect(is_known, || format!("node {} is not declared yet", id.0));
        if is_known { id } else { Statechart::ROOT }
    }

    fn expect(&mut self, holds: bool, message: impl FnOnce() -> String) {
        if !holds {
            self.found.push(Diagnostic::error("E0150", Span::default(), message()));
        }
    }
}
