//! Temporal properties of a chart's runs.
//!
//! ```text
//! # What a goalie never does, and what it does in time.
//! property "no dive for a ball that stays away":
//!     always (entering RightDive or entering LeftDive implies [Ball.approaching])
//!
//! property "the body is served ten times a second":
//!     always eventually entering RobotController within 100 ms
//! ```
//!
//! A file holds named properties; `#` begins a comment. [`parse`] reads it and never fails; a
//! [`Property`] prints as text that parses to the same property.
//!
//! # The language
//!
//! ```text
//! property = "property" "name" ":" formula
//! formula  = until [ "implies" formula ]
//! until    = either [ "until" either [ within ] ]
//! either   = both { "or" both }
//! both     = single { "and" single }
//! single   = "not" single | "always" formula | "eventually" formula [ within ]
//!          | "in" state | "entering" state | "leaving" state | "event" name | "[" condition "]"
//!          | "true" | "false" | "(" formula ")"
//! within   = "within" number ("ms" | "s")
//! ```
//!
//! `always` and `eventually` extend as far to the right as possible; `within` belongs to the
//! nearest `eventually` or `until` before it. States are referred to by paths as in roles
//! ([`path`](aseme::path)), in backquotes if they have characters other than letters, digits, `_`,
//! `/` and `.`. Conditions are those of guards ([`yase::expression`]): fields of messages,
//! constants of the model, functions, but no timers and states.
//!
//! # Semantics
//!
//! A run is a sequence of positions, one for each run-to-completion step of the chart; the first is
//! its start. Each has a time. At a position
//!
//! - `in S` holds if S is active after the step, `entering S` and `leaving S` if it was entered or
//!   left in the step, `event e` if the event was offered to the chart in the step, whether or not
//!   a transition consumed it;
//! - `[c]` holds if the condition is true of the newest messages at the beginning of the step. As
//!   in guards, a condition that reads a message that has not arrived is unknown, and unknown does
//!   not hold: neither `[Ball.found]` nor `[!Ball.found]` holds, but `not [Ball.found]` does;
//! - `always p` holds if p holds at this position and all later ones, `eventually p` if p holds at
//!   this or a later one;
//! - `p until q` holds if q holds at this position or a later one, and p at each position before
//!   it;
//! - `within d` requires q at a position whose time is at most d later than this one's.
//!
//! This defines properties of infinite runs. For a finite prefix of a run, [`Monitor`] gives one of
//! four verdicts: the property is [violated](MonitorVerdict::Violated) or
//! [satisfied](MonitorVerdict::Satisfied) by every continuation; it holds [so
//! far](MonitorVerdict::SoFar), and would if the run ended here; or it is
//! [awaited](MonitorVerdict::Awaited): something required has not happened yet. An unbounded
//! requirement is never violated on a finite run; if the run ends, it is undecided. A bounded
//! requirement is violated as soon as its time is over. Liveness properties of infinite runs are
//! decided only by exploration, which searches for a violating cycle ([`check`]).
//!
//! # Exploration
//!
//! [`check`] searches for a run of the chart that violates a property. If the property has no
//! bound, time is ignored: activities return and timers expire in any order. With a bound model
//! time is counted: activities take the duration in the model (none if it has none), timers are
//! exact, and both happen before time passes; messages and events arrive at any time. A running
//! activity returns eventually, and a timer that is started expires; messages may never arrive. The
//! values of messages are free at each step, as far as guards, conditions and assignments of the
//! step are consistent. Regions that cannot influence the property are not explored.
//!
//! A violating run is executed on the machine before it is reported, with values for all that it
//! reads: a message that has come stays, and what the chart has assigned stays unless the program
//! has another publisher of it. A run that is not confirmed so leaves the property undecided.

mod check;
mod clause;
mod compiled_property;
mod explore;
mod lexer;
mod monitor;
pub(crate) mod names;
mod parser;
mod print;
mod product;
mod syntax;

pub use check::{PropertyOutcome, PropertyResult, check};
pub use compiled_property::{AtomicProposition, CompiledProperty};
pub use monitor::{Monitor, MonitorVerdict};
pub use names::{BoundProperty, bind, guards};
pub use parser::parse;
pub use syntax::{Property, PropertyFormula, PropertyFormulaKind};
