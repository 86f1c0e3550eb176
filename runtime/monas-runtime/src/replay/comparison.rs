//! Comparison of an agent's recorded and replayed publications, one timestamp at a time.

use narukom::{Hub, Timestamp, TopicSlot};

use super::{ComparisonCounts, ReplayDifference};
use monas_core::records::{CHART, CYCLE};

/// The counts so far: a line for each agent and topic.
#[derive(Default)]
pub(crate) struct ComparisonReport {
    lines: Vec<ComparisonCounts>,
}

impl ComparisonReport {
    /// Index of the line of an agent and a topic.
    pub(crate) fn line(&mut self, host: &str, agent: &str, topic: &str) -> usize {
        let known = self
            .lines
            .iter()
            .position(|line| line.host == host && line.agent == agent && line.topic == topic);
        known.unwrap_or_else(|| {
            self.lines.push(ComparisonCounts {
                host: host.into(),
                agent: agent.into(),
                topic: topic.into(),
                compared: 0,
                different: 0,
                only_recorded: 0,
                only_replayed: 0,
            });
            self.lines.len() - 1
        })
    }

    /// All lines, by host, agent and topic.
    pub(crate) fn tallies(mut self) -> Vec<ComparisonCounts> {
        self.lines.sort_by(|a, b| (&a.host, &a.agent, &a.topic).cmp(&(&b.host, &b.agent, &b.topic)));
        self.lines
    }
}

/// The recorded and replayed publications of one agent at one timestamp.
pub(crate) struct MomentComparison {
    host: String,
    agent: String,
    recorded: Vec<RecordedOutput>,
    produced: Vec<ReplayedOutput>,
    /// Number of recorded cycle records.
    cycles: u64,
}

struct RecordedOutput {
    topic: Option<TopicSlot>,
    line: usize,
    cycle: u64,
    bytes: Vec<u8>,
}

struct ReplayedOutput {
    topic: TopicSlot,
    bytes: Vec<u8>,
    /// Whether it has been compared.
    is_paired: bool,
}

impl MomentComparison {
    pub(crate) fn new(host: &str, agent: &str) -> MomentComparison {
        let (host, agent) = (host.to_owned(), agent.to_owned());
        MomentComparison { host, agent, recorded: Vec::new(), produced: Vec::new(), cycles: 0 }
    }

    pub(crate) fn produced(&mut self, topic: TopicSlot, bytes: Vec<u8>) {
        self.produced.push(ReplayedOutput { topic, bytes, is_paired: false });
    }

    pub(crate) fn recorded(&mut self, topic: Option<TopicSlot>, line: usize, bytes: Vec<u8>) {
        self.recorded.push(RecordedOutput { topic, line, cycle: 0, bytes });
    }

    /// Whether the recording has more publications than the replay.
    pub(crate) fn is_behind(&self) -> bool {
        self.recorded.len() > self.produced.len()
    }

    /// Drops publications beyond the end of the recording; they are not differences.
    pub(crate) fn discard_pending(&mut self) {
        self.produced.truncate(self.recorded.len());
    }

    /// Compares and drops the pending publications. Of each topic, the first recorded message is
    /// paired with the first replayed one, and so on.
    pub(crate) fn compare(
        &mut self,
        hub: &Hub,
        time: Timestamp,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) {
        if self.recorded.is_empty() && self.produced.is_empty() {
            return;
        }
        self.number_cycles(hub);
        let topics_now = self.produced.iter().map(|now| Some(now.topic));
        let is_in_order = topics_now.eq(self.recorded.iter().map(|then| then.topic));
        let recorded = std::mem::take(&mut self.recorded);
        let mut differences = 0;
        for then in &recorded {
            differences += u64::from(!self.pair(then, time, report, on_difference));
        }
        differences += self.report_unrecorded(hub, time, report, on_difference);
        if differences == 0 && !is_in_order {
            self.report_order(&recorded, time, report, on_difference);
        }
        self.produced.clear();
    }

    /// Compares a recorded message with the first unpaired replayed one of its topic. Returns false
    /// if there is none, or if they differ.
    fn pair(
        &mut self,
        then: &RecordedOutput,
        time: Timestamp,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> bool {
        let partner = self.produced.iter().position(|now| !now.is_paired && Some(now.topic) == then.topic);
        let tally = &mut report.lines[then.line];
        let Some(index) = partner else {
            tally.only_recorded += 1;
            on_difference(self.difference(&tally.topic, then.cycle, time, Some(&then.bytes), None));
            return false;
        };
        self.produced[index].is_paired = true;
        tally.compared += 1;
        let is_equal = self.produced[index].bytes == then.bytes;
        if !is_equal {
            tally.different += 1;
            let now = &self.produced[index].bytes;
            on_difference(self.difference(&tally.topic, then.cycle, time, Some(&then.bytes), Some(now)));
        }
        is_equal
    }

    /// Reports the first message that is out of order.
    fn report_order(
        &self,
        recorded: &[RecordedOutput],
        time: Timestamp,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) {
        let pairs = recorded.iter().zip(&self.produced);
        if let Some((then, _)) = pairs.into_iter().find(|(then, now)| then.topic != Some(now.topic)) {
            let tally = &mut report.lines[then.line];
            tally.different += 1;
            on_difference(self.difference(
                &tally.topic,
                then.cycle,
                time,
                Some(&then.bytes),
                Some(&then.bytes),
            ));
        }
    }

    fn report_unrecorded(
        &self,
        hub: &Hub,
        time: Timestamp,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> u64 {
        let mut count = 0;
        for now in self.produced.iter().filter(|now| !now.is_paired) {
            let topic = hub.declaration(now.topic).map_or("", |topic| topic.path());
            let line = report.line(&self.host, &self.agent, topic);
            report.lines[line].only_replayed += 1;
            on_difference(self.difference(topic, self.cycles.max(1), time, None, Some(&now.bytes)));
            count += 1;
        }
        count
    }

    /// A list's cycle begins with its record; a step of a chart ends with it, after the records of
    /// its micro-steps.
    fn number_cycles(&mut self, hub: &Hub) {
        let (cycle, chart) = (hub.topic(CYCLE.path()), hub.topic(CHART.path()));
        for then in &mut self.recorded {
            self.cycles += u64::from(then.topic == cycle);
            then.cycle = if then.topic == chart { self.cycles + 1 } else { self.cycles.max(1) };
        }
    }

    fn difference(
        &self,
        topic: &str,
        cycle: u64,
        time: Timestamp,
        recorded: Option<&[u8]>,
        replayed: Option<&[u8]>,
    ) -> ReplayDifference {
        ReplayDifference {
            host: self.host.clone(),
            agent: self.agent.clone(),
            cycle,
            time,
            topic: topic.to_owned(),
            recorded: recorded.map(<[u8]>::to_vec),
            replayed: replayed.map(<[u8]>::to_vec),
        }
    }
}
