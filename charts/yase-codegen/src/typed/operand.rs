//! Values of all types of expressions, with comparison and arithmetic as in expressions.

use std::any::Any;

use super::{GuardResult, GuardUnknown};
use yase::expression::arithmetic::{arithmetic, compare, negative as negated};
use yase::expression::{Additive, Comparison, GuardError, Multiplicative};
use yase::vocabulary::Value;

/// A value, or why there is none.
pub type Computed<'a> = Result<Value<'a>, GuardUnknown>;

/// An operand of a comparison or an arithmetic operation: a field of a message, a constant, or a
/// computed value. Numbers compare by value, regardless of width.
pub trait Operand<'a> {
    /// The value; [`Value::Missing`] of an optional field that is not set.
    fn value(self) -> Value<'a>;
}

impl<'a> Operand<'a> for Value<'a> {
    fn value(self) -> Value<'a> {
        self
    }
}

impl<'a> Operand<'a> for bool {
    fn value(self) -> Value<'a> {
        Value::Bool(self)
    }
}

impl<'a> Operand<'a> for i32 {
    fn value(self) -> Value<'a> {
        Value::Int(self.into())
    }
}

impl<'a> Operand<'a> for i64 {
    fn value(self) -> Value<'a> {
        Value::Int(self)
    }
}

impl<'a> Operand<'a> for u32 {
    fn value(self) -> Value<'a> {
        Value::Uint(self.into())
    }
}

impl<'a> Operand<'a> for u64 {
    fn value(self) -> Value<'a> {
        Value::Uint(self)
    }
}

impl<'a> Operand<'a> for f32 {
    fn value(self) -> Value<'a> {
        Value::Float(self.into())
    }
}

impl<'a> Operand<'a> for f64 {
    fn value(self) -> Value<'a> {
        Value::Float(self)
    }
}

impl<'a> Operand<'a> for &'a str {
    fn value(self) -> Value<'a> {
        Value::Text(self)
    }
}

impl<'a> Operand<'a> for &'a String {
    fn value(self) -> Value<'a> {
        Value::Text(self)
    }
}

impl<'a> Operand<'a> for &'a Option<String> {
    fn value(self) -> Value<'a> {
        self.as_deref().map_or(Value::Missing, Value::Text)
    }
}

impl<'a, T: Operand<'a>> Operand<'a> for Option<T> {
    fn value(self) -> Value<'a> {
        self.map_or(Value::Missing, Operand::value)
    }
}

/// The nested message.
///
/// # Errors
/// It is not set.
pub fn inside<T>(message: &Option<T>) -> Result<&T, GuardUnknown> {
    message.as_ref().ok_or(GuardUnknown::Unknown)
}

/// The nested message, as an argument of a function.
///
/// # Errors
/// It is not set.
pub fn whole<T: Any + Send + Sync>(message: &Option<T>) -> Computed<'_> {
    Ok(Value::Message(inside(message)?))
}

/// The value of an operand.
///
/// # Errors
/// It is an optional field that is not set.
pub fn given<'a>(value: impl Operand<'a>) -> Computed<'a> {
    match value.value() {
        Value::Missing => Err(GuardUnknown::Unknown),
        value => Ok(value),
    }
}

/// Whether a Boolean value is true.
///
/// # Errors
/// It is an optional field that is not set, or not a Boolean.
pub fn holds<'a>(value: impl Operand<'a>) -> GuardResult {
    match given(value)? {
        Value::Bool(truth) => Ok(truth),
        _ => Err(GuardError::WrongType.into()),
    }
}

/// Evaluates an operand; an unknown one becomes [`Value::Missing`], so that the other operands are
/// evaluated too and their failures are reported.
///
/// # Errors
/// The failure of the operand.
pub fn attempt<'a, T: Operand<'a>>(value: impl FnOnce() -> Result<T, GuardUnknown>) -> Computed<'a> {
    match value() {
        Ok(value) => Ok(value.value()),
        Err(GuardUnknown::Unknown) => Ok(Value::Missing),
        Err(failed) => Err(failed),
    }
}

fn ask<'a>(left: impl Operand<'a>, comparison: Comparison, right: impl Operand<'a>) -> GuardResult {
    compare(left.value(), comparison, right.value())?.ok_or(GuardUnknown::Unknown)
}

/// `left == right`.
///
/// # Errors
/// One of them is missing, or not a number.
pub fn equal<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> GuardResult {
    ask(left, Comparison::Equal, right)
}

/// `left != right`.
///
/// # Errors
/// One of them is missing, or not a number.
pub fn differ<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> GuardResult {
    ask(left, Comparison::NotEqual, right)
}

/// `left < right`.
///
/// # Errors
/// One of them is missing, or not a number.
pub fn less<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> GuardResult {
    ask(left, Comparison::Less, right)
}

/// `left <= right`.
///
/// # Errors
/// One of them is missing, or not a number.
pub fn at_most<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> GuardResult {
    ask(left, Comparison::LessOrEqual, right)
}

/// `left > right`.
///
/// # Errors
/// One of them is missing, or not a number.
pub fn more<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> GuardResult {
    ask(left, Comparison::Greater, right)
}

/// `left >= right`.
///
/// # Errors
/// One of them is missing, or not a number.
pub fn at_least<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> GuardResult {
    ask(left, Comparison::GreaterOrEqual, right)
}

/// `left + right`.
///
/// # Errors
/// One of them is missing, or the sum is out of range.
pub fn plus<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> Computed<'a> {
    given(arithmetic(left.value(), Additive::Plus, right.value())?)
}

/// `left - right`.
///
/// # Errors
/// One of them is missing, or the difference is out of range.
pub fn minus<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> Computed<'a> {
    given(arithmetic(left.value(), Additive::Minus, right.value())?)
}

/// `left * right`.
///
/// # Errors
/// One of them is missing, or the product is out of range.
pub fn times<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> Computed<'a> {
    given(arithmetic(left.value(), Multiplicative::Times, right.value())?)
}

/// `left / right`.
///
/// # Errors
/// One of them is missing, or `right` is zero.
pub fn over<'a>(left: impl Operand<'a>, right: impl Operand<'a>) -> Computed<'a> {
    given(arithmetic(left.value(), Multiplicative::Over, right.value())?)
}

/// `-value`.
///
/// # Errors
/// It is missing, or out of range.
pub fn negative<'a>(value: impl Operand<'a>) -> Computed<'a> {
    given(negated(value.value())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_widths_compare_by_value() {
        assert_eq!(equal(3_u32, 3.0_f32), Ok(true));
        assert_eq!(less(-1_i64, 0_u64), Ok(true));
        assert_eq!(more(f64::NAN, 0.0), Err(GuardError::NotANumber.into()));
        assert_eq!(at_most(None::<f64>, 0.0), Err(GuardUnknown::Unknown));
    }

    #[test]
    fn whole_numbers_stay_whole_and_quotients_do_not() {
        assert!(matches!(plus(u64::MAX, -1_i64), Ok(Value::Uint(sum)) if sum == u64::MAX - 1));
        assert!(matches!(over(7, 2), Ok(Value::Float(3.5))));
        assert!(matches!(over(7, 0), Err(GuardUnknown::Failed(GuardError::DivisionByZero))));
        assert!(matches!(negative(u64::MAX), Err(GuardUnknown::Failed(GuardError::OutOfRange))));
    }

    #[test]
    fn a_failure_on_the_right_counts_although_the_left_is_missing() {
        let missing = || -> Result<f64, GuardUnknown> { Err(GuardUnknown::Unknown) };
        let answer = || -> GuardResult { less(attempt(missing)?, over(1, 0)?) };
        assert_eq!(answer(), Err(GuardError::DivisionByZero.into()));
    }
}
