//! Counts the cycles of an agent and publishes a record of each.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use narukom::{Moment, Narukom, Publisher};

use super::entry;
use super::orders::{Asked, Orders};
use crate::error::Error;
use crate::monitors::Broken;
use crate::records::{self, CYCLE, Delivery, STATISTICS, Turn};
use crate::statistics::AgentStatistics;

/// Tells of the cycles of an agent; several count together when the list and the charts run on threads of their own.
pub(super) struct Teller {
    hub: Narukom,
    agent: String,
    number: Arc<AtomicU64>,
    /// In a replay: the numbers that its next cycles had among those of all threads.
    given: VecDeque<u64>,
    cycles: Publisher<records::Cycle>,
    statistics: Publisher<records::AgentEntry>,
}

impl Teller {
    pub(super) fn new(hub: &Narukom, agent: &str) -> Result<Teller, Error> {
        let cycles = hub.publisher(CYCLE, agent).map_err(Error::hub)?;
        let statistics = hub.publisher(STATISTICS, agent).map_err(Error::hub)?;
        let (hub, agent) = (hub.clone(), agent.into());
        Ok(Teller { hub, agent, number: Arc::default(), given: VecDeque::new(), cycles, statistics })
    }

    /// Another one for the same agent, which tells of one of its parts.
    pub(super) fn of_part(&self, part: u16) -> Result<Teller, Error> {
        let Teller { cycles, statistics, .. } = Teller::new(&self.hub, &self.agent)?;
        Ok(Teller {
            hub: self.hub.clone(),
            agent: self.agent.clone(),
            number: self.number.clone(),
            given: VecDeque::new(),
            cycles: cycles.of_part(part),
            statistics: statistics.of_part(part),
        })
    }

    /// In a replay: cycles had these numbers, since other threads of the agent count theirs with them.
    pub(super) fn number_by(&mut self, given: impl Iterator<Item = u64>) {
        self.given.clear();
        self.given.extend(given);
    }

    fn count(&mut self) -> u64 {
        match self.given.pop_front() {
            Some(number) => {
                self.number.store(number, Ordering::Relaxed);
                number
            }
            None => self.number.fetch_add(1, Ordering::Relaxed) + 1,
        }
    }

    /// A cycle has begun, and brought this.
    pub(super) fn tell(&mut self, now: Moment, delivered: impl IntoIterator<Item = Delivery>) {
        self.tell_noted(now, delivered, &[]);
    }

    /// As [`tell`](Teller::tell), with the points of the hub's history at which it was brought.
    pub(super) fn tell_noted(
        &mut self,
        now: Moment,
        delivered: impl IntoIterator<Item = Delivery>,
        seen: &[u64],
    ) {
        let number = self.count();
        let make = |cycle: &mut records::Cycle| {
            (cycle.number, cycle.time) = (number, now.as_nanos());
            cycle.delivered.extend(delivered);
            cycle.seen.extend_from_slice(seen);
        };
        self.cycles.publish_with(make, now);
    }

    /// A chart has made a step, or has found time gone by, which brought this and broke these.
    pub(super) fn tell_step(
        &mut self,
        now: Moment,
        delivered: impl IntoIterator<Item = Delivery>,
        broken: &[Broken],
    ) {
        let number = self.count();
        let make = |cycle: &mut records::Cycle| {
            (cycle.number, cycle.time) = (number, now.as_nanos());
            cycle.delivered.extend(delivered);
            cycle.violations.extend(broken.iter().map(Broken::record));
        };
        self.cycles.publish_with(make, now);
    }

    /// A turn is over. `make` says what it was.
    pub(super) fn tell_turn(&mut self, now: Moment, make: impl FnOnce(&mut records::Cycle)) {
        self.cycles.publish_with(make, now);
    }

    /// The agent's thread follows a change from now on. That is for recordings; if nobody makes one, nothing is said.
    pub(super) fn tell_ordered(&mut self, now: Moment, orders: &Orders, chart: u32) {
        let Some(asked) = &orders.asked else { return };
        // The blackboards of a chart that begins are there already, others are yet to be made.
        let seen = if orders.charts.is_empty() { self.hub.position() } else { asked.ready_at };
        self.tell_asked(now, asked, seen, chart);
    }

    /// The agent does what somebody asked, when so many publications had happened; if nobody makes a recording, nothing is said.
    pub(super) fn tell_asked(&mut self, now: Moment, asked: &Asked, seen: u64, chart: u32) {
        if !self.hub.is_observed() {
            return;
        }
        self.tell_turn(now, |cycle| {
            (cycle.time, cycle.turn, cycle.chart) = (now.as_nanos(), Turn::Ordered.into(), chart);
            cycle.seen.push(seen);
            let (publisher, sequence) = (asked.publisher.to_string(), asked.sequence);
            cycle.asked = Some(records::Asked { publisher, sequence });
        });
    }

    /// What was counted and measured of the agent's thread so far.
    pub(super) fn tell_statistics(&mut self, statistics: &AgentStatistics, now: Moment) {
        self.statistics.publish(entry::counted(statistics), now);
    }

    /// How many cycles there were.
    pub(super) fn number(&self) -> u64 {
        self.number.load(Ordering::Relaxed)
    }
}

/// Writes to the log what the cycles of an agent and the calls of its activities take.
pub(super) fn log_times(statistics: &AgentStatistics) {
    let AgentStatistics { agent, cycles, overruns, missed, cycle_time, cycle_cpu, cycle_percentiles, .. } =
        statistics;
    let (mean, deviation) = (cycle_time.map(|time| time.mean()), cycle_time.map(|time| time.deviation()));
    let (cpu, of) = (cycle_cpu.map(|cpu| cpu.mean()), cycle_percentiles.unwrap_or_default());
    tracing::info!(%agent, cycles, ?mean, ?deviation, ?cpu, p50 = ?of.p50, p99 = ?of.p99, overruns, missed, "a cycle takes");
    for activity in &statistics.activities {
        let time = activity.call_time;
        let (mean, deviation) = (time.map(|time| time.mean()), time.map(|time| time.deviation()));
        let (cpu, of) =
            (activity.call_cpu.map(|cpu| cpu.mean()), activity.call_percentiles.unwrap_or_default());
        tracing::info!(%agent, activity = %activity.name, ?mean, ?deviation, ?cpu, p50 = ?of.p50, p99 = ?of.p99, "a call takes");
    }
}
