//! Compiled expressions, and how they are evaluated: without allocation, without names.
//!
//! Conditions are three-valued (Kleene): what reads a message that has not arrived is unknown, and only true
//! fires.

use super::arithmetic::{Operator, arithmetic, compare, compare_plainly, negative};
use super::facts::{CallError, Facts, MessageSource, TimerId, TimerState};
use super::names::ScriptId;
use super::reads::Reads;
use super::syntax::{Additive, Comparison, Multiplicative};
use crate::statechart::NodeId;
use crate::typed::{Change, TypedTest, TypedValue};
use crate::vocabulary::{FieldId, FunctionId, TopicId, Value};

/// No function that an expression may call takes more arguments.
pub(super) const MAX_ARGUMENTS: usize = 8;

/// A compiled guard.
#[derive(Clone, PartialEq, Debug)]
pub struct Guard {
    test: Test,
    reads: Box<[TopicId]>,
    sources: Box<[MessageSource]>,
    timers: Box<[TimerId]>,
}

impl Guard {
    pub(super) fn new(test: Test) -> Guard {
        let mut reads = Reads::default();
        reads.of_test(&test);
        Guard { test, reads: reads.topics(), sources: reads.sources(), timers: reads.timers() }
    }

    /// Whether the guard holds. Unknown, which is what reads a message that has not arrived, is not holding.
    ///
    /// # Errors
    /// When an operation has no result; see [`GuardError`].
    #[inline]
    pub fn evaluate(&self, facts: &impl Facts) -> Result<bool, GuardError> {
        match self.evaluate_plainly(facts) {
            Some(holds) => Ok(holds),
            None => Ok(self.test.evaluate(facts)? == Truth::True),
        }
    }

    /// The same where fields are compared with constants of their own kinds, which is all that most guards do; else nothing.
    #[inline(always)]
    pub(crate) fn evaluate_plainly(&self, facts: &impl Facts) -> Option<bool> {
        match &self.test {
            Test::All(tests) => {
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

    /// The topics it reads, each once, in order.
    pub fn reads(&self) -> &[TopicId] {
        &self.reads
    }

    /// The sources it reads messages of, each once, in order.
    pub fn sources(&self) -> &[MessageSource] {
        &self.sources
    }

    /// The timers it reads, each once, in order.
    pub fn timers(&self) -> &[TimerId] {
        &self.timers
    }

    /// The timers of which it matters to the guard whether they are over or were never set.
    pub(crate) fn timers_told_apart(&self) -> Vec<TimerId> {
        let mut reads = Reads::default();
        reads.of_test(&self.test);
        reads.timers_told_apart(&self.timers)
    }

    /// Whether it is the word `false`: never taken, and meant so.
    pub fn is_literally_false(&self) -> bool {
        self.test == Test::Literal(false)
    }

    /// What it asks, for those who write it down in another language.
    pub fn test(&self) -> &Test {
        &self.test
    }

    /// From now on a function says whether it holds. What it reads remains.
    pub(crate) fn ask(&mut self, test: TypedTest) {
        self.test = Test::Typed(test);
    }
}

/// A compiled value: the right side of an assignment.
#[derive(Clone, PartialEq, Debug)]
pub struct Operand {
    term: Term,
    reads: Box<[TopicId]>,
    sources: Box<[MessageSource]>,
    change: Option<Change>,
}

impl Operand {
    pub(super) fn new(term: Term) -> Operand {
        let mut reads = Reads::default();
        reads.of_term(&term);
        Operand { term, reads: reads.topics(), sources: reads.sources(), change: None }
    }

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

    /// The sources it reads messages of, each once, in order.
    pub fn sources(&self) -> &[MessageSource] {
        &self.sources
    }

    /// What it is made of, for those who write it down in another language.
    pub fn term(&self) -> &Term {
        &self.term
    }

    /// From now on a function gives the value, and another puts it into its message. What it reads remains.
    pub(crate) fn ask(&mut self, value: TypedValue, change: Change) {
        (self.term, self.change) = (Term::Typed(value), Some(change));
    }

    /// The function that puts the value into its message, if there is one.
    pub(crate) fn change(&self) -> Option<&Change> {
        self.change.as_ref()
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

/// A comparison without an answer is unknown.
impl From<Option<bool>> for Truth {
    fn from(answer: Option<bool>) -> Truth {
        answer.map_or(Truth::Unknown, Truth::from)
    }
}

/// What has a truth value.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum Test {
    /// `true` or `false`.
    Literal(bool),
    /// Each of them, looked at up to the first that is false.
    All(Box<[Test]>),
    /// One of them, looked at up to the first that is true.
    Any(Box<[Test]>),
    /// The contrary.
    Not(Box<Test>),
    /// A comparison of two values.
    Compare(Term, Comparison, Term),
    /// The usual comparison, of a field with a constant, without a detour.
    FieldIs {
        /// Whose message.
        source: MessageSource,
        /// Which field of it.
        path: Box<[FieldId]>,
        /// How they are compared.
        comparison: Comparison,
        /// The constant, on the right.
        literal: Literal,
    },
    /// Whether no message has arrived.
    Absent(MessageSource),
    /// Whether a timer is over.
    Over {
        /// The timer.
        timer: TimerId,
        /// What it says of a timer that was never started.
        when_unset: bool,
    },
    /// `TimeoutCheck` of the timer of that name, which nothing starts on the blackboard.
    NeverStarted(Box<str>),
    /// Whether a state is active.
    Active(NodeId),
    /// A condition in the host's own language.
    Script(ScriptId),
    /// A value that is true or false.
    Holds(Term),
    /// What a function says.
    Typed(TypedTest),
}

impl Test {
    #[inline(always)]
    fn evaluate_plainly(&self, facts: &impl Facts) -> Option<bool> {
        match self {
            Test::FieldIs { source, path, comparison, literal } => {
                compare_plainly(facts.field(source, path), *comparison, literal)
            }
            _ => None,
        }
    }

    pub(super) fn compare(left: Term, comparison: Comparison, right: Term) -> Test {
        match (left, right) {
            (Term::Field(source, path), Term::Literal(literal)) => {
                Test::FieldIs { source, path, comparison, literal }
            }
            (Term::Literal(literal), Term::Field(source, path)) => {
                Test::FieldIs { source, path, comparison: comparison.mirrored(), literal }
            }
            (left, right) => Test::Compare(left, comparison, right),
        }
    }

    pub(super) fn evaluate(&self, facts: &impl Facts) -> Result<Truth, GuardError> {
        Ok(match self {
            Test::Literal(value) => Truth::from(*value),
            Test::All(tests) => all(tests, facts)?,
            Test::Any(tests) => any(tests, facts)?,
            Test::Not(test) => test.evaluate(facts)?.negated(),
            Test::Compare(left, comparison, right) => {
                Truth::from(compare(left.evaluate(facts)?, *comparison, right.evaluate(facts)?)?)
            }
            Test::FieldIs { source, path, comparison, literal } => {
                Truth::from(compare(facts.field(source, path), *comparison, literal.value())?)
            }
            Test::Absent(source) => Truth::from(matches!(facts.message(source), Value::Missing)),
            Test::Over { timer, when_unset } => Truth::from(match facts.timer(*timer) {
                TimerState::Unset => *when_unset,
                TimerState::Running => false,
                TimerState::Over => true,
            }),
            Test::NeverStarted(_) => Truth::False,
            Test::Active(state) => Truth::from(facts.is_active(*state)),
            Test::Script(script) => Truth::from(facts.script(*script)?),
            Test::Typed(test) => Truth::from(test.ask(facts)?),
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

/// A value that is known beforehand.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum Literal {
    /// True or false.
    Bool(bool),
    /// A whole number with a sign.
    Int(i64),
    /// A whole number without one.
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

/// What has a value.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum Term {
    /// A value that is known beforehand.
    Literal(Literal),
    /// A field of a message; the path leads through messages inside it.
    Field(MessageSource, Box<[FieldId]>),
    /// A whole message.
    Message(MessageSource),
    /// What a function makes of its arguments.
    Call(FunctionId, Box<[Term]>),
    /// Zero minus a value.
    Negative(Box<Term>),
    /// A sum, from left to right.
    Sum(Box<Term>, Box<[(Additive, Term)]>),
    /// A product, from left to right.
    Product(Box<Term>, Box<[(Multiplicative, Term)]>),
    /// Whether something holds.
    Truth(Box<Test>),
    /// What a function says.
    Typed(TypedValue),
}

impl Term {
    pub(super) fn evaluate<'a>(&'a self, facts: &'a impl Facts) -> Result<Value<'a>, GuardError> {
        Ok(match self {
            Term::Literal(literal) => literal.value(),
            Term::Field(source, path) => facts.field(source, path),
            Term::Message(source) => facts.message(source),
            Term::Call(function, arguments) => call(*function, arguments, facts)?,
            Term::Negative(term) => negative(term.evaluate(facts)?)?,
            Term::Sum(first, rest) => chain(first, rest, facts)?,
            Term::Product(first, rest) => chain(first, rest, facts)?,
            Term::Truth(test) => test.evaluate(facts)?.value(),
            Term::Typed(value) => value.ask(facts)?,
        })
    }
}

/// From left to right.
fn chain<'a, O>(
    first: &'a Term,
    rest: &'a [(O, Term)],
    facts: &'a impl Facts,
) -> Result<Value<'a>, GuardError>
where
    O: Copy + Into<Operator>,
{
    rest.iter().try_fold(first.evaluate(facts)?, |result, (operator, term)| {
        arithmetic(result, *operator, term.evaluate(facts)?)
    })
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
