//! Charts whose guards and assignments are Rust functions.
//!
//! A [`TypedChart`] is a statechart with a function for each guard and each assigned value.
//! Functions read messages as structs, so that the compiler finds fields that no longer exist;
//! nothing is interpreted or looked up by name while the chart runs. `aseme_codegen::generate`
//! writes such charts as crates; they can be written by hand as well.
//!
//! **The machine is the same.** A generator could write every step as code instead. That would be a
//! second engine: rules such as which activities delay transitions, what a history contains and
//! which of two regions wins would be implemented twice, and every chart could reveal a difference.
//! Here the structure of a chart is data for [`Machine`](yase::Machine), and only its guards and
//! values are code, so the traces of both are equal. A chart without activities and timers has no
//! further decisions at run time: [`flatten`](crate::flatten) executes all its steps beforehand,
//! and writes them as code.
//!
//! A guard has three results: it holds, it does not hold, or it is unknown because a message that
//! it reads has not arrived ([`GuardUnknown`]). [`all!`](crate::all!) and [`any!`](crate::any!)
//! combine results by Kleene's logic; `?` ends the innermost of them with an unknown result.
//!
//! ```
//! use yase_codegen::typed::*;
//! use yase::vocabulary::{FieldEntry, MessageEntry, TopicEntry, TopicKind, ValueType};
//! use yase::{FieldId, NodeId, NodeKind, Semantics, TopicId, TypeEnvironment};
//!
//! struct Ball {
//!     found: bool,
//!     distance: f64,
//! }
//!
//! const BALL: Source<Ball> = Source::new(0);
//! const NEAR: f64 = 0.25;
//!
//! fn look_to_kick(input: &GuardInput<'_>) -> GuardResult {
//!     all!(holds(input.latest(BALL)?.found)?, less(input.latest(BALL)?.distance, NEAR)?)
//! }
//!
//! let mut chart = TypedChartBuilder::new("player");
//! chart.reads(BALL, SourceDeclaration::own("soccer/ball", "Ball"));
//! chart.constant("near", NEAR);
//! chart.add(NodeId(1), NodeId(0), NodeKind::Start, "");
//! chart.add(NodeId(2), NodeId(0), NodeKind::Basic, "look");
//! chart.add(NodeId(3), NodeId(0), NodeKind::Basic, "kick");
//! chart.connect(NodeId(1), NodeId(2), "");
//! chart.connect(NodeId(2), NodeId(3), "[Ball.found && Ball.distance < near]");
//! chart.guard(look_to_kick);
//!
//! let field = |id, name: &str, kind| FieldEntry { id: FieldId(id), name: name.into(), kind };
//! let vocabulary = TypeEnvironment {
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
//!     ..TypeEnvironment::default()
//! };
//! let chart = chart.finish().expect("its texts can be read");
//! assert!(chart.compile(&vocabulary, Semantics::yase()).is_ok());
//! ```
//!
//! | code | what is wrong |
//! |---|---|
//! | E0150 | inconsistent statements |
//! | E0151 | functions for other messages or another model |

mod builder;
mod chart;
mod operand;

pub use crate::{all, any};
pub use builder::TypedChartBuilder;
pub use chart::TypedChart;
pub use operand::{
    Computed, Operand, at_least, at_most, attempt, differ, equal, given, holds, inside, less, minus, more,
    negative, over, plus, times, whole,
};
pub use yase::expression::{CallError, Field, NodeId, inside_mut, set};
pub use yase::native::{
    Function, GuardInput, GuardResult, GuardUnknown, Source, SourceDeclaration, Timer, TypedTest, TypedValue,
};
pub use yase::{Diagnostic, NodeKind, Value};

/// Whether all conditions hold. They are evaluated from left to right up to the first that does not
/// hold; an unknown one does not end the evaluation, since a later one may be false.
#[macro_export]
macro_rules! all {
    ($($part:expr),+ $(,)?) => {
        $crate::typed::all_of(&[$(&|| ::core::result::Result::Ok($part)),+])
    };
}

/// Whether any condition holds. They are evaluated from left to right up to the first that holds;
/// an unknown one does not end the evaluation.
#[macro_export]
macro_rules! any {
    ($($part:expr),+ $(,)?) => {
        $crate::typed::any_of(&[$(&|| ::core::result::Result::Ok($part)),+])
    };
}

/// The expansion of [`all!`](crate::all!).
#[doc(hidden)]
pub fn all_of(parts: &[&dyn Fn() -> GuardResult]) -> GuardResult {
    decide(parts, true)
}

/// The expansion of [`any!`](crate::any!).
#[doc(hidden)]
pub fn any_of(parts: &[&dyn Fn() -> GuardResult]) -> GuardResult {
    decide(parts, false)
}

/// `usual` if every part has that value, the negation as soon as one part has it.
fn decide(parts: &[&dyn Fn() -> GuardResult], usual: bool) -> GuardResult {
    let mut answer = Ok(usual);
    for part in parts {
        match part() {
            Ok(truth) if truth == usual => {}
            Err(GuardUnknown::Unknown) => answer = Err(GuardUnknown::Unknown),
            decided => return decided,
        }
    }
    answer
}

#[cfg(test)]
mod tests {
    use super::*;
    use yase::expression::GuardError;

    const UNKNOWN: GuardResult = Err(GuardUnknown::Unknown);
    const FAILED: GuardResult = Err(GuardUnknown::Failed(GuardError::DivisionByZero));

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

    /// A text declares how it reads a timer; code may read it in any form.
    #[test]
    fn code_may_distinguish_timers_that_its_text_does_not() {
        let mut draft = TypedChartBuilder::new("waits");
        draft.starts(Timer(0), "late");
        draft.add(NodeId(1), NodeId(0), NodeKind::Start, "");
        draft.add(NodeId(2), NodeId(0), NodeKind::Basic, "wait");
        draft.add(NodeId(3), NodeId(0), NodeKind::Basic, "go");
        draft.connect(NodeId(1), NodeId(2), "/ StartTimeout(late, 1s)");
        draft.connect(NodeId(2), NodeId(3), "[late]");
        draft.guard(|input| Ok(input.is_over(Timer(0))));
        let chart = draft.finish().unwrap();
        let vocabulary = yase::TypeEnvironment::default();
        let typed = chart.compile(&vocabulary, yase::Semantics::yase()).unwrap();
        let plain = chart.statechart().compile(&vocabulary).unwrap();
        let told_apart = |chart: &yase::CompiledChart| -> usize {
            chart.guards().map(|(_, _, guard)| guard.timers_distinguished_from_unset().len()).sum()
        };
        assert_eq!((told_apart(&plain), told_apart(&typed)), (0, 1));
    }
}
