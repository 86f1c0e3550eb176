//! Statecharts of [`yase`] as Rust, in two forms.
//!
//! - [`typed`]: guards and assigned values become functions over the types of the messages. The
//!   machine of `yase` executes the chart as it executes interpreted charts, so all charts are
//!   supported and traces are those of the interpreted chart. The cost is that of the machine
//!   without the interpretation of guards.
//! - [`flatten`](mod@flatten): everything becomes one `enum` of configurations and one `match`. The
//!   code needs no library, has no traces, and costs about as much as a `match` by hand. Only
//!   charts of events, conditions and actions are supported: no activities, timers, deferred events
//!   or random choice.
//!
//! **Use [`typed`] for the charts of agents**: their states have activities, and the compiler finds
//! message fields that no longer exist. `aseme` generates such charts from roles
//! (`monas generate`). **Use [`flatten`](mod@flatten) for a protocol or a mode switch** in a
//! program that does not use the machine (`monas model convert door.scxml door.rs`).
//!
//! Neither is a second engine. A typed chart runs on the machine itself; a flattened chart is the
//! recorded behaviour of the machine, step by step, from each configuration and for each event.
//! Both are thus equivalent to the interpreted chart, and neither replaces the other: activities
//! need the rules of the machine, and charts without activities do not.
//!
//! ```
//! use yase::expression::parse_transition;
//! use yase::{Node, NodeKind, Semantics, Statechart, Transition};
//! use yase_codegen::flatten::flatten;
//!
//! let mut door = Statechart::new("door");
//! let start = door.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let shut = door.add(Statechart::ROOT, Node::new(NodeKind::Basic, "shut"));
//! let open = door.add(Statechart::ROOT, Node::new(NodeKind::Basic, "open"));
//! for (source, target, text) in [(start, shut, ""), (shut, open, "push [!locked]"), (open, shut, "pull")] {
//!     door.connect(Transition { expression: parse_transition(text).0, ..Transition::new(source, target) });
//! }
//! let code = flatten(&door, Semantics::yase(), 100).expect("it is simple enough").to_rust();
//! assert!(code.contains("pub trait Host {\n    /// The condition `!locked`\n    fn not_locked(&self) -> bool;"));
//! ```

pub mod flatten;
pub mod typed;
