//! Random semantics: a profile, a profile with one changed point, or any combination.

use std::num::NonZeroU32;

use yase::{
    ActivityOnExit, CompletionTrigger, ConflictResolution, Deferral, Delivery, EventMatching, EventPool,
    ExitOrder, ExitPointArrival, FailureEvents, Firing, InitialState, JoinMode, RootCompletion, SegmentOrder,
    Semantics, StructureRules, TerminateExit, TimerScope, TransitionToAncestor, WriteVisibility,
};

use super::Choices;

/// Limit of micro-steps, and of steps at one time.
const MICRO_STEP_LIMIT: u32 = 40;

/// The derivation of the semantics of a case.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Variant {
    /// `yase`, `uml` or `scxml`.
    Profile(&'static str),
    /// A profile with one point changed, by its number in [`POINTS`].
    Flipped(&'static str, usize),
    Mixed,
}

/// A value of one variation point.
pub(crate) type Point = (&'static str, fn(&mut Semantics));

/// All values of all points.
pub(crate) const POINTS: [Point; 46] = [
    ("eventless as written", |it| it.eventless = CompletionTrigger::AsWritten),
    ("eventless quiescent", |it| it.eventless = CompletionTrigger::Quiescent),
    ("eventless once", |it| it.eventless = CompletionTrigger::Once),
    ("eventless always", |it| it.eventless = CompletionTrigger::Always),
    ("START a place", |it| it.start = InitialState::Place),
    ("START in the same step", |it| it.start = InitialState::SameStep),
    ("guarded first", |it| it.order = SegmentOrder::GuardedFirst),
    ("segments as modelled", |it| it.order = SegmentOrder::AsModelled),
    ("firing each transition", |it| it.firing = Firing::EachTransition),
    ("firing each segment", |it| it.firing = Firing::EachSegment),
    ("firing in phases", |it| it.firing = Firing::Phases),
    ("exits forward", |it| it.exits = ExitOrder::Forward),
    ("exits reverse", |it| it.exits = ExitOrder::ReverseDocument),
    ("raised first", |it| it.pool = EventPool::RaisedFirst),
    ("one pool", |it| it.pool = EventPool::One),
    ("events exact", |it| it.matching = EventMatching::Exact),
    ("events by prefix", |it| it.matching = EventMatching::TokenPrefix),
    ("running blocks", |it| it.on_exit = ActivityOnExit::Blocks),
    ("running interrupted", |it| it.on_exit = ActivityOnExit::Interrupted),
    ("ancestor re-entered", |it| it.ancestor = TransitionToAncestor::Reentered),
    ("ancestor completed", |it| it.ancestor = TransitionToAncestor::Completed),
    ("join together", |it| it.join = JoinMode::Together),
    ("join each", |it| it.join = JoinMode::Each),
    ("exit point first", |it| it.exit_points = ExitPointArrival::First),
    ("exit point all", |it| it.exit_points = ExitPointArrival::All),
    ("TERMINATE exits nothing", |it| it.terminate = TerminateExit::Nothing),
    ("TERMINATE exits its source", |it| it.terminate = TerminateExit::Source),
    ("seen next step", |it| it.sharing = WriteVisibility::NextStep),
    ("seen at once", |it| it.sharing = WriteVisibility::AtOnce),
    ("root END idle", |it| it.root_end = RootCompletion::Idle),
    ("root END exits all", |it| it.root_end = RootCompletion::ExitsAll),
    ("timers of the chart", |it| it.timers = TimerScope::Chart),
    ("timers of states", |it| it.timers = TimerScope::State),
    ("conflict declared", |it| it.conflict = ConflictResolution::Declared),
    ("conflict random", |it| it.conflict = ConflictResolution::Random),
    ("completion events off", |it| it.completion_events = false),
    ("completion events on", |it| it.completion_events = true),
    ("delivery each step", |it| it.delivery = Delivery::EachStep),
    ("delivery explicit", |it| it.delivery = Delivery::Explicit),
    ("failures by cause", |it| it.failures = FailureEvents::ByCause),
    ("failures every time", |it| it.failures = FailureEvents::EveryTime),
    ("deferral on", |it| it.deferral = Deferral::On),
    ("deferral innermost", |it| it.deferral = Deferral::Innermost),
    ("deferral off", |it| it.deferral = Deferral::Off),
    ("structure strict", |it| it.structure = StructureRules::Strict),
    ("structure of UML", |it| it.structure = StructureRules::Uml),
];

pub(crate) fn semantics(choices: &mut Choices<'_>) -> (Semantics, Variant) {
    let (name, mut semantics) = profile(choices);
    semantics.limit = NonZeroU32::new(MICRO_STEP_LIMIT).unwrap();
    match choices.below(10) {
        0..3 => (semantics, Variant::Profile(name)),
        3..8 => {
            let first = choices.below(POINTS.len());
            let index =
                (first..POINTS.len()).chain(0..first).find(|&index| differs(semantics, index)).unwrap();
            POINTS[index].1(&mut semantics);
            (semantics, Variant::Flipped(name, index))
        }
        _ => {
            for _ in 0..12 {
                choices.pick(&POINTS).1(&mut semantics);
            }
            (semantics, Variant::Mixed)
        }
    }
}

fn profile(choices: &mut Choices<'_>) -> (&'static str, Semantics) {
    match choices.below(4) {
        0 => ("uml", Semantics::uml()),
        1 => ("scxml", Semantics::scxml()),
        _ => ("yase", Semantics::yase()),
    }
}

fn differs(semantics: Semantics, point: usize) -> bool {
    let mut changed = semantics;
    POINTS[point].1(&mut changed);
    changed != semantics
}

/// Whether a semantics has a certain value of a point.
pub(crate) fn has(semantics: Semantics, point: usize) -> bool {
    !differs(semantics, point)
}

/// Whether a value of a point differs from that of a profile.
pub(crate) fn differs_somewhere(point: usize) -> bool {
    [Semantics::yase(), Semantics::uml(), Semantics::scxml()].into_iter().any(|it| differs(it, point))
}
