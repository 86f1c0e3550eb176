//! Agents that repeat their recorded real-time turns.

use std::collections::VecDeque;

use narukom::{HostId, Timestamp, TopicSlot};

use super::recorded_inputs::RecordedInputs;
use crate::agent_factory::PreparedAgent;
use crate::agent_update::{AgentCommand, AgentUpdate, STOPPED_BY_REQUEST};
use crate::cycle_recorder::CycleRecorder;
use crate::list::ActivityList;
use crate::turn_record::due_record;
use monas_core::chart_runner::{
    ActivityCall, AgentDefaults, ChartDriver, ChartRunner, Dispatch, FinishedCall, ReplayGuide, call_record,
};
use monas_core::error::Error;
use monas_core::monitors::PropertyViolation;
use monas_core::records::{Call, Cycle, Delivery, News, Turn};

/// The list or the chart of an agent.
pub(crate) enum ReplayedThread {
    /// A list that has not begun.
    Waiting(Box<PendingListCycle>),
    List(Box<RepeatedList>),
    Chart(Box<ReplayedChart>),
}

impl ReplayedThread {
    /// The list or chart of the agent; `None` if it has neither.
    pub(crate) fn new(member: PreparedAgent, feed: &RecordedInputs) -> Result<Option<ReplayedThread>, Error> {
        let PreparedAgent { policy, frequency, list, mut charts, recorder, .. } = member;
        let defaults = AgentDefaults { frequency, policy, ..AgentDefaults::default() };
        Ok(match (list, charts.pop()) {
            (Some(list), None) => {
                let recorder = recorder.of_part(list.blackboard().part())?;
                let list = RepeatedList { list, recorder, feed: feed.clone(), is_over: false };
                Some(ReplayedThread::List(Box::new(list)))
            }
            (None, Some(runner)) if charts.is_empty() => {
                let recorder = recorder.of_part(runner.part())?;
                let chart = ReplayedChart::new(runner, defaults, recorder, feed);
                Some(ReplayedThread::Chart(Box::new(chart)))
            }
            (None, None) => {
                Some(ReplayedThread::Waiting(Box::new(PendingListCycle { recorder, feed: feed.clone() })))
            }
            _ => None,
        })
    }

    /// Begins the list, if it waits for that.
    ///
    /// # Errors
    /// The recorder of its cycles cannot be created.
    pub(crate) fn begin(&mut self, list: ActivityList) -> Result<(), Error> {
        if let ReplayedThread::Waiting(waiting) = self {
            let PendingListCycle { recorder, feed } = &**waiting;
            let recorder = recorder.of_part(list.blackboard().part())?;
            let list = RepeatedList { list, recorder, feed: feed.clone(), is_over: false };
            *self = ReplayedThread::List(Box::new(list));
        }
        Ok(())
    }
}

impl ReplayedThread {
    /// Sets the recorded numbers of the next cycles.
    pub(crate) fn set_cycle_numbers(&mut self, given: impl Iterator<Item = u64>) {
        match self {
            ReplayedThread::Waiting(_) => {}
            ReplayedThread::List(list) => list.recorder.set_numbers(given),
            ReplayedThread::Chart(chart) => chart.driver.recorder.set_numbers(given),
        }
    }

    /// Applies an update between two turns.
    ///
    /// # Errors
    /// The reasons against it: nothing has changed.
    pub(crate) fn apply(&mut self, update: AgentUpdate, now: Timestamp) -> Result<Vec<String>, Vec<String>> {
        match self {
            ReplayedThread::Waiting(_) => Ok(Vec::new()),
            ReplayedThread::List(list) => {
                list.apply(update);
                Ok(Vec::new())
            }
            ReplayedThread::Chart(chart) => chart.apply(update, now),
        }
    }
}

/// The data for a list that has not begun.
pub(crate) struct PendingListCycle {
    recorder: CycleRecorder,
    feed: RecordedInputs,
}

/// A list that repeats its cycles.
pub(crate) struct RepeatedList {
    list: ActivityList,
    recorder: CycleRecorder,
    feed: RecordedInputs,
    is_over: bool,
}

impl RepeatedList {
    /// Executes a cycle that began at `now`.
    pub(crate) fn cycle(&mut self, now: Timestamp) {
        if self.is_over {
            return;
        }
        self.feed.fetching();
        self.list.begin(now);
        self.feed.publishing();
        self.recorder.record(now, Delivery::all(self.list.blackboard(), 0));
        self.feed.publishing();
        self.list.cycle(now, None);
        self.is_over = self.list.stopped().is_some();
    }

    /// The records of its cycles contain their times, and so its frequency and its pauses.
    fn apply(&mut self, update: AgentUpdate) {
        update.edits.into_iter().for_each(|edit| self.list.edit(edit));
        for command in update.commands {
            match command {
                AgentCommand::Start => self.list.restart(),
                AgentCommand::Stop => self.list.stop(STOPPED_BY_REQUEST),
                AgentCommand::Policy(policy) => self.list.set_policy(policy),
                _ => {}
            }
        }
        self.is_over = self.list.stopped().is_some();
    }
}

/// A chart. It repeats the turns of its thread through the same loop; only the pool is missing: an
/// activity is called when its recorded return is due. An activity that checks whether it was
/// cancelled therefore gets the recorded result.
pub(crate) struct ReplayedChart {
    runner: ChartRunner,
    driver: ReplayDriver,
    /// The time of the last turn or change.
    now: Timestamp,
    /// When its next step by itself was due, according to the record of its last turn.
    recorded_due: u64,
    has_failed: bool,
    is_stopping: bool,
    /// The runner with which it starts again.
    next: Option<ChartRunner>,
}

/// Carries out calls when the recording specifies their returns.
struct ReplayDriver {
    recorder: CycleRecorder,
    inputs: RecordedInputs,
    /// The calls that return in this turn, in the recorded order.
    returning: VecDeque<Call>,
    /// By topic: whether its messages wake the chart.
    followed: Vec<bool>,
}

impl ChartDriver for ReplayDriver {
    fn call(&mut self, call: ActivityCall, _: Timestamp) -> Dispatch {
        Dispatch::Held(call)
    }

    fn next_return(&mut self, runner: &mut ChartRunner) -> Option<FinishedCall> {
        let returned = self.returning.pop_front()?;
        runner.take_held(|activation| call_record(activation) == returned).map(ActivityCall::run)
    }

    fn record_step(&mut self, now: Timestamp, delivered: &[Delivery], violations: &[PropertyViolation]) {
        self.inputs.publishing();
        self.recorder.record_step(now, delivered.iter().cloned(), violations);
    }

    fn follow(&mut self, topic: TopicSlot) -> bool {
        let followed = self.followed.get_mut(topic.number() as usize);
        followed.is_some_and(|followed| !std::mem::replace(followed, true))
    }

    fn cycle(&self) -> u64 {
        self.recorder.number()
    }
}

impl ReplayedChart {
    fn new(
        mut runner: ChartRunner,
        defaults: AgentDefaults,
        recorder: CycleRecorder,
        inputs: &RecordedInputs,
    ) -> ReplayedChart {
        runner.set_defaults(defaults);
        runner.replay_from(Box::new(inputs.clone()));
        let followed = vec![false; runner.hub().topics().len()];
        let driver = ReplayDriver { recorder, inputs: inputs.clone(), returning: VecDeque::new(), followed };
        ReplayedChart {
            runner,
            driver,
            now: Timestamp::ZERO,
            recorded_due: 0,
            has_failed: false,
            is_stopping: false,
            next: None,
        }
    }

    /// Whether a restart is pending.
    pub(crate) fn restarts(&self) -> bool {
        self.next.is_some()
    }

    fn apply(&mut self, mut update: AgentUpdate, now: Timestamp) -> Result<Vec<String>, Vec<String>> {
        // Events that the change makes due were not handled before the change.
        self.now = self.now.max(now);
        let mut notes = Vec::new();
        if let Some((_, swap)) = update.swap {
            notes = self.runner.swap(*swap, now)?;
            self.follow_guards();
        }
        update.instances.into_iter().for_each(|(_, instances)| self.runner.replace_instances(instances, now));
        if let Some((_, own)) = update.chart_settings {
            self.runner.apply_settings(*own, now);
        }
        update.events.iter().for_each(|event| _ = self.runner.raise(event));
        if let Some(mut runner) = update.charts.pop() {
            runner.replay_from(Box::new(self.driver.inputs.clone()));
            self.next = Some(runner);
        }
        for command in update.commands {
            match command {
                AgentCommand::Pause => self.runner.set_paused(true),
                AgentCommand::Start | AgentCommand::Resume => self.runner.set_paused(false),
                // A stop and a step are separate turns.
                AgentCommand::Stop | AgentCommand::Step => {}
                settings => self.runner.update_defaults(|defaults| settings.apply_to(defaults), now),
            }
        }
        Ok(notes)
    }

    fn follow_guards(&mut self) {
        for topic in self.runner.topics_of_guards() {
            self.driver.follow(topic);
        }
    }

    /// Repeats a turn. After the chart has diverged the recording may lack the returns of its
    /// activities; those without a record return in the next turn.
    pub(crate) fn turn(&mut self, turn: Turn, record: &Cycle, has_diverged: bool) {
        let now = Timestamp::from_nanos(record.time);
        (self.now, self.recorded_due) = (now, record.due);
        self.set_returning(&record.returned, has_diverged);
        match turn {
            Turn::None | Turn::Ordered => {}
            Turn::Start => self.start(record.first_tick, now),
            Turn::Round | Turn::Step => self.run(turn, &record.news, now),
            Turn::Stop => self.stop(now),
        }
    }

    /// When the chart acts by itself before `next`, the time of its next recorded turn; `None` if
    /// its due time is the recorded one, since threads wake late.
    pub(crate) fn due_before(&self, next: Timestamp) -> Option<Timestamp> {
        let due = self.runner.due(self.now);
        let is_over = self.has_failed || self.is_stopping || self.runner.is_paused() || self.runner.is_over();
        let is_new = due > self.now && due < next && due_record(due) != self.recorded_due;
        (is_new && !is_over).then_some(due)
    }

    /// Executes a turn that was not recorded.
    pub(crate) fn run_unrecorded_turn(&mut self, now: Timestamp) {
        self.now = now;
        self.set_returning(&[], true);
        self.run(Turn::Round, &[], now);
    }

    fn set_returning(&mut self, recorded: &[Call], has_diverged: bool) {
        self.driver.returning.clear();
        let held = || self.runner.held_calls().map(|call| (call, call_record(call.activation)));
        let known = recorded.iter().filter(|returned| held().any(|(_, call)| call == **returned));
        self.driver.returning.extend(known.cloned());
        if has_diverged {
            for (call, record) in held().filter(|(_, record)| !recorded.contains(record)) {
                call.request_cancellation();
                self.driver.returning.push_back(record);
            }
        }
    }

    fn start(&mut self, first_tick: u64, now: Timestamp) {
        if let Some(runner) = self.next.take() {
            self.runner.replace(runner);
            (self.has_failed, self.is_stopping) = (false, false);
        }
        self.runner.set_ticks(first_tick);
        self.follow_guards();
        self.runner.start(now);
    }

    /// If a commanded step fails, only its reply says so, and the agent continues.
    fn run(&mut self, turn: Turn, news: &[News], now: Timestamp) {
        if self.has_failed || self.runner.is_over() {
            return;
        }
        news.iter().for_each(|news| self.deliver_notice(news, now));
        let mut result = self.runner.run_turn(&mut self.driver, now);
        if result.is_ok() && turn == Turn::Step && !self.runner.is_over() {
            result = self.runner.step_once(&mut self.driver, now);
        }
        self.has_failed = result.is_err() && turn != Turn::Step;
    }

    fn deliver_notice(&mut self, news: &News, now: Timestamp) {
        let host = match news.host.as_str() {
            "" => HostId::LOCAL,
            // A hub without a number for a host has no message of it either.
            name => match self.runner.hub().host_id(name) {
                Ok(host) => host,
                Err(_) => return,
            },
        };
        // Nor has a hub that does not declare the topic.
        let Some(topic) = self.runner.hub().topic_by_hash(news.topic) else { return };
        let origin = news.by.and_then(|call| self.runner.origin(call.node, call.number));
        self.runner.message_arrived(topic, host, origin, now);
    }

    fn stop(&mut self, now: Timestamp) {
        if !self.is_stopping {
            self.runner.cancel_all();
        }
        self.is_stopping = true;
        self.runner.end_turn(&mut self.driver, now);
    }
}
