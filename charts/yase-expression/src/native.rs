//! Guards and assigned values as Rust functions: a host compiles a chart with functions in place of
//! texts, and the machine calls them with the current data ([`GuardInput`]).

use std::any::Any;
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use crate::eval_context::{CallError, EvalContext, MessageSource, TimerId, TimerState};
use crate::guard_error::GuardError;
use crate::node_id::NodeId;
use crate::vocabulary::{FunctionId, Value};

/// The result of a guard function.
pub type GuardResult = Result<bool, GuardUnknown>;

/// Why a function returns no value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum GuardUnknown {
    /// It depends on a message that has not arrived.
    Unknown,
    /// An operation has no result.
    Failed(GuardError),
}

impl From<GuardError> for GuardUnknown {
    fn from(error: GuardError) -> GuardUnknown {
        GuardUnknown::Failed(error)
    }
}

impl From<CallError> for GuardUnknown {
    fn from(error: CallError) -> GuardUnknown {
        GuardUnknown::Failed(error.into())
    }
}

/// Messages of one type that a chart reads or writes, by their index in the chart.
pub struct Source<M> {
    number: usize,
    message: PhantomData<fn() -> M>,
}

impl<M> Source<M> {
    /// The source with this index: the sources of a chart are numbered from 0 in the order of their
    /// declarations.
    pub const fn new(number: usize) -> Source<M> {
        Source { number, message: PhantomData }
    }

    /// Its index in the chart.
    pub fn number(self) -> usize {
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

/// A timer, by its index in the chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Timer(pub usize);

/// A function of the type environment, by its index in the chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Function(pub usize);

/// Resolves the indices of a chart on one blackboard.
#[derive(Clone, Debug)]
pub struct Slots {
    /// The message source of each [`Source`], by index.
    pub sources: Arc<[MessageSource]>,
    /// The function of each [`Function`], by index.
    pub functions: Arc<[FunctionId]>,
    /// The timer of each [`Timer`], by index; `None` if no action starts it there.
    pub timers: Box<[Option<TimerId>]>,
}

/// The data that a guard reads in one evaluation.
#[derive(Clone, Copy)]
pub struct GuardInput<'a> {
    facts: &'a dyn EvalContext,
    slots: &'a Slots,
}

impl fmt::Debug for GuardInput<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GuardInput").field("slots", self.slots).finish_non_exhaustive()
    }
}

impl<'a> GuardInput<'a> {
    fn source<M>(&self, source: Source<M>) -> Result<&'a MessageSource, GuardUnknown> {
        self.slots.sources.get(source.number).ok_or(GuardError::WrongType.into())
    }

    /// The latest message.
    ///
    /// # Errors
    /// No message has arrived.
    pub fn latest<M: Any>(&self, source: Source<M>) -> Result<&'a M, GuardUnknown> {
        match self.message(source)? {
            Value::Message(message) => Ok(message.downcast_ref().ok_or(GuardError::WrongType)?),
            _ => Err(GuardError::WrongType.into()),
        }
    }

    /// The latest message as an argument of a function.
    ///
    /// # Errors
    /// No message has arrived.
    pub fn message<M>(&self, source: Source<M>) -> Result<Value<'a>, GuardUnknown> {
        match self.facts.message(self.source(source)?) {
            Value::Missing => Err(GuardUnknown::Unknown),
            message => Ok(message),
        }
    }

    /// Whether no message has arrived: `M == NULL`.
    pub fn is_absent<M>(&self, source: Source<M>) -> bool {
        matches!(self.message(source), Err(GuardUnknown::Unknown))
    }

    /// Whether a timer has expired or was never started: its bare name.
    pub fn is_over(&self, timer: Timer) -> bool {
        self.state(timer) != TimerState::Running
    }

    /// Whether a timer was started and has expired: `TimeoutCheck`.
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

    /// The result of a function.
    ///
    /// # Errors
    /// The function fails, or its result is unknown.
    pub fn call(&self, function: Function, arguments: &[Value<'_>]) -> Result<Value<'a>, GuardUnknown> {
        let missing = || CallError::new("there is no such function");
        let function = self.slots.functions.get(function.0).ok_or_else(missing)?;
        match self.facts.call(*function, arguments)? {
            Value::Missing => Err(GuardUnknown::Unknown),
            value => Ok(value),
        }
    }
}

/// A guard as a function.
pub type GuardFn = fn(&GuardInput<'_>) -> GuardResult;
/// An assigned value as a function.
pub type ValueFn = for<'a> fn(&GuardInput<'a>) -> Result<Value<'a>, GuardUnknown>;
type FieldSetterFn = dyn Fn(&mut dyn Any, Value<'_>) -> Result<(), CallError> + Send + Sync;

/// A guard that is a function.
#[derive(Clone)]
pub struct TypedTest {
    /// The function.
    pub test: GuardFn,
    /// Resolves its indices.
    pub slots: Arc<Slots>,
}

impl TypedTest {
    /// Whether the guard holds; `None` if that is unknown.
    ///
    /// # Errors
    /// An operation has no result.
    pub fn ask(&self, facts: &impl EvalContext) -> Result<Option<bool>, GuardError> {
        match (self.test)(&GuardInput { facts, slots: &self.slots }) {
            Ok(holds) => Ok(Some(holds)),
            Err(GuardUnknown::Unknown) => Ok(None),
            Err(GuardUnknown::Failed(error)) => Err(error),
        }
    }
}

/// An assigned value that is a function.
#[derive(Clone)]
pub struct TypedValue {
    /// The function.
    pub value: ValueFn,
    /// Resolves its indices.
    pub slots: Arc<Slots>,
}

impl TypedValue {
    /// The value; missing if it depends on a message that has not arrived.
    ///
    /// # Errors
    /// An operation has no result.
    pub fn ask<'a>(&'a self, facts: &'a impl EvalContext) -> Result<Value<'a>, GuardError> {
        match (self.value)(&GuardInput { facts, slots: &self.slots }) {
            Ok(value) => Ok(value),
            Err(GuardUnknown::Unknown) => Ok(Value::Missing),
            Err(GuardUnknown::Failed(error)) => Err(error),
        }
    }
}

/// A function that stores a value in its message.
#[derive(Clone)]
pub struct FieldSetter(pub Arc<FieldSetterFn>);

impl FieldSetter {
    /// Stores a value in a message.
    ///
    /// # Errors
    /// The message has another type, or its field cannot hold the value.
    pub fn make(&self, message: &mut dyn Any, value: Value<'_>) -> Result<(), CallError> {
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

impl PartialEq for FieldSetter {
    fn eq(&self, other: &FieldSetter) -> bool {
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

impl fmt::Debug for FieldSetter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("FieldSetter")
    }
}
