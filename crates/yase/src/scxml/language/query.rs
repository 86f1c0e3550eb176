//! Expressions that ask for nothing but which states are active.

use super::syntax::{Builtin, Expression, Unary};
use super::value::Value;

/// An expression made of `In()`, one level of it.
pub(crate) enum ActiveQuery<'a> {
    Known(bool),
    In(&'a str),
    Not(&'a Expression),
    All(Vec<&'a Expression>),
    Any(Vec<&'a Expression>),
}

impl Expression {
    /// What the expression asks, if it is made of `In()`.
    pub(crate) fn active_query(&self) -> Option<ActiveQuery<'_>> {
        Some(match self {
            Expression::Literal(Value::Bool(value)) => ActiveQuery::Known(*value),
            Expression::Builtin(Builtin::In, state) => match &**state {
                Expression::Literal(Value::Text(state)) => ActiveQuery::In(state),
                _ => return None,
            },
            Expression::Unary(Unary::Not, operand) => ActiveQuery::Not(operand),
            Expression::And(operands) => ActiveQuery::All(operands.iter().collect()),
            Expression::Or(operands) => ActiveQuery::Any(operands.iter().collect()),
            _ => return None,
        })
    }

    /// Whether it is all made of `In()`, or a literal.
    pub(crate) fn is_null(&self) -> bool {
        match self.active_query() {
            Some(ActiveQuery::Known(_) | ActiveQuery::In(_)) => true,
            Some(ActiveQuery::Not(operand)) => operand.is_null(),
            Some(ActiveQuery::All(operands) | ActiveQuery::Any(operands)) => {
                operands.into_iter().all(Expression::is_null)
            }
            None => matches!(self, Expression::Literal(_)),
        }
    }
}
