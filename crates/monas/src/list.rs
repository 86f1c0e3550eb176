//! A list of activities that run one after the other: one pass is one cycle, and one transaction.

use narukom::{Blackboard, Moment};

use crate::activity::Activity;
use crate::agent::Policy;
use crate::call::{self, Failure};
use crate::statistics::{ActivityStatistics, Average};
use crate::talws::Clock;

/// How many calls an activity that keeps failing misses at most before it is tried again.
const LONGEST_PAUSE: u64 = 64;

/// The list of one agent, with its blackboard.
pub(crate) struct List {
    agent: String,
    policy: Policy,
    entries: Vec<Entry>,
    blackboard: Blackboard,
    cycles: u64,
    /// Why no more cycles happen.
    stopped: Option<String>,
}

struct Entry {
    name: String,
    activity: Box<dyn Activity>,
    health: Health,
    calls: u64,
    failures: u64,
    time: Option<Average>,
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
    pub(crate) fn new(
        agent: &str,
        policy: Policy,
        activities: Vec<(String, Box<dyn Activity>)>,
        blackboard: Blackboard,
    ) -> List {
        let down = || Health::Down { since_failures: 0, retry: 0 };
        let entry =
            |(name, activity)| Entry { name, activity, health: down(), calls: 0, failures: 0, time: None };
        let entries = activities.into_iter().map(entry).collect();
        List { agent: agent.into(), policy, entries, blackboard, cycles: 0, stopped: None }
    }

    /// Begins a cycle: delivers what has arrived.
    pub(crate) fn begin(&mut self, now: Moment) {
        self.cycles += 1;
        self.blackboard.process_messages(now);
    }

    /// Goes through the cycle: calls each activity in turn, and publishes what they wrote. With a clock, measures how long each takes.
    pub(crate) fn cycle(&mut self, now: Moment, clock: Option<&Clock>) -> Outcome {
        let mut watch = clock.map(|clock| (clock, clock.now()));
        for index in 0..self.entries.len() {
            let result = self.entries[index].run(self.cycles, &mut self.blackboard);
            if let Some((clock, since)) = &mut watch {
                self.entries[index].measure(clock, since);
            }
            let Err(failure) = result else { continue };
            let outcome = self.failed(index, &failure);
            if outcome != Outcome::Continues {
                self.blackboard.publish_all(now);
                return outcome;
            }
        }
        self.blackboard.publish_all(now);
        Outcome::Continues
    }

    fn failed(&mut self, index: usize, failure: &Failure) -> Outcome {
        let entry = &mut self.entries[index];
        entry.failures += 1;
        tracing::error!(agent = %self.agent, activity = %entry.name, cycle = self.cycles, "activity failed: {failure}");
        match self.policy {
            Policy::Restart => entry.back_off(self.cycles),
            Policy::Skip => {}
            Policy::StopAgent | Policy::SafeState => {
                let reason = format!("activity `{}` failed in cycle {}: {failure}", entry.name, self.cycles);
                self.stop(&reason);
                return if self.policy == Policy::SafeState { Outcome::SafeState } else { Outcome::Stopped };
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
        for entry in self.entries.iter_mut().filter(|entry| matches!(entry.health, Health::Up)) {
            if let Err(failure) = call::stop(entry.activity.as_mut(), &mut self.blackboard) {
                tracing::error!(agent = %self.agent, activity = %entry.name, "activity failed to stop: {failure}");
            }
        }
    }

    pub(crate) fn stopped(&self) -> Option<&str> {
        self.stopped.as_deref()
    }

    pub(crate) fn blackboard(&self) -> &Blackboard {
        &self.blackboard
    }

    pub(crate) fn activity_statistics(&self) -> impl Iterator<Item = ActivityStatistics> {
        self.entries.iter().map(|entry| ActivityStatistics {
            name: entry.name.clone(),
            calls: entry.calls,
            failures: entry.failures,
            call_time: entry.time,
            state: None,
        })
    }
}

impl Entry {
    fn run(&mut self, cycle: u64, blackboard: &mut Blackboard) -> Result<(), Failure> {
        if let Health::Down { retry, .. } = self.health {
            if cycle < retry {
                return Ok(());
            }
            call::start(self.activity.as_mut(), blackboard)?;
        }
        self.calls += 1;
        // Whatever it says, its next call is in the next cycle.
        let _ = call::execute(self.activity.as_mut(), blackboard)?;
        self.health = Health::Up;
        Ok(())
    }

    /// Takes the time since the one before it ended, which one reading of the clock serves for both.
    fn measure(&mut self, clock: &Clock, since: &mut Moment) {
        let now = clock.now();
        self.time.get_or_insert_default().add(now.since(*since));
        *since = now;
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
