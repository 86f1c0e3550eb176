//! Abstraction of a chart from its program, so that it can be explored alone.
//!
//! Conditions on messages and functions become free inputs, as far as [`logic`](crate::logic) finds
//! them satisfiable together; timers and states keep their meaning. Actions that write become one
//! that may change anything its blackboard shows, and arrivals of messages become events.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use yase::expression::{
    Action, ActionKind, Expression, ExpressionKind, Name, Path, ScriptId, TransitionExpression, Trigger,
};
use yase::statechart::Constant;
use yase::{CompiledChart, Diagnostic, Source, Statechart, TypeEnvironment};
use yase_explore::Environment;

use crate::checked_model::timers;
use crate::checked_model::{CheckedModel, placed, subject_of};
use crate::logic::{Claim, GuardSolver};

/// A chart to be explored, and the meaning of its conditions.
pub(crate) struct Abstraction {
    pub(crate) chart: Arc<CompiledChart>,
    /// The condition that each script represents.
    pub(crate) conditions: Vec<Option<Expression>>,
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
            node.entry = actions(&node.entry);
            node.exit = actions(&node.exit);
        }
        let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
        let compiled = chart.compile_with(&vocabulary, subject.semantics)?;
        let conditions = compiled.scripts().map(|entry| making.conditions.get(entry.text).cloned()).collect();
        let events = outside(&chart);
        Ok(Abstraction { chart: Arc::new(compiled), conditions, constants: chart.constants.clone(), events })
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
        let mut known = BTreeMap::new();
        surroundings.allows = Box::new(move |script, value, decided| {
            let mut together: Vec<(ScriptId, bool)> = decided.to_vec();
            together.sort_unstable();
            together.push((script, value));
            *known.entry(together).or_insert_with_key(|together| {
                !self.claims(together, &GuardSolver::new(&self.constants)).is_no()
            })
        });
        surroundings
    }

    /// Whether conditions can have these values at the same time.
    pub(crate) fn can_be(&self, decided: &[(ScriptId, bool)]) -> crate::logic::Satisfiability {
        self.claims(decided, &GuardSolver::new(&self.constants))
    }

    fn claims(&self, decided: &[(ScriptId, bool)], logic: &GuardSolver<'_>) -> crate::logic::Satisfiability {
        let claims = decided.iter().filter_map(|&(script, value)| {
            let condition = self.conditions.get(script.0 as usize)?.as_ref()?;
            Some(if value { Claim::Holds(condition) } else { Claim::DoesNotHold(condition) })
        });
        logic.together(&claims.collect::<Vec<_>>())
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
    Abstraction::new(&subject).map_err(|found| placed(source, found))
}

/// Builds an [`Abstraction`].
struct AbstractionBuilder {
    timers: BTreeSet<timers::TimerKey>,
    /// The parsed condition for each text.
    conditions: BTreeMap<String, Expression>,
}

impl AbstractionBuilder {
    fn expression(&mut self, expression: &TransitionExpression, board: yase::NodeId) -> TransitionExpression {
        TransitionExpression {
            trigger: expression.trigger.as_ref().map(trigger),
            guard: expression.guard.as_ref().map(|guard| self.guard(guard, board)),
            actions: actions(&expression.actions),
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
        Expression { kind, place: guard.place }
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
                let place = first.place;
                let kind = if all { ExpressionKind::And(data) } else { ExpressionKind::Or(data) };
                Some(self.condition(&Expression { kind, place }))
            }
        });
        parts
    }

    fn condition(&mut self, condition: &Expression) -> Expression {
        if matches!(condition.kind, ExpressionKind::Bool(_)) {
            return condition.clone();
        }
        let text = condition.to_string();
        self.conditions.entry(text.clone()).or_insert_with(|| condition.clone());
        Expression { kind: ExpressionKind::Script(text), place: condition.place }
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
    Path { segments: vec![Name { text: event.text(), place: event.place }], place: event.place }
}

fn actions(actions: &[Action]) -> Vec<Action> {
    let made = actions.iter().filter_map(|action| {
        let kind = match &action.kind {
            ActionKind::StartTimeout { .. } => action.kind.clone(),
            ActionKind::Raise(event) => ActionKind::Raise(plain(event)),
            ActionKind::Publish(_) | ActionKind::PublishAll => return None,
            ActionKind::Assign { .. } | ActionKind::ProcessMessages | ActionKind::Script(_) => {
                ActionKind::Script(action.to_string())
            }
        };
        Some(Action { kind, place: action.place })
    });
    made.collect()
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
