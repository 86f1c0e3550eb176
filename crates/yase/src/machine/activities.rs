//! The activities of BASIC states: which of them lock their region, and which have returned.

use crate::chart::{Chart, Place};
use crate::host::{Activation, Outcome};
use crate::machine::Status;
use crate::machine::run::Run;

/// The activities of a chart, by their number in it.
#[derive(Clone, Debug)]
pub(super) struct Activities {
    slots: Box<[Slot]>,
    pub(super) count: u64,
    /// Whether one has been queued since it was asked last.
    pub(super) queued: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) phase: Phase,
    pub(super) number: u64,
    /// Whether it has been asked to return.
    pub(super) cancelled: bool,
}

/// Where an activity is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Phase {
    /// Its state is not active.
    Idle,
    /// Its state was entered; it starts when the step is over.
    Queued,
    /// It runs.
    Running,
    /// It waits to be called again.
    Ongoing,
    /// It returned with a failure.
    Failed,
    /// It has done its work.
    Done,
}

impl Activities {
    pub(super) fn new(count: usize) -> Activities {
        let slot = Slot { phase: Phase::Idle, number: 0, cancelled: false };
        Activities { slots: vec![slot; count].into(), count: 0, queued: false }
    }

    /// Becomes equal to those of another machine of the same chart.
    pub(super) fn copy_from(&mut self, other: &Activities) {
        self.slots.copy_from_slice(&other.slots);
        (self.count, self.queued) = (other.count, other.queued);
    }

    pub(super) fn reset(&mut self) {
        for slot in &mut self.slots {
            slot.phase = Phase::Idle;
        }
    }

    /// Whether activities wait to be started, as far as is known since this was asked last.
    pub(super) fn take_queued(&mut self) -> bool {
        std::mem::take(&mut self.queued)
    }

    pub(super) fn slots(&self) -> &[Slot] {
        &self.slots
    }

    pub(super) fn slot(&self, activity: usize) -> Slot {
        self.slots[activity]
    }

    pub(super) fn slot_mut(&mut self, activity: usize) -> &mut Slot {
        &mut self.slots[activity]
    }
}

impl Run {
    /// The state of an activity was entered: from now on its region is locked.
    pub(super) fn enqueue_activity(&mut self, chart: &Chart, place: Place, activity: usize) {
        self.activities.count += 1;
        self.activities.queued = true;
        let number = self.activities.count;
        *self.activities.slot_mut(activity) = Slot { phase: Phase::Queued, number, cancelled: false };
        self.lock(chart, place);
    }

    pub(super) fn lock(&mut self, chart: &Chart, place: Place) {
        self.running.insert(place.index());
        self.running_regions.insert(chart.states[place.index()].region.index());
    }

    pub(super) fn unlock(&mut self, chart: &Chart, place: Place) {
        self.running.remove(place.index());
        self.running_regions.remove(chart.states[place.index()].region.index());
    }

    pub(super) fn activation(&self, chart: &Chart, place: Place, slot: Slot) -> Activation {
        let region = chart.states[place.index()].region;
        Activation { node: chart.layout.node(place), region, number: slot.number }
    }

    /// The place and number of the activity that an activation is of, if it is still that one.
    fn current(&self, chart: &Chart, activation: Activation) -> Option<(Place, usize)> {
        let place = chart.layout.place(activation.node)?;
        let activity = chart.states[place.index()].activity?;
        let is_current =
            self.status == Status::Running && self.activities.slot(activity).number == activation.number;
        is_current.then_some((place, activity))
    }

    pub(super) fn activity_returned(
        &mut self,
        chart: &Chart,
        activation: Activation,
        outcome: Outcome,
    ) -> bool {
        let Some((place, activity)) = self.current(chart, activation) else { return false };
        let slot = self.activities.slot_mut(activity);
        if slot.phase != Phase::Running {
            return false;
        }
        slot.phase = match outcome {
            Outcome::Done => Phase::Done,
            Outcome::Ongoing => Phase::Ongoing,
            Outcome::Failed => Phase::Failed,
        };
        self.unlock(chart, place);
        self.release_held(chart, place);
        if outcome == Outcome::Failed {
            self.queues.arrive(chart.errors.activity.into());
        }
        if outcome == Outcome::Done {
            self.completed(chart, place);
        }
        self.due = true;
        true
    }

    /// What was held because of this activity is offered again.
    fn release_held(&mut self, chart: &Chart, place: Place) {
        let region = chart.states[place.index()].region;
        self.queues.release(|compound| {
            let compound = &chart.compounds[compound.0 as usize];
            let mut sources = compound.sources();
            compound.leaves(place) || sources.any(|source| chart.states[source.index()].region == region)
        });
    }

    pub(super) fn activity_resumed(&mut self, chart: &Chart, activation: Activation) -> bool {
        let Some((place, activity)) = self.current(chart, activation) else { return false };
        let slot = self.activities.slot(activity);
        if !matches!(slot.phase, Phase::Ongoing | Phase::Failed) || self.is_being_left(chart, place) {
            return false;
        }
        self.activities.slot_mut(activity).phase = Phase::Running;
        self.lock(chart, place);
        true
    }
}
