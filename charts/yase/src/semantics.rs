//! The semantic variation points of statechart dialects.

use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};

/// The semantics of a [`CompiledChart`](crate::CompiledChart) where statechart dialects differ.
///
/// A chart is compiled for one semantics
/// ([`Statechart::compile_with`](crate::Statechart::compile_with)). Each field is one variation
/// point, independent of the others. There are three presets:
///
/// | point | [`yase`](Semantics::yase) (default) | [`uml`](Semantics::uml) | [`scxml`](Semantics::scxml) |
/// |---|---|---|---|
/// | [`eventless`](Semantics::eventless) | as written, examined again | on completion, examined once | always |
/// | [`start`](Semantics::start) | own micro-step | same step | same step |
/// | [`order`](Semantics::order) | guarded first | as modelled | as modelled |
/// | [`firing`](Semantics::firing) | each transition | each segment | phases |
/// | [`exits`](Semantics::exits) | forward | forward | reverse document |
/// | [`pool`](Semantics::pool) | raised before arrived | one | raised before arrived |
/// | [`matching`](Semantics::matching) | exact | exact | token prefix |
/// | [`on_exit`](Semantics::on_exit) | blocks | interrupted | interrupted |
/// | [`ancestor`](Semantics::ancestor) | left and entered again | completed | left and entered again |
/// | [`join`](Semantics::join) | together | each | together |
/// | [`exit_points`](Semantics::exit_points) | first arrival | all regions | first arrival |
/// | [`terminate`](Semantics::terminate) | nothing is left | the source is left | nothing is left |
/// | [`deferral`](Semantics::deferral) | on | innermost | off |
/// | [`sharing`](Semantics::sharing) | next step | at once | at once |
/// | [`root_end`](Semantics::root_end) | idle | idle | exits all |
/// | [`completion_events`](Semantics::completion_events) | no | no | yes |
/// | [`failures`](Semantics::failures) | by cause | by cause | every time |
/// | [`structure`](Semantics::structure) | strict | UML | strict |
///
/// [`delivery`](Semantics::delivery) (each step), [`timers`](Semantics::timers) (the chart's),
/// [`conflict`](Semantics::conflict) (declared) and [`limit`](Semantics::limit) (1,000) are equal
/// in all presets.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub struct Semantics {
    /// When a transition without a trigger may be taken.
    pub eventless: CompletionTrigger,
    /// Whether a composite can remain in its START.
    pub start: InitialState,
    /// The order in which the segments that leave one node are tried.
    pub order: SegmentOrder,
    /// The execution of the transitions of one micro-step.
    pub firing: Firing,
    /// The order in which states are left.
    pub exits: ExitOrder,
    /// Whether raised events precede arrived ones.
    pub pool: EventPool,
    /// Which events a trigger matches.
    pub matching: EventMatching,
    /// The effect of a running activity on a transition that would leave its state.
    pub on_exit: ActivityOnExit,
    /// The effect of a transition to an active ancestor of its source.
    pub ancestor: TransitionToAncestor,
    /// The selection of the transitions into a JOIN.
    pub join: JoinMode,
    /// When an exit point that several regions reach is passed.
    pub exit_points: ExitPointArrival,
    /// The states that a transition to TERMINATE leaves before the chart stops.
    pub terminate: TerminateExit,
    /// When other blackboards show what an action writes.
    pub sharing: WriteVisibility,
    /// The effect of reaching the END of the root.
    pub root_end: RootCompletion,
    /// The lifetime of a timer.
    pub timers: TimerScope,
    /// Which of two transitions wins that exit a common state, neither nested in the other.
    pub conflict: ConflictResolution,
    /// Whether reaching END raises `done.state.NAME` for the composite, and for the AND around it
    /// that is complete with it.
    pub completion_events: bool,
    /// The events that failures of guards and actions raise.
    pub failures: FailureEvents,
    /// When blackboards receive messages.
    pub delivery: Delivery,
    /// Whether states keep the events they defer.
    pub deferral: Deferral,
    /// The forms of charts that are accepted.
    pub structure: StructureRules,
    /// The limit for the micro-steps of a step, and for the steps with an effect at one time,
    /// beyond which the chart is stopped as a livelock. 1,000 by default; a chart that processes
    /// more events in one step needs more.
    pub limit: NonZeroU32,
}

const THOUSAND: NonZeroU32 = NonZeroU32::MIN.saturating_add(999);

impl Semantics {
    /// The semantics of the thesis.
    pub const fn yase() -> Semantics {
        Semantics {
            eventless: CompletionTrigger::AsWritten,
            start: InitialState::Place,
            order: SegmentOrder::GuardedFirst,
            firing: Firing::EachTransition,
            exits: ExitOrder::Forward,
            pool: EventPool::RaisedFirst,
            matching: EventMatching::Exact,
            on_exit: ActivityOnExit::Blocks,
            ancestor: TransitionToAncestor::Reentered,
            join: JoinMode::Together,
            exit_points: ExitPointArrival::First,
            terminate: TerminateExit::Nothing,
            sharing: WriteVisibility::NextStep,
            root_end: RootCompletion::Idle,
            timers: TimerScope::Chart,
            conflict: ConflictResolution::Declared,
            completion_events: false,
            failures: FailureEvents::ByCause,
            delivery: Delivery::EachStep,
            deferral: Deferral::On,
            structure: StructureRules::Strict,
            limit: THOUSAND,
        }
    }

    /// The semantics of UML state machines (2.5.1).
    pub const fn uml() -> Semantics {
        Semantics {
            eventless: CompletionTrigger::Once,
            start: InitialState::SameStep,
            order: SegmentOrder::AsModelled,
            firing: Firing::EachSegment,
            pool: EventPool::One,
            on_exit: ActivityOnExit::Interrupted,
            ancestor: TransitionToAncestor::Completed,
            join: JoinMode::Each,
            exit_points: ExitPointArrival::All,
            terminate: TerminateExit::Source,
            sharing: WriteVisibility::AtOnce,
            deferral: Deferral::Innermost,
            structure: StructureRules::Uml,
            ..Semantics::yase()
        }
    }

    /// The semantics of SCXML (W3C recommendation of 2015, appendix D).
    pub const fn scxml() -> Semantics {
        Semantics {
            eventless: CompletionTrigger::Always,
            start: InitialState::SameStep,
            order: SegmentOrder::AsModelled,
            firing: Firing::Phases,
            exits: ExitOrder::ReverseDocument,
            matching: EventMatching::TokenPrefix,
            on_exit: ActivityOnExit::Interrupted,
            sharing: WriteVisibility::AtOnce,
            root_end: RootCompletion::ExitsAll,
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
pub enum CompletionTrigger {
    /// Out of a BASIC state once it has completed. Out of a composite without a guard, or back to
    /// itself, once it has completed. Out of a composite to another node with a guard, when nothing
    /// inside is enabled or running. In each case the guard is evaluated again in every step.
    AsWritten,
    /// Independent of completion: whenever nothing inside is enabled or running.
    Quiescent,
    /// When its source completes, before anything else: a guard that does not hold then is not
    /// evaluated again.
    Once,
    /// Whenever its source is active.
    Always,
}

/// Whether a composite can remain in its START.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum InitialState {
    /// The transition out of START is the next micro-step.
    Place,
    /// The transition out of START is taken while the composite is entered; if none is enabled, the
    /// composite remains in START.
    SameStep,
}

/// The order in which the segments that leave one node are tried; a higher priority always comes
/// first.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SegmentOrder {
    /// Segments with a guard before those without, which act as "else"; then as modelled.
    GuardedFirst,
    /// As modelled.
    AsModelled,
}

/// The execution of the transitions of one micro-step.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Firing {
    /// One after the other: each exits, executes its actions and enters before the next.
    EachTransition,
    /// One after the other, and each segment by segment: the states up to the boundary that the
    /// segment crosses are left, its actions are executed, the states around its target are
    /// entered. So a composite is left after the actions of a segment to its exit point, and
    /// entered before those of a segment out of its entry point.
    EachSegment,
    /// All states are left, then all actions are executed, then all states are entered.
    Phases,
}

/// The order in which states are left; inner ones always before outer ones.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ExitOrder {
    /// Regions in document order.
    Forward,
    /// The last state in document order first.
    ReverseDocument,
}

/// Whether raised events precede arrived ones.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EventPool {
    /// Raised events are offered before arrived ones.
    RaisedFirst,
    /// There is one queue, oldest first.
    One,
}

/// Which events a trigger matches.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EventMatching {
    /// The event of that name.
    Exact,
    /// Every event whose name begins with its tokens: `a.b` matches `a.b` and `a.b.c`. `a.*` equals
    /// `a`, `*` matches every event.
    TokenPrefix,
}

/// The effect of a running activity on a transition that would leave its state.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ActivityOnExit {
    /// The transition waits, and so does everything else in the scope of the activity.
    Blocks,
    /// The activity is requested to return, and its state is left at once; its return is ignored.
    Interrupted,
}

/// The effect of a transition to an active ancestor of its source.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TransitionToAncestor {
    /// The ancestor is left and entered again.
    Reentered,
    /// The states up to the ancestor are left, and the region that contained the source counts as
    /// complete.
    Completed,
}

/// The selection of the transitions into a JOIN.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum JoinMode {
    /// As one transition, when all sources have completed.
    Together,
    /// Each when its own source completes, which leaves its region without an active child; the
    /// last one goes on through the JOIN.
    Each,
}

/// When an exit point of an AND that transitions from several of its regions reach is passed.
///
/// This concerns arrivals from states, directly or through static connectors. Behind a CHOICE, a
/// FORK or another such exit point, the first arrival passes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ExitPointArrival {
    /// By the first transition that reaches it.
    First,
    /// By the last: each region that has arrived remains without an active child until all have. A
    /// transition without a trigger arrives when its source has completed.
    All,
}

/// The states that a transition to TERMINATE leaves before the chart stops.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TerminateExit {
    /// Nothing.
    Nothing,
    /// The states that a transition to a state in the place of TERMINATE would leave.
    Source,
}

/// When other blackboards show what an action writes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WriteVisibility {
    /// At the beginning of the next step.
    NextStep,
    /// At once, where no activity runs.
    AtOnce,
}

/// The effect of reaching the END of the root.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RootCompletion {
    /// The chart remains in its last configuration.
    Idle,
    /// All states are left at the end of the micro-step.
    ExitsAll,
}

/// The lifetime of a timer.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TimerScope {
    /// Until it is set again.
    Chart,
    /// Until its state is left: the state whose entry started it, or the target of the transition
    /// that did.
    State,
}

/// Which of two transitions wins that exit a common state, neither nested in the other.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ConflictResolution {
    /// The one whose source comes first in the model.
    Declared,
    /// A random one, chosen by the [`Chooser`](crate::Chooser).
    Random,
}

/// The events that failures of guards and actions raise.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FailureEvents {
    /// `error.guard`, once until the guard has succeeded or its inputs have changed, and
    /// `error.action`.
    ByCause,
    /// `error.execution`, every time.
    EveryTime,
}

/// When blackboards receive messages.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Delivery {
    /// At the beginning of each step, where no activity is running; and where an action calls
    /// `process_messages`.
    EachStep,
    /// Only where an action calls `process_messages`.
    Explicit,
}

/// Whether states keep deferred events.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Deferral {
    /// An event that no transition takes is kept while an active state defers it.
    On,
    /// An event that an active state defers is kept, unless a transition of that state or of one
    /// inside it takes it; those of states around it and in other regions do not.
    Innermost,
    /// An event that no transition takes is dropped.
    Off,
}

/// The forms of charts that are accepted.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StructureRules {
    /// Composites have a START, entry points lead into their composite, activities belong to BASIC
    /// states, internal transitions stay inside their source.
    Strict,
    /// Also the forms of UML. A composite without START has no active child after its default
    /// entry, and counts as complete. An entry point that leads nowhere stands for its composite. A
    /// composite that is not a region may run an activity beside its children, on a blackboard of
    /// its own, and completes when both have. An internal (local) transition may lead to an exit
    /// point of its source.
    Uml,
}
