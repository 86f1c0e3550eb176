//! A list in real time: a thread that runs a cycle whenever one is due.

use std::sync::Arc;

use narukom::Moment;

use super::ENDED;
use super::clock::Clock;
use super::deadlines::Deadlines;
use super::real_time::Switch;
use super::stopper::Stopper;
use super::teller::{self, Teller};
use crate::list::{List, Outcome};
use crate::records::Delivery;
use crate::statistics::{AgentStatistics, Average};

/// What the thread of a list owns.
pub(super) struct ListThread {
    pub(super) host: String,
    pub(super) agent: String,
    pub(super) list: List,
    pub(super) deadlines: Deadlines,
    pub(super) statistics_every: Option<u64>,
    pub(super) teller: Teller,
    pub(super) switch: Arc<Switch>,
    pub(super) stopper: Stopper,
    pub(super) clock: Clock,
    pub(super) cycles: u64,
    pub(super) cycle_time: Average,
}

impl ListThread {
    /// Runs cycles until the agent is stopped.
    pub(super) fn run(mut self) -> AgentStatistics {
        while self.stopper.wait_until(self.deadlines.next(), &self.clock) && !self.switch.is_off() {
            let began = self.clock.now();
            let outcome = self.cycle(began);
            let ended = self.clock.now();
            self.account(began, ended);
            if outcome != Outcome::Continues {
                if outcome == Outcome::SafeState {
                    self.switch.rest_body();
                }
                self.switch.stop(self.list.stopped().unwrap_or_default());
                break;
            }
        }
        self.list.stop(ENDED);
        self.statistics()
    }

    fn cycle(&mut self, now: Moment) -> Outcome {
        self.list.begin(now);
        let blackboard = self.list.blackboard();
        self.teller.tell_noted(now, Delivery::all(blackboard, 0).collect(), &[blackboard.position()]);
        self.list.cycle(now, Some(&self.clock))
    }

    fn account(&mut self, began: Moment, ended: Moment) {
        self.cycles += 1;
        self.cycle_time.add(ended.since(began));
        if let Some(late) = self.deadlines.ended(ended) {
            tracing::warn!(agent = %self.agent, cycle = self.cycles, "cycle ended {late:?} after the next was due");
        }
        if self.statistics_every.is_some_and(|every| self.cycles.is_multiple_of(every)) {
            let activities = self.list.activity_statistics();
            teller::log_times(&self.agent, self.cycles, self.cycle_time, activities);
        }
    }

    fn statistics(&self) -> AgentStatistics {
        AgentStatistics {
            host: self.host.clone(),
            agent: self.agent.clone(),
            cycles: self.cycles,
            overruns: self.deadlines.overruns(),
            activities: self.list.activity_statistics().collect(),
            cycle_time: Some(self.cycle_time),
            stopped: self.list.stopped().filter(|reason| *reason != ENDED).map(str::to_owned),
            ..AgentStatistics::default()
        }
    }
}
