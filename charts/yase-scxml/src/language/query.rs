//! Expressions that depend only on active states.

use super::syntax::{Builtin, ScriptExpression, Unary};
use super::value::ScriptValue;

/// One level of an expression made of `In()`.
pub(crate) enum ActiveQuery<'a> {
    Known(bool),
    In(&'a str),
    Not(&'a ScriptExpression),
    All(Vec<&'a ScriptExpression>),
    Any(Vec<&'a ScriptExpression>),
}

impl ScriptExpression {
    /// The query, if the expression is made of `In()`.
    pub(crate) fn active_query(&self) -> Option<ActiveQuery<'_>> {
        Some(match self {
            ScriptExpression::Literal(ScriptValue::Bool(value)) => ActiveQuery::Known(*value),
            ScriptExpression::Builtin(Builtin::In, state) => match &**state {
                ScriptExpression::Literal(ScriptValue::Text(state)) => ActiveQuery::In(state),
                _ => return None,
            },
            ScriptExpression::Unary(Unary::Not, operand) => ActiveQuery::Not(operand),
            ScriptExpression::And(operands) => ActiveQuery::All(operands.iter().collect()),
            ScriptExpression::Or(operands) => ActiveQuery::Any(operands.iter().collect()),
            _ => return None,
        })
    }

    /// Whether it consists of `In()` and literals.
    pub(crate) fn is_null(&self) -> bool {
        match self.active_query() {
            Some(ActiveQuery::Known(_) | ActiveQuery::In(_)) => true,
            Some(ActiveQuery::Not(operand)) => operand.is_null(),
            Some(ActiveQuery::All(operands) | ActiveQuery::Any(operands)) => {
                operands.into_iter().all(ScriptExpression::is_null)
            }
            None => matches!(self, ScriptExpression::Literal(_)),
        }
    }
}
