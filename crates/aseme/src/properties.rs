//! What must always be so: properties of a chart's runs, in a language small enough to be read aloud.
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
//! A file holds properties, each with a name of its own; `#` begins a comment. [`parse`] reads it and never fails; a [`Property`] prints as text that reads back as the same.
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
//! `always` and `eventually` reach as far to the right as they can; `within` belongs to the nearest `eventually` or `until` before it. States are named by paths as in
//! roles ([`path`](crate::path)); what is not made of letters, digits, `_`, `/` and `.` stands in backquotes. A condition is that of a guard
//! ([`yase::expression`]): fields of messages, constants of the model, functions; timers and states have no place in it.
//!
//! # What it means
//!
//! A run is a row of positions, one for each run-to-completion step of the chart, the first being its start. Each has a time. At a position
//!
//! - `in S` says that S is active when the step is over, `entering S` and `leaving S` that it was entered or left in the step, `event e` that the event was offered
//!   to the chart in the step, whether or not anybody took it;
//! - `[c]` says that the condition is true of the newest messages at the beginning of the step. As in guards, a condition that reads a message that has not
//!   arrived is unknown, and what is unknown does not hold: neither `[Ball.found]` nor `[!Ball.found]` does, and `not [Ball.found]` does;
//! - `always p` says p of this position and all later ones, `eventually p` of this or a later one;
//! - `p until q` says that q comes, at this position or a later one, and p holds at each before it;
//! - `within d` asks that q comes at a position whose time is at most d later than this one's.
//!
//! On an infinite run that is all. Of a run that has come only so far, [`Monitor`] says one of four things: the property is [violated](Verdict::Violated) or
//! [satisfied](Verdict::Satisfied), however the run goes on; it holds [so far](Verdict::SoFar), and would if the run ended here; or it is
//! [awaited](Verdict::Awaited): something that must come has not come yet. What is awaited without a bound is never violated on a finite run; if the run ends, it is not
//! decided. What is awaited within a bound is violated as soon as the time is over. Where the promise is one that a chart can keep for ever or break for ever, only an
//! exploration decides, which looks for a run that goes round in a circle ([`check`]).
//!
//! # Exploration
//!
//! [`check`] looks for a run of the chart that violates a property. Without a bound in the property it leaves time out: activities return and timers expire in any
//! order. With a bound it counts model time: activities take the duration that the model says (none, if it says nothing), timers are exact, and both happen before time goes
//! on; messages and events come whenever they like. An activity that runs returns some day, and a timer that is set expires; messages need never come. The values of
//! messages are free at each step, as far as guards and conditions of the step agree on them: a property that relies on a message to stay as it was at an earlier step is
//! reported as violated. Regions that cannot matter to the property are left to do nothing.

mod check;
mod clause;
pub(crate) mod cone;
mod explore;
mod monitor;
pub(crate) mod names;
mod parser;
mod plan;
mod print;
mod product;
mod scanner;
mod syntax;

pub use check::{Judgement, Outcome, check};
pub use monitor::{Monitor, Verdict};
pub use names::{Bound, bind, guards};
pub use parser::parse;
pub use plan::{Atom, Plan};
pub use syntax::{Formula, FormulaKind, Property};
