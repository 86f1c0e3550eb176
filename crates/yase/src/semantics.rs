//! The points at which statechart dialects differ, as values.

use std::num::NonZeroU32;

/// How a [`Machine`](crate::Machine) reads a chart where dialects of statecharts differ.
///
/// The default is [`Semantics::yase`]. Each field is one point; they are independent of each other.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub struct Semantics {
    /// When a transition without a trigger may be taken.
    pub eventless: Eventless,
    /// When blackboards receive messages.
    pub delivery: Delivery,
    /// Whether states keep the events they defer.
    pub deferral: Deferral,
    /// How many micro-steps a step may have, and how many steps that do something may happen at one moment, before the chart is stopped
    /// as one that never rests. A thousand by default; a chart that is to take more events than that in one go needs more.
    pub limit: NonZeroU32,
}

impl Semantics {
    /// The meaning the thesis gives to charts.
    pub const fn yase() -> Semantics {
        const THOUSAND: NonZeroU32 = NonZeroU32::MIN.saturating_add(999);
        Semantics {
            eventless: Eventless::AsWritten,
            delivery: Delivery::EachStep,
            deferral: Deferral::On,
            limit: THOUSAND,
        }
    }
}

impl Default for Semantics {
    fn default() -> Semantics {
        Semantics::yase()
    }
}

/// When a transition without a trigger may be taken.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum Eventless {
    /// Out of a BASIC state once it has completed. Out of a composite without a guard, or back to itself, once it has completed.
    /// Out of a composite to elsewhere with a guard, when nothing inside can step and nothing inside runs. In each case
    /// the guard is looked at again in every step.
    AsWritten,
    /// Completion does not matter: whenever nothing inside can step and nothing inside runs.
    Quiescent,
}

/// When blackboards receive messages.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum Delivery {
    /// At the beginning of each step, where no activity runs; and where an action says `process_messages`.
    EachStep,
    /// Only where an action says `process_messages`.
    Explicit,
}

/// Whether states keep the events they defer.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum Deferral {
    /// An event that nobody takes waits while an active state defers it.
    On,
    /// An event that nobody takes is dropped.
    Off,
}
