//! Charts whose guards and assignments are Rust functions.
//!
//! A [`TypedChart`] is a statechart together with a function for each guard and each assigned value. Functions read messages as what they
//! are, structs with fields, so that a field that is gone is found by the compiler; nothing is interpreted while the chart runs, and
//! nothing is looked up by name. `aseme::generate` writes such charts as crates; a person may write one as well.
//!
//! **The machine is the same.** A generator could write out every step as code instead. That would be a second engine: what holds activities
//! back, what history remembers, which of two regions wins would be decided in two places, and every chart would be a new chance for them to
//! differ. Here a chart's structure is data for [`Machine`](crate::Machine) as ever, and what is particular to a chart, its guards and
//! values, is code. The traces of both are equal because one thing makes them. Where a chart has no activities and no timers there is nothing left to be decided while
//! it runs: [`flatten`](crate::flatten) has the machine go through all of it beforehand, and writes down what it did as code.
//!
//! A guard has three answers: it holds, it does not, or it cannot tell, since a message that it reads has not arrived ([`Undecided`]).
//! [`all!`](crate::all!) and [`any!`](crate::any!) join answers as Kleene's logic does; `?` gives up on the innermost of them.
//!
//! ```
//! use yase::typed::*;
//! use yase::vocabulary::{FieldEntry, MessageEntry, TopicEntry, TopicKind, ValueType};
//! use yase::{FieldId, NodeId, NodeKind, Semantics, TopicId, Vocabulary};
//!
//! struct Ball {
//!     found: bool,
//!     distance: f64,
//! }
//!
//! const BALL: Source<Ball> = Source::new(0);
//! const NEAR: f64 = 0.25;
//!
//! fn look_to_kick(world: &World<'_>) -> Truth {
//!     all!(holds(world.latest(BALL)?.found)?, less(world.latest(BALL)?.distance, NEAR)?)
//! }
//!
//! let mut chart = Draft::new("player");
//! chart.reads(BALL, Reads::own("soccer/ball", "Ball"));
//! chart.constant("near", NEAR);
//! chart.add(NodeId(1), NodeId(0), NodeKind::Start, "");
//! chart.add(NodeId(2), NodeId(0), NodeKind::Basic, "look");
//! chart.add(NodeId(3), NodeId(0), NodeKind::Basic, "kick");
//! chart.connect(NodeId(1), NodeId(2), "");
//! chart.connect(NodeId(2), NodeId(3), "[Ball.found && Ball.distance < near]");
//! chart.guard(look_to_kick);
//!
//! let field = |id, name: &str, kind| FieldEntry { id: FieldId(id), name: name.into(), kind };
//! let vocabulary = Vocabulary {
//!     topics: vec![TopicEntry {
//!         id: TopicId(0),
//!         path: "soccer/ball".into(),
//!         kind: TopicKind::State,
//!         message: "Ball".into(),
//!     }],
//!     messages: vec![MessageEntry {
//!         name: "Ball".into(),
//!         fields: vec![field(0, "found", ValueType::Bool), field(1, "distance", ValueType::Number)],
//!     }],
//!     ..Vocabulary::default()
//! };
//! let chart = chart.finish().expect("its texts can be read");
//! assert!(chart.compile(&vocabulary, Semantics::yase()).is_ok());
//! ```
//!
//! | code | what is wrong |
//! |---|---|
//! | E0150 | what was written down does not fit together |
//! | E0151 | the functions were made for other messages or another model |

mod binding;
mod draft;
mod field;
mod operand;
mod world;

pub use crate::diagnostic::Diagnostic;
pub use crate::statechart::{NodeId, NodeKind};
pub use crate::vocabulary::Value;
pub use crate::{all, any};
pub use binding::TypedChart;
pub(crate) use binding::{Program, Wiring};
pub use draft::{Draft, Reads};
pub use field::{Field, inside_mut, set};
pub use operand::{
    Computed, Operand, at_least, at_most, attempt, differ, equal, given, holds, inside, less, minus, more,
    negative, over, plus, times, whole,
};
pub(crate) use world::Change;
pub use world::{Function, Source, Timer, TypedTest, TypedValue, World};

pub use crate::expression::CallError;
use crate::expression::GuardError;

/// What a guard answers.
pub type Truth = Result<bool, Undecided>;

/// Why there is no answer, or no value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Undecided {
    /// It depends on a message that has not arrived.
    Unknown,
    /// An operation has no result.
    Failed(GuardError),
}

impl From<GuardError> for Undecided {
    fn from(error: GuardError) -> Undecided {
        Undecided::Failed(error)
    }
}

impl From<CallError> for Undecided {
    fn from(error: CallError) -> Undecided {
        Undecided::Failed(error.into())
    }
}

/// Whether all of some conditions hold. They are looked at from left to right, up to the first that does not hold; one that cannot tell
/// does not end it, since the answer is no if a later one does not hold.
#[macro_export]
macro_rules! all {
    ($($part:expr),+ $(,)?) => {
        $crate::typed::all_of(&[$(&|| ::core::result::Result::Ok($part)),+])
    };
}

/// Whether one of some conditions holds. They are looked at from left to right, up to the first that holds; one that cannot tell does
/// not end it.
#[macro_export]
macro_rules! any {
    ($($part:expr),+ $(,)?) => {
        $crate::typed::any_of(&[$(&|| ::core::result::Result::Ok($part)),+])
    };
}

/// What [`all!`](crate::all!) expands to.
#[doc(hidden)]
pub fn all_of(parts: &[&dyn Fn() -> Truth]) -> Truth {
    decide(parts, true)
}

/// What [`any!`](crate::any!) expands to.
#[doc(hidden)]
pub fn any_of(parts: &[&dyn Fn() -> Truth]) -> Truth {
    decide(parts, false)
}

/// `usual` if every part says so, the contrary as soon as one does.
fn decide(parts: &[&dyn Fn() -> Truth], usual: bool) -> Truth {
    let mut answer = Ok(usual);
    for part in parts {
        match part() {
            Ok(truth) if truth == usual => {}
            Err(Undecided::Unknown) => answer = Err(Undecided::Unknown),
            decided => return decided,
        }
    }
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNKNOWN: Truth = Err(Undecided::Unknown);
    const FAILED: Truth = Err(Undecided::Failed(GuardError::DivisionByZero));

    #[test]
    fn all_is_kleenes_and() {
        let cases = [
            (Ok(true), Ok(true), Ok(true)),
            (Ok(true), Ok(false), Ok(false)),
            (Ok(false), FAILED, Ok(false)),
            (UNKNOWN, Ok(true), UNKNOWN),
            (UNKNOWN, Ok(false), Ok(false)),
            (UNKNOWN, FAILED, FAILED),
            (Ok(true), UNKNOWN, UNKNOWN),
        ];
        for (first, second, result) in cases {
            assert_eq!(all!(first.clone()?, second.clone()?), result, "{first:?} && {second:?}");
        }
    }

    #[test]
    fn any_is_kleenes_or() {
        let cases = [
            (Ok(false), Ok(false), Ok(false)),
            (Ok(false), Ok(true), Ok(true)),
            (Ok(true), FAILED, Ok(true)),
            (UNKNOWN, Ok(true), Ok(true)),
            (UNKNOWN, Ok(false), UNKNOWN),
            (UNKNOWN, FAILED, FAILED),
        ];
        for (first, second, result) in cases {
            assert_eq!(any!(first.clone()?, second.clone()?), result, "{first:?} || {second:?}");
        }
    }

    /// A text says what it asks of a timer; code may ask anything.
    #[test]
    fn code_may_tell_apart_what_its_text_does_not() {
        let mut draft = Draft::new("waits");
        draft.starts(Timer(0), "late");
        draft.add(NodeId(1), NodeId(0), NodeKind::Start, "");
        draft.add(NodeId(2), NodeId(0), NodeKind::Basic, "wait");
        draft.add(NodeId(3), NodeId(0), NodeKind::Basic, "go");
        draft.connect(NodeId(1), NodeId(2), "/ StartTimeout(late, 1s)");
        draft.connect(NodeId(2), NodeId(3), "[late]");
        draft.guard(|world| Ok(world.is_over(Timer(0))));
        let chart = draft.finish().unwrap();
        let vocabulary = crate::Vocabulary::default();
        let typed = chart.compile(&vocabulary, crate::Semantics::yase()).unwrap();
        let plain = chart.statechart().compile(&vocabulary).unwrap();
        let told_apart = |chart: &crate::Chart| -> usize {
            chart.guards.iter().map(|scoped| scoped.guard.timers_told_apart().len()).sum()
        };
        assert_eq!((told_apart(&plain), told_apart(&typed)), (0, 1));
    }
}
