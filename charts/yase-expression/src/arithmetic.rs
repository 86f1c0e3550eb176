//! Arithmetic and comparison of expression values: numbers of any width, missing values, no silent
//! overflow. Guards written as Rust functions use the same operations.

use std::cmp::Ordering;

use super::guard_error::GuardError;
use super::ir::Literal;
use super::syntax::{Additive, Comparison, Multiplicative};
use crate::vocabulary::Value;

/// Negates a number.
///
/// # Errors
/// The value is not a number, or the result is out of range.
pub fn negative(value: Value<'_>) -> Result<Value<'_>, GuardError> {
    arithmetic(Value::Uint(0), ArithmeticOperator::Minus, value)
}

/// An arithmetic operator.
#[derive(Clone, Copy, Debug)]
pub enum ArithmeticOperator {
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `*`
    Times,
    /// `/`
    Over,
}

impl From<Additive> for ArithmeticOperator {
    fn from(operator: Additive) -> ArithmeticOperator {
        match operator {
            Additive::Plus => ArithmeticOperator::Plus,
            Additive::Minus => ArithmeticOperator::Minus,
        }
    }
}

impl From<Multiplicative> for ArithmeticOperator {
    fn from(operator: Multiplicative) -> ArithmeticOperator {
        match operator {
            Multiplicative::Times => ArithmeticOperator::Times,
            Multiplicative::Over => ArithmeticOperator::Over,
        }
    }
}

/// A number that stays an integer as long as it is exact.
#[derive(Clone, Copy)]
enum NumericValue {
    Whole(i128),
    Float(f64),
}

impl NumericValue {
    fn of(value: Value<'_>) -> Result<NumericValue, GuardError> {
        match value {
            Value::Int(value) => Ok(NumericValue::Whole(value.into())),
            Value::Uint(value) => Ok(NumericValue::Whole(value.into())),
            Value::Float(value) => Ok(NumericValue::Float(value)),
            _ => Err(GuardError::WrongType),
        }
    }

    fn to_f64(self) -> f64 {
        match self {
            NumericValue::Whole(value) => value as f64,
            NumericValue::Float(value) => value,
        }
    }
}

/// Sums and products of integers are integers; a quotient is a floating-point number. The result is
/// missing if an operand is missing.
///
/// # Errors
/// An operand is not a number, the result is out of range, or the divisor is zero.
pub fn arithmetic<'a>(
    left: Value<'a>,
    operator: impl Into<ArithmeticOperator>,
    right: Value<'a>,
) -> Result<Value<'a>, GuardError> {
    if matches!(left, Value::Missing) || matches!(right, Value::Missing) {
        return Ok(Value::Missing);
    }
    match (NumericValue::of(left)?, operator.into(), NumericValue::of(right)?) {
        (NumericValue::Whole(a), ArithmeticOperator::Plus, NumericValue::Whole(b)) => whole(a.checked_add(b)),
        (NumericValue::Whole(a), ArithmeticOperator::Minus, NumericValue::Whole(b)) => {
            whole(a.checked_sub(b))
        }
        (NumericValue::Whole(a), ArithmeticOperator::Times, NumericValue::Whole(b)) => {
            whole(a.checked_mul(b))
        }
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

fn floating(left: f64, operator: ArithmeticOperator, right: f64) -> Result<Value<'static>, GuardError> {
    Ok(Value::Float(match operator {
        ArithmeticOperator::Plus => left + right,
        ArithmeticOperator::Minus => left - right,
        ArithmeticOperator::Times => left * right,
        ArithmeticOperator::Over if right == 0.0 => return Err(GuardError::DivisionByZero),
        ArithmeticOperator::Over => left / right,
    }))
}

/// Result of a comparison; `None` if an operand is missing.
///
/// # Errors
/// The operands have different types, or one of them is not a number (NaN).
#[inline]
pub fn compare(
    left: Value<'_>,
    comparison: Comparison,
    right: Value<'_>,
) -> Result<Option<bool>, GuardError> {
    let order = match (left, right) {
        (Value::Missing, _) | (_, Value::Missing) => return Ok(None),
        (Value::Float(left), Value::Float(right)) => compare_floats(left, right)?,
        // the general case below is correct for integers too, but slower
        (Value::Int(left), Value::Int(right)) => left.cmp(&right),
        (Value::Uint(left), Value::Uint(right)) => left.cmp(&right),
        (Value::Int(left), Value::Uint(right)) => compare_signs(left, right),
        (Value::Uint(left), Value::Int(right)) => compare_signs(right, left).reverse(),
        (Value::Enum(left), Value::Enum(right)) => left.cmp(&right),
        (Value::Bool(left), Value::Bool(right)) => left.cmp(&right),
        (Value::Text(left), Value::Text(right)) => left.cmp(right),
        (left, right) => compare_numbers(NumericValue::of(left)?, NumericValue::of(right)?)?,
    };
    Ok(Some(holds(comparison, order)))
}

/// Comparison with a constant for values with a simple order; `None` for all others, which
/// [`compare`] handles.
#[inline(always)]
pub(crate) fn compare_plainly(left: Value<'_>, comparison: Comparison, right: &Literal) -> Option<bool> {
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

/// A lookup instead of a branch: there are many guards and each uses another comparison.
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

/// Compares by value regardless of width; no integer is rounded.
fn compare_numbers(left: NumericValue, right: NumericValue) -> Result<Ordering, GuardError> {
    match (left, right) {
        (NumericValue::Whole(left), NumericValue::Whole(right)) => Ok(left.cmp(&right)),
        (NumericValue::Float(left), NumericValue::Float(right)) => compare_floats(left, right),
        (NumericValue::Whole(left), NumericValue::Float(right)) => compare_whole(left, right),
        (NumericValue::Float(left), NumericValue::Whole(right)) => {
            compare_whole(right, left).map(Ordering::reverse)
        }
    }
}

/// A cast from float to `i128` truncates the fraction and saturates far beyond 64 bits, so the
/// integer parts are compared first.
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

    /// Rows of strictly increasing values; numbers of all widths share one row.
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
            value => panic!("{value:?} is not a literal"),
        }
    }

    #[test]
    fn values_of_all_widths_are_ordered() {
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
    fn common_comparisons_take_the_fast_path() {
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
                let (left, right) = (NumericValue::of(left).unwrap(), NumericValue::of(right).unwrap());
                assert_eq!(compare_numbers(left, right), Ok(Ordering::Equal));
            }
        }
        let (less, more) = (NumericValue::Whole(1), NumericValue::Whole(2));
        assert_eq!(compare_numbers(less, more), Ok(Ordering::Less));
        assert_eq!(compare_numbers(NumericValue::Float(1.0), NumericValue::Float(2.0)), Ok(Ordering::Less));
    }

    #[test]
    fn nan_has_no_order() {
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
        for (operator, result) in [
            (ArithmeticOperator::Plus, 6.0),
            (ArithmeticOperator::Minus, 3.0),
            (ArithmeticOperator::Times, 6.75),
            (ArithmeticOperator::Over, 3.0),
        ] {
            assert_eq!(float(arithmetic(left, operator, right)), result);
        }
        assert_eq!(float(arithmetic(Value::Int(3), ArithmeticOperator::Minus, Value::Float(0.5))), 2.5);
        assert_eq!(float(negative(Value::Float(0.5))), -0.5);
    }
}
