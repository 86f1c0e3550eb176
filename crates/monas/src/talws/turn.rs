//! What a turn of a chart in real time began with, and its record.

use std::collections::VecDeque;

use narukom::{HostId, Moment};

use super::handover::Mail;
use super::pool::Called;
use super::teller::Teller;
use crate::chart::{Runner, call_record};
use crate::records::{Call, Cycle, News, Turn};

/// What is told of a turn when it is over.
pub(super) struct Told {
    pub(super) turn: Turn,
    pub(super) now: Moment,
    /// When the chart does something by itself.
    pub(super) due: Moment,
    pub(super) first_tick: u64,
}

/// What a turn began with. It keeps its memory from turn to turn.
#[derive(Default)]
pub(super) struct TurnNotes {
    news: Vec<News>,
    returned: Vec<Call>,
}

impl TurnNotes {
    /// A turn begins with this mail.
    pub(super) fn begin(&mut self, runner: &mut Runner, mail: &Mail<Called>) {
        runner.forget_fetches();
        let news = mail.messages.iter().map(|(topic, host, origin)| News {
            topic: topic.number(),
            host: host_name(runner, *host),
            by: runner.call_of(*origin),
        });
        self.news.clear();
        self.news.extend(news);
        self.note_returned(&mail.returned);
    }

    /// A turn begins in which the chart is being stopped: news do not matter any more.
    pub(super) fn begin_stop(&mut self, runner: &mut Runner, returned: &VecDeque<Called>) {
        runner.forget_fetches();
        self.news.clear();
        self.note_returned(returned);
    }

    fn note_returned(&mut self, returned: &VecDeque<Called>) {
        self.returned.clear();
        self.returned.extend(returned.iter().map(|called| call_record(called.assignment.activation)));
    }

    /// The turn is over.
    pub(super) fn tell(&self, told: Told, runner: &Runner, teller: &mut Teller) {
        let Told { turn, now, due, first_tick } = told;
        let make = |cycle: &mut Cycle| {
            (cycle.time, cycle.turn, cycle.chart) = (now.as_nanos(), turn.into(), runner.place());
            (cycle.first_tick, cycle.due) = (first_tick, due_record(due));
            cycle.seen.extend_from_slice(runner.fetches());
            cycle.news.extend_from_slice(&self.news);
            cycle.returned.extend_from_slice(&self.returned);
        };
        teller.tell_turn(now, make);
    }
}

/// A moment at which something is due, as records have it.
pub(super) fn due_record(due: Moment) -> u64 {
    if due == Moment::MAX { 0 } else { due.as_nanos() }
}

/// The name of a host, as records have it.
fn host_name(runner: &Runner, host: HostId) -> String {
    if host == HostId::LOCAL {
        return String::new();
    }
    runner.hub().host_name(host).map(|name| name.to_string()).unwrap_or_default()
}
