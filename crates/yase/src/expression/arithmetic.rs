//! Numbers of any width, and the comparison of values.

use std::cmp::Ordering;

use super::program::{GuardError, Literal};
use super::syntax::{Additive, Comparison, Multiplicative};
use crate::vocabulary::Value;

/// Zero minus a number.
pub(crate) fn negative(value: Value<'_>) -> Result<Value<'_>, GuardError> {
    arithmetic(Value::Uint(0), Operator::Minus, value)
}

/// What is done to two numbers.
#[derive(Clone, Copy)]
pub(crate) enum Operator {
    Plus,
    Minus,
    Times,
    Over,
}

impl From<Additive> for Operator {
    fn from(operator: Additive) -> Operator {
        match operator {
            Additive::Plus => Operator::Plus,
            Additive::Minus => Operator::Minus,
        }
    }
}

impl From<Multiplicative> for Operator {
    fn from(operator: Multiplicative) -> Operator {
        match operator {
            Multiplicative::Times => Operator::Times,
            Multiplicative::Over => Operator::Over,
        }
    }
}

/// A number, whole as long as it is exact.
#[derive(Clone, Copy)]
enum Number {
    Whole(i128),
    Float(f64),
}

impl Number {
    fn of(value: Value<'_>) -> Result<Number, GuardError> {
        match value {
            Value::Int(value) => Ok(Number::Whole(value.into())),
            Value::Uint(value) => Ok(Number::Whole(value.into())),
            Value::Float(value) => Ok(Number::Float(value)),
            _ => Err(GuardError::WrongType),
        }
    }

    fn to_f64(self) -> f64 {
        match self {
            Number::Whole(value) => value as f64,
            Number::Float(value) => value,
        }
    }
}

/// Sums and products of whole numbers are whole; a quotient is a floating point number. Missing if a value is
/// missing.
pub(crate) fn arithmetic<'a>(
    left: Value<'a>,
    operator: impl Into<Operator>,
    right: Value<'a>,
) -> Result<Value<'a>, GuardError> {
    if matches!(left, Value::Missing) || matches!(right, Value::Missing) {
        return Ok(Value::Missing);
    }
    match (Number::of(left)?, operator.into(), Number::of(right)?) {
        (Number::Whole(a), Operator::Plus, Number::Whole(b)) => whole(a.checked_add(b)),
        (Number::Whole(a), Operator::Minus, Number::Whole(b)) => whole(a.checked_sub(b)),
        (Number::Whole(a), Operator::Times, Number::Whole(b)) => whole(a.checked_mul(b)),
        (a, operator, b) => floating(a.to_f64(), operator, b.to_f64()),
    }
}

fn whole(result: Option<i128>) -> Result<Value<'static>, GuardError> {
    let result = result.ok_or(GuardError::OutOfRange)?;
    if let Ok(signed) = i64::try_from(result) {
        return Ok(Value::Int(signed));
    }
    u64::try_from(result).map(Value::Uint).map_err(|_| GuardError::OutOfRange)
}

fn floating(left: f64, operator: Operator, right: f64) -> Result<Value<'static>, GuardError> {
    Ok(Value::Float(match operator {
        Operator::Plus => left + right,
        Operator::Minus => left - right,
        Operator::Times => left * right,
        Operator::Over if right == 0.0 => return Err(GuardError::DivisionByZero),
        Operator::Over => left / right,
    }))
}

/// Whether a comparison holds; nothing if a value is missing.
#[inline]
pub(crate) fn compare(
    left: Value<'_>,
    comparison: Comparison,
    right: Value<'_>,
) -> Result<Option<bool>, GuardError> {
    let order = match (left, right) {
        (Value::Missing, _) | (_, Value::Missing) => return Ok(None),
        (Value::Float(left), Value::Float(right)) => compare_floats(left, right)?,
        // what follows for whole numbers would be right, but takes longer
        (Value::Int(left), Value::Int(right)) => left.cmp(&right),
        (Value::Uint(left), Value::Uint(right)) => left.cmp(&right),
        (Value::Int(left), Value::Uint(right)) => compare_signs(left, right),
        (Value::Uint(left), Value::Int(right)) => compare_signs(right, left).reverse(),
        (Value::Enum(left), Value::Enum(right)) => left.cmp(&right),
        (Value::Bool(left), Value::Bool(right)) => left.cmp(&right),
        (Value::Text(left), Value::Text(right)) => left.cmp(right),
        (left, right) => compare_numbers(Number::of(left)?, Number::of(right)?)?,
    };
    Ok(Some(holds(comparison, order)))
}

/// Whether a comparison with a constant holds, for values whose order is plain; else nothing, and [`compare`] knows.
#[inline(always)]
pub(super) fn compare_plainly(left: Value<'_>, comparison: Comparison, right: &Literal) -> Option<bool> {
    let order = match (right, left) {
        (&Literal::Uint(right), Value::Int(left)) => compare_signs(left, right),
        (&Literal::Uint(right), Value::Uint(left)) => left.cmp(&right),
        (&Literal::Int(right), Value::Int(left)) => left.cmp(&right),
        (&Literal::Float(right), Value::Float(left)) => left.partial_cmp(&right)?,
        (&Literal::Enum(right), Value::Enum(left)) => left.cmp(&right),
        (&Literal::Bool(right), Value::Bool(left)) => left.cmp(&right),
        _ => return None,
    };
    Some(holds(comparison, order))
}

/// Looked up rather than branched on: guards are many, and each compares in its own way.
#[inline]
fn holds(comparison: Comparison, order: Ordering) -> bool {
    let (less, equal, greater) = (0b001, 0b010, 0b100);
    let holding = match comparison {
        Comparison::Equal => equal,
        Comparison::NotEqual => less | greater,
        Comparison::Less => less,
        Comparison::LessOrEqual => less | equal,
        Comparison::Greater => greater,
        Comparison::GreaterOrEqual => greater | equal,
    };
    holding >> (order as i8 + 1) & 1 == 1
}

#[inline]
fn compare_signs(signed: i64, unsigned: u64) -> Ordering {
    u64::try_from(signed).map_or(Ordering::Less, |signed| signed.cmp(&unsigned))
}

#[inline]
fn compare_floats(left: f64, right: f64) -> Result<Ordering, GuardError> {
    left.partial_cmp(&right).ok_or(GuardError::NotANumber)
}

/// By value, whatever the width: no whole number is rounded on the way.
fn compare_numbers(left: Number, right: Number) -> Result<Ordering, GuardError> {
    match (left, right) {
        (Number::Whole(left), Number::Whole(right)) => Ok(left.cmp(&right)),
        (Number::Float(left), Number::Float(right)) => compare_floats(left, right),
        (Number::Whole(left), Number::Float(right)) => compare_whole(left, right),
        (Number::Float(left), Number::Whole(right)) => compare_whole(right, left).map(Ordering::reverse),
    }
}

/// A cast of a float to `i128` cuts off the fraction, and saturates far beyond 64 bits: the whole parts
/// decide first.
fn compare_whole(whole: i128, float: f64) -> Result<Ordering, GuardError> {
    if float.is_nan() {
        return Err(GuardError::NotANumber);
    }
    match whole.cmp(&(float as i128)) {
        Ordering::Equal => compare_floats(0.0, float - float.trunc()),
        order => Ok(order),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expected(comparison: Comparison, order: Ordering) -> bool {
        match comparison {
            Comparison::Equal => order.is_eq(),
            Comparison::NotEqual => order.is_ne(),
            Comparison::Less => order.is_lt(),
            Comparison::LessOrEqual => order.is_le(),
            Comparison::Greater => order.is_gt(),
            Comparison::GreaterOrEqual => order.is_ge(),
        }
    }

    /// Rows in which each value is less than the next; numbers of all widths stand in one.
    const ROWS: [&[Value<'static>]; 4] = [
        &[
            Value::Int(i64::MIN),
            Value::Float(-3.5),
            Value::Int(-3),
            Value::Float(-0.5),
            Value::Uint(0),
            Value::Float(0.5),
            Value::Int(1),
            Value::Uint(2),
            Value::Float(2.5),
            Value::Int(i64::MAX),
            Value::Uint(1 << 63),
            Value::Uint(u64::MAX),
            Value::Float(1e30),
        ],
        &[Value::Enum(-1), Value::Enum(0), Value::Enum(7)],
        &[Value::Bool(false), Value::Bool(true)],
        &[Value::Text(""), Value::Text("a"), Value::Text("b")],
    ];

    fn literal(value: Value<'_>) -> Literal {
        match value {
            Value::Bool(value) => Literal::Bool(value),
            Value::Int(value) => Literal::Int(value),
            Value::Uint(value) => Literal::Uint(value),
            Value::Float(value) => Literal::Float(value),
            Value::Enum(value) => Literal::Enum(value),
            Value::Text(value) => Literal::Text(value.into()),
            value => panic!("{value:?} is no literal"),
        }
    }

    #[test]
    fn values_are_in_order_whatever_their_width() {
        for row in ROWS {
            for (i, &left) in row.iter().enumerate() {
                for (j, &right) in row.iter().enumerate() {
                    for comparison in Comparison::ALL {
                        let holds = expected(comparison, i.cmp(&j));
                        let said = compare(left, comparison, right);
                        assert_eq!(said, Ok(Some(holds)), "{left:?} {comparison:?} {right:?}");
                        let plainly = compare_plainly(left, comparison, &literal(right));
                        assert!(
                            plainly.is_none_or(|said| said == holds),
                            "{left:?} {comparison:?} {right:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn what_guards_mostly_compare_takes_the_short_way() {
        for value in [Value::Int(3), Value::Uint(3), Value::Float(3.0), Value::Enum(3), Value::Bool(true)] {
            assert_eq!(compare_plainly(value, Comparison::Equal, &literal(value)), Some(true), "{value:?}");
        }
        assert_eq!(compare_plainly(Value::Int(-1), Comparison::Less, &Literal::Uint(0)), Some(true));
        assert_eq!(compare_plainly(Value::Missing, Comparison::Equal, &Literal::Uint(0)), None);
    }

    #[test]
    fn equal_numbers_are_equal_in_every_width() {
        let threes = [Value::Int(3), Value::Uint(3), Value::Float(3.0)];
        for (left, right) in threes.into_iter().flat_map(|left| threes.map(|right| (left, right))) {
            for comparison in Comparison::ALL {
                let holds = expected(comparison, Ordering::Equal);
                assert_eq!(compare(left, comparison, right), Ok(Some(holds)));
                let (left, right) = (Number::of(left).unwrap(), Number::of(right).unwrap());
                assert_eq!(compare_numbers(left, right), Ok(Ordering::Equal));
            }
        }
        let (less, more) = (Number::Whole(1), Number::Whole(2));
        assert_eq!(compare_numbers(less, more), Ok(Ordering::Less));
        assert_eq!(compare_numbers(Number::Float(1.0), Number::Float(2.0)), Ok(Ordering::Less));
    }

    #[test]
    fn what_is_no_number_has_no_order() {
        for other in [Value::Int(1), Value::Uint(0), Value::Float(0.0)] {
            for (left, right) in [(other, Value::Float(f64::NAN)), (Value::Float(f64::NAN), other)] {
                assert_eq!(compare(left, Comparison::Less, right), Err(GuardError::NotANumber));
            }
        }
        assert_eq!(compare(Value::Text("1"), Comparison::Equal, Value::Int(1)), Err(GuardError::WrongType));
    }

    fn float(value: Result<Value<'_>, GuardError>) -> f64 {
        match value {
            Ok(Value::Float(value)) => value,
            other => panic!("{other:?} has no fraction"),
        }
    }

    #[test]
    fn numbers_with_fractions_are_reckoned_with_as_such() {
        let (left, right) = (Value::Float(4.5), Value::Float(1.5));
        for (operator, result) in
            [(Operator::Plus, 6.0), (Operator::Minus, 3.0), (Operator::Times, 6.75), (Operator::Over, 3.0)]
        {
            assert_eq!(float(arithmetic(left, operator, right)), result);
        }
        assert_eq!(float(arithmetic(Value::Int(3), Operator::Minus, Value::Float(0.5))), 2.5);
        assert_eq!(float(negative(Value::Float(0.5))), -0.5);
    }
}
