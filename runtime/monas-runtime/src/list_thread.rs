//! A list in real time: a thread that executes its cycles on time.

use std::sync::Arc;
use std::time::Duration;

use narukom::Timestamp;

use super::END_REASON;
use super::agent_shared::{AgentShared, PendingCommands, ThreadShared};
use super::agent_update::{AgentCommand, AgentUpdate, ChartStatus, STOPPED_BY_REQUEST};
use super::clock::{CPU_EVERY, RunClock, cpu_time};
use super::cycle_recorder::{self, CycleRecorder};
use super::deadlines::Deadlines;
use super::sync::Wakeups;
use crate::list::ActivityList;
use crate::list::CycleOutcome;
use crate::list::CycleTimer;
use monas_core::call::{self, CallFailure};
use monas_core::chart_runner::FinishedCall;
use monas_core::records::Delivery;
use monas_core::scheduling::Scheduling;
use monas_core::statistics::{AgentStatistics, Timing};

/// Minimum interval between warnings about overruns.
const WARNING_INTERVAL: Duration = Duration::from_secs(1);

/// The data owned by the thread of a list.
pub(crate) struct ListThread {
    pub(crate) host: String,
    pub(crate) agent: Arc<AgentShared>,
    pub(crate) thread: Arc<ThreadShared>,
    pub(crate) list: ActivityList,
    pub(crate) deadlines: Deadlines,
    pub(crate) statistics_every: Option<u64>,
    pub(crate) scheduling: Scheduling,
    pub(crate) recorder: CycleRecorder,
    pub(crate) clock: RunClock,
    pub(crate) cycles: u64,
    pub(crate) timing: Timing,
    /// The time of the last overrun warning, followed by the number of overruns since then.
    pub(crate) last_warning: Option<Timestamp>,
    pub(crate) suppressed_warnings: u64,
    /// Whether the last cycle was an overrun.
    pub(crate) was_late: bool,
    /// Whether its activities have been stopped.
    pub(crate) has_ended: bool,
}

impl ListThread {
    /// Executes cycles until the run ends.
    pub(crate) fn run(mut self) -> AgentStatistics {
        let mut mail = Wakeups::<FinishedCall>::default();
        self.agent.observed().add_this_thread();
        self.agent.schedule(&self.scheduling, &Scheduling::default());
        self.publish_status(true);
        loop {
            self.wait(&mut mail);
            if mail.stop {
                break;
            }
            if let Err(failure) = call::caught(|| self.serve()) {
                self.fail(&failure);
            }
        }
        self.list.stop(END_REASON);
        self.statistics()
    }

    /// Applies commands, and executes a cycle if one is due.
    fn serve(&mut self) {
        self.apply_pending_commands();
        if !self.is_inactive() && self.deadlines.next() <= self.clock.now() {
            self.cycle();
        }
    }

    /// Stops the agent after a panic outside of its activities, for example in an observer. It can
    /// be started again.
    fn fail(&mut self, failure: &CallFailure) {
        self.thread.watchdog.end_cycle();
        self.has_ended = true;
        let reason = format!("its thread {failure}");
        self.list.stop(&reason);
        self.agent.fail(&reason, false);
        self.agent.mark_finished(&self.thread, false);
        self.publish_status(true);
    }

    /// Waits for the next cycle, or for a wake-up.
    fn wait(&self, mail: &mut Wakeups<FinishedCall>) {
        let (clock, rests) = (self.clock, self.is_inactive());
        let until = if rests { Timestamp::MAX } else { self.deadlines.next() };
        let timeout = || {
            let now = clock.now();
            (now < until).then(|| until.since(now))
        };
        self.thread.mailbox.wait(timeout, mail);
    }

    /// Whether no cycle is due at any time.
    fn is_inactive(&self) -> bool {
        self.has_ended || self.agent.is_paused() || self.agent.has_stopped()
    }

    /// Applies the pending commands.
    fn apply_pending_commands(&mut self) {
        if self.agent.has_stopped() {
            self.end();
        }
        while let Some(batch) = self.thread.next_batch() {
            let (orders, answer) = batch.open();
            let said = self.apply(orders);
            self.publish_status(true);
            PendingCommands::answer(&answer, Ok(said));
        }
    }

    fn end(&mut self) {
        if !self.has_ended {
            self.has_ended = true;
            self.list.stop(&self.agent.reason().unwrap_or_else(|| STOPPED_BY_REQUEST.into()));
            self.agent.mark_finished(&self.thread, false);
            self.publish_status(true);
        }
    }

    fn apply(&mut self, orders: AgentUpdate) -> Vec<String> {
        let mut said = Vec::new();
        let now = self.clock.now();
        self.recorder.record_update(now, &orders, 0);
        orders.edits.into_iter().for_each(|edit| self.list.edit(edit));
        for directive in orders.commands {
            match directive {
                AgentCommand::Start => {
                    self.list.restart();
                    self.has_ended = false;
                    self.deadlines.skip_to(now);
                }
                AgentCommand::Stop => self.end(),
                AgentCommand::Resume => self.deadlines.skip_to(now),
                AgentCommand::Step => self.cycle(),
                AgentCommand::Frequency(frequency) => self.deadlines.set_frequency(frequency, now),
                AgentCommand::Policy(policy) => self.list.set_policy(policy),
                AgentCommand::StatisticsEvery(cycles) => self.statistics_every = cycles,
                AgentCommand::Scheduling(priority, real_time) => {
                    let wanted = Scheduling { priority, real_time, ..self.scheduling.clone() };
                    let was = std::mem::replace(&mut self.scheduling, wanted);
                    said.extend(self.agent.schedule(&self.scheduling, &was));
                }
                AgentCommand::Pause => {}
            }
        }
        said
    }

    fn cycle(&mut self) {
        let began = self.clock.now();
        self.list.begin(began);
        let blackboard = self.list.blackboard();
        self.recorder.record_with_fetches(began, Delivery::all(blackboard, 0), &[blackboard.position()]);
        let cpu = if self.was_late || self.cycles.is_multiple_of(CPU_EVERY) { cpu_time() } else { None };
        self.thread.watchdog.start_cycle(began, self.list.number());
        let watchdog = Some(&self.thread.watchdog);
        let timer = CycleTimer { clock: &self.clock, since: began, cpu, watchdog };
        let (outcome, ended) = self.list.timed_cycle(began, timer, &mut self.timing);
        self.thread.watchdog.end_cycle();
        self.record_cycle(ended);
        if outcome != CycleOutcome::Running {
            self.has_ended = true;
            self.agent.fail(self.list.stopped().unwrap_or_default(), outcome == CycleOutcome::SafeState);
            self.agent.mark_finished(&self.thread, false);
        }
        self.publish_status(outcome != CycleOutcome::Running);
    }

    fn record_cycle(&mut self, ended: Timestamp) {
        self.cycles += 1;
        let late = self.deadlines.ended(ended);
        self.was_late = late.is_some();
        late.into_iter().for_each(|late| self.warn(late, ended));
        if self.statistics_every.is_some_and(|every| self.cycles.is_multiple_of(every)) {
            let statistics = self.statistics();
            cycle_recorder::log_times(&statistics);
            self.recorder.record_statistics(&statistics, ended);
        }
    }

    /// Logs an overrun, at most once per second, with the number of overruns since the last
    /// warning.
    fn warn(&mut self, late: Duration, now: Timestamp) {
        if self.last_warning.is_some_and(|warned| now < warned + WARNING_INTERVAL) {
            self.suppressed_warnings += 1;
            return;
        }
        let (agent, cycle, unsaid) = (&self.agent.name, self.cycles, self.suppressed_warnings);
        tracing::warn!(%agent, cycle, unsaid, "cycle ended {late:.1?} after the next was due");
        (self.last_warning, self.suppressed_warnings) = (Some(now), 0);
    }

    fn publish_status(&self, always: bool) {
        self.thread.publish_status(self.clock.now(), always, || (self.statistics(), ChartStatus::default()));
    }

    fn statistics(&self) -> AgentStatistics {
        AgentStatistics {
            host: self.host.clone(),
            agent: self.agent.name.clone(),
            cycles: self.cycles,
            overruns: self.deadlines.overruns(),
            activities: self.list.activity_statistics().collect(),
            missed: self.deadlines.missed(),
            cycle_time: self.timing.wall(),
            cycle_cpu: self.timing.cpu(),
            cycle_percentiles: self.timing.percentiles(),
            stopped: self
                .list
                .stopped()
                .filter(|reason| *reason != END_REASON && *reason != STOPPED_BY_REQUEST)
                .map(str::to_owned),
            ..AgentStatistics::default()
        }
    }
}
