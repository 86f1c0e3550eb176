//! Statecharts as checked data, transition expressions, and the machine that steps them.

pub mod diagnostic;
pub mod expression;
pub mod statechart;
pub mod vocabulary;

pub use diagnostic::{Diagnostic, Severity, Source, Span};
pub use statechart::{Node, NodeId, NodeKind, Statechart, Transition, TransitionId};
pub use vocabulary::{FieldId, FunctionId, TopicId, Value, Vocabulary};
