//! Counts the cycles of an agent and publishes a record of each.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use narukom::{Moment, Narukom, Publisher};

use super::entry;
use crate::error::Error;
use crate::records::{self, CYCLE, Delivery, STATISTICS};
use crate::statistics::AgentStatistics;

/// Tells of the cycles of an agent; several count together when the list and the charts run on threads of their own.
pub(super) struct Teller {
    hub: Narukom,
    agent: String,
    number: Arc<AtomicU64>,
    cycles: Publisher<records::Cycle>,
    statistics: Publisher<records::AgentEntry>,
}

impl Teller {
    pub(super) fn new(hub: &Narukom, agent: &str) -> Result<Teller, Error> {
        let cycles = hub.publisher(CYCLE, agent).map_err(Error::hub)?;
        let statistics = hub.publisher(STATISTICS, agent).map_err(Error::hub)?;
        Ok(Teller { hub: hub.clone(), agent: agent.into(), number: Arc::default(), cycles, statistics })
    }

    /// Another one for the same agent.
    pub(super) fn another(&self) -> Result<Teller, Error> {
        Ok(Teller { number: self.number.clone(), ..Teller::new(&self.hub, &self.agent)? })
    }

    /// A cycle has begun, and brought this.
    pub(super) fn tell(&mut self, now: Moment, delivered: Vec<Delivery>) {
        self.tell_noted(now, delivered, &[]);
    }

    /// As [`tell`](Teller::tell), with the points of the hub's history at which it was brought.
    pub(super) fn tell_noted(&mut self, now: Moment, delivered: Vec<Delivery>, seen: &[u64]) {
        let number = self.number.fetch_add(1, Ordering::Relaxed) + 1;
        let make = |cycle: &mut records::Cycle| {
            (cycle.number, cycle.time, cycle.delivered) = (number, now.as_nanos(), delivered);
            cycle.seen.extend_from_slice(seen);
        };
        self.cycles.publish_with(make, now);
    }

    /// A turn of a chart is over. `make` says what it was.
    pub(super) fn tell_turn(&mut self, now: Moment, make: impl FnOnce(&mut records::Cycle)) {
        self.cycles.publish_with(make, now);
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
