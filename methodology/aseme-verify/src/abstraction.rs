//! Abstraction of a chart from its program, so that it can be explored alone.
//!
//! Conditions on messages and functions become free inputs, as far as [`logic`](crate::logic) finds
//! them satisfiable together; timers and states keep their meaning. The value of an assignment is
//! known until the next messages are delivered; other actions may change anything that their
//! blackboard shows. Arrivals of messages become events.

mod assignment;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use yase::expression::{
    Action, ActionKind, Expression, ExpressionKind, Name, Path, ScriptId, TransitionExpression, Trigger,
};
use yase::statechart::Constant;
use yase::{CompiledChart, Diagnostic, Source, Statechart, TypeEnvironment};
use yase_explore::{Environment, WriteEffects};

use crate::checked_model::timers;
use crate::checked_model::{CheckedModel, in_source, subject_of};
use crate::logic::{Claim, GuardSolver};
pub(crate) use assignment::{Assignment, may_be_one_message, same_message};

/// A chart to be explored, and the meaning of its conditions.
pub(crate) struct Abstraction {
    pub(crate) chart: Arc<CompiledChart>,
    /// The condition that each script represents.
    pub(crate) conditions: Vec<Option<Expression>>,
    /// The assignment that each script stands for.
    pub(crate) assignments: Vec<Option<Assignment>>,
    /// The facts that hold after its execution.
    facts: Vec<Option<Expression>>,
    /// The events that triggers await, as written.
    pub(crate) awaited: Vec<Path>,
    pub(crate) constants: Vec<Constant>,
    /// The external events.
    events: Vec<String>,
}

impl Abstraction {
    /// Builds the abstraction of a chart.
    pub(crate) fn new(subject: &CheckedModel) -> Result<Abstraction, Vec<Diagnostic>> {
        let mut making = AbstractionBuilder {
            timers: timers::started(subject).into_keys().collect(),
            conditions: BTreeMap::new(),
            assignments: BTreeMap::new(),
        };
        let mut chart = subject.chart.clone();
        let ids: Vec<_> = chart.transitions().map(|(id, _)| id).collect();
        for id in ids {
            let board = timers::blackboard(subject, id);
            let expression = making.expression(&subject.transition(id).expression, board);
            chart.transition_mut(id).expression = expression;
        }
        let ids: Vec<_> = chart.nodes().map(|(id, _)| id).collect();
        for id in ids {
            let node = chart.node_mut(id);
            node.entry = making.actions(&node.entry);
            node.exit = making.actions(&node.exit);
        }
        let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
        let compiled = chart.compile_with(&vocabulary, subject.semantics)?;
        let conditions = compiled.scripts().map(|entry| making.conditions.get(entry.text).cloned()).collect();
        let assigned = |entry: yase::ScriptEntry<'_>| making.assignments.get(entry.text).cloned();
        let assignments: Vec<Option<Assignment>> = compiled.scripts().map(assigned).collect();
        let constants = chart.constants.clone();
        let facts = assignments.iter().map(|it| it.as_ref()?.fact(&constants)).collect();
        let (events, awaited) = (outside(&chart), awaited(&subject.chart));
        let chart = Arc::new(compiled);
        Ok(Abstraction { chart, conditions, assignments, facts, awaited, constants, events })
    }

    /// Adds external events, as far as the chart has them.
    pub(crate) fn with_events(mut self, events: &BTreeSet<String>) -> Abstraction {
        let known = events.iter().filter(|event| self.chart.events().find(event).is_some());
        let new: Vec<String> = known.filter(|event| !self.events.contains(event)).cloned().collect();
        self.events.extend(new);
        self
    }

    /// The environment of the chart.
    pub(crate) fn surroundings(&self) -> Environment<'_> {
        let mut surroundings = Environment::default();
        surroundings.events.clone_from(&self.events);
        surroundings.messages = self.conditions.iter().any(Option::is_some);
        surroundings.allows = Box::new(self.satisfiable(&[]));
        surroundings.effects = self.effects(&[]);
        surroundings
    }

    /// Whether values of conditions are possible together; additional conditions follow those of
    /// the chart.
    pub(crate) fn satisfiable<'a>(
        &'a self,
        more: &[&'a Expression],
    ) -> impl FnMut(ScriptId, bool, &[(ScriptId, bool)]) -> bool + 'a {
        let more = more.to_vec();
        let mut known = BTreeMap::new();
        let logic = GuardSolver::new(&self.constants);
        move |script, value, decided| {
            let mut together: Vec<(ScriptId, bool)> = decided.to_vec();
            together.push((script, value));
            together.sort_unstable();
            together.dedup();
            *known.entry(together).or_insert_with_key(|together| {
                let claims = together.iter().filter_map(|&(script, value)| self.claim(script, value, &more));
                !logic.together(&claims.collect::<Vec<_>>()).is_no()
            })
        }
    }

    /// The writes of actions; `more` conditions follow those of the chart.
    pub(crate) fn effects<'a>(&'a self, more: &[&'a Expression]) -> WriteEffects<'a> {
        let more = more.to_vec();
        let changes = move |action: ScriptId, fact: ScriptId| {
            let Some(assignment) = self.assignment(action) else { return true };
            match (self.condition(fact, &more), self.assignment(fact)) {
                (Some(condition), _) => assignment.may_change(condition),
                (None, Some(other)) => assignment.may_overwrite(other),
                (None, None) => true,
            }
        };
        let is_inherited = |action| self.assignment(action).is_some_and(|it| !it.is_of_signal());
        WriteEffects { changes: Box::new(changes), is_inherited: Box::new(is_inherited) }
    }

    pub(crate) fn assignment(&self, script: ScriptId) -> Option<&Assignment> {
        self.assignments.get(script.0 as usize)?.as_ref()
    }

    /// Whether the chart may assign fields of the message of a path.
    pub(crate) fn is_assigned(&self, path: &Path) -> bool {
        self.assignments.iter().flatten().any(|it| may_be_one_message(&it.target, path))
    }

    fn condition<'a>(&'a self, script: ScriptId, more: &[&'a Expression]) -> Option<&'a Expression> {
        let index = script.0 as usize;
        match index.checked_sub(self.conditions.len()) {
            Some(position) => more.get(position).copied(),
            None => self.conditions[index].as_ref(),
        }
    }

    /// The claim that follows from the value of a condition, or from the execution of an action.
    fn claim<'a>(&'a self, script: ScriptId, value: bool, more: &[&'a Expression]) -> Option<Claim<'a>> {
        match self.condition(script, more) {
            Some(condition) if value => Some(Claim::Holds(condition)),
            Some(condition) => Some(Claim::DoesNotHold(condition)),
            None => self.facts.get(script.0 as usize)?.as_ref().map(Claim::Holds),
        }
    }

    /// Whether conditions can have these values at the same time.
    pub(crate) fn can_be(&self, decided: &[(ScriptId, bool)]) -> crate::logic::Satisfiability {
        let claims = decided.iter().filter_map(|&(script, value)| self.claim(script, value, &[]));
        GuardSolver::new(&self.constants).together(&claims.collect::<Vec<_>>())
    }
}

/// The chart that is explored for a model, and that its traces refer to: conditions on data are
/// free inputs.
///
/// # Errors
/// The errors that prevent reading or compiling the model.
pub fn explorable(source: &Arc<Source>) -> Result<Arc<CompiledChart>, Vec<Diagnostic>> {
    abstracted(source).map(|abstraction| abstraction.chart)
}

/// Builds the abstraction of a model.
pub(crate) fn abstracted(source: &Arc<Source>) -> Result<Abstraction, Vec<Diagnostic>> {
    let subject = subject_of(source)?;
    Abstraction::new(&subject).map_err(|found| in_source(source, found))
}

/// Builds an [`Abstraction`].
struct AbstractionBuilder {
    timers: BTreeSet<timers::TimerKey>,
    /// The parsed condition for each text.
    conditions: BTreeMap<String, Expression>,
    /// The assignment of each text.
    assignments: BTreeMap<String, Assignment>,
}

impl AbstractionBuilder {
    fn expression(&mut self, expression: &TransitionExpression, board: yase::NodeId) -> TransitionExpression {
        TransitionExpression {
            trigger: expression.trigger.as_ref().map(trigger),
            guard: expression.guard.as_ref().map(|guard| self.guard(guard, board)),
            actions: self.actions(&expression.actions),
        }
    }

    /// Replaces the largest parts of a guard that depend only on data by conditions.
    fn guard(&mut self, guard: &Expression, board: yase::NodeId) -> Expression {
        if !self.is_about_timers_or_states(guard, board) {
            return self.condition(guard);
        }
        let kind = match &guard.kind {
            ExpressionKind::And(parts) => ExpressionKind::And(self.parts(parts, board, true)),
            ExpressionKind::Or(parts) => ExpressionKind::Or(self.parts(parts, board, false)),
            ExpressionKind::Not(inner) => ExpressionKind::Not(Box::new(self.guard(inner, board))),
            ExpressionKind::TimeoutCheck(path) if !self.is_timer(path, board) => ExpressionKind::Bool(false),
            other => other.clone(),
        };
        Expression { kind, position: guard.position }
    }

    /// Keeps parts about data together, so that dependencies between them are preserved.
    fn parts(&mut self, parts: &[Expression], board: yase::NodeId, all: bool) -> Vec<Expression> {
        let (kept, data): (Vec<&Expression>, Vec<&Expression>) =
            parts.iter().partition(|part| self.is_about_timers_or_states(part, board));
        let mut parts: Vec<Expression> = kept.into_iter().map(|part| self.guard(part, board)).collect();
        let data: Vec<Expression> = data.into_iter().cloned().collect();
        parts.extend(match data.as_slice() {
            [] => None,
            [one] => Some(self.condition(one)),
            [first, ..] => {
                let position = first.position;
                let kind = if all { ExpressionKind::And(data) } else { ExpressionKind::Or(data) };
                Some(self.condition(&Expression { kind, position }))
            }
        });
        parts
    }

    fn actions(&mut self, actions: &[Action]) -> Vec<Action> {
        let made = actions.iter().filter_map(|action| {
            let kind = match &action.kind {
                ActionKind::StartTimeout { .. } => action.kind.clone(),
                ActionKind::Raise(event) => ActionKind::Raise(plain(event)),
                ActionKind::Publish(_) | ActionKind::PublishAll => return None,
                ActionKind::Assign { target, value } => {
                    let text = action.to_string();
                    let assignment = Assignment { target: target.clone(), value: value.clone() };
                    self.assignments.entry(text.clone()).or_insert(assignment);
                    ActionKind::Script(text)
                }
                ActionKind::ProcessMessages | ActionKind::Script(_) => ActionKind::Script(action.to_string()),
            };
            Some(Action { kind, position: action.position })
        });
        made.collect()
    }

    fn condition(&mut self, condition: &Expression) -> Expression {
        if matches!(condition.kind, ExpressionKind::Bool(_)) {
            return condition.clone();
        }
        let text = condition.to_string();
        self.conditions.entry(text.clone()).or_insert_with(|| condition.clone());
        Expression { kind: ExpressionKind::Script(text), position: condition.position }
    }

    fn is_timer(&self, path: &Path, board: yase::NodeId) -> bool {
        self.timers.contains(&(board, path.text()))
    }

    fn is_about_timers_or_states(&self, expression: &Expression, board: yase::NodeId) -> bool {
        match &expression.kind {
            ExpressionKind::TimeoutCheck(_) | ExpressionKind::In(_) => true,
            ExpressionKind::Variable(path) => self.is_timer(path, board),
            ExpressionKind::And(parts) | ExpressionKind::Or(parts) => {
                parts.iter().any(|part| self.is_about_timers_or_states(part, board))
            }
            ExpressionKind::Not(inner) => self.is_about_timers_or_states(inner, board),
            _ => false,
        }
    }
}

fn trigger(trigger: &Trigger) -> Trigger {
    match trigger {
        Trigger::Any => Trigger::Any,
        Trigger::Not(event) => Trigger::Not(plain(event)),
        Trigger::OneOf(events) => Trigger::OneOf(events.iter().map(plain).collect()),
    }
}

/// An event with a single name, so that it is not resolved as a message.
fn plain(event: &Path) -> Path {
    Path { segments: vec![Name { text: event.text(), position: event.position }], position: event.position }
}

/// The paths that triggers name.
fn awaited(chart: &Statechart) -> Vec<Path> {
    let triggers = chart.transitions().filter_map(|(_, it)| match &it.expression.trigger {
        Some(Trigger::OneOf(events)) => Some(events),
        _ => None,
    });
    triggers.flatten().cloned().collect()
}

/// The events that triggers name and that no action of the chart raises.
fn outside(chart: &Statechart) -> Vec<String> {
    let mut named: BTreeSet<String> = BTreeSet::new();
    let mut takes_any = false;
    for (_, transition) in chart.transitions() {
        match &transition.expression.trigger {
            Some(Trigger::OneOf(events)) => named.extend(events.iter().map(Path::text)),
            Some(Trigger::Any | Trigger::Not(_)) => takes_any = true,
            None => {}
        }
    }
    let of_transitions = chart.transitions().flat_map(|(_, it)| &it.expression.actions);
    let of_nodes = chart.nodes().flat_map(|(_, node)| node.entry.iter().chain(&node.exit));
    for action in of_transitions.chain(of_nodes) {
        match &action.kind {
            ActionKind::Raise(event) => named.remove(&event.text()),
            ActionKind::StartTimeout { timer, .. } => named.remove(&timer.text()),
            _ => false,
        };
    }
    named.retain(|name| !name.starts_with("error.") && !name.starts_with("done."));
    named.into_iter().chain(takes_any.then(|| String::from("any other event"))).collect()
}
