//! What guards and values ask.

use std::any::Any;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use super::{Truth, Undecided};
use crate::expression::{CallError, Facts, GuardError, MessageSource, TimerId, TimerState};
use crate::statechart::NodeId;
use crate::vocabulary::{FunctionId, Value};

/// Messages of one type that a chart reads or writes, by their number in the chart.
pub struct Source<M> {
    number: usize,
    message: PhantomData<fn() -> M>,
}

impl<M> Source<M> {
    /// The source of that number: those of a chart are numbered from 0, in the order in which [`Draft::reads`](super::Draft::reads)
    /// declares them.
    pub const fn new(number: usize) -> Source<M> {
        Source { number, message: PhantomData }
    }

    pub(super) fn number(self) -> usize {
        self.number
    }
}

impl<M> Clone for Source<M> {
    fn clone(&self) -> Source<M> {
        *self
    }
}

impl<M> Copy for Source<M> {}

impl<M> fmt::Debug for Source<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Source({})", self.number)
    }
}

/// A timer, by its number in the chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Timer(pub usize);

/// A function of the vocabulary, by its number in the chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Function(pub usize);

/// What the numbers of a chart mean on one blackboard.
#[derive(Clone, Debug)]
pub(crate) struct Slots {
    pub(super) sources: Arc<[MessageSource]>,
    pub(super) functions: Arc<[FunctionId]>,
    /// None for what nothing starts there.
    pub(super) timers: Box<[Option<TimerId>]>,
}

/// The data of one moment, as a guard sees it.
#[derive(Clone, Copy)]
pub struct World<'a> {
    facts: &'a dyn Facts,
    slots: &'a Slots,
}

impl fmt::Debug for World<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("World").field("slots", self.slots).finish_non_exhaustive()
    }
}

impl<'a> World<'a> {
    fn source<M>(&self, source: Source<M>) -> Result<&'a MessageSource, Undecided> {
        self.slots.sources.get(source.number).ok_or(GuardError::WrongType.into())
    }

    /// The latest message.
    ///
    /// # Errors
    /// None has arrived.
    pub fn latest<M: Any>(&self, source: Source<M>) -> Result<&'a M, Undecided> {
        match self.message(source)? {
            Value::Message(message) => Ok(message.downcast_ref().ok_or(GuardError::WrongType)?),
            _ => Err(GuardError::WrongType.into()),
        }
    }

    /// The latest message, for a function.
    ///
    /// # Errors
    /// None has arrived.
    pub fn message<M>(&self, source: Source<M>) -> Result<Value<'a>, Undecided> {
        match self.facts.message(self.source(source)?) {
            Value::Missing => Err(Undecided::Unknown),
            message => Ok(message),
        }
    }

    /// Whether no message has arrived: `M == NULL`.
    pub fn is_absent<M>(&self, source: Source<M>) -> bool {
        matches!(self.message(source), Err(Undecided::Unknown))
    }

    /// Whether a timer is over, or was never started: its bare name.
    pub fn is_over(&self, timer: Timer) -> bool {
        self.state(timer) != TimerState::Running
    }

    /// Whether a timer was started and is over: `TimeoutCheck`.
    pub fn has_expired(&self, timer: Timer) -> bool {
        self.state(timer) == TimerState::Over
    }

    fn state(&self, timer: Timer) -> TimerState {
        match self.slots.timers.get(timer.0) {
            Some(&Some(timer)) => self.facts.timer(timer),
            _ => TimerState::Unset,
        }
    }

    /// Whether a state is active: `In(state)`.
    pub fn is_in(&self, state: impl Into<NodeId>) -> bool {
        self.facts.is_active(state.into())
    }

    /// What a function makes of its arguments.
    ///
    /// # Errors
    /// The function fails, or has nothing to say.
    pub fn call(&self, function: Function, arguments: &[Value<'_>]) -> Result<Value<'a>, Undecided> {
        let missing = || CallError::new("there is no such function");
        let function = self.slots.functions.get(function.0).ok_or_else(missing)?;
        match self.facts.call(*function, arguments)? {
            Value::Missing => Err(Undecided::Unknown),
            value => Ok(value),
        }
    }
}

pub(super) type Test = fn(&World<'_>) -> Truth;
pub(super) type Valuation = for<'a> fn(&World<'a>) -> Result<Value<'a>, Undecided>;
type Put = dyn Fn(&mut dyn Any, Value<'_>) -> Result<(), CallError> + Send + Sync;

/// A guard that is a function.
#[derive(Clone)]
pub struct TypedTest {
    pub(super) test: Test,
    pub(super) slots: Arc<Slots>,
}

impl TypedTest {
    pub(crate) fn ask(&self, facts: &impl Facts) -> Result<Option<bool>, GuardError> {
        match (self.test)(&World { facts, slots: &self.slots }) {
            Ok(holds) => Ok(Some(holds)),
            Err(Undecided::Unknown) => Ok(None),
            Err(Undecided::Failed(error)) => Err(error),
        }
    }
}

/// An assigned value that is a function.
#[derive(Clone)]
pub struct TypedValue {
    pub(super) value: Valuation,
    pub(super) slots: Arc<Slots>,
}

impl TypedValue {
    pub(crate) fn ask<'a>(&'a self, facts: &'a impl Facts) -> Result<Value<'a>, GuardError> {
        match (self.value)(&World { facts, slots: &self.slots }) {
            Ok(value) => Ok(value),
            Err(Undecided::Unknown) => Ok(Value::Missing),
            Err(Undecided::Failed(error)) => Err(error),
        }
    }
}

/// A function that puts a value into its message.
#[derive(Clone)]
pub(crate) struct Change(pub(super) Arc<Put>);

impl Change {
    pub(crate) fn make(&self, message: &mut dyn Any, value: Value<'_>) -> Result<(), CallError> {
        (self.0)(message, value)
    }
}

impl PartialEq for TypedTest {
    fn eq(&self, other: &TypedTest) -> bool {
        std::ptr::fn_addr_eq(self.test, other.test)
    }
}

impl PartialEq for TypedValue {
    fn eq(&self, other: &TypedValue) -> bool {
        std::ptr::fn_addr_eq(self.value, other.value)
    }
}

impl PartialEq for Change {
    fn eq(&self, other: &Change) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl fmt::Debug for TypedTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("TypedTest")
    }
}

impl fmt::Debug for TypedValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("TypedValue")
    }
}

impl fmt::Debug for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Change")
    }
}
