//! The truth of a condition and of each of its parts, from the values of a tape.

use std::panic::{self, AssertUnwindSafe};

use monas::linked::FUNCTIONS;
use serde::Serialize;
use serde_json::Value;
use yase::diagnostic::Suggestions;
use yase::expression::{
    CallError, EvalContext, EventInterner, Expression, ExpressionKind, MessageSource, NameScope,
    ScriptInterner, TimerId, TimerState, TransitionExpression,
};
use yase::vocabulary::FunctionEntry;
use yase::{FieldId, FunctionId, NodeId, TypeEnvironment};

use crate::chart_history::ChartHistory;
use crate::read_value::{ReadMoment, ReadValue};
use crate::tape_run::TapeRun;

/// A part of a guard that is not a conjunction, disjunction or negation of these.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct GuardAtom {
    /// The text of the part.
    pub text: String,
    /// Whether it held; none if that is unknown because a message had not arrived.
    pub value: Option<bool>,
    /// The values that it read.
    pub reads: Vec<ReadValue>,
}

impl TapeRun {
    /// The parts of a condition in the order of its text.
    pub(crate) fn atoms(&self, condition: &Expression, moment: &ReadMoment<'_>) -> Vec<GuardAtom> {
        let parts = match &condition.kind {
            ExpressionKind::And(parts) | ExpressionKind::Or(parts) => parts.iter().collect(),
            ExpressionKind::Not(inner)
                if matches!(inner.kind, ExpressionKind::And(_) | ExpressionKind::Or(_)) =>
            {
                vec![&**inner]
            }
            _ => {
                let (text, value) = (condition.to_string(), self.truth(condition, moment));
                return vec![GuardAtom { text, value, reads: self.reads(condition, moment) }];
            }
        };
        parts.into_iter().flat_map(|part| self.atoms(part, moment)).collect()
    }

    /// Whether a condition holds, by Kleene's logic; none if that is unknown.
    pub(crate) fn truth(&self, condition: &Expression, moment: &ReadMoment<'_>) -> Option<bool> {
        let truths = |parts: &[Expression]| -> Vec<Option<bool>> {
            parts.iter().map(|part| self.truth(part, moment)).collect()
        };
        let decided = |truths: &[Option<bool>], by: bool| match truths {
            all if all.contains(&Some(by)) => Some(by),
            all if all.contains(&None) => None,
            _ => Some(!by),
        };
        match &condition.kind {
            ExpressionKind::And(parts) => decided(&truths(parts), false),
            ExpressionKind::Or(parts) => decided(&truths(parts), true),
            ExpressionKind::Not(inner) => self.truth(inner, moment).map(|truth| !truth),
            _ => evaluate(self.with_values(condition, moment)?),
        }
    }

    /// The condition with the values of its names; none if one of them is unknown.
    fn with_values(&self, condition: &Expression, moment: &ReadMoment<'_>) -> Option<Expression> {
        let mut is_unknown = false;
        let plain = condition.replaced(&mut |part| {
            let kind = match &part.kind {
                ExpressionKind::Variable(path) => match self.read(path, moment) {
                    // A timer that was never started has expired by its bare name.
                    Some(read) if read.is_timer => ExpressionKind::Bool(read.value != Value::Bool(false)),
                    Some(read) => literal(&read.value).unwrap_or_else(|| {
                        is_unknown = true;
                        ExpressionKind::Bool(false)
                    }),
                    // The name of a value of an enumeration.
                    None if !is_function(&path.text()) => ExpressionKind::Text(path.text()),
                    None => return None,
                },
                ExpressionKind::TimeoutCheck(path) => {
                    let read = self.read(path, moment);
                    ExpressionKind::Bool(read.is_some_and(|read| read.value == Value::Bool(true)))
                }
                ExpressionKind::Absent(path) | ExpressionKind::Present(path) => {
                    let has_one = self.read(path, moment).is_some_and(|read| read.message.is_some());
                    ExpressionKind::Bool(has_one == matches!(part.kind, ExpressionKind::Present(_)))
                }
                ExpressionKind::In(name) => {
                    let node = moment.chart.statechart.find(&name.text);
                    let is_active = node.is_some_and(|node| ChartHistory::is_active(moment.steps, node));
                    ExpressionKind::Bool(is_active)
                }
                _ => return None,
            };
            Some(Expression { kind, position: part.position })
        });
        (!is_unknown).then_some(plain)
    }
}

/// A value as an expression; none for null and for what expressions cannot read.
fn literal(value: &Value) -> Option<ExpressionKind> {
    let signed = |number: f64| {
        let kind = ExpressionKind::Decimal(number.abs());
        let position = Default::default();
        match number.is_sign_negative() {
            true => ExpressionKind::Negative(Box::new(Expression { kind, position })),
            false => kind,
        }
    };
    match value {
        Value::Bool(value) => Some(ExpressionKind::Bool(*value)),
        Value::Number(number) => match number.as_u64() {
            Some(number) => Some(ExpressionKind::Integer(number)),
            None => number.as_f64().map(signed),
        },
        Value::String(text) => Some(ExpressionKind::Text(text.clone())),
        _ => None,
    }
}

fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|function| function.name == name)
}

/// The truth of a condition without names; none if it has no value.
fn evaluate(condition: Expression) -> Option<bool> {
    let functions = FUNCTIONS.iter().zip(0..).map(|(function, number)| FunctionEntry {
        id: FunctionId(number),
        name: function.name.into(),
        parameters: (function.parameters)(),
        result: (function.result)(),
    });
    let vocabulary = TypeEnvironment { functions: functions.collect(), ..TypeEnvironment::default() };
    let (mut events, mut scripts) = (EventInterner::new(), ScriptInterner::new());
    let mut names = NameScope {
        vocabulary: &vocabulary,
        constants: &[],
        timers: &[],
        events: &mut events,
        scripts: &mut scripts,
        states: &|_| None,
        suggestions: &Suggestions::default(),
    };
    let expression = TransitionExpression { guard: Some(condition), ..TransitionExpression::default() };
    let guard = expression.compile(&mut names).ok()?.guard?;
    guard.evaluate(&NoNames).ok()
}

/// The vocabulary of a condition without names: functions only.
struct NoNames;

impl EvalContext for NoNames {
    fn field(&self, _: &MessageSource, _: &[FieldId]) -> yase::Value<'_> {
        yase::Value::Missing
    }

    fn message(&self, _: &MessageSource) -> yase::Value<'_> {
        yase::Value::Missing
    }

    fn call(
        &self,
        function: FunctionId,
        arguments: &[yase::Value<'_>],
    ) -> Result<yase::Value<'_>, CallError> {
        let declaration = FUNCTIONS.get(function.0 as usize);
        let declaration = declaration.ok_or_else(|| CallError::new("there is no such function"))?;
        panic::catch_unwind(AssertUnwindSafe(|| (declaration.call)(arguments)))
            .map_err(|_| CallError::new("the function panicked"))?
            .ok_or_else(|| CallError::new("the function does not take these arguments"))
    }

    fn timer(&self, _: TimerId) -> TimerState {
        TimerState::Unset
    }

    fn is_active(&self, _: NodeId) -> bool {
        false
    }
}
