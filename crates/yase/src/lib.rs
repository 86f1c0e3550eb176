//! Statecharts as checked data, transition expressions, and the machine that steps them.
//!
//! A [`Statechart`] is data: a tree of nodes with transitions between them, as a model file, a formula or an editor makes it.
//! [`Statechart::compile`] checks it against a [`Vocabulary`], the words its expressions may use, and gives a [`Chart`]: immutable,
//! everything that does not depend on data worked out in advance. A [`Machine`] runs a chart. What it knows of its world is what a
//! [`Host`] tells it: blackboards to read and to write, and activities to start. It reads no clock and starts no thread, so the same
//! chart runs on a robot, in simulated time and in a test.
//!
//! # How a chart is read
//!
//! The model is that of YASE, the statechart engine of the Monas architecture, which is near to Rhapsody and UML and differs from both where
//! agents need it:
//!
//! - A BASIC state may run an **activity**: once for each time it is entered, for as long as it takes. Meanwhile its **region** is locked: no
//!   state that shares the blackboard steps, and no composite around it is left. An event that finds its transition locked is held and offered
//!   again, before newer ones, when the activity has returned.
//! - Each region of an AND has a **blackboard** of its own, as the root has. It does not move while an activity works on it.
//! - **START** is a place where a composite rests for a moment: its guards are read after the action that led there.
//! - A transition without a trigger is taken when its source has **completed**: the activity has returned, END is reached, all
//!   regions have completed. A composite may also be left by a guard, when nothing inside can step and nothing inside runs.
//! - Inner transitions win over outer ones; guards are all read before anything happens; a compound transition through connectors happens as a
//!   whole or not at all.
//!
//! One call of [`Machine::run_to_completion`] is a transaction: messages are delivered, transitions are taken until none is enabled, what was
//! written is published, activities start. Where dialects differ, the [`Semantics`] that a chart is compiled for says which reading is meant.
//!
//! # Example
//!
//! A lamp that is on for as long as somebody works, which takes half a second:
//!
//! ```
//! use std::sync::Arc;
//! use yase::expression::parse_transition;
//! use yase::{Activation, Host, Machine, Moment, Node, NodeKind, Outcome, Statechart, Transition, Vocabulary};
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
//! /// A world with activities, but without messages.
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
//! let chart = lamp.compile(&Vocabulary::default()).expect("the chart is in order");
//! let mut machine = Machine::new(Arc::new(chart));
//! let mut room = Room::default();
//! machine.start(Moment::ZERO, &mut room);
//! machine.run_to_completion(Moment::ZERO, &mut room)?;
//! assert!(machine.is_active(off));
//!
//! machine.dispatch_name("button");
//! machine.run_to_completion(Moment::from_millis(100), &mut room)?;
//! assert!(machine.is_active(on));
//!
//! let working = room.working.take().expect("the activity was started when the step was over");
//! machine.activity_returned(working, Outcome::Done);
//! machine.run_to_completion(Moment::from_millis(600), &mut room)?;
//! assert!(machine.is_active(off));
//! # Ok::<(), yase::MachineError>(())
//! ```
//!
//! # Pictures
//!
//! [`export`] draws a chart as SVG and writes it for XState, Mermaid, PlantUML and Graphviz, with a list of what these cannot say:
//!
//! ```
//! use yase::{Node, NodeKind, Statechart, Transition, export};
//!
//! let mut chart = Statechart::new("short");
//! let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let end = chart.add(Statechart::ROOT, Node::new(NodeKind::Terminate, "enough"));
//! chart.connect(Transition::new(start, end));
//!
//! assert!(export::to_svg(&chart).contains(">enough</text>"));
//! let mermaid = export::to_mermaid(&chart);
//! assert!(mermaid.text.contains("[*] --> s_enough"));
//! let lost = "`short/enough` is of the kind TERMINATE; for Mermaid it is a state";
//! assert_eq!(mermaid.lost[0].message, lost);
//! ```
//!
//! # Rust alone
//!
//! [`flatten`] writes a chart of events, conditions and actions as Rust: one `enum`, one `match`, no library.

/// What the README shows runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod bits;
mod chart;
pub mod diagnostic;
pub mod explore;
pub mod export;
pub mod expression;
pub mod flatten;
mod host;
mod machine;
mod moment;
pub mod scxml;
mod semantics;
pub mod statechart;
pub mod swap;
mod trace;
pub mod typed;
pub mod vocabulary;

pub use chart::{ActivityEntry, Chart, CompoundId, RegionId, ScriptEntry, ScriptPlace};
pub use diagnostic::{Diagnostic, Severity, Source, Span};
pub use host::{ActionError, ActionPlace, Activation, Host, Outcome, Report};
pub use machine::snapshot;
pub use machine::{
    Chooser, Machine, MachineError, MachineErrorKind, MicroStep, Performance, States, Status, StepSummary,
};
pub use moment::Moment;
pub use semantics::{
    ActiveAncestor, ConflictChoice, Deferral, Delivery, EventMatching, EventPool, Eventless, ExitOrder,
    FailureEvents, Firing, Joining, RootEnd, RunningOnExit, SegmentOrder, Semantics, Sharing, StartRest,
    TimerScope,
};
pub use statechart::{Element, Node, NodeId, NodeKind, Statechart, Transition, TransitionId};
pub use trace::{Occasion, TraceRecord};
pub use vocabulary::{FieldId, FunctionId, TopicId, Value, Vocabulary};
