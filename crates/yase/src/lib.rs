//! Statecharts as checked data, transition expressions, and the machine that steps them.

mod bits;
mod chart;
pub mod diagnostic;
pub mod expression;
mod host;
mod machine;
mod moment;
mod semantics;
pub mod statechart;
mod trace;
pub mod vocabulary;

pub use chart::{ActivityEntry, Chart, CompoundId, RegionId};
pub use diagnostic::{Diagnostic, Severity, Source, Span};
pub use host::{ActionError, ActionPlace, Activation, Host, Outcome, Report};
pub use machine::{Machine, MachineError, MachineErrorKind, Status, StepSummary};
pub use moment::Moment;
pub use semantics::{Deferral, Delivery, Eventless, Semantics};
pub use statechart::{Node, NodeId, NodeKind, Statechart, Transition, TransitionId};
pub use trace::{Occasion, TraceRecord};
pub use vocabulary::{FieldId, FunctionId, TopicId, Value, Vocabulary};
