//! The inputs of a chart's turn in real time, and its record.

use narukom::{HostId, Timestamp};

use super::cycle_recorder::CycleRecorder;
use super::sync::Wakeups;
use monas_core::chart_runner::{ChartRunner, FinishedCall, call_record};
use monas_core::records::{Call, Cycle, News, Turn, topic_in_records};

/// A finished turn.
pub(crate) struct TurnRecord {
    pub(crate) turn: Turn,
    pub(crate) now: Timestamp,
    /// When the chart next acts by itself.
    pub(crate) due: Timestamp,
    pub(crate) first_tick: u64,
}

/// The inputs of a turn. It keeps its memory between turns.
#[derive(Default)]
pub(crate) struct TurnRecorder {
    notices: Vec<News>,
    returned: Vec<Call>,
}

impl TurnRecorder {
    /// Begins a turn with the arrivals.
    pub(crate) fn begin(&mut self, runner: &mut ChartRunner, wakeups: &Wakeups<FinishedCall>) {
        runner.clear_fetches();
        let news = wakeups.messages.iter().map(|(topic, host, origin)| News {
            topic: topic_in_records(runner.hub(), *topic),
            host: host_name(runner, *host),
            by: runner.publishing_call(*origin),
        });
        self.notices.clear();
        self.notices.extend(news);
        self.returned.clear();
        self.returned.extend(wakeups.returned.iter().map(|finished| call_record(finished.call.activation)));
    }

    /// Records the finished turn.
    pub(crate) fn record(&self, record: TurnRecord, runner: &ChartRunner, recorder: &mut CycleRecorder) {
        let TurnRecord { turn, now, due, first_tick } = record;
        let make = |cycle: &mut Cycle| {
            (cycle.time, cycle.turn, cycle.chart) = (now.as_nanos(), turn.into(), runner.chart_index());
            (cycle.first_tick, cycle.due) = (first_tick, due_record(due));
            cycle.seen.extend_from_slice(runner.fetches());
            cycle.news.extend_from_slice(&self.notices);
            cycle.returned.extend_from_slice(&self.returned);
        };
        recorder.record_turn(now, make);
    }
}

/// A due time as a value of a record.
pub(crate) fn due_record(due: Timestamp) -> u64 {
    if due == Timestamp::MAX { 0 } else { due.as_nanos() }
}

/// The name of a host as a value of a record.
fn host_name(runner: &ChartRunner, host: HostId) -> String {
    if host == HostId::LOCAL {
        return String::new();
    }
    runner.hub().host_name(host).map(|name| name.to_string()).unwrap_or_default()
}
