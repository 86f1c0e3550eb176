//! A chart in real time: a thread that steps it while its activities run on the pool of its agent.

use std::sync::Arc;
use std::time::Duration;

use narukom::{Timestamp, TopicSlot};

use super::END_REASON;
use super::agent_shared::{AgentShared, PendingCommands, ThreadShared};
use super::agent_update::{AgentCommand, AgentStatus, AgentUpdate, ChartStatus, STOPPED_BY_REQUEST};
use super::clock::RunClock;
use super::cycle_recorder::{self, CycleRecorder};
use super::free_loop::{FreeLoop, LOOP_REMEDY, LoopReport};
use super::pool::ActivityPool;
use super::sync::Wakeups;
use super::turn_record::{TurnRecord, TurnRecorder};
use monas_core::call::{self, CallFailure};
use monas_core::chart_runner::{ActivityCall, ChartDriver, ChartRunner, Dispatch, FinishedCall};
use monas_core::monitors::PropertyViolation;
use monas_core::records::{Delivery, Turn};
use monas_core::scheduling::Scheduling;
use monas_core::statistics::{AgentStatistics, Timing};
use yase::NodeId;

/// The data owned by the thread of a chart.
pub(crate) struct ChartThread {
    runner: ChartRunner,
    driver: PoolDriver,
    turn_recorder: TurnRecorder,
    /// Whether only this chart, and not its agent, was requested to stop.
    is_idle: bool,
    /// Whether the chart has ended; it can be started again.
    has_ended: bool,
}

/// Calls activities on a pool.
pub(crate) struct PoolDriver {
    agent: Arc<AgentShared>,
    thread: Arc<ThreadShared>,
    pool: Arc<ActivityPool>,
    /// The arrivals since the last turn.
    wakeups: Wakeups<FinishedCall>,
    recorder: CycleRecorder,
    clock: RunClock,
    /// The most recent reading of the clock. Reading it takes longer than much of what happens in
    /// between.
    last_time: Timestamp,
    /// Whether the run is ending.
    run_ends: bool,
    steps: u64,
    timing: Timing,
    free_loop: FreeLoop,
}

impl ChartDriver for PoolDriver {
    fn call(&mut self, call: ActivityCall, _: Timestamp) -> Dispatch {
        self.free_loop.called(call.activation.node);
        match self.pool.submit(call, &self.thread.mailbox) {
            Ok(()) => Dispatch::Submitted,
            Err(error) => Dispatch::Refused(None, error.to_string()),
        }
    }

    fn next_return(&mut self, _: &mut ChartRunner) -> Option<FinishedCall> {
        self.wakeups.returned.pop_front()
    }

    fn record_step(&mut self, now: Timestamp, delivered: &[Delivery], violations: &[PropertyViolation]) {
        self.recorder.record_step(now, delivered.iter().cloned(), violations);
    }

    /// Measures the step. The processing of returns before the step is part of it.
    fn step_ended(&mut self, runner: &mut ChartRunner, now: Timestamp) {
        self.steps += 1;
        let began = self.last_time;
        let took = self.read_clock().since(began);
        self.timing.add(took, None);
        if runner.statistics_every().is_some_and(|every| self.steps.is_multiple_of(every)) {
            let statistics = self.statistics(runner);
            cycle_recorder::log_times(&statistics);
            self.recorder.record_statistics(&statistics, now);
        }
    }

    fn follow(&mut self, topic: TopicSlot) -> bool {
        self.thread.mailbox.follow(topic)
    }

    fn cycle(&self) -> u64 {
        self.recorder.number()
    }
}

impl PoolDriver {
    pub(crate) fn new(
        agent: Arc<AgentShared>,
        thread: Arc<ThreadShared>,
        pool: Arc<ActivityPool>,
        recorder: CycleRecorder,
        clock: RunClock,
    ) -> PoolDriver {
        PoolDriver {
            agent,
            thread,
            pool,
            wakeups: Wakeups::default(),
            recorder,
            clock,
            last_time: clock.now(),
            run_ends: false,
            steps: 0,
            timing: Timing::default(),
            free_loop: FreeLoop::default(),
        }
    }

    fn read_clock(&mut self) -> Timestamp {
        self.last_time = self.clock.now();
        self.last_time
    }

    /// Sleeps until something arrives or a time is reached.
    fn wait(&mut self, until: Timestamp) {
        let clock = self.clock;
        let timeout = || {
            if until == Timestamp::MAX {
                return Some(Duration::MAX);
            }
            let now = clock.now();
            (now < until).then(|| until.since(now))
        };
        self.thread.mailbox.wait(timeout, &mut self.wakeups);
        self.run_ends |= self.wakeups.stop;
    }

    /// Reports the call that has lasted longest to the supervisor.
    fn update_watchdog(&self, runner: &ChartRunner) {
        match runner.longest_running() {
            Some((activity, since)) => {
                self.thread.watchdog.set_activity(activity);
                self.thread.watchdog.start_cycle(since, self.steps);
            }
            None => {
                self.thread.watchdog.end_cycle();
            }
        }
    }

    fn statistics(&self, runner: &ChartRunner) -> AgentStatistics {
        AgentStatistics {
            host: runner.host().into(),
            agent: self.agent.name.clone(),
            cycles: self.steps,
            micro_steps: runner.micro_steps(),
            activities: runner.activity_statistics().collect(),
            cycle_time: self.timing.wall(),
            cycle_percentiles: self.timing.percentiles(),
            stopped: self
                .agent
                .reason()
                .filter(|reason| reason != END_REASON && reason != STOPPED_BY_REQUEST),
            ..AgentStatistics::default()
        }
    }
}

impl ChartThread {
    /// A thread whose periodic steps begin now.
    pub(crate) fn new(mut runner: ChartRunner, driver: PoolDriver) -> ChartThread {
        runner.skip_ticks(driver.last_time);
        let turn_recorder = TurnRecorder::default();
        ChartThread { runner, driver, turn_recorder, is_idle: false, has_ended: false }
    }

    /// Executes turns until the run ends.
    pub(crate) fn run(mut self) -> AgentStatistics {
        self.driver.agent.observed().add_this_thread();
        self.driver.agent.schedule(&self.runner.scheduling(), &Scheduling::default());
        if let Err(failure) = call::caught(|| self.begin()) {
            self.fail(&failure);
        }
        while !self.driver.run_ends {
            if let Err(failure) = call::caught(|| self.turn()) {
                self.fail(&failure);
            }
        }
        self.end();
        self.driver.statistics(&self.runner)
    }

    /// Stops the agent after a panic outside of its activities, for example in a listener. It can
    /// be started again, with charts in their initial state.
    fn fail(&mut self, failure: &CallFailure) {
        self.driver.thread.watchdog.end_cycle();
        (self.driver.wakeups, self.has_ended) = (Wakeups::default(), true);
        self.runner.cancel_all();
        self.driver.agent.fail(&format!("its thread {failure}"), false);
        self.driver.agent.mark_finished(&self.driver.thread, false);
        self.publish_status(true);
    }

    fn begin(&mut self) {
        self.follow_guards();
        let now = self.driver.read_clock();
        self.runner.record_fetches();
        self.runner.start(now);
        self.record_turn(Turn::Start, now);
        (self.has_ended, self.is_idle) = (false, false);
        self.driver.thread.mark_active();
        self.publish_status(true);
    }

    fn follow_guards(&self) {
        for topic in self.runner.topics_of_guards() {
            self.driver.thread.mailbox.follow(topic);
        }
    }

    /// Cancels the activities that are running, waits until they have returned, and ends the chart.
    fn end(&mut self) {
        if self.has_ended {
            return;
        }
        self.has_ended = true;
        self.runner.cancel_all();
        loop {
            let now = self.driver.read_clock();
            self.driver.wakeups.messages.clear();
            self.turn_recorder.begin(&mut self.runner, &self.driver.wakeups);
            let is_over = self.runner.end_turn(&mut self.driver, now);
            self.driver.update_watchdog(&self.runner);
            self.record_turn(Turn::Stop, now);
            if is_over {
                break;
            }
            self.driver.wait(Timestamp::MAX);
        }
        self.driver.agent.mark_finished(&self.driver.thread, self.is_idle);
        self.publish_status(true);
    }

    /// Waits for work, applies commands, and runs until the chart is stable.
    fn turn(&mut self) {
        let is_inactive = self.has_ended || self.runner.is_paused() || self.runner.is_over();
        let due = || self.runner.due(self.driver.last_time);
        let until = if is_inactive { Timestamp::MAX } else { due() };
        self.driver.wait(until);
        let now = self.driver.read_clock();
        let Wakeups { messages, returned, check_commands, .. } = &self.driver.wakeups;
        let is_free = messages.is_empty() && !returned.is_empty() && !check_commands && now < until;
        self.driver.free_loop.begin_turn(is_free);
        if self.driver.run_ends {
            return;
        }
        if self.driver.agent.has_stopped() {
            self.end();
        }
        self.apply_pending_commands();
        if self.has_ended {
            self.driver.wakeups.messages.clear();
        } else if let Err(reason) = self.run_turn(Turn::Round) {
            let enters_safe_state = self.runner.requires_safe_state();
            self.driver.agent.fail(&reason, enters_safe_state);
            self.end();
        }
        if self.runner.is_over() {
            self.end();
        }
        self.publish_status(false);
    }

    /// Delivers the arrivals and runs until the chart is stable; `Turn::Step` makes one more step.
    fn run_turn(&mut self, turn: Turn) -> Result<(), String> {
        let now = self.driver.last_time;
        self.turn_recorder.begin(&mut self.runner, &self.driver.wakeups);
        for (topic, host, origin) in self.driver.wakeups.messages.drain(..) {
            self.runner.message_arrived(topic, host, origin, now);
        }
        let mut result = self.runner.run_turn(&mut self.driver, now);
        if result.is_ok() && turn == Turn::Step && !self.runner.is_over() {
            result = self.runner.step_once(&mut self.driver, now);
        }
        self.driver.update_watchdog(&self.runner);
        self.record_turn(turn, now);
        match self.driver.free_loop.end_turn(now) {
            Some(LoopReport::Begun { states, rate, is_first }) => {
                self.runner.set_loop(&states);
                if is_first {
                    self.warn_of_loop(&states, rate);
                }
            }
            Some(LoopReport::Ended) => self.runner.set_loop(&[]),
            None => {}
        }
        result.map_err(|error| error.to_string())
    }

    fn warn_of_loop(&self, states: &[NodeId], rate: f64) {
        let (robot, agent) = (self.runner.host(), &self.driver.agent.name);
        let (chart, states) = (self.runner.name(), self.runner.state_names(states));
        tracing::warn!(
            %robot, %agent,
            "`{chart}` loops without a wait: {states}, {rate:.0} calls a second; {LOOP_REMEDY}"
        );
    }

    /// Records a finished turn, if a recording is being made.
    fn record_turn(&mut self, turn: Turn, now: Timestamp) {
        if !self.runner.hub().is_observed() {
            return;
        }
        let due = self.runner.due(now);
        let first_tick = if turn == Turn::Start { self.runner.ticks() } else { 0 };
        let record = TurnRecord { turn, now, due, first_tick };
        self.turn_recorder.record(record, &self.runner, &mut self.driver.recorder);
    }

    fn apply_pending_commands(&mut self) {
        while let Some(batch) = self.driver.thread.next_batch() {
            let (update, answer) = batch.open();
            let result = self.apply(update);
            self.publish_status(true);
            PendingCommands::answer(&answer, result);
        }
    }

    fn apply(&mut self, update: AgentUpdate) -> Result<Vec<String>, Vec<String>> {
        if let Some(aspect) = update.inspection {
            return Ok(self.runner.inspect(aspect));
        }
        let mut notes = Vec::new();
        let now = self.driver.read_clock();
        self.driver.recorder.record_update(now, &update, self.runner.chart_index());
        if let Some((_, swap)) = update.swap {
            let is_dry_run = swap.is_dry_run;
            notes = self.runner.swap(*swap, now)?;
            if !is_dry_run {
                self.driver.free_loop = FreeLoop::default();
                self.follow_guards();
            }
        }
        update.instances.into_iter().for_each(|(_, instances)| self.runner.replace_instances(instances, now));
        for runner in update.charts {
            self.end();
            self.runner.replace(runner);
            self.driver.free_loop = FreeLoop::default();
            self.runner.skip_ticks(now);
            self.begin();
        }
        if let Some((_, own)) = update.chart_settings {
            notes.extend(self.reconfigure(|runner| runner.apply_settings(*own, now)));
        }
        update.events.iter().for_each(|event| _ = self.runner.raise(event));
        self.is_idle |= update.only.is_some() && update.commands.contains(&AgentCommand::Stop);
        for command in update.commands {
            notes.extend(self.apply_command(command, now)?);
        }
        Ok(notes)
    }

    fn apply_command(&mut self, command: AgentCommand, now: Timestamp) -> Result<Vec<String>, Vec<String>> {
        match command {
            AgentCommand::Stop => self.end(),
            AgentCommand::Step => {
                self.driver.read_clock();
                self.run_turn(Turn::Step).map_err(|reason| vec![reason])?;
            }
            AgentCommand::Pause => self.runner.set_paused(true),
            AgentCommand::Start | AgentCommand::Resume => self.runner.set_paused(false),
            AgentCommand::Frequency(_)
            | AgentCommand::Policy(_)
            | AgentCommand::StatisticsEvery(_)
            | AgentCommand::Scheduling(..) => {
                return Ok(self.reconfigure(|runner| {
                    runner.update_defaults(|defaults| command.apply_to(defaults), now);
                }));
            }
        }
        Ok(Vec::new())
    }

    /// Changes the settings. Returns what the system does not grant.
    fn reconfigure(&mut self, change: impl FnOnce(&mut ChartRunner)) -> Vec<String> {
        let before = self.runner.scheduling();
        change(&mut self.runner);
        match self.runner.scheduling() {
            wanted if wanted != before => self.driver.agent.schedule(&wanted, &before),
            _ => Vec::new(),
        }
    }

    fn publish_status(&self, always: bool) {
        let status = match (self.has_ended, self.runner.is_paused()) {
            (true, _) => AgentStatus::Stopped,
            (false, true) => AgentStatus::Paused,
            (false, false) => AgentStatus::Running,
        };
        self.driver.thread.publish_status(self.driver.last_time, always, || {
            let chart = ChartStatus { active: self.runner.active_states(), status };
            (self.driver.statistics(&self.runner), chart)
        });
    }
}
