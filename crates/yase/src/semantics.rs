//! The points at which statechart dialects differ, as values.

use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};

/// How a [`Chart`](crate::Chart) is read where dialects of statecharts differ.
///
/// A chart is compiled for one semantics ([`Statechart::compile_with`](crate::Statechart::compile_with)). Each field is one point; they
/// are independent of each other. There are three named sets of values:
///
/// | point | [`yase`](Semantics::yase) (default) | [`uml`](Semantics::uml) | [`scxml`](Semantics::scxml) |
/// |---|---|---|---|
/// | [`eventless`](Semantics::eventless) | as written, looked at again | on completion, looked at once | always |
/// | [`start`](Semantics::start) | a place | same step | same step |
/// | [`order`](Semantics::order) | guarded first | as modelled | as modelled |
/// | [`firing`](Semantics::firing) | each transition | each transition | phases |
/// | [`exits`](Semantics::exits) | forward | forward | reverse document |
/// | [`pool`](Semantics::pool) | raised before arrived | one | raised before arrived |
/// | [`matching`](Semantics::matching) | exact | exact | token prefix |
/// | [`on_exit`](Semantics::on_exit) | blocks | interrupted | interrupted |
/// | [`ancestor`](Semantics::ancestor) | left and entered again | completed | left and entered again |
/// | [`join`](Semantics::join) | together | each | together |
/// | [`deferral`](Semantics::deferral) | on | on | off |
/// | [`sharing`](Semantics::sharing) | next step | at once | at once |
/// | [`root_end`](Semantics::root_end) | idle | idle | exits all |
/// | [`completion_events`](Semantics::completion_events) | no | no | yes |
/// | [`failures`](Semantics::failures) | by cause | by cause | every time |
///
/// [`delivery`](Semantics::delivery) (each step), [`timers`](Semantics::timers) (the chart's), [`conflict`](Semantics::conflict) (declared)
/// and [`limit`](Semantics::limit) (1,000) are the same in all of them.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub struct Semantics {
    /// When a transition without a trigger may be taken.
    pub eventless: Eventless,
    /// Whether a composite rests at its START.
    pub start: StartRest,
    /// In which order the segments that leave one node are tried.
    pub order: SegmentOrder,
    /// How the transitions of one micro-step happen.
    pub firing: Firing,
    /// In which order states are left.
    pub exits: ExitOrder,
    /// Whether raised events come before arrived ones.
    pub pool: EventPool,
    /// Which events a trigger names.
    pub matching: EventMatching,
    /// What a running activity means for a transition that would leave its state.
    pub on_exit: RunningOnExit,
    /// What a transition to an active ancestor of its source does.
    pub ancestor: ActiveAncestor,
    /// How the transitions into a JOIN are taken.
    pub join: Joining,
    /// When other blackboards see what an action writes.
    pub sharing: Sharing,
    /// What happens when the root reaches its END.
    pub root_end: RootEnd,
    /// How long a timer lives.
    pub timers: TimerScope,
    /// Which of two transitions wins that leave common states, neither nested in the other.
    pub conflict: ConflictChoice,
    /// Whether reaching END raises `done.state.NAME` for the composite, and for the AND around it that is complete with it.
    pub completion_events: bool,
    /// Which events the failures of guards and actions are.
    pub failures: FailureEvents,
    /// When blackboards receive messages.
    pub delivery: Delivery,
    /// Whether states keep the events they defer.
    pub deferral: Deferral,
    /// How many micro-steps a step may have, and how many steps that do something may happen at one moment, before the chart is stopped
    /// as one that never rests. A thousand by default; a chart that is to take more events than that in one go needs more.
    pub limit: NonZeroU32,
}

const THOUSAND: NonZeroU32 = NonZeroU32::MIN.saturating_add(999);

impl Semantics {
    /// The meaning the thesis gives to charts.
    pub const fn yase() -> Semantics {
        Semantics {
            eventless: Eventless::AsWritten,
            start: StartRest::Place,
            order: SegmentOrder::GuardedFirst,
            firing: Firing::EachTransition,
            exits: ExitOrder::Forward,
            pool: EventPool::RaisedFirst,
            matching: EventMatching::Exact,
            on_exit: RunningOnExit::Blocks,
            ancestor: ActiveAncestor::Reentered,
            join: Joining::Together,
            sharing: Sharing::NextStep,
            root_end: RootEnd::Idle,
            timers: TimerScope::Chart,
            conflict: ConflictChoice::Declared,
            completion_events: false,
            failures: FailureEvents::ByCause,
            delivery: Delivery::EachStep,
            deferral: Deferral::On,
            limit: THOUSAND,
        }
    }

    /// The meaning of UML's state machines (2.5.1).
    pub const fn uml() -> Semantics {
        Semantics {
            eventless: Eventless::Once,
            start: StartRest::SameStep,
            order: SegmentOrder::AsModelled,
            pool: EventPool::One,
            on_exit: RunningOnExit::Interrupted,
            ancestor: ActiveAncestor::Completed,
            join: Joining::Each,
            sharing: Sharing::AtOnce,
            ..Semantics::yase()
        }
    }

    /// The meaning of SCXML (W3C recommendation of 2015, appendix D).
    pub const fn scxml() -> Semantics {
        Semantics {
            eventless: Eventless::Always,
            start: StartRest::SameStep,
            order: SegmentOrder::AsModelled,
            firing: Firing::Phases,
            exits: ExitOrder::ReverseDocument,
            matching: EventMatching::TokenPrefix,
            on_exit: RunningOnExit::Interrupted,
            sharing: Sharing::AtOnce,
            root_end: RootEnd::ExitsAll,
            completion_events: true,
            failures: FailureEvents::EveryTime,
            deferral: Deferral::Off,
            ..Semantics::yase()
        }
    }
}

impl Default for Semantics {
    fn default() -> Semantics {
        Semantics::yase()
    }
}

/// When a transition without a trigger may be taken.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Eventless {
    /// Out of a BASIC state once it has completed. Out of a composite without a guard, or back to itself, once it has completed.
    /// Out of a composite to elsewhere with a guard, when nothing inside can step and nothing inside runs. In each case
    /// the guard is looked at again in every step.
    AsWritten,
    /// Completion does not matter: whenever nothing inside can step and nothing inside runs.
    Quiescent,
    /// When its source completes, which is looked at once, before anything else: a guard that does not hold then is not read again.
    Once,
    /// Whenever its source is active.
    Always,
}

/// Whether a composite rests at its START.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StartRest {
    /// START is a place: its way out is the next micro-step.
    Place,
    /// The way out of START is taken while the composite is entered; if none is open, the chart rests there.
    SameStep,
}

/// In which order the segments that leave one node are tried; a higher priority comes first in any case.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SegmentOrder {
    /// Those with a guard before those without, so that one without is the "else"; then as in the model.
    GuardedFirst,
    /// As in the model.
    AsModelled,
}

/// How the transitions of one micro-step happen.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Firing {
    /// One after the other: each leaves, acts and enters before the next does.
    EachTransition,
    /// All states are left, then all actions are done, then all states are entered.
    Phases,
}

/// In which order states are left; inner ones before outer ones in any case.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ExitOrder {
    /// Regions in the order of the document.
    Forward,
    /// The last state of the document first.
    ReverseDocument,
}

/// Whether raised events come before arrived ones.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EventPool {
    /// What was raised is offered before what has arrived.
    RaisedFirst,
    /// There is one pool, oldest first.
    One,
}

/// Which events a trigger names.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EventMatching {
    /// The event of that name.
    Exact,
    /// Every event whose name begins with its tokens: `a.b` names `a.b` and `a.b.c`. `a.*` is `a`, `*` is every event.
    TokenPrefix,
}

/// What a running activity means for a transition that would leave its state.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RunningOnExit {
    /// The transition waits, and so does all else in the region of the activity.
    Blocks,
    /// The activity is asked to return, and its state is left at once; what it returns is of no more interest.
    Interrupted,
}

/// What a transition to an active ancestor of its source does.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ActiveAncestor {
    /// The ancestor is left and entered again.
    Reentered,
    /// The states on the way up to the ancestor are left, and the part of it that held the source counts as complete.
    Completed,
}

/// How the transitions into a JOIN are taken.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Joining {
    /// As one transition, when all sources have completed.
    Together,
    /// Each when its own source completes; the way out of the JOIN follows when all have arrived.
    Each,
}

/// When other blackboards see what an action writes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Sharing {
    /// At the beginning of the next step.
    NextStep,
    /// At once, where no activity runs.
    AtOnce,
}

/// What happens when the root reaches its END.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RootEnd {
    /// The chart idles in its last configuration.
    Idle,
    /// When the micro-step is over, everything is left.
    ExitsAll,
}

/// How long a timer lives.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TimerScope {
    /// Until it is set again.
    Chart,
    /// Until the state is left that it belongs to: that whose entry started it, or the target of the transition that did.
    State,
}

/// Which of two transitions wins that leave common states, neither nested in the other.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ConflictChoice {
    /// The one whose source comes first in the model.
    Declared,
    /// The one that the [`Chooser`](crate::Chooser) draws.
    Random,
}

/// Which events the failures of guards and actions are.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FailureEvents {
    /// `error.guard`, once until the guard has succeeded or what it reads has changed, and `error.action`.
    ByCause,
    /// `error.execution`, every time.
    EveryTime,
}

/// When blackboards receive messages.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Delivery {
    /// At the beginning of each step, where no activity runs; and where an action says `process_messages`.
    EachStep,
    /// Only where an action says `process_messages`.
    Explicit,
}

/// Whether states keep the events they defer.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Deferral {
    /// An event that nobody takes waits while an active state defers it.
    On,
    /// An event that nobody takes is dropped.
    Off,
}
