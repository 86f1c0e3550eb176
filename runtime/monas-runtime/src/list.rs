//! A list of activities called one after the other: one pass is one cycle and one transaction.

mod edit;

use std::sync::Arc;
use std::time::Duration;

use narukom::{Blackboard, Timestamp};

use crate::RunClock;
use crate::Watchdog;
use crate::cpu_time;
use monas_core::activity::Activity;
use monas_core::activity_context::ActivityContext;
use monas_core::activity_context::calling;
use monas_core::agent::{FailurePolicy, ListedActivity};
use monas_core::call::{self, CallFailure};
use monas_core::memory::LeakDetector;
use monas_core::statistics::{ActivityStatistics, Timing};

pub(crate) use edit::ListEdit;

/// The maximum number of calls skipped for an activity that keeps failing.
const LONGEST_PAUSE: u64 = 64;

/// The list of one agent, with its blackboard.
pub(crate) struct ActivityList {
    agent: String,
    policy: FailurePolicy,
    entries: Vec<ListEntry>,
    blackboard: Blackboard,
    cycles: u64,
    /// Start of the last cycle.
    last_cycle: Option<Timestamp>,
    /// Why it has stopped.
    stopped: Option<String>,
}

/// Timing of a cycle.
pub(crate) struct CycleTimer<'a> {
    pub(crate) clock: &'a RunClock,
    /// End of the last call, or start of the cycle.
    pub(crate) since: Timestamp,
    /// CPU time at that point, if it is measured.
    pub(crate) cpu: Option<Duration>,
    /// Is informed of each call, in real time.
    pub(crate) watchdog: Option<&'a Watchdog>,
}

struct ListEntry {
    name: String,
    /// Its name in log lines.
    caller: Arc<ActivityContext>,
    activity: Box<dyn Activity>,
    /// Its failure policy, if it differs from the agent's.
    policy: Option<FailurePolicy>,
    health: ActivityHealth,
    calls: u64,
    failures: u64,
    timing: Timing,
    growth: LeakDetector,
}

/// Whether an activity may be called.
enum ActivityHealth {
    /// Not started yet, or failed: to be started in cycle `retry`, after a number of consecutive
    /// failures.
    Down { since_failures: u32, retry: u64 },
    /// Running; its last success was preceded by a number of consecutive failures.
    Up,
}

/// Outcome of a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum CycleOutcome {
    /// The list continues.
    Running,
    /// The list has stopped.
    Stopped,
    /// The list has stopped, and the body must stand still.
    SafeState,
}

/// The outcome of a cycle that a policy ends.
fn stopped_by(policy: FailurePolicy) -> CycleOutcome {
    if policy == FailurePolicy::SafeState { CycleOutcome::SafeState } else { CycleOutcome::Stopped }
}

impl ActivityList {
    pub(crate) fn new(
        agent: &str,
        policy: FailurePolicy,
        activities: Vec<ListedActivity>,
        blackboard: Blackboard,
    ) -> ActivityList {
        let host = blackboard.hub().host().to_owned();
        let entries = activities.into_iter().map(|listed| ListEntry::new(listed, &host, agent)).collect();
        ActivityList {
            agent: agent.into(),
            policy,
            entries,
            blackboard,
            cycles: 0,
            last_cycle: None,
            stopped: None,
        }
    }

    /// Begins a cycle: delivers messages.
    pub(crate) fn begin(&mut self, now: Timestamp) {
        self.cycles += 1;
        self.last_cycle = Some(now);
        self.blackboard.process_messages(now);
    }

    /// Executes the cycle: calls each activity in turn and publishes the outputs. With a timer,
    /// measures each call.
    pub(crate) fn cycle(&mut self, now: Timestamp, mut watch: Option<CycleTimer<'_>>) -> CycleOutcome {
        for index in 0..self.entries.len() {
            if let Some(watchdog) = watch.as_ref().and_then(|watch| watch.watchdog) {
                watchdog.set_activity(index);
            }
            let result = self.entries[index].run(self.cycles, &mut self.blackboard, watch.is_some());
            if let Some(watch) = &mut watch {
                self.entries[index].measure(watch);
                if watch.watchdog.is_some_and(Watchdog::is_abandoned) {
                    return self.was_stuck(index);
                }
            }
            let Err(failure) = result else { continue };
            let outcome = self.failed(index, &failure);
            if outcome != CycleOutcome::Running {
                return self.publish(outcome, index, now, watch);
            }
        }
        self.publish(CycleOutcome::Running, self.entries.len().saturating_sub(1), now, watch)
    }

    /// As [`cycle`](Self::cycle), and adds the duration of the cycle to a statistic. Returns its
    /// end.
    pub(crate) fn timed_cycle(
        &mut self,
        now: Timestamp,
        timer: CycleTimer<'_>,
        timing: &mut Timing,
    ) -> (CycleOutcome, Timestamp) {
        let CycleTimer { clock, since, cpu, .. } = timer;
        let outcome = self.cycle(now, Some(timer));
        let ended = clock.now();
        let cpu = cpu.and_then(|before| Some(cpu_time()?.saturating_sub(before)));
        timing.add(ended.since(since), cpu);
        (outcome, ended)
    }

    /// Ends the cycle with the activity at that index: publishes the outputs, unless the watchdog
    /// has abandoned the cycle.
    fn publish(
        &mut self,
        outcome: CycleOutcome,
        index: usize,
        now: Timestamp,
        watch: Option<CycleTimer<'_>>,
    ) -> CycleOutcome {
        let watchdog = watch.and_then(|watch| watch.watchdog);
        if !self.entries.is_empty() && watchdog.is_some_and(|watchdog| !watchdog.end_cycle()) {
            return self.was_stuck(index);
        }
        self.blackboard.publish_all(now);
        outcome
    }

    /// An activity returned after the watchdog had abandoned it: the outputs of the cycle are
    /// discarded.
    fn was_stuck(&mut self, index: usize) -> CycleOutcome {
        let entry = &mut self.entries[index];
        entry.failures += 1;
        let policy = entry.policy.unwrap_or(self.policy);
        let reason = format!("activity `{}` was stuck in cycle {}", entry.name, self.cycles);
        self.stop(&reason);
        // The outputs on it are dropped with it.
        let random = self.blackboard.random().clone();
        let part = self.blackboard.part();
        self.blackboard = self.blackboard.hub().blackboard(&self.agent).of_part(part);
        *self.blackboard.random() = random;
        stopped_by(policy)
    }

    fn failed(&mut self, index: usize, failure: &CallFailure) -> CycleOutcome {
        let entry = &mut self.entries[index];
        entry.failures += 1;
        let robot = self.blackboard.hub().host();
        tracing::error!(%robot, agent = %self.agent, activity = %entry.name, cycle = self.cycles, "activity failed: {failure}");
        let policy = entry.policy.unwrap_or(self.policy);
        if policy == FailurePolicy::Restart {
            entry.back_off(self.cycles);
        }
        if !policy.stops_agent() {
            return CycleOutcome::Running;
        }
        let reason = format!("activity `{}` failed in cycle {}: {failure}", entry.name, self.cycles);
        self.stop(&reason);
        stopped_by(policy)
    }

    /// Stops every started activity, in the order of the list.
    pub(crate) fn stop(&mut self, reason: &str) {
        if self.stopped.is_some() {
            return;
        }
        self.stopped = Some(reason.to_owned());
        (0..self.entries.len()).for_each(|index| self.end(index));
    }

    pub(crate) fn stopped(&self) -> Option<&str> {
        self.stopped.as_deref()
    }

    pub(crate) fn last_cycle(&self) -> Option<Timestamp> {
        self.last_cycle
    }

    pub(crate) fn blackboard(&self) -> &Blackboard {
        &self.blackboard
    }

    /// The number of its last cycle.
    pub(crate) fn number(&self) -> u64 {
        self.cycles
    }

    pub(crate) fn activity_statistics(&self) -> impl Iterator<Item = ActivityStatistics> {
        self.entries.iter().map(|entry| ActivityStatistics {
            name: entry.name.clone(),
            calls: entry.calls,
            failures: entry.failures,
            call_time: entry.timing.wall(),
            call_cpu: entry.timing.cpu(),
            call_percentiles: entry.timing.percentiles(),
            held: entry.growth.held(),
            grows: entry.growth.grows(),
            loops: false,
            state: None,
        })
    }
}

impl ActivityHealth {
    /// The health of an activity before its first call.
    fn new() -> ActivityHealth {
        ActivityHealth::Down { since_failures: 0, retry: 0 }
    }
}

impl ListEntry {
    fn new(
        ListedActivity { name, activity, policy, .. }: ListedActivity,
        host: &str,
        agent: &str,
    ) -> ListEntry {
        ListEntry {
            caller: ActivityContext::new(host, agent, &name),
            name,
            activity,
            policy,
            health: ActivityHealth::new(),
            calls: 0,
            failures: 0,
            timing: Timing::default(),
            growth: LeakDetector::default(),
        }
    }

    fn run(&mut self, cycle: u64, blackboard: &mut Blackboard, counts: bool) -> Result<(), CallFailure> {
        if matches!(self.health, ActivityHealth::Down { retry, .. } if cycle < retry) {
            return Ok(());
        }
        let (activity, is_up) = (self.activity.as_mut(), matches!(self.health, ActivityHealth::Up));
        let calls = &mut self.calls;
        let mut call = || {
            if !is_up {
                call::start(activity, blackboard)?;
            }
            *calls += 1;
            // Whatever it returns, its next call is in the next cycle.
            call::execute(activity, blackboard).map(drop)
        };
        calling(&self.caller, cycle, || match counts {
            true => self.caller.account.with_account(call),
            false => call(),
        })?;
        self.health = ActivityHealth::Up;
        Ok(())
    }

    /// Measures the time since the end of the previous call; one clock reading serves both.
    fn measure(&mut self, watch: &mut CycleTimer<'_>) {
        let now = watch.clock.now();
        let cpu_now = watch.cpu.and_then(|_| cpu_time());
        let cpu = cpu_now.zip(watch.cpu).map(|(now, since)| now.saturating_sub(since));
        self.timing.add(now.since(watch.since), cpu);
        self.caller.check_memory_growth(&mut self.growth);
        (watch.since, watch.cpu) = (now, cpu_now);
    }

    /// The first failure skips no call, the n-th consecutive one skips 2^(n-1) - 1.
    fn back_off(&mut self, cycle: u64) {
        let failures = match self.health {
            ActivityHealth::Down { since_failures, .. } => since_failures.saturating_add(1),
            ActivityHealth::Up => 1,
        };
        let pause = 1_u64.checked_shl(failures - 1).unwrap_or(LONGEST_PAUSE).min(LONGEST_PAUSE);
        self.health = ActivityHealth::Down { since_failures: failures, retry: cycle + pause };
    }
}
