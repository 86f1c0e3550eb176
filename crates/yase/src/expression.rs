//! Transition expressions.

mod arithmetic;
mod compile;
mod facts;
mod lexer;
mod names;
mod parser;
mod print;
mod program;
mod reads;
mod syntax;

pub use compile::{CompiledTransition, CompiledTrigger, Effect, compile_actions};
pub use facts::{CallError, Facts, MessageSource, Origin, TimerId, TimerState};
pub use names::{EventId, EventTable, Names};
pub use parser::{parse_actions, parse_actions_at, parse_condition, parse_transition, parse_transition_at};
pub use program::{Guard, GuardError, Operand};
pub use syntax::{
    Action, ActionKind, Additive, Comparison, Expression, ExpressionKind, Multiplicative, Name, Path, Place,
    TimeoutForm, TransitionExpression, Trigger, started_timers,
};

#[cfg(test)]
mod tests;
