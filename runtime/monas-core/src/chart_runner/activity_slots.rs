//! The activities of a chart's states: one slot for each, with its instance, its phase and its
//! statistics.
//!
//! ```text
//!          prepare_call              take_back
//!   Idle ---------------> Running ---------------> Idle
//!                            ^                      | defer, pause
//!                            +------ Waiting <------+
//!                       prepare_call     end_exited: back to Idle
//! ```

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use narukom::{Blackboard, Hub, Timestamp, TopicSlot};
use yase::{Activation, CompiledChart, NodeId, TraceRecord};

use crate::activity::{Activity, Topics};
use crate::activity_context::ActivityContext;
use crate::activity_context::calling;
use crate::call::{self, ActivityCall, CallTiming, FinishedCall};
use crate::memory::LeakDetector;
use crate::parameters::Parameters;
use crate::statistics::{ActivityStatistics, Timing};

/// First pause of an activity that is restarted after a failure; each further consecutive failure
/// doubles it.
const FIRST_PAUSE: Duration = Duration::from_millis(10);
/// Maximum number of doublings of the pause.
const MAX_DOUBLINGS: u32 = 6;
/// The node of a slot whose state a model swap has removed.
const NO_NODE: NodeId = NodeId(u32::MAX);

/// All activities of a chart.
pub(crate) struct ActivitySlots {
    /// One for each BASIC state with an activity, in document order. These are followed by slots
    /// whose states a model swap removed while their activities were running.
    slots: Vec<ActivitySlot>,
    /// Index of the slot of each node.
    slot_of_node: Vec<Option<usize>>,
    /// Activations that wait for their first call, in the order in which the machine started them.
    ready: VecDeque<Activation>,
    /// Indices of the slots that are running, in the order of their calls.
    running: Vec<usize>,
}

/// The activity of one state. Its single instance serves successive activations.
struct ActivitySlot {
    node: NodeId,
    name: String,
    context: Arc<ActivityContext>,
    /// The duration of a call in simulated time.
    duration: Duration,
    /// The topics that the activity declares to read, sorted; `None` without a declaration.
    declared: Option<Box<[TopicSlot]>>,
    /// The priority of the state, 0 if it has none.
    state_priority: i32,
    /// The priority of the transition segment that most recently entered the state.
    entry_priority: i32,
    /// None while it is running.
    activity: Option<Box<dyn Activity>>,
    /// Whether `start` has been called since the instance was created or failed.
    is_started: bool,
    phase: Phase,
    /// The newest activation of the state.
    newest: Option<Activation>,
    /// Parameters that the instance receives when it returns.
    new_parameters: Option<Parameters>,
    /// Replaces the instance when it returns.
    successor: Option<Box<dyn Activity>>,
    /// Topics of messages that arrived while it was running and have not been delivered to it.
    missed: Vec<TopicSlot>,
    calls: u64,
    timing: Timing,
    leak_detector: LeakDetector,
    /// Whether it is part of a loop without a wait.
    loops: bool,
    failures: u64,
    failures_in_a_row: u32,
}

/// The phase of an activity slot.
enum Phase {
    /// Not running and not waiting.
    Idle,
    /// It returned `Ongoing`, or is paused after a failure.
    Waiting {
        activation: Activation,
        /// The time of the next call.
        due: Timestamp,
        /// A message on one of these topics triggers an earlier call.
        topics: Vec<TopicSlot>,
    },
    /// It is being called.
    Running {
        /// The number of the running activation.
        number: u64,
        since: Timestamp,
        /// The call, unless the driver has it.
        held: Option<HeldCall>,
    },
}

/// A call that its slot keeps until the activity returns.
enum HeldCall {
    /// The activity is called when the time of its return is known.
    Pending(ActivityCall),
    /// The activity was called; the result takes effect at a time.
    Finished(FinishedCall, Timestamp),
}

impl ActivitySlots {
    /// `activities` are in the order of [`CompiledChart::activities`].
    pub(crate) fn new(
        chart: &CompiledChart,
        activities: Vec<Box<dyn Activity>>,
        hub: &Hub,
        agent: &str,
    ) -> ActivitySlots {
        let mut slot_of_node = vec![None; chart.statechart().nodes().len()];
        let slots = chart.activities().zip(activities).enumerate().map(|(index, (entry, activity))| {
            slot_of_node[entry.node.0 as usize] = Some(index);
            ActivitySlot {
                node: entry.node,
                name: entry.name.into(),
                context: ActivityContext::new(hub.host(), agent, entry.name),
                duration: entry.duration.unwrap_or_default(),
                declared: declared(&activity.topics(), hub),
                state_priority: chart.statechart().node(entry.node).priority,
                entry_priority: 0,
                activity: Some(activity),
                is_started: false,
                phase: Phase::Idle,
                newest: None,
                new_parameters: None,
                successor: None,
                missed: Vec::new(),
                calls: 0,
                timing: Timing::default(),
                leak_detector: LeakDetector::default(),
                loops: false,
                failures: 0,
                failures_in_a_row: 0,
            }
        });
        let slots = slots.collect();
        ActivitySlots { slots, slot_of_node, ready: VecDeque::new(), running: Vec::new() }
    }

    /// Moves in the slots of a chart that this one replaces. `counterpart` maps its nodes, `known`
    /// its activations.
    pub(crate) fn take_over(
        &mut self,
        old: ActivitySlots,
        counterpart: impl Fn(NodeId) -> Option<NodeId>,
        known: impl Fn(Activation) -> Option<Activation>,
    ) {
        self.ready = old.ready.into_iter().filter_map(&known).collect();
        let mut running: Vec<Option<usize>> = vec![None; old.slots.len()];
        for (index, mut slot) in old.slots.into_iter().enumerate() {
            let is_running = matches!(slot.phase, Phase::Running { .. });
            let node = Some(slot.node).filter(|node| *node != NO_NODE);
            let target = node.and_then(&counterpart).and_then(|node| self.index_of(node));
            slot.migrate(&known);
            let position = match target.map(|index| (index, &mut self.slots[index])) {
                Some((index, successor)) if successor.name == slot.name => {
                    slot.node = successor.node;
                    slot.duration = successor.duration;
                    slot.state_priority = successor.state_priority;
                    *successor = slot;
                    index
                }
                other => {
                    if let Some((_, successor)) = other {
                        successor.entry_priority = slot.entry_priority;
                    }
                    if !is_running {
                        continue;
                    }
                    (slot.node, slot.newest) = (NO_NODE, None);
                    self.slots.push(slot);
                    self.slots.len() - 1
                }
            };
            running[index] = is_running.then_some(position);
        }
        self.running = old.running.into_iter().filter_map(|index| running[index]).collect();
    }

    fn index_of(&self, node: NodeId) -> Option<usize> {
        self.slot_of_node.get(node.0 as usize).copied().flatten()
    }

    fn slot(&self, activation: Activation) -> Option<&ActivitySlot> {
        self.slots.get(self.index_of(activation.node)?)
    }

    fn slot_mut(&mut self, activation: Activation) -> Option<&mut ActivitySlot> {
        let index = self.index_of(activation.node)?;
        self.slots.get_mut(index)
    }

    /// The slot that is running for an activation: the one at `index`, unless the chart has been
    /// swapped since the call.
    fn running_slot(&self, index: usize, number: u64) -> Option<usize> {
        let is_it = |slot: &ActivitySlot| slot.running_number() == Some(number);
        match self.slots.get(index).is_some_and(is_it) {
            true => Some(index),
            false => self.slots.iter().position(is_it),
        }
    }

    /// Queues a new activation for the call of its activity.
    pub(crate) fn begin(&mut self, activation: Activation) {
        if let Some(slot) = self.slot_mut(activation) {
            slot.newest = Some(activation);
        }
        self.ready.push_back(activation);
    }

    /// Whether this is the most recent activation of its state.
    pub(crate) fn is_newest(&self, activation: Activation) -> bool {
        self.slot(activation).is_some_and(|slot| slot.newest == Some(activation))
    }

    /// Removes and returns the first activation whose activity can be called for the first time,
    /// and drops those that ended before their first call. An activity that still runs for an
    /// earlier activation of its state is called after it has returned.
    pub(crate) fn next_ready(
        &mut self,
        is_current: impl Fn(&ActivitySlots, Activation) -> bool,
    ) -> Option<Activation> {
        let mut ready = std::mem::take(&mut self.ready);
        ready.retain(|activation| is_current(self, *activation));
        self.ready = ready;
        let is_free =
            |activation: &Activation| self.slot(*activation).is_some_and(|slot| slot.activity.is_some());
        let first = self.ready.iter().position(is_free)?;
        self.ready.remove(first)
    }

    /// Drops all activations that wait for their first call.
    pub(crate) fn clear_ready(&mut self) {
        self.ready.clear();
    }

    /// Records the entries of a micro-step: a state without a priority takes that of the transition
    /// by which it is entered.
    pub(crate) fn record_transitions(&mut self, chart: &CompiledChart, record: &TraceRecord<'_>) {
        let mut set = |node: NodeId, priority: i32| {
            if let Some(index) = self.slot_of_node.get(node.0 as usize).copied().flatten() {
                self.slots[index].entry_priority = priority;
            }
        };
        record.entries.iter().for_each(|node| set(*node, 0));
        let selected = record.selected.iter().flat_map(|&compound| chart.segments(compound));
        for segment in selected.chain(record.taken) {
            let transition = chart.statechart().transition(*segment);
            set(transition.target, transition.priority);
        }
    }

    /// Takes the activity of an activation out of its slot, which then is in the phase `Running`.
    pub(crate) fn prepare_call(
        &mut self,
        activation: Activation,
        is_resumed: bool,
        blackboard: Box<Blackboard>,
        now: Timestamp,
    ) -> Option<ActivityCall> {
        let index = self.index_of(activation.node)?;
        let slot = &mut self.slots[index];
        let activity = slot.activity.take()?;
        slot.phase = Phase::Running { number: activation.number, since: now, held: None };
        slot.missed.clear();
        slot.calls += 1;
        self.running.push(index);
        Some(ActivityCall {
            activation,
            priority: slot.priority(),
            duration: slot.duration,
            number: slot.calls,
            is_resumed,
            slot: index,
            activity,
            context: slot.context.clone(),
            cycle: 0,
            is_started: slot.is_started,
            is_called: false,
            blackboard,
        })
    }

    /// Keeps a call that is carried out when the driver knows that the activity has returned.
    pub(crate) fn hold(&mut self, call: ActivityCall) {
        let slot = call.slot;
        self.set_held(slot, HeldCall::Pending(call));
    }

    /// Keeps the result of a call until it takes effect.
    pub(crate) fn hold_result(&mut self, finished: FinishedCall, at: Timestamp) {
        let slot = finished.call.slot;
        self.set_held(slot, HeldCall::Finished(finished, at));
    }

    fn set_held(&mut self, slot: usize, call: HeldCall) {
        if let Some(Phase::Running { held, .. }) = self.slots.get_mut(slot).map(|slot| &mut slot.phase) {
            *held = Some(call);
        }
    }

    /// The earliest result that takes effect by now; among equal times, that of the earliest call.
    pub(crate) fn next_return(&mut self, now: Timestamp) -> Option<FinishedCall> {
        let first = self.running.iter().copied().min_by_key(|&index| self.slots[index].returns_at())?;
        let slot = &mut self.slots[first];
        if slot.returns_at() > now {
            return None;
        }
        match slot.take_held(|held| matches!(held, HeldCall::Finished(..)))? {
            HeldCall::Finished(finished, _) => Some(finished),
            HeldCall::Pending(_) => None,
        }
    }

    /// Calls that wait for their activities to return, in call order.
    pub(crate) fn held_calls(&self) -> impl Iterator<Item = &ActivityCall> {
        self.running.iter().filter_map(|&index| match &self.slots[index].phase {
            Phase::Running { held: Some(HeldCall::Pending(call)), .. } => Some(call),
            _ => None,
        })
    }

    /// Takes out the call of an activation that waits for its activity to return.
    pub(crate) fn take_held(&mut self, is_it: impl Fn(Activation) -> bool) -> Option<ActivityCall> {
        let number = self.held_calls().find(|call| is_it(call.activation))?.activation.number;
        let slot = self.slots.iter_mut().find(|slot| slot.running_number() == Some(number))?;
        match slot.take_held(|held| matches!(held, HeldCall::Pending(_)))? {
            HeldCall::Pending(call) => Some(call),
            HeldCall::Finished(..) => None,
        }
    }

    /// Puts the instance of a call back into its slot. Returns the blackboard, and the activation
    /// as the chart now names it: the chart may have been swapped since the call.
    pub(crate) fn take_back(
        &mut self,
        call: ActivityCall,
        timing: Option<CallTiming>,
    ) -> (Activation, Box<Blackboard>) {
        let activation = self.current_activation(&call);
        let ActivityCall { slot, activity, is_started, is_called, mut blackboard, .. } = call;
        let Some(index) = self.running_slot(slot, activation.number) else {
            return (activation, blackboard);
        };
        self.running.retain(|running| *running != index);
        let slot = &mut self.slots[index];
        slot.phase = Phase::Idle;
        slot.put_back(activity, is_started, &mut blackboard);
        match timing {
            _ if !is_called => slot.calls -= 1,
            Some(timing) => {
                slot.timing.add(timing.wall, timing.cpu);
                slot.context.check_memory_growth(&mut slot.leak_detector);
            }
            None => {}
        }
        (activation, blackboard)
    }

    /// Marks the slot of a call that was lost with its activity: it never runs again.
    pub(crate) fn abandon(&mut self, activation: Activation) {
        self.running.retain(|&index| self.slots[index].running_number() != Some(activation.number));
        if let Some(slot) = self.slot_mut(activation) {
            slot.phase = Phase::Idle;
        }
    }

    /// The activation of a call, as the chart now names it.
    pub(crate) fn current_activation(&self, call: &ActivityCall) -> Activation {
        let number = call.activation.number;
        let Some(index) = self.running_slot(call.slot, number) else { return call.activation };
        let slot = &self.slots[index];
        let newest = slot.newest.filter(|newest| newest.number == number);
        newest.unwrap_or(Activation { node: slot.node, ..call.activation })
    }

    /// The slot that has been running for the longest time, and since when.
    pub(crate) fn longest_running(&self) -> Option<(usize, Timestamp)> {
        let index = *self.running.first()?;
        match self.slots[index].phase {
            Phase::Running { since, .. } => Some((index, since)),
            _ => None,
        }
    }

    /// Whether no activity is being called.
    pub(crate) fn is_quiet(&self) -> bool {
        self.running.is_empty()
    }

    /// Makes a known result take effect now, since its activation was cancelled.
    pub(crate) fn cancel(&mut self, activation: Activation, now: Timestamp) {
        for &index in &self.running {
            if let Phase::Running { number, held: Some(HeldCall::Finished(_, at)), .. } =
                &mut self.slots[index].phase
                && *number == activation.number
            {
                *at = now;
            }
        }
    }

    /// Replaces the instance of a state's activity now, or when it returns. Returns the old
    /// instance and its activation if it waits for a call, so that it can be stopped.
    pub(crate) fn replace_instance(
        &mut self,
        node: NodeId,
        activity: Box<dyn Activity>,
        hub: &Hub,
    ) -> Option<(Arc<ActivityContext>, Box<dyn Activity>, Activation)> {
        let index = self.index_of(node)?;
        let slot = self.slots.get_mut(index)?;
        slot.declared = declared(&activity.topics(), hub);
        if slot.activity.is_none() {
            slot.successor = Some(activity);
            return None;
        }
        let old = slot.activity.replace(activity)?;
        let was_started = std::mem::take(&mut slot.is_started);
        match slot.phase {
            Phase::Waiting { activation, .. } if was_started => Some((slot.context.clone(), old, activation)),
            _ => None,
        }
    }

    /// Configures the activities with a given name; running ones are configured when they return.
    pub(crate) fn configure(&mut self, name: &str, parameters: &Parameters) {
        for slot in self.slots.iter_mut().filter(|slot| slot.name == name) {
            let parameters = parameters.without_accesses();
            match &mut slot.activity {
                Some(activity) => call::configure_again(name, &mut **activity, &parameters),
                None => slot.new_parameters = Some(parameters),
            }
        }
    }

    /// The topics whose messages trigger an early call of a waiting activation.
    pub(crate) fn wake_topics(&self, activation: Activation) -> &[TopicSlot] {
        match self.slot(activation).map(|slot| &slot.phase) {
            Some(Phase::Waiting { topics, .. }) => topics,
            _ => &[],
        }
    }

    /// Ends an activation that has finished.
    pub(crate) fn finished(&mut self, activation: Activation) {
        if let Some(slot) = self.slot_mut(activation) {
            slot.failures_in_a_row = 0;
        }
    }

    /// Schedules another call of the activation after a delay, or when a message arrives on a topic
    /// that was read on its blackboard; immediately if one has arrived during the call. Guards of
    /// the chart read on the same blackboard, so only declared topics count if there are any.
    pub(crate) fn defer(
        &mut self,
        activation: Activation,
        now: Timestamp,
        delay: Duration,
        blackboard: &Blackboard,
    ) {
        let Some(slot) = self.slot_mut(activation) else { return };
        let mut topics = blackboard.topics_read();
        if let Some(declared) = &slot.declared {
            topics.retain(|topic| declared.binary_search(topic).is_ok());
        }
        let has_missed = slot.missed.iter().any(|topic| topics.contains(topic));
        let due = if has_missed { now } else { now + delay };
        slot.failures_in_a_row = 0;
        slot.phase = Phase::Waiting { activation, due, topics };
    }

    /// Notes that an activation has failed: `start` is called before its next call. Returns the
    /// pause before that call.
    pub(crate) fn failed(&mut self, activation: Activation) -> Duration {
        let Some(slot) = self.slot_mut(activation) else { return FIRST_PAUSE };
        slot.is_started = false;
        slot.failures += 1;
        let pause = FIRST_PAUSE * (1 << slot.failures_in_a_row.min(MAX_DOUBLINGS));
        slot.failures_in_a_row = slot.failures_in_a_row.saturating_add(1);
        pause
    }

    /// Schedules the next call of a failed activation; messages do not trigger it earlier.
    pub(crate) fn pause(&mut self, activation: Activation, due: Timestamp) {
        if let Some(slot) = self.slot_mut(activation) {
            slot.phase = Phase::Waiting { activation, due, topics: Vec::new() };
        }
    }

    /// Ends the wait of an activation whose state was exited. Returns the instance, to be stopped.
    pub(crate) fn end_exited(
        &mut self,
        activation: Activation,
    ) -> Option<(Arc<ActivityContext>, &mut (dyn Activity + 'static))> {
        let slot = self.slot_mut(activation)?;
        slot.stop_waiting(|waiting, _| waiting == activation)?;
        Some((slot.context.clone(), slot.activity.as_deref_mut()?))
    }

    /// Schedules an early call of the activations that wait for a message's topic, except the one
    /// that published it.
    pub(crate) fn message_arrived(
        &mut self,
        topic: TopicSlot,
        publisher: Option<Activation>,
        now: Timestamp,
    ) {
        let others = self.slots.iter_mut().filter(|slot| publisher.is_none() || slot.newest != publisher);
        for slot in others {
            match &mut slot.phase {
                Phase::Waiting { due, topics, .. } if topics.contains(&topic) => *due = now.min(*due),
                Phase::Running { .. } if !slot.missed.contains(&topic) => slot.missed.push(topic),
                _ => {}
            }
        }
    }

    /// The time of the next call of a waiting activation.
    pub(crate) fn next_call(&self) -> Timestamp {
        let waiting = self.slots.iter().filter_map(|slot| match slot.phase {
            Phase::Waiting { due, .. } => Some(due),
            _ => None,
        });
        waiting.min().unwrap_or(Timestamp::MAX)
    }

    /// The time at which the next result takes effect.
    pub(crate) fn next_result(&self) -> Timestamp {
        let running = self.running.iter().map(|&index| self.slots[index].returns_at());
        running.min().unwrap_or(Timestamp::MAX)
    }

    /// Removes the first activation in document order whose next call is due.
    pub(crate) fn next_due(&mut self, now: Timestamp) -> Option<Activation> {
        self.slots.iter_mut().find_map(|slot| slot.stop_waiting(|_, due| due <= now))
    }

    /// Removes the activation of a state that waits for its next call.
    pub(crate) fn take_waiting(&mut self, node: NodeId) -> Option<Activation> {
        self.slots.iter_mut().find_map(|slot| slot.stop_waiting(|waiting, _| waiting.node == node))
    }

    /// The name of the activity of an activation.
    pub(crate) fn name(&self, activation: Activation) -> &str {
        self.slot(activation).map_or("", |slot| &slot.name)
    }

    /// Marks the slots of these states, and no others, as parts of a loop without a wait.
    pub(crate) fn set_loop(&mut self, nodes: &[NodeId]) {
        self.slots.iter_mut().for_each(|slot| slot.loops = nodes.contains(&slot.node));
    }

    /// The statistics of the activities of the chart, in document order.
    pub(crate) fn statistics<'a>(
        &'a self,
        chart: &'a CompiledChart,
    ) -> impl Iterator<Item = ActivityStatistics> + 'a {
        self.slots.iter().take(chart.activities().count()).map(|slot| ActivityStatistics {
            name: slot.name.clone(),
            state: Some(chart.short_path(slot.node)),
            calls: slot.calls,
            failures: slot.failures,
            call_time: slot.timing.wall(),
            call_cpu: slot.timing.cpu(),
            call_percentiles: slot.timing.percentiles(),
            held: slot.leak_detector.held(),
            grows: slot.leak_detector.grows(),
            loops: slot.loops,
        })
    }
}

impl ActivitySlot {
    /// The number of the running activation.
    fn running_number(&self) -> Option<u64> {
        match self.phase {
            Phase::Running { number, .. } => Some(number),
            _ => None,
        }
    }

    /// When its result takes effect, if it is known.
    fn returns_at(&self) -> Timestamp {
        match self.phase {
            Phase::Running { held: Some(HeldCall::Finished(_, at)), .. } => at,
            _ => Timestamp::MAX,
        }
    }

    fn take_held(&mut self, is_it: impl Fn(&HeldCall) -> bool) -> Option<HeldCall> {
        match &mut self.phase {
            Phase::Running { held, .. } => held.take_if(|held| is_it(held)),
            _ => None,
        }
    }

    /// The priority of its calls: that of the state, or of the transition into the state.
    fn priority(&self) -> i32 {
        if self.state_priority == 0 { self.entry_priority } else { self.state_priority }
    }

    /// Ends the wait of an activation that satisfies a condition.
    fn stop_waiting(&mut self, is_it: impl Fn(Activation, Timestamp) -> bool) -> Option<Activation> {
        match self.phase {
            Phase::Waiting { activation, due, .. } if is_it(activation, due) => {
                self.phase = Phase::Idle;
                Some(activation)
            }
            _ => None,
        }
    }

    /// Renames the activations after a model swap.
    fn migrate(&mut self, known: impl Fn(Activation) -> Option<Activation>) {
        self.newest = self.newest.and_then(&known);
        if let Phase::Waiting { activation, .. } = &mut self.phase {
            match known(*activation) {
                Some(new) => *activation = new,
                None => self.phase = Phase::Idle,
            }
        }
    }

    /// Puts back the instance of a call and applies a pending successor or new parameters.
    fn put_back(&mut self, activity: Box<dyn Activity>, is_started: bool, blackboard: &mut Blackboard) {
        (self.activity, self.is_started) = match self.successor.take() {
            Some(successor) => {
                self.end(activity, is_started, blackboard);
                (Some(successor), false)
            }
            None => (Some(activity), is_started),
        };
        if let Some((activity, parameters)) = self.activity.as_mut().zip(self.new_parameters.take()) {
            call::configure_again(&self.name, &mut **activity, &parameters);
        }
    }

    /// Stops an instance that was replaced while it was running.
    fn end(&self, mut activity: Box<dyn Activity>, is_started: bool, blackboard: &mut Blackboard) {
        let stopped = calling(&self.context, 0, || match is_started {
            true => call::stop(activity.as_mut(), blackboard),
            false => Ok(()),
        });
        if let Err(failure) = stopped {
            tracing::error!(activity = %self.name, "activity failed to stop: {failure}");
        }
    }
}

/// The topics that an activity declares to read, sorted; `None` without a declaration.
fn declared(topics: &Topics, hub: &Hub) -> Option<Box<[TopicSlot]>> {
    let mut slots: Vec<TopicSlot> = topics.read_paths().iter().filter_map(|path| hub.topic(path)).collect();
    slots.sort_unstable();
    topics.is_declared().then(|| slots.into())
}
