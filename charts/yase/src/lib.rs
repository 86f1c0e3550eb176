//! Statecharts as checked data, transition expressions, and the machine that executes them.
//!
//! A [`Statechart`] is data: a tree of nodes with transitions between them, produced by a model
//! file, a formula or an editor. [`Statechart::compile`] checks it against a [`TypeEnvironment`],
//! which declares the names its expressions may use, and returns a [`CompiledChart`]: immutable,
//! with everything that does not depend on data precomputed. A [`Machine`] executes a chart. A
//! [`Host`] provides its environment: blackboards to read and write, and activities to start. The
//! machine reads no clock and starts no thread, so the same chart runs on a robot, in simulated
//! time and in a test.
//!
//! # Semantics
//!
//! The semantics is that of YASE, the statechart engine of the Monas architecture. It is close to
//! Rhapsody and UML and differs from both where agents require it:
//!
//! - A BASIC state may run an **activity** once per entry, of any duration. Meanwhile its **scope**
//!   is locked: no state that shares the blackboard takes a transition, and no enclosing composite
//!   is left. An event whose transition is locked is held and offered again, before newer events,
//!   when the activity has returned.
//! - Each region of an AND has its own **blackboard**, as does the root. It does not change while
//!   an activity uses it.
//! - A composite can remain in **START**: its guards are evaluated after the action of the
//!   transition that entered the composite.
//! - A transition without a trigger is taken when its source has **completed**: the activity has
//!   returned, END is reached, or all regions have completed. A guarded transition may also leave a
//!   composite when nothing inside is enabled or running.
//! - Inner transitions take precedence over outer ones. All guards are evaluated before any action.
//!   A compound transition through connectors is taken completely or not at all.
//!
//! One call of [`Machine::run_to_completion`] is a transaction: messages are delivered, transitions
//! are taken until none is enabled, outputs are published, activities start. If dialects differ,
//! the [`Semantics`] for which a chart is compiled selects the variant.
//!
//! # Example
//!
//! A lamp that is on while an activity runs, which takes half a second:
//!
//! ```
//! use std::sync::Arc;
//! use yase::expression::parse_transition;
//! use yase::{Activation, Host, Machine, Timestamp, Node, NodeKind, Outcome, Statechart, Transition, TypeEnvironment};
//!
//! let mut lamp = Statechart::new("lamp");
//! let start = lamp.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let off = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "off"));
//! let on = lamp.add(Statechart::ROOT, Node { activity: Some("work".into()), ..Node::new(NodeKind::Basic, "on") });
//! for (source, target, text) in [(start, off, ""), (off, on, "button"), (on, off, "")] {
//!     let (expression, wrong) = parse_transition(text);
//!     assert!(wrong.is_empty());
//!     lamp.connect(Transition { expression, ..Transition::new(source, target) });
//! }
//!
//! /// A host with activities, but without messages.
//! #[derive(Default)]
//! struct Room {
//!     working: Option<Activation>,
//! }
//!
//! impl Host for Room {
//!     fn start(&mut self, activation: Activation) {
//!         self.working = Some(activation);
//!     }
//!     fn cancel(&mut self, _: Activation) {}
//!     fn stop(&mut self, _: Activation) {}
//! }
//!
//! let chart = lamp.compile(&TypeEnvironment::default()).expect("the chart is in order");
//! let mut machine = Machine::new(Arc::new(chart));
//! let mut room = Room::default();
//! machine.start(Timestamp::ZERO, &mut room);
//! machine.run_to_completion(Timestamp::ZERO, &mut room)?;
//! assert!(machine.is_active(off));
//!
//! machine.dispatch_name("button");
//! machine.run_to_completion(Timestamp::from_millis(100), &mut room)?;
//! assert!(machine.is_active(on));
//!
//! let working = room.working.take().expect("the activity was started when the step was over");
//! machine.activity_returned(working, Outcome::Done);
//! machine.run_to_completion(Timestamp::from_millis(600), &mut room)?;
//! assert!(machine.is_active(off));
//! # Ok::<(), yase::MachineError>(())
//! ```
//!
//! # Related crates
//!
//! | crate | purpose |
//! |---|---|
//! | `yase-expression` | parses, checks and evaluates transition expressions, as [`expression`] |
//! | `yase-scxml` | reads and writes SCXML, and runs its documents |
//! | `yase-explore` | enumerates the reachable states of a chart |
//! | `yase-export` | draws charts, and exports them for XState, Mermaid, PlantUML and Graphviz |
//! | `yase-codegen` | generates Rust: native guards for this machine, or a single `match` without it |

/// Runs the examples of the README as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod bits;
mod compile;
mod host;
mod ids;
mod machine;
pub mod migrate;
pub mod native;
mod script;
mod semantics;
pub mod statechart;
mod timestamp;
mod trace;

pub use compile::{ActivityEntry, CompiledChart, ScriptEntry, ScriptLocation};
pub use diagnostic::{Diagnostic, Severity, Source, Span};
pub use host::{ActionError, Host, Notice, Outcome};
pub use ids::{ActionLocation, Activation, CompoundTransitionId, ScopeId};
pub use machine::{
    Chooser, GuardValue, Machine, MachineError, MachineErrorKind, MicroStep, Status, StepSummary,
};
pub use machine::{snapshot, state_key};
pub use script::{ActiveStates, ScriptContext};
pub use semantics::{
    ActivityOnExit, CompletionTrigger, ConflictResolution, Deferral, Delivery, EventMatching, EventPool,
    ExitOrder, ExitPointArrival, FailureEvents, Firing, InitialState, JoinMode, RootCompletion, SegmentOrder,
    Semantics, StructureRules, TerminateExit, TimerScope, TransitionToAncestor, WriteVisibility,
};
pub use statechart::{
    Element, Node, NodeId, NodeKind, StateNames, Statechart, Transition, TransitionId, UnknownState,
};
pub use timestamp::Timestamp;
pub use trace::{MicroStepCause, TraceRecord};
pub use vocabulary::{FieldId, FunctionId, TopicId, TypeEnvironment, Value};
/// Transition expressions: the crate `yase-expression`.
pub use yase_expression as expression;
pub use yase_expression::{diagnostic, vocabulary};
