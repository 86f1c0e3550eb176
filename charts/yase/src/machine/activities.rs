//! The activities of BASIC states: their phases, and the scopes they lock.

use crate::bits::BitSet;
use crate::compile::{CompiledChart, NodeIndex};
use crate::host::Outcome;
use crate::ids::Activation;
use crate::machine::Status;
use crate::machine::machine_state::MachineState;

/// The activities of a chart, by their index in it.
#[derive(Clone, Debug)]
pub(crate) struct ActivityTable {
    slots: Box<[ActivityState]>,
    /// The activities that are not idle: few of a large chart.
    used: BitSet,
    pub(crate) count: u64,
    /// Whether one has been queued since the last query.
    pub(crate) queued: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct ActivityState {
    pub(crate) phase: InvocationPhase,
    pub(crate) number: u64,
    /// Whether it has been requested to return.
    pub(crate) cancelled: bool,
}

/// The phase of an activity.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum InvocationPhase {
    /// Its state is not active.
    Idle,
    /// Its state was entered; it starts at the end of the step.
    Queued,
    /// It is running.
    Running,
    /// It waits for the next call.
    Ongoing,
    /// It has failed.
    Failed,
    /// It has finished.
    Done,
}

impl ActivityTable {
    pub(crate) fn new(count: usize) -> ActivityTable {
        let slot = ActivityState { phase: InvocationPhase::Idle, number: 0, cancelled: false };
        ActivityTable { slots: vec![slot; count].into(), used: BitSet::new(count), count: 0, queued: false }
    }

    /// Copies the activities of another machine of the same chart.
    pub(crate) fn copy_from(&mut self, other: &ActivityTable) {
        for activity in self.used.members().chain(other.used.members()) {
            self.slots[activity] = other.slots[activity];
        }
        self.used.copy_from(&other.used);
        (self.count, self.queued) = (other.count, other.queued);
    }

    pub(crate) fn reset(&mut self) {
        for activity in self.used.members() {
            self.slots[activity].phase = InvocationPhase::Idle;
        }
        self.used.clear();
    }

    /// Whether activities may wait to be started, as of the last query.
    #[inline]
    pub(crate) fn take_queued(&mut self) -> bool {
        std::mem::take(&mut self.queued)
    }

    /// The activities that are not idle, in ascending order.
    pub(crate) fn used(&self) -> impl Iterator<Item = (usize, ActivityState)> {
        self.used.members().map(|activity| (activity, self.slots[activity]))
    }

    /// The memory of the activities, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.slots)
    }

    #[inline]
    pub(crate) fn slot(&self, activity: usize) -> ActivityState {
        self.slots[activity]
    }

    /// Sets an activity, also to a phase other than idle.
    #[inline]
    pub(crate) fn set(&mut self, activity: usize, state: ActivityState) {
        match state.phase {
            InvocationPhase::Idle => self.used.remove(activity),
            _ => self.used.insert(activity),
        }
        self.slots[activity] = state;
    }

    /// An activity that is not idle and does not become so.
    #[inline]
    pub(crate) fn slot_mut(&mut self, activity: usize) -> &mut ActivityState {
        &mut self.slots[activity]
    }
}

impl MachineState {
    /// The state of an activity was entered: from now on its scope is locked.
    #[inline]
    pub(crate) fn enqueue_activity(&mut self, chart: &CompiledChart, node: NodeIndex, activity: usize) {
        self.activities.count += 1;
        self.activities.queued = true;
        let number = self.activities.count;
        self.activities
            .set(activity, ActivityState { phase: InvocationPhase::Queued, number, cancelled: false });
        self.lock(chart, node);
    }

    #[inline]
    pub(crate) fn lock(&mut self, chart: &CompiledChart, node: NodeIndex) {
        self.running.insert(node.index());
        self.running_regions.insert(chart.states[node.index()].activity_region.index());
    }

    #[inline]
    pub(crate) fn unlock(&mut self, chart: &CompiledChart, node: NodeIndex) {
        self.running.remove(node.index());
        self.running_regions.remove(chart.states[node.index()].activity_region.index());
    }

    #[inline]
    pub(crate) fn activation(
        &self,
        chart: &CompiledChart,
        index: NodeIndex,
        slot: ActivityState,
    ) -> Activation {
        let region = chart.states[index.index()].activity_region;
        Activation { node: chart.layout.node(index), region, number: slot.number }
    }

    /// The indices of the node and the activity of an activation, if it is the current one.
    #[inline]
    fn current(&self, chart: &CompiledChart, activation: Activation) -> Option<(NodeIndex, usize)> {
        let node = chart.layout.find_index(activation.node)?;
        let activity = chart.states[node.index()].activity?;
        let is_current =
            self.status == Status::Running && self.activities.slot(activity).number == activation.number;
        is_current.then_some((node, activity))
    }

    pub(crate) fn activity_returned(
        &mut self,
        chart: &CompiledChart,
        activation: Activation,
        outcome: Outcome,
    ) -> bool {
        let Some((node, activity)) = self.current(chart, activation) else { return false };
        let slot = self.activities.slot_mut(activity);
        if slot.phase != InvocationPhase::Running {
            return false;
        }
        slot.phase = match outcome {
            Outcome::Done => InvocationPhase::Done,
            Outcome::Ongoing => InvocationPhase::Ongoing,
            Outcome::Failed => InvocationPhase::Failed,
        };
        self.unlock(chart, node);
        self.release_held(chart, node);
        if outcome == Outcome::Failed {
            self.queues.arrive(chart.errors.activity.into());
        }
        if outcome == Outcome::Done {
            self.completed(chart, node);
        }
        self.needs_step = true;
        true
    }

    /// Offers the events again that were held because of this activity.
    fn release_held(&mut self, chart: &CompiledChart, node: NodeIndex) {
        let region = chart.states[node.index()].activity_region;
        self.queues.release(|compound| {
            let compound = &chart.compounds[compound.0 as usize];
            let mut sources = compound.sources();
            compound.leaves(node) || sources.any(|source| chart.states[source.index()].region == region)
        });
    }

    pub(crate) fn activity_resumed(&mut self, chart: &CompiledChart, activation: Activation) -> bool {
        let Some((node, activity)) = self.current(chart, activation) else { return false };
        let slot = self.activities.slot(activity);
        if !matches!(slot.phase, InvocationPhase::Ongoing | InvocationPhase::Failed)
            || self.has_pending_exit(chart, node)
        {
            return false;
        }
        self.activities.slot_mut(activity).phase = InvocationPhase::Running;
        self.lock(chart, node);
        true
    }
}
