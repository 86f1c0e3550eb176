//! Compiled expressions, and how they are evaluated: without allocation, without names.
//!
//! Conditions are three-valued (Kleene): what reads a message that has not arrived is unknown, and only true fires.

use std::cmp::Ordering;

use super::facts::{CallError, Facts, MessageSource, TimerId, TimerState};
use super::syntax::{Additive, Comparison, Multiplicative};
use crate::statechart::NodeId;
use crate::vocabulary::{FieldId, FunctionId, TopicId, Value};

/// No function that an expression may call takes more arguments.
pub(super) const MAX_ARGUMENTS: usize = 8;

/// A compiled guard.
#[derive(Clone, PartialEq, Debug)]
pub struct Guard {
    pub(super) test: Test,
    pub(super) reads: Box<[TopicId]>,
    pub(super) timers: Box<[TimerId]>,
}

impl Guard {
    /// Whether the guard holds. Unknown, which is what reads a message that has not arrived, is not holding.
    ///
    /// # Errors
    /// When an operation has no result; see [`GuardError`].
    pub fn evaluate(&self, facts: &impl Facts) -> Result<bool, GuardError> {
        Ok(self.test.evaluate(facts)? == Truth::True)
    }

    /// The topics it reads, each once, in order.
    pub fn reads(&self) -> &[TopicId] {
        &self.reads
    }

    /// The timers it reads, each once, in order.
    pub fn timers(&self) -> &[TimerId] {
        &self.timers
    }

    /// Whether it is the word `false`: never taken, and meant so.
    pub fn is_literally_false(&self) -> bool {
        self.test == Test::Literal(false)
    }
}

/// A compiled value: the right side of an assignment.
#[derive(Clone, PartialEq, Debug)]
pub struct Operand {
    pub(super) term: Term,
    pub(super) reads: Box<[TopicId]>,
}

impl Operand {
    /// The value; [`Value::Missing`] if it depends on a message that has not arrived.
    ///
    /// # Errors
    /// When an operation has no result; see [`GuardError`].
    pub fn evaluate<'a>(&'a self, facts: &'a impl Facts) -> Result<Value<'a>, GuardError> {
        self.term.evaluate(facts)
    }

    /// The topics it reads, each once, in order.
    pub fn reads(&self) -> &[TopicId] {
        &self.reads
    }
}

/// Why an expression has no value. A guard that errs counts as false.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GuardError {
    /// A number was divided by zero.
    #[error("division by zero")]
    DivisionByZero,
    /// A whole number left the range of 64 bits.
    #[error("a whole number is out of range")]
    OutOfRange,
    /// What is not a number (NaN) was compared.
    #[error("what is not a number was compared")]
    NotANumber,
    /// A value is of another kind than its field or function was declared with.
    #[error("a value is not of the declared type")]
    WrongType,
    /// A function failed.
    #[error("the function failed: {0}")]
    Call(#[from] CallError),
}

/// The three values of Kleene's logic, ordered so that "and" is the least and "or" the greatest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Truth {
    False,
    Unknown,
    True,
}

impl Truth {
    fn negated(self) -> Truth {
        match self {
            Truth::False => Truth::True,
            Truth::Unknown => Truth::Unknown,
            Truth::True => Truth::False,
        }
    }

    fn value(self) -> Value<'static> {
        match self {
            Truth::False => Value::Bool(false),
            Truth::Unknown => Value::Missing,
            Truth::True => Value::Bool(true),
        }
    }
}

impl From<bool> for Truth {
    fn from(holds: bool) -> Truth {
        if holds { Truth::True } else { Truth::False }
    }
}

/// What has a truth value.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Test {
    Literal(bool),
    All(Box<[Test]>),
    Any(Box<[Test]>),
    Not(Box<Test>),
    Compare(Term, Comparison, Term),
    Absent(MessageSource),
    Over { timer: TimerId, when_unset: bool },
    Active(NodeId),
    Holds(Term),
}

impl Test {
    pub(super) fn evaluate(&self, facts: &impl Facts) -> Result<Truth, GuardError> {
        Ok(match self {
            Test::Literal(value) => Truth::from(*value),
            Test::All(tests) => all(tests, facts)?,
            Test::Any(tests) => any(tests, facts)?,
            Test::Not(test) => test.evaluate(facts)?.negated(),
            Test::Compare(left, comparison, right) => {
                compare(left.evaluate(facts)?, *comparison, right.evaluate(facts)?)?
            }
            Test::Absent(source) => Truth::from(matches!(facts.message(source), Value::Missing)),
            Test::Over { timer, when_unset } => Truth::from(match facts.timer(*timer) {
                TimerState::Unset => *when_unset,
                TimerState::Running => false,
                TimerState::Over => true,
            }),
            Test::Active(state) => Truth::from(facts.is_active(*state)),
            Test::Holds(term) => match term.evaluate(facts)? {
                Value::Bool(value) => Truth::from(value),
                Value::Missing => Truth::Unknown,
                _ => return Err(GuardError::WrongType),
            },
        })
    }
}

/// From left to right, up to the first that is false: what follows is not looked at, so it cannot err.
fn all(tests: &[Test], facts: &impl Facts) -> Result<Truth, GuardError> {
    let mut truth = Truth::True;
    for test in tests {
        truth = truth.min(test.evaluate(facts)?);
        if truth == Truth::False {
            break;
        }
    }
    Ok(truth)
}

/// From left to right, up to the first that is true.
fn any(tests: &[Test], facts: &impl Facts) -> Result<Truth, GuardError> {
    let mut truth = Truth::False;
    for test in tests {
        truth = truth.max(test.evaluate(facts)?);
        if truth == Truth::True {
            break;
        }
    }
    Ok(truth)
}

/// What has a value.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Term {
    Bool(bool),
    Uint(u64),
    Float(f64),
    Text(Box<str>),
    Enum(i32),
    Field(MessageSource, Box<[FieldId]>),
    Message(MessageSource),
    Call(FunctionId, Box<[Term]>),
    Negative(Box<Term>),
    Sum(Box<Term>, Box<[(Additive, Term)]>),
    Product(Box<Term>, Box<[(Multiplicative, Term)]>),
    Truth(Box<Test>),
}

impl Term {
    pub(super) fn evaluate<'a>(&'a self, facts: &'a impl Facts) -> Result<Value<'a>, GuardError> {
        Ok(match self {
            Term::Bool(value) => Value::Bool(*value),
            Term::Uint(value) => Value::Uint(*value),
            Term::Float(value) => Value::Float(*value),
            Term::Text(value) => Value::Text(value),
            Term::Enum(value) => Value::Enum(*value),
            Term::Field(source, path) => facts.field(source, path),
            Term::Message(source) => facts.message(source),
            Term::Call(function, arguments) => call(*function, arguments, facts)?,
            Term::Negative(term) => negative(term.evaluate(facts)?)?,
            Term::Sum(first, rest) => {
                let mut sum = first.evaluate(facts)?;
                for (operator, term) in rest {
                    sum = arithmetic(sum, Operator::from(*operator), term.evaluate(facts)?)?;
                }
                sum
            }
            Term::Product(first, rest) => {
                let mut product = first.evaluate(facts)?;
                for (operator, term) in rest {
                    product = arithmetic(product, Operator::from(*operator), term.evaluate(facts)?)?;
                }
                product
            }
            Term::Truth(test) => test.evaluate(facts)?.value(),
        })
    }
}

/// A call whose arguments depend on a message that has not arrived is not made: its result is missing too.
fn call<'a>(function: FunctionId, terms: &'a [Term], facts: &'a impl Facts) -> Result<Value<'a>, GuardError> {
    let mut arguments = [Value::Missing; MAX_ARGUMENTS];
    let arguments = arguments.get_mut(..terms.len()).ok_or(GuardError::WrongType)?;
    for (argument, term) in arguments.iter_mut().zip(terms) {
        *argument = term.evaluate(facts)?;
        if matches!(argument, Value::Missing) {
            return Ok(Value::Missing);
        }
    }
    Ok(facts.call(function, arguments)?)
}

fn negative(value: Value<'_>) -> Result<Value<'_>, GuardError> {
    arithmetic(Value::Uint(0), Operator::Minus, value)
}

#[derive(Clone, Copy)]
enum Operator {
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

/// Sums and products of whole numbers are whole; a quotient is a floating point number.
fn arithmetic<'a>(left: Value<'a>, operator: Operator, right: Value<'a>) -> Result<Value<'a>, GuardError> {
    if matches!(left, Value::Missing) || matches!(right, Value::Missing) {
        return Ok(Value::Missing);
    }
    match (Number::of(left)?, operator, Number::of(right)?) {
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

fn compare(left: Value<'_>, comparison: Comparison, right: Value<'_>) -> Result<Truth, GuardError> {
    let order = match (left, right) {
        (Value::Missing, _) | (_, Value::Missing) => return Ok(Truth::Unknown),
        (Value::Float(left), Value::Float(right)) => left.partial_cmp(&right).ok_or(GuardError::NotANumber)?,
        (Value::Enum(left), Value::Enum(right)) => left.cmp(&right),
        (Value::Bool(left), Value::Bool(right)) => left.cmp(&right),
        (Value::Text(left), Value::Text(right)) => left.cmp(right),
        (left, right) => compare_numbers(Number::of(left)?, Number::of(right)?)?,
    };
    Ok(Truth::from(match comparison {
        Comparison::Equal => order.is_eq(),
        Comparison::NotEqual => order.is_ne(),
        Comparison::Less => order.is_lt(),
        Comparison::LessOrEqual => order.is_le(),
        Comparison::Greater => order.is_gt(),
        Comparison::GreaterOrEqual => order.is_ge(),
    }))
}

/// By value, whatever the width: no whole number is rounded on the way.
fn compare_numbers(left: Number, right: Number) -> Result<Ordering, GuardError> {
    match (left, right) {
        (Number::Whole(left), Number::Whole(right)) => Ok(left.cmp(&right)),
        (Number::Float(left), Number::Float(right)) => left.partial_cmp(&right).ok_or(GuardError::NotANumber),
        (Number::Whole(left), Number::Float(right)) => compare_whole(left, right),
        (Number::Float(left), Number::Whole(right)) => compare_whole(right, left).map(Ordering::reverse),
    }
}

/// A cast of a float to `i128` cuts off the fraction, and saturates far beyond 64 bits: the whole parts decide first.
fn compare_whole(whole: i128, float: f64) -> Result<Ordering, GuardError> {
    if float.is_nan() {
        return Err(GuardError::NotANumber);
    }
    match whole.cmp(&(float as i128)) {
        Ordering::Equal => 0.0_f64.partial_cmp(&(float - float.trunc())).ok_or(GuardError::NotANumber),
        order => Ok(order),
    }
}
