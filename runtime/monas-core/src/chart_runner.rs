//! Execution of a statechart of an agent: the machine, its blackboards, and the activities of its
//! states.
//!
//! [`ChartRunner::run_until_stable`] is the one loop that steps a chart and calls its activities.
//! It is independent of time, threads and recordings: a [`ChartDriver`] carries out the calls.
//! There are four drivers: simulated time, threads with a pool, replay of these threads, and
//! scenarios.

mod activity_slots;
mod agent_defaults;
mod chart_host;
mod delivery_log;
mod inspect;
mod model_swap;
mod region_blackboards;
mod source_subscriptions;

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use narukom::{HostId, Hub, Timestamp, TopicSlot};
use yase::expression::EventId;
use yase::{Activation, Chooser, Machine, MachineError, NodeId, Outcome, Status, TopicId};

use crate::activity::{Activity, Progress};
use crate::activity_context::calling;
use crate::agent::{ChartSettings, FailurePolicy};
use crate::binder::BoundChart;
use crate::call::{self, CallFailure};
use crate::error::Error;
use crate::listener::ListenerSet;
use crate::monitors::{self, Monitors, PropertyViolation, StepObservation};
use crate::publishing_activity::{self, PublishingActivity};
use crate::records::{self, Delivery};
use crate::seeds::component_seed;

pub use crate::call::{ActivityCall, CallTiming, FinishedCall};
pub use agent_defaults::AgentDefaults;
use chart_host::{ChartHost, RootScope};
pub(crate) use chart_host::{message_field, set_message_field, transition_name};
use delivery_log::DeliveryLog;
pub use delivery_log::ReplayGuide;
pub use inspect::ChartAspect;
pub use model_swap::ModelSwap;

/// Minimum delay before the next call of an activity that returned `Ongoing`, except after
/// messages.
const MIN_DELAY: Duration = Duration::from_millis(1);
/// Number of runners created in this process.
static RUNNERS: AtomicU64 = AtomicU64::new(0);

/// Executes one statechart of an agent.
pub struct ChartRunner {
    /// Unique in this process.
    number: u64,
    hub: Hub,
    machine: Machine,
    host: ChartHost,
    monitors: Option<Monitors>,
    settings: ChartSettings,
    defaults: AgentDefaults,
    /// Number of the next periodic step on the grid of the chart's frequency.
    ticks: u64,
    is_paused: bool,
    /// After a failure that stops the agent: whether the body enters its safe state.
    enters_safe_state: Option<bool>,
    micro_steps: u64,
}

/// Calls the activities of a chart and records its steps.
pub trait ChartDriver {
    /// Carries out a call or reports when it is carried out.
    fn call(&mut self, call: ActivityCall, now: Timestamp) -> Dispatch;

    /// The next activity that has returned to the chart since the turn began.
    fn next_return(&mut self, _runner: &mut ChartRunner) -> Option<FinishedCall> {
        None
    }

    /// Records a step, or deadlines that have passed, with the deliveries and the violated
    /// properties.
    fn record_step(&mut self, now: Timestamp, delivered: &[Delivery], violations: &[PropertyViolation]);

    /// Called after a step has been recorded.
    fn step_ended(&mut self, _runner: &mut ChartRunner, _now: Timestamp) {}

    /// Follows a topic that a waiting activity has read. Returns true if it was not followed
    /// before: messages may have been missed.
    fn follow(&mut self, _topic: TopicSlot) -> bool {
        false
    }

    /// Number of the most recently recorded cycle, for log lines.
    fn cycle(&self) -> u64;
}

/// A driver's answer to a call.
pub enum Dispatch {
    /// The call returns through [`ChartDriver::next_return`].
    Submitted,
    /// The chart keeps the call until the driver takes it out for execution.
    Held(ActivityCall),
    /// The call has been executed; its result takes effect at the given time.
    Finished(FinishedCall, Timestamp),
    /// The agent must stop for the given reason. The call is returned unless it was lost.
    Refused(Option<ActivityCall>, String),
}

/// Why a chart cannot continue.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    /// A macrostep does not terminate.
    #[error("chart `{chart}`: {error}")]
    Step {
        /// The chart.
        chart: String,
        /// Its error.
        error: MachineError,
    },
    /// The agent must stop.
    #[error("{0}")]
    Stop(String),
}

/// The agent of a chart and the values for the creation of the chart.
#[derive(Clone, Copy)]
pub struct ChartContext<'a> {
    /// The hub of the host.
    pub hub: &'a Hub,
    /// The agent.
    pub agent: &'a str,
    /// Index of the chart among the charts of the agent.
    pub number: u32,
    /// The seed of the run.
    pub seed: u64,
    /// Receive every micro-step.
    pub listeners: &'a ListenerSet,
    /// The time of creation.
    pub now: Timestamp,
}

impl ChartContext<'_> {
    /// The path of the chart, from which the seeds of its random numbers are derived.
    fn path(&self) -> String {
        format!("{}/{}/{}", self.hub.host(), self.agent, self.number)
    }

    /// The part of its agent under which the chart publishes.
    fn part(&self) -> u16 {
        u16::try_from(self.number).unwrap_or(u16::MAX)
    }

    /// The seed of choices between transitions of equal priority.
    fn random_seed(&self) -> u64 {
        let seed = component_seed(self.seed, &format!("{}#chooser", self.path()));
        seed.iter().take(8).fold(0, |number, byte| number << 8 | u64::from(*byte))
    }
}

impl ChartRunner {
    /// A runner of a chart, before its first step.
    ///
    /// # Errors
    /// A topic of the chart that the hub does not have.
    pub fn new(
        bound: BoundChart,
        own: ChartSettings,
        context: ChartContext<'_>,
    ) -> Result<ChartRunner, Error> {
        let BoundChart { chart, functions, activities } = bound;
        let host = ChartHost::new(&chart, context, functions, activities)?;
        let mut machine = Machine::new(chart);
        machine.set_chooser(Chooser::seeded(context.random_seed()));
        Ok(ChartRunner {
            number: RUNNERS.fetch_add(1, Ordering::Relaxed),
            hub: context.hub.clone(),
            machine,
            host,
            monitors: None,
            settings: own,
            defaults: AgentDefaults::default(),
            ticks: 0,
            is_paused: false,
            enters_safe_state: None,
            micro_steps: 0,
        })
    }

    /// Checks properties of the chart from its start on.
    pub fn set_monitors(&mut self, monitors: Monitors) {
        self.host.blackboards.add_read_topics(monitors.topics());
        self.host.observation = Some(StepObservation::default());
        self.monitors = Some(monitors);
    }

    /// Enters the root. The first transitions are those of the first step.
    pub fn start(&mut self, now: Timestamp) {
        self.host.now = now;
        self.machine.start(yase_timestamp(now), &mut self.host);
    }

    /// Notes a published message; `origin` is the activity of a chart that published it, if any.
    pub fn message_arrived(
        &mut self,
        topic: TopicSlot,
        host: HostId,
        origin: Option<PublishingActivity>,
        now: Timestamp,
    ) {
        let id = TopicId(topic.number());
        if self.machine.reads_topic(id) {
            self.notify_machine(id, host);
        }
        let own = origin.filter(|origin| origin.runner == self.number).map(|origin| origin.activation);
        self.host.slots.message_arrived(topic, own, now);
    }

    fn notify_machine(&mut self, topic: TopicId, host: HostId) {
        if host == HostId::LOCAL {
            self.machine.message_arrived(topic, 1);
        } else if let Some(host) = self.hub.host_name(host) {
            self.machine.message_arrived_from(&host, topic, 1);
        }
    }

    /// Raises an event from outside. Returns false if no expression names it.
    pub fn raise(&mut self, event: &str) -> bool {
        self.machine.dispatch_name(event)
    }

    /// Raises an event of the chart from outside.
    pub(crate) fn raise_id(&mut self, event: EventId) {
        self.machine.dispatch(event);
    }

    /// When the chart next acts by itself: a step, a call of a waiting activity, or the return of a
    /// call.
    pub fn due(&self, now: Timestamp) -> Timestamp {
        let by_itself = match self.machine.needs_step(yase_timestamp(now)) {
            true => now,
            false => {
                let deadline = self.machine.next_deadline();
                let deadline = deadline.map_or(Timestamp::MAX, |at| Timestamp::from_nanos(at.as_nanos()));
                let property = self.monitors.as_ref().map_or(Timestamp::MAX, Monitors::due);
                deadline.min(self.host.slots.next_call()).min(property)
            }
        };
        by_itself.min(self.host.slots.next_result()).min(self.tick())
    }

    fn is_step_due(&self, now: Timestamp) -> bool {
        self.machine.needs_step(yase_timestamp(now)) || self.is_tick_due(now)
    }

    /// Steps and calls activities until nothing is left to do at this time.
    ///
    /// Activities that a step starts are called before the next step, in the order in which the
    /// machine started them; each return is followed by a step; activities that wait for another
    /// call get it when the chart is stable.
    ///
    /// # Errors
    /// Why the agent must stop.
    pub fn run_until_stable(
        &mut self,
        driver: &mut impl ChartDriver,
        now: Timestamp,
    ) -> Result<(), ChartError> {
        while !self.is_over() && !self.is_paused {
            if let Some(call) = self.next_started() {
                self.dispatch(call, driver, now)?;
            } else if self.is_step_due(now) {
                self.step_and_record(driver, now)?;
            } else if let Some(finished) = self.host.slots.next_return(now) {
                self.complete_call(finished, driver, now)?;
            } else if let Some(call) = self.next_due_call(now) {
                self.dispatch(call, driver, now)?;
            } else {
                return self.check_deadlines(driver, now);
            }
        }
        Ok(())
    }

    /// Takes back the activities that have returned, one after the other, and runs until the chart
    /// is stable after each.
    ///
    /// # Errors
    /// Why the agent must stop.
    pub fn run_turn(&mut self, driver: &mut impl ChartDriver, now: Timestamp) -> Result<(), ChartError> {
        while let Some(finished) = driver.next_return(self) {
            self.complete_call(finished, driver, now)?;
            self.run_until_stable(driver, now)?;
        }
        self.run_until_stable(driver, now)
    }

    /// Makes one step if one is due, and calls the activities that are due before and after it.
    ///
    /// # Errors
    /// Why the agent must stop.
    pub fn step_once(&mut self, driver: &mut impl ChartDriver, now: Timestamp) -> Result<(), ChartError> {
        while let Some(finished) = self.host.slots.next_return(now) {
            self.complete_call(finished, driver, now)?;
        }
        while let Some(call) = self.next_due_call(now) {
            self.dispatch(call, driver, now)?;
        }
        match !self.is_over() && self.is_step_due(now) {
            true => self.step_and_record(driver, now)?,
            false => self.check_deadlines(driver, now)?,
        }
        while let Some(call) = self.next_started() {
            self.dispatch(call, driver, now)?;
        }
        Ok(())
    }

    /// Takes back the activities that have returned after all were cancelled. Ends the chart and
    /// returns true when the last one has returned.
    pub fn end_turn(&mut self, driver: &mut impl ChartDriver, now: Timestamp) -> bool {
        while let Some(finished) = driver.next_return(self) {
            let activation = self.host.slots.current_activation(&finished.call);
            if let Err(failure) = self.handle_return(finished, false, now) {
                let activity = self.host.slots.name(activation);
                tracing::error!(agent = %self.host.agent, %activity, "activity failed: {failure}");
            }
        }
        let is_quiet = self.host.slots.is_quiet();
        if is_quiet {
            self.stop(now);
        }
        is_quiet
    }

    fn dispatch(
        &mut self,
        mut call: ActivityCall,
        driver: &mut impl ChartDriver,
        now: Timestamp,
    ) -> Result<(), ChartError> {
        call.cycle = driver.cycle();
        let activation = call.activation;
        match driver.call(call, now) {
            Dispatch::Submitted => {}
            Dispatch::Held(call) => self.host.slots.hold(call),
            Dispatch::Finished(finished, at) => self.host.slots.hold_result(finished, at),
            Dispatch::Refused(call, reason) => {
                match call {
                    Some(call) => {
                        let (activation, blackboard) = self.host.slots.take_back(call, None);
                        self.host.blackboards.take_back(activation, blackboard, true);
                    }
                    None => self.host.slots.abandon(activation),
                }
                return Err(ChartError::Stop(reason));
            }
        }
        Ok(())
    }

    fn step_and_record(&mut self, driver: &mut impl ChartDriver, now: Timestamp) -> Result<(), ChartError> {
        while self.is_tick_due(now) {
            self.ticks += 1;
        }
        let stepped = self.step(now);
        let violations = self.take_violations(now);
        driver.record_step(now, &self.host.delivered, &violations);
        let answered = self.handle_violations(&violations, driver.cycle(), now);
        driver.step_ended(self, now);
        stepped.map_err(|error| ChartError::Step { chart: self.name().to_owned(), error })?;
        answered
    }

    /// Checks for properties whose deadlines have passed.
    fn check_deadlines(&mut self, driver: &mut impl ChartDriver, now: Timestamp) -> Result<(), ChartError> {
        if !self.monitors.as_mut().is_some_and(|monitors| monitors.check_deadlines(now)) {
            return Ok(());
        }
        let violations = self.take_violations(now);
        driver.record_step(now, &[], &violations);
        self.handle_violations(&violations, driver.cycle(), now)
    }

    fn take_violations(&mut self, now: Timestamp) -> Vec<PropertyViolation> {
        self.monitors.as_mut().map(|monitors| monitors.take_violations(now)).unwrap_or_default()
    }

    fn handle_violations(
        &self,
        violations: &[PropertyViolation],
        cycle: u64,
        now: Timestamp,
    ) -> Result<(), ChartError> {
        let who = (self.host(), self.agent());
        monitors::handle_violations(violations, who, self.policy(), cycle, now).map_err(ChartError::Stop)
    }

    /// Processes the return of an activity to the chart.
    fn complete_call(
        &mut self,
        finished: FinishedCall,
        driver: &mut impl ChartDriver,
        now: Timestamp,
    ) -> Result<(), ChartError> {
        let activation = self.host.slots.current_activation(&finished.call);
        let restart = self.policy_of(activation) == FailurePolicy::Restart;
        let result = self.handle_return(finished, restart, now);
        // Messages may have arrived on a topic before it was followed.
        let topics = self.host.slots.wake_topics(activation).iter().copied();
        let missed: Vec<TopicSlot> = topics.filter(|topic| driver.follow(*topic)).collect();
        missed.into_iter().for_each(|topic| self.message_arrived(topic, HostId::LOCAL, None, now));
        let Err(failure) = result else { return Ok(()) };
        self.handle_failure(activation, &failure, driver.cycle()).map_err(ChartError::Stop)
    }

    /// Makes one run-to-completion step.
    ///
    /// # Errors
    /// The step does not terminate; the machine has stopped.
    pub fn step(&mut self, now: Timestamp) -> Result<(), MachineError> {
        self.host.begin_step(now);
        let summary = self.machine.run_to_completion(yase_timestamp(now), &mut self.host)?;
        self.micro_steps += u64::from(summary.micro_steps);
        if let (Some(monitors), Some(seen)) = (&mut self.monitors, &self.host.observation) {
            monitors.step(&self.machine, seen, &RootScope(&self.host), now);
        }
        if let Some(seen) = &mut self.host.observation {
            seen.clear();
        }
        self.end_exited_activities(now);
        Ok(())
    }

    /// Stops the activities that were waiting when their states were exited.
    fn end_exited_activities(&mut self, now: Timestamp) {
        while let Some(activation) = self.host.exited.pop() {
            let ChartHost { blackboards, slots, host, agent, .. } = &mut self.host;
            let blackboard = blackboards.reclaim_mut(activation.region, now);
            let (Some(blackboard), Some((context, activity))) = (blackboard, slots.end_exited(activation))
            else {
                continue;
            };
            if let Err(failure) = calling(&context, 0, || call::stop(activity, blackboard)) {
                tracing::error!(robot = %host, agent = %agent, "activity failed to stop: {failure}");
            }
            blackboards.publish_all(activation.region, now);
        }
    }

    /// The next activity that a step has started, as a call with its blackboard.
    pub fn next_started(&mut self) -> Option<ActivityCall> {
        let machine = &self.machine;
        let activation = self.host.slots.next_ready(|slots, activation| {
            machine.status() == Status::Running
                && machine.is_active(activation.node)
                && slots.is_newest(activation)
        })?;
        self.prepare_call(activation, false)
    }

    /// The next activity that waits for another call and is due.
    fn next_due_call(&mut self, now: Timestamp) -> Option<ActivityCall> {
        loop {
            let activation = self.host.slots.next_due(now)?;
            if self.machine.activity_resumed(activation) {
                return self.resume(activation, now);
            }
        }
    }

    /// Calls the waiting activity of a state before it is due.
    pub(crate) fn call_now(&mut self, node: NodeId, now: Timestamp) -> Option<ActivityCall> {
        let activation = self.host.slots.take_waiting(node)?;
        if !self.machine.activity_resumed(activation) {
            return None;
        }
        self.resume(activation, now)
    }

    /// Delivers the messages that have arrived before the activity is called again.
    fn resume(&mut self, activation: Activation, now: Timestamp) -> Option<ActivityCall> {
        self.host.now = now;
        self.host.blackboards.refresh(activation.region, now)?;
        self.prepare_call(activation, true)
    }

    fn prepare_call(&mut self, activation: Activation, is_resumed: bool) -> Option<ActivityCall> {
        let ChartHost { blackboards, slots, now, .. } = &mut self.host;
        let blackboard = blackboards.lend_blackboard(activation, *now)?;
        slots.prepare_call(activation, is_resumed, blackboard, *now)
    }

    /// Replaces the instances of activities. One that waits for its next call, or returns from a
    /// call, is stopped; the new one is started before it is called.
    pub fn replace_instances(&mut self, instances: Vec<(NodeId, Box<dyn Activity>)>, now: Timestamp) {
        for (node, activity) in instances {
            let Some((context, mut old, activation)) =
                self.host.slots.replace_instance(node, activity, &self.hub)
            else {
                continue;
            };
            let Some(blackboard) = self.host.blackboards.reclaim_mut(activation.region, now) else {
                continue;
            };
            if let Err(failure) = calling(&context, 0, || call::stop(old.as_mut(), blackboard)) {
                tracing::error!(robot = %self.host.host, agent = %self.host.agent, "activity failed to stop: {failure}");
            }
            self.host.blackboards.publish_all(activation.region, now);
        }
    }

    /// Processes a returned call: publishes what the activity wrote, dispatches the events it
    /// raised and completes its state if it has finished. None of this happens if the state was
    /// exited.
    ///
    /// # Errors
    /// The activity failed in a state that is still active.
    pub(crate) fn handle_return(
        &mut self,
        finished: FinishedCall,
        restart: bool,
        now: Timestamp,
    ) -> Result<(), CallFailure> {
        let FinishedCall { call, result, timing } = finished;
        let (activation, blackboard) = self.host.slots.take_back(call, timing);
        let is_current = self.is_current(activation);
        let resident = self.host.blackboards.take_back(activation, blackboard, is_current);
        match resident.filter(|_| is_current).map(|blackboard| blackboard.take_events()) {
            Some(events) => {
                let origin = PublishingActivity { runner: self.number, activation };
                publishing_activity::publish_as(origin, || {
                    self.host.blackboards.publish_all(activation.region, now)
                });
                for event in events {
                    self.machine.dispatch_name(&event);
                }
                self.finish_activation(activation, result, restart, now)
            }
            None => {
                if let Err(failure) = result {
                    self.host.slots.failed(activation);
                    let activity = self.host.slots.name(activation);
                    tracing::error!(robot = %self.host.host, agent = %self.host.agent, %activity, "activity failed after its state was left: {failure}");
                }
                Ok(())
            }
        }
    }

    fn finish_activation(
        &mut self,
        activation: Activation,
        result: Result<Progress, CallFailure>,
        restart: bool,
        now: Timestamp,
    ) -> Result<(), CallFailure> {
        let outcome = match &result {
            Ok(Progress::Done) => Outcome::Done,
            Ok(Progress::Ongoing(_)) => Outcome::Ongoing,
            Err(_) => Outcome::Failed,
        };
        self.machine.activity_returned(activation, outcome);
        let ChartHost { slots, blackboards, .. } = &mut self.host;
        match result {
            Ok(Progress::Done) => slots.finished(activation),
            Ok(Progress::Ongoing(delay)) => {
                if let Some(blackboard) = blackboards.resident(activation.region) {
                    slots.defer(activation, now, delay.max(MIN_DELAY), blackboard);
                }
            }
            Err(failure) => {
                let pause = slots.failed(activation);
                if restart {
                    slots.pause(activation, now + pause);
                }
                return Err(failure);
            }
        }
        Ok(())
    }

    /// Whether an activation is the current one of its state, so that its return takes effect.
    fn is_current(&self, activation: Activation) -> bool {
        self.machine.status() == Status::Running
            && self.machine.is_active(activation.node)
            && self.host.slots.is_newest(activation)
    }

    /// Requests that every running activity return soon.
    pub fn cancel_all(&self) {
        self.host.blackboards.cancel_all();
    }

    /// Ends the chart and stops waiting activities.
    pub fn stop(&mut self, now: Timestamp) {
        self.machine.stop(&mut self.host);
        self.end_exited_activities(now);
        self.host.slots.clear_ready();
    }

    /// Stops or resumes [`run_until_stable`](ChartRunner::run_until_stable).
    pub fn set_paused(&mut self, is_paused: bool) {
        self.is_paused = is_paused;
    }

    /// Replaces this runner by another that starts from the beginning; keeps the settings of the
    /// agent.
    pub fn replace(&mut self, mut successor: ChartRunner) {
        successor.defaults = self.defaults.clone();
        successor.is_paused = self.is_paused;
        *self = successor;
    }

    /// Starts recording the positions of the hub's history at which messages are fetched.
    pub fn record_fetches(&mut self) {
        self.host.blackboards.delivery_log = DeliveryLog::Noted(Vec::new());
    }

    /// The positions recorded since [`clear_fetches`](ChartRunner::clear_fetches).
    pub fn fetches(&self) -> &[u64] {
        self.host.blackboards.delivery_log.recorded()
    }

    /// Clears the recorded positions.
    pub fn clear_fetches(&mut self) {
        self.host.blackboards.delivery_log.clear();
    }

    /// Fetches messages as a recording specifies from now on.
    pub fn replay_from(&mut self, guide: Box<dyn ReplayGuide>) {
        self.host.blackboards.delivery_log = DeliveryLog::Led(guide);
    }

    /// The calls that wait for their activities to return, in call order.
    pub fn held_calls(&self) -> impl Iterator<Item = &ActivityCall> {
        self.host.slots.held_calls()
    }

    /// Takes the call of an activation that waits for its activity to return.
    pub fn take_held(&mut self, is_it: impl Fn(Activation) -> bool) -> Option<ActivityCall> {
        self.host.slots.take_held(is_it)
    }

    /// The activity of a recorded call as the origin of a message; `None` if the state has no
    /// activity.
    pub fn origin(&self, node: u32, number: u64) -> Option<PublishingActivity> {
        let entry = self.machine.chart().activity(NodeId(node))?;
        let activation = Activation { node: entry.node, region: entry.region, number };
        Some(PublishingActivity { runner: self.number, activation })
    }

    /// The origin of a message as a recorded call; `None` if it is not an activity of this chart.
    pub fn publishing_call(&self, origin: Option<PublishingActivity>) -> Option<records::Call> {
        let PublishingActivity { activation, .. } = origin.filter(|origin| origin.runner == self.number)?;
        Some(call_record(activation))
    }
}

/// The record of a call.
pub fn call_record(activation: Activation) -> records::Call {
    records::Call { node: activation.node.0, number: activation.number }
}

fn yase_timestamp(time: Timestamp) -> yase::Timestamp {
    yase::Timestamp::from_nanos(time.as_nanos())
}
