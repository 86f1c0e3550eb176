//! A list of activities that run one after the other: one pass is one cycle, and one transaction.

mod edit;

use std::sync::Arc;
use std::time::Duration;

use narukom::{Blackboard, Moment};

use crate::activity::Activity;
use crate::agent::{Listed, Policy};
use crate::call::{self, Failure};
use crate::logger::{self, Caller};
use crate::memory::Growth;
use crate::statistics::{ActivityStatistics, Timing};
use crate::talws::{Clock, Pulse, cpu_time};

pub(crate) use edit::ListEdit;

/// How many calls an activity that keeps failing misses at most before it is tried again.
const LONGEST_PAUSE: u64 = 64;

/// The list of one agent, with its blackboard.
pub(crate) struct List {
    agent: String,
    policy: Policy,
    entries: Vec<Entry>,
    blackboard: Blackboard,
    cycles: u64,
    /// When the last cycle began.
    last_cycle: Option<Moment>,
    /// Why no more cycles happen.
    stopped: Option<String>,
}

/// What a cycle is measured with.
pub(crate) struct Watch<'a> {
    pub(crate) clock: &'a Clock,
    /// When the last call ended, or the cycle began.
    pub(crate) since: Moment,
    /// The processor's time at that moment, if it is measured.
    pub(crate) cpu: Option<Duration>,
    pub(crate) pulse: &'a Pulse,
}

struct Entry {
    name: String,
    /// Its name in log lines.
    caller: Arc<Caller>,
    activity: Box<dyn Activity>,
    /// What happens when it fails, if it has a policy of its own.
    policy: Option<Policy>,
    health: Health,
    calls: u64,
    failures: u64,
    timing: Timing,
    growth: Growth,
}

/// Whether an activity may be called.
enum Health {
    /// It has not started yet, or failed; it is to be started in that cycle, after so many failures in a row.
    Down { since_failures: u32, retry: u64 },
    /// It runs; so many failures in a row preceded its last success.
    Up,
}

/// What became of a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Outcome {
    /// There will be more.
    Continues,
    /// It was the last one.
    Stopped,
    /// It was the last one, and the body is to stand still.
    SafeState,
}

impl List {
    pub(crate) fn new(agent: &str, policy: Policy, activities: Vec<Listed>, blackboard: Blackboard) -> List {
        let host = blackboard.hub().host().to_owned();
        let entries = activities.into_iter().map(|listed| Entry::new(listed, &host, agent)).collect();
        List { agent: agent.into(), policy, entries, blackboard, cycles: 0, last_cycle: None, stopped: None }
    }

    /// Begins a cycle: delivers what has arrived.
    pub(crate) fn begin(&mut self, now: Moment) {
        self.cycles += 1;
        self.last_cycle = Some(now);
        self.blackboard.process_messages(now);
    }

    /// Goes through the cycle: calls each activity in turn, and publishes what they wrote. With a watch, measures how long each takes.
    pub(crate) fn cycle(&mut self, now: Moment, mut watch: Option<Watch<'_>>) -> Outcome {
        for index in 0..self.entries.len() {
            if let Some(watch) = &watch {
                watch.pulse.calls(index);
            }
            let result = self.entries[index].run(self.cycles, &mut self.blackboard, watch.is_some());
            if let Some(watch) = &mut watch {
                self.entries[index].measure(watch);
                if watch.pulse.is_cut() {
                    return self.was_stuck(index);
                }
            }
            let Err(failure) = result else { continue };
            let outcome = self.failed(index, &failure);
            if outcome != Outcome::Continues {
                return self.publish(outcome, index, now, watch);
            }
        }
        self.publish(Outcome::Continues, self.entries.len().saturating_sub(1), now, watch)
    }

    /// Ends the cycle with the activity at that place: publishes what was written, if nobody has given it up.
    fn publish(&mut self, outcome: Outcome, index: usize, now: Moment, watch: Option<Watch<'_>>) -> Outcome {
        if !self.entries.is_empty() && watch.is_some_and(|watch| !watch.pulse.ends()) {
            return self.was_stuck(index);
        }
        self.blackboard.publish_all(now);
        outcome
    }

    /// An activity has returned after everybody had given it up: nothing of what was done in the cycle matters any more.
    fn was_stuck(&mut self, index: usize) -> Outcome {
        let entry = &mut self.entries[index];
        entry.failures += 1;
        let policy = entry.policy.unwrap_or(self.policy);
        let reason = format!("activity `{}` was stuck in cycle {}", entry.name, self.cycles);
        self.stop(&reason);
        // Whatever was written there is dropped with it.
        let random = self.blackboard.random().clone();
        let part = self.blackboard.part();
        self.blackboard = self.blackboard.hub().blackboard(&self.agent).of_part(part);
        *self.blackboard.random() = random;
        if policy == Policy::SafeState { Outcome::SafeState } else { Outcome::Stopped }
    }

    fn failed(&mut self, index: usize, failure: &Failure) -> Outcome {
        let entry = &mut self.entries[index];
        entry.failures += 1;
        let robot = self.blackboard.hub().host();
        tracing::error!(%robot, agent = %self.agent, activity = %entry.name, cycle = self.cycles, "activity failed: {failure}");
        let policy = entry.policy.unwrap_or(self.policy);
        match policy {
            Policy::Restart => entry.back_off(self.cycles),
            Policy::Skip => {}
            Policy::StopAgent | Policy::SafeState => {
                let reason = format!("activity `{}` failed in cycle {}: {failure}", entry.name, self.cycles);
                self.stop(&reason);
                return if policy == Policy::SafeState { Outcome::SafeState } else { Outcome::Stopped };
            }
        }
        Outcome::Continues
    }

    /// Stops every activity that has started, in the order of the list.
    pub(crate) fn stop(&mut self, reason: &str) {
        if self.stopped.is_some() {
            return;
        }
        self.stopped = Some(reason.to_owned());
        (0..self.entries.len()).for_each(|place| self.end(place));
    }

    pub(crate) fn stopped(&self) -> Option<&str> {
        self.stopped.as_deref()
    }

    pub(crate) fn last_cycle(&self) -> Option<Moment> {
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
            state: None,
        })
    }
}

impl Health {
    /// That of what has not been called yet.
    fn new() -> Health {
        Health::Down { since_failures: 0, retry: 0 }
    }
}

impl Entry {
    fn new(Listed { name, activity, policy, .. }: Listed, host: &str, agent: &str) -> Entry {
        Entry {
            caller: Caller::new(host, agent, &name),
            name,
            activity,
            policy,
            health: Health::new(),
            calls: 0,
            failures: 0,
            timing: Timing::default(),
            growth: Growth::default(),
        }
    }

    fn run(&mut self, cycle: u64, blackboard: &mut Blackboard, counts: bool) -> Result<(), Failure> {
        if matches!(self.health, Health::Down { retry, .. } if cycle < retry) {
            return Ok(());
        }
        let (activity, is_up) = (self.activity.as_mut(), matches!(self.health, Health::Up));
        let calls = &mut self.calls;
        let mut call = || {
            if !is_up {
                call::start(activity, blackboard)?;
            }
            *calls += 1;
            // Whatever it says, its next call is in the next cycle.
            call::execute(activity, blackboard).map(drop)
        };
        logger::calling(&self.caller, cycle, || match counts {
            true => self.caller.account.during(call),
            false => call(),
        })?;
        self.health = Health::Up;
        Ok(())
    }

    /// Takes the time since the one before it ended, which one reading of the clock serves for both.
    fn measure(&mut self, watch: &mut Watch<'_>) {
        let now = watch.clock.now();
        let cpu_now = watch.cpu.and_then(|_| cpu_time());
        let cpu = cpu_now.zip(watch.cpu).map(|(now, since)| now.saturating_sub(since));
        self.timing.add(now.since(watch.since), cpu);
        self.caller.has_called(&mut self.growth);
        (watch.since, watch.cpu) = (now, cpu_now);
    }

    /// The first failure costs no call, the n-th in a row 2^(n-1) - 1 of them.
    fn back_off(&mut self, cycle: u64) {
        let failures = match self.health {
            Health::Down { since_failures, .. } => since_failures.saturating_add(1),
            Health::Up => 1,
        };
        let pause = 1_u64.checked_shl(failures - 1).unwrap_or(LONGEST_PAUSE).min(LONGEST_PAUSE);
        self.health = Health::Down { since_failures: failures, retry: cycle + pause };
    }
}
