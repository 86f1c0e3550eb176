//! Compiled expressions and their evaluation, without allocation and without names.
//!
//! Conditions have three values (Kleene): a condition that reads a message that has not arrived is
//! unknown, and only true enables a transition.

use super::arithmetic::{ArithmeticOperator, arithmetic, compare, compare_plainly, negative};
use super::eval_context::{EvalContext, MessageSource, TimerId, TimerState};
use super::guard_error::GuardError;
use super::names::ScriptId;
use super::read_set::ReadSet;
use super::syntax::{Additive, Comparison, Multiplicative};
use crate::native::{FieldSetter, TypedTest, TypedValue};
use crate::node_id::NodeId;
use crate::vocabulary::{FieldId, FunctionId, TopicId, Value};

/// Maximum number of arguments of a function.
pub(crate) const MAX_ARGUMENTS: usize = 8;

/// A compiled guard.
#[derive(Clone, PartialEq, Debug)]
pub struct Guard {
    test: BooleanTerm,
    reads: Box<[TopicId]>,
    sources: Box<[MessageSource]>,
    timers: Box<[TimerId]>,
}

impl Guard {
    pub(crate) fn new(test: BooleanTerm) -> Guard {
        let mut reads = ReadSet::default();
        reads.of_test(&test);
        Guard { test, reads: reads.topics(), sources: reads.sources(), timers: reads.timers() }
    }

    /// Whether the guard holds. Unknown (it reads a message that has not arrived) counts as not
    /// holding.
    ///
    /// # Errors
    /// An operation has no result; see [`GuardError`].
    #[inline]
    pub fn evaluate(&self, facts: &impl EvalContext) -> Result<bool, GuardError> {
        match self.evaluate_plainly(facts) {
            Some(holds) => Ok(holds),
            None => Ok(self.test.evaluate(facts)? == TruthValue::True),
        }
    }

    /// The same for guards that consist of timers and of fields compared with constants of their
    /// own types, as most do; `None` for others.
    #[inline(always)]
    pub fn evaluate_plainly(&self, facts: &impl EvalContext) -> Option<bool> {
        match &self.test {
            BooleanTerm::All(tests) => {
                for test in tests {
                    if !test.evaluate_plainly(facts)? {
                        return Some(false);
                    }
                }
                Some(true)
            }
            test => test.evaluate_plainly(facts),
        }
    }

    /// The topics it reads, sorted, without duplicates.
    pub fn reads(&self) -> &[TopicId] {
        &self.reads
    }

    /// The message sources it reads, sorted, without duplicates.
    pub fn sources(&self) -> &[MessageSource] {
        &self.sources
    }

    /// The timers it reads, sorted, without duplicates.
    pub fn timers(&self) -> &[TimerId] {
        &self.timers
    }

    /// The timers for which the guard distinguishes expired from never started.
    pub fn timers_distinguished_from_unset(&self) -> Vec<TimerId> {
        let mut reads = ReadSet::default();
        reads.of_test(&self.test);
        reads.timers_distinguished(&self.timers)
    }

    /// The timer that it tests first and that it requires, with the result for a timer that was
    /// never started: until the timer is over, the guard is false and reads nothing else.
    pub fn leading_timer(&self) -> Option<(TimerId, bool)> {
        let first = match &self.test {
            BooleanTerm::All(tests) => tests.first()?,
            test => test,
        };
        match first {
            BooleanTerm::Over { timer, when_unset } => Some((*timer, *when_unset)),
            _ => None,
        }
    }

    /// Whether it is the word `false`: intentionally never taken.
    pub fn is_literally_false(&self) -> bool {
        self.test == BooleanTerm::Literal(false)
    }

    /// Its condition, for translation to another language.
    pub fn test(&self) -> &BooleanTerm {
        &self.test
    }

    /// Replaces the condition by a function. The recorded reads stay.
    pub fn set_native_test(&mut self, test: TypedTest) {
        self.test = BooleanTerm::Typed(test);
    }
}

/// A compiled value: the right side of an assignment.
#[derive(Clone, PartialEq, Debug)]
pub struct Operand {
    term: ValueTerm,
    reads: Box<[TopicId]>,
    sources: Box<[MessageSource]>,
    change: Option<FieldSetter>,
}

impl Operand {
    pub(crate) fn new(term: ValueTerm) -> Operand {
        let mut reads = ReadSet::default();
        reads.of_term(&term);
        Operand { term, reads: reads.topics(), sources: reads.sources(), change: None }
    }

    /// The value; [`Value::Missing`] if it depends on a message that has not arrived.
    ///
    /// # Errors
    /// An operation has no result; see [`GuardError`].
    pub fn evaluate<'a>(&'a self, facts: &'a impl EvalContext) -> Result<Value<'a>, GuardError> {
        self.term.evaluate(facts)
    }

    /// The topics it reads, sorted, without duplicates.
    pub fn reads(&self) -> &[TopicId] {
        &self.reads
    }

    /// The message sources it reads, sorted, without duplicates.
    pub fn sources(&self) -> &[MessageSource] {
        &self.sources
    }

    /// Its term, for translation to another language.
    pub fn term(&self) -> &ValueTerm {
        &self.term
    }

    /// Replaces the value by a function, with another that stores it in its message. The recorded
    /// reads stay.
    pub fn set_native_value(&mut self, value: TypedValue, change: FieldSetter) {
        (self.term, self.change) = (ValueTerm::Typed(value), Some(change));
    }

    /// The function that stores the value in its message, if there is one.
    pub fn change(&self) -> Option<&FieldSetter> {
        self.change.as_ref()
    }
}

/// The values of Kleene's logic, ordered so that "and" is the minimum and "or" the maximum.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum TruthValue {
    False,
    Unknown,
    True,
}

impl TruthValue {
    fn negated(self) -> TruthValue {
        match self {
            TruthValue::False => TruthValue::True,
            TruthValue::Unknown => TruthValue::Unknown,
            TruthValue::True => TruthValue::False,
        }
    }

    fn value(self) -> Value<'static> {
        match self {
            TruthValue::False => Value::Bool(false),
            TruthValue::Unknown => Value::Missing,
            TruthValue::True => Value::Bool(true),
        }
    }
}

impl From<bool> for TruthValue {
    fn from(holds: bool) -> TruthValue {
        if holds { TruthValue::True } else { TruthValue::False }
    }
}

/// A comparison without a result is unknown.
impl From<Option<bool>> for TruthValue {
    fn from(answer: Option<bool>) -> TruthValue {
        answer.map_or(TruthValue::Unknown, TruthValue::from)
    }
}

/// A term with a truth value.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum BooleanTerm {
    /// `true` or `false`.
    Literal(bool),
    /// Conjunction, evaluated up to the first false operand.
    All(Box<[BooleanTerm]>),
    /// Disjunction, evaluated up to the first true operand.
    Any(Box<[BooleanTerm]>),
    /// Negation.
    Not(Box<BooleanTerm>),
    /// A comparison of two values.
    Compare(ValueTerm, Comparison, ValueTerm),
    /// The most frequent comparison, of a field with a constant, without indirection.
    FieldIs {
        /// The source of the message.
        source: MessageSource,
        /// The field.
        path: Box<[FieldId]>,
        /// The comparison.
        comparison: Comparison,
        /// The constant on the right.
        literal: Literal,
    },
    /// Whether no message has arrived.
    Absent(MessageSource),
    /// Whether a timer has expired.
    Over {
        /// The timer.
        timer: TimerId,
        /// The result for a timer that was never started.
        when_unset: bool,
    },
    /// `TimeoutCheck` of the timer with this name, which no action starts on the blackboard.
    NeverStarted(Box<str>),
    /// Whether a state is active.
    Active(NodeId),
    /// A condition in the language of the host.
    Script(ScriptId),
    /// A Boolean value.
    Holds(ValueTerm),
    /// The result of a function.
    Typed(TypedTest),
}

impl BooleanTerm {
    #[inline(always)]
    fn evaluate_plainly(&self, facts: &impl EvalContext) -> Option<bool> {
        match self {
            BooleanTerm::FieldIs { source, path, comparison, literal } => {
                compare_plainly(facts.field(source, path), *comparison, literal)
            }
            BooleanTerm::Over { timer, when_unset } => Some(match facts.timer(*timer) {
                TimerState::Unset => *when_unset,
                TimerState::Running => false,
                TimerState::Over => true,
            }),
            BooleanTerm::Literal(value) => Some(*value),
            _ => None,
        }
    }

    pub(crate) fn compare(left: ValueTerm, comparison: Comparison, right: ValueTerm) -> BooleanTerm {
        match (left, right) {
            (ValueTerm::Field(source, path), ValueTerm::Literal(literal)) => {
                BooleanTerm::FieldIs { source, path, comparison, literal }
            }
            (ValueTerm::Literal(literal), ValueTerm::Field(source, path)) => {
                BooleanTerm::FieldIs { source, path, comparison: comparison.mirrored(), literal }
            }
            (left, right) => BooleanTerm::Compare(left, comparison, right),
        }
    }

    pub(crate) fn evaluate(&self, facts: &impl EvalContext) -> Result<TruthValue, GuardError> {
        Ok(match self {
            BooleanTerm::Literal(value) => TruthValue::from(*value),
            BooleanTerm::All(tests) => all(tests, facts)?,
            BooleanTerm::Any(tests) => any(tests, facts)?,
            BooleanTerm::Not(test) => test.evaluate(facts)?.negated(),
            BooleanTerm::Compare(left, comparison, right) => {
                TruthValue::from(compare(left.evaluate(facts)?, *comparison, right.evaluate(facts)?)?)
            }
            BooleanTerm::FieldIs { source, path, comparison, literal } => {
                TruthValue::from(compare(facts.field(source, path), *comparison, literal.value())?)
            }
            BooleanTerm::Absent(source) => TruthValue::from(matches!(facts.message(source), Value::Missing)),
            BooleanTerm::Over { timer, when_unset } => TruthValue::from(match facts.timer(*timer) {
                TimerState::Unset => *when_unset,
                TimerState::Running => false,
                TimerState::Over => true,
            }),
            BooleanTerm::NeverStarted(_) => TruthValue::False,
            BooleanTerm::Active(state) => TruthValue::from(facts.is_active(*state)),
            BooleanTerm::Script(script) => TruthValue::from(facts.script(*script)?),
            BooleanTerm::Typed(test) => TruthValue::from(test.ask(facts)?),
            BooleanTerm::Holds(term) => match term.evaluate(facts)? {
                Value::Bool(value) => TruthValue::from(value),
                Value::Missing => TruthValue::Unknown,
                _ => return Err(GuardError::WrongType),
            },
        })
    }
}

/// Evaluates from left to right up to the first false operand; later operands cannot fail.
fn all(tests: &[BooleanTerm], facts: &impl EvalContext) -> Result<TruthValue, GuardError> {
    let mut truth = TruthValue::True;
    for test in tests {
        truth = truth.min(test.evaluate(facts)?);
        if truth == TruthValue::False {
            break;
        }
    }
    Ok(truth)
}

/// Evaluates from left to right up to the first true operand.
fn any(tests: &[BooleanTerm], facts: &impl EvalContext) -> Result<TruthValue, GuardError> {
    let mut truth = TruthValue::False;
    for test in tests {
        truth = truth.max(test.evaluate(facts)?);
        if truth == TruthValue::True {
            break;
        }
    }
    Ok(truth)
}

/// A constant value.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum Literal {
    /// True or false.
    Bool(bool),
    /// A signed integer.
    Int(i64),
    /// An unsigned integer.
    Uint(u64),
    /// A number with a fraction.
    Float(f64),
    /// A text.
    Text(Box<str>),
    /// The number of a value of an enumeration.
    Enum(i32),
}

impl Literal {
    #[inline]
    fn value(&self) -> Value<'_> {
        match self {
            Literal::Bool(value) => Value::Bool(*value),
            Literal::Int(value) => Value::Int(*value),
            Literal::Uint(value) => Value::Uint(*value),
            Literal::Float(value) => Value::Float(*value),
            Literal::Text(value) => Value::Text(value),
            Literal::Enum(value) => Value::Enum(*value),
        }
    }
}

/// A term with a value.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum ValueTerm {
    /// A constant value.
    Literal(Literal),
    /// A field of a message; the path leads through nested messages.
    Field(MessageSource, Box<[FieldId]>),
    /// A whole message.
    Message(MessageSource),
    /// The result of a function.
    Call(FunctionId, Box<[ValueTerm]>),
    /// A negated value.
    Negative(Box<ValueTerm>),
    /// A sum, from left to right.
    Sum(Box<ValueTerm>, Box<[(Additive, ValueTerm)]>),
    /// A product, from left to right.
    Product(Box<ValueTerm>, Box<[(Multiplicative, ValueTerm)]>),
    /// A truth value.
    Truth(Box<BooleanTerm>),
    /// The result of a function.
    Typed(TypedValue),
}

impl ValueTerm {
    pub(crate) fn evaluate<'a>(&'a self, facts: &'a impl EvalContext) -> Result<Value<'a>, GuardError> {
        Ok(match self {
            ValueTerm::Literal(literal) => literal.value(),
            ValueTerm::Field(source, path) => facts.field(source, path),
            ValueTerm::Message(source) => facts.message(source),
            ValueTerm::Call(function, arguments) => call(*function, arguments, facts)?,
            ValueTerm::Negative(term) => negative(term.evaluate(facts)?)?,
            ValueTerm::Sum(first, rest) => chain(first, rest, facts)?,
            ValueTerm::Product(first, rest) => chain(first, rest, facts)?,
            ValueTerm::Truth(test) => test.evaluate(facts)?.value(),
            ValueTerm::Typed(value) => value.ask(facts)?,
        })
    }
}

/// From left to right.
fn chain<'a, O>(
    first: &'a ValueTerm,
    rest: &'a [(O, ValueTerm)],
    facts: &'a impl EvalContext,
) -> Result<Value<'a>, GuardError>
where
    O: Copy + Into<ArithmeticOperator>,
{
    rest.iter().try_fold(first.evaluate(facts)?, |result, (operator, term)| {
        arithmetic(result, *operator, term.evaluate(facts)?)
    })
}

/// A function is not called if an argument depends on a message that has not arrived; its result is
/// missing too.
fn call<'a>(
    function: FunctionId,
    terms: &'a [ValueTerm],
    facts: &'a impl EvalContext,
) -> Result<Value<'a>, GuardError> {
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
