//! Counts the cycles of an agent and publishes a record of each.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use narukom::{Hub, Publisher, Timestamp};

use super::agent_entry;
use super::agent_update::{AgentUpdate, ChangeRef};
use super::duration_text::DurationText;
use monas_core::error::Error;
use monas_core::monitors::PropertyViolation;
use monas_core::records::{self, CYCLE, Delivery, STATISTICS, Turn};
use monas_core::statistics::{AgentStatistics, MovingAverage, Percentiles};

/// Records the cycles of an agent. Several recorders share one counter when the list and the charts
/// run on separate threads.
pub(crate) struct CycleRecorder {
    hub: Hub,
    agent: String,
    number: Arc<AtomicU64>,
    /// In a replay: the recorded numbers of its next cycles among those of all threads.
    given: VecDeque<u64>,
    cycles: Publisher<records::Cycle>,
    statistics: Publisher<records::AgentEntry>,
}

impl CycleRecorder {
    pub(crate) fn new(hub: &Hub, agent: &str) -> Result<CycleRecorder, Error> {
        let cycles = hub.publisher(CYCLE, agent).map_err(Error::hub)?;
        let statistics = hub.publisher(STATISTICS, agent).map_err(Error::hub)?;
        let (hub, agent) = (hub.clone(), agent.into());
        Ok(CycleRecorder { hub, agent, number: Arc::default(), given: VecDeque::new(), cycles, statistics })
    }

    /// Another recorder of the same agent, for one of its parts.
    pub(crate) fn of_part(&self, part: u16) -> Result<CycleRecorder, Error> {
        let CycleRecorder { cycles, statistics, .. } = CycleRecorder::new(&self.hub, &self.agent)?;
        Ok(CycleRecorder {
            hub: self.hub.clone(),
            agent: self.agent.clone(),
            number: self.number.clone(),
            given: VecDeque::new(),
            cycles: cycles.of_part(part),
            statistics: statistics.of_part(part),
        })
    }

    /// In a replay: sets the recorded numbers of the next cycles, since other threads of the agent
    /// share the counter.
    pub(crate) fn set_numbers(&mut self, given: impl Iterator<Item = u64>) {
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

    /// Records the start of a cycle with its deliveries.
    pub(crate) fn record(&mut self, now: Timestamp, delivered: impl IntoIterator<Item = Delivery>) {
        self.record_with_fetches(now, delivered, &[]);
    }

    /// As [`record`](Self::record), with the positions of the hub's history at which messages were
    /// fetched.
    pub(crate) fn record_with_fetches(
        &mut self,
        now: Timestamp,
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

    /// Records a step of a chart, or a check of its deadlines, with deliveries and violations.
    pub(crate) fn record_step(
        &mut self,
        now: Timestamp,
        delivered: impl IntoIterator<Item = Delivery>,
        broken: &[PropertyViolation],
    ) {
        let number = self.count();
        let make = |cycle: &mut records::Cycle| {
            (cycle.number, cycle.time) = (number, now.as_nanos());
            cycle.delivered.extend(delivered);
            cycle.violations.extend(broken.iter().map(PropertyViolation::record));
        };
        self.cycles.publish_with(make, now);
    }

    /// Records a finished turn. `make` creates the record.
    pub(crate) fn record_turn(&mut self, now: Timestamp, make: impl FnOnce(&mut records::Cycle)) {
        self.cycles.publish_with(make, now);
    }

    /// Records that the agent's thread applies an update from now on, if a recording is being made.
    pub(crate) fn record_update(&mut self, now: Timestamp, orders: &AgentUpdate, chart: u32) {
        let Some(asked) = &orders.change else { return };
        // The blackboards of a starting chart already exist; other blackboards are created later.
        let seen = if orders.charts.is_empty() { self.hub.position() } else { asked.ready_at };
        self.record_change_request(now, asked, seen, chart);
    }

    /// Records that the agent follows a change request, with the number of publications by then, if
    /// a recording is being made.
    pub(crate) fn record_change_request(&mut self, now: Timestamp, asked: &ChangeRef, seen: u64, chart: u32) {
        if !self.hub.is_observed() {
            return;
        }
        self.record_turn(now, |cycle| {
            (cycle.time, cycle.turn, cycle.chart) = (now.as_nanos(), Turn::Ordered.into(), chart);
            cycle.seen.push(seen);
            let (publisher, sequence) = (asked.publisher.to_string(), asked.sequence);
            cycle.asked = Some(records::Asked { publisher, sequence });
        });
    }

    /// Publishes the counts and measurements of the agent's thread so far.
    pub(crate) fn record_statistics(&mut self, statistics: &AgentStatistics, now: Timestamp) {
        self.statistics.publish(agent_entry::counted(statistics), now);
    }

    /// Number of cycles so far.
    pub(crate) fn number(&self) -> u64 {
        self.number.load(Ordering::Relaxed)
    }
}

/// Logs the durations of the cycles of an agent and of the calls of its activities.
pub(crate) fn log_times(statistics: &AgentStatistics) {
    let AgentStatistics { agent, cycles, overruns, missed, cycle_time, cycle_cpu, cycle_percentiles, .. } =
        statistics;
    let [mean, deviation, cpu] = measured(*cycle_time, *cycle_cpu);
    let [p50, p99] = percentiles(*cycle_percentiles);
    tracing::info!(%agent, cycles, %mean, %deviation, %cpu, %p50, %p99, overruns, missed, "a cycle takes");
    for activity in &statistics.activities {
        let [mean, deviation, cpu] = measured(activity.call_time, activity.call_cpu);
        let [p50, p99] = percentiles(activity.call_percentiles);
        tracing::info!(%agent, activity = %activity.name, %mean, %deviation, %cpu, %p50, %p99, "a call takes");
    }
}

/// Mean, deviation and mean CPU time.
fn measured(time: Option<MovingAverage>, cpu: Option<MovingAverage>) -> [DurationText; 3] {
    let (mean, deviation) = (time.map(|time| time.mean()), time.map(|time| time.deviation()));
    [mean, deviation, cpu.map(|cpu| cpu.mean())].map(DurationText)
}

/// The median and the 99th percentile.
fn percentiles(of: Option<Percentiles>) -> [DurationText; 2] {
    [of.map(|of| of.p50), of.map(|of| of.p99)].map(DurationText)
}
