//! What an agent published then and publishes now, moment by moment.

use narukom::{Moment, Narukom, TopicSlot};

use super::{Difference, Tally};
use crate::records::{CHART, CYCLE};

/// What was compared so far: a line for each agent and topic.
#[derive(Default)]
pub(super) struct Ledger {
    lines: Vec<Tally>,
}

impl Ledger {
    /// The line of an agent and a topic.
    pub(super) fn line(&mut self, host: &str, agent: &str, topic: &str) -> usize {
        let known = self
            .lines
            .iter()
            .position(|line| line.host == host && line.agent == agent && line.topic == topic);
        known.unwrap_or_else(|| {
            self.lines.push(Tally {
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
    pub(super) fn tallies(mut self) -> Vec<Tally> {
        self.lines.sort_by(|a, b| (&a.host, &a.agent, &a.topic).cmp(&(&b.host, &b.agent, &b.topic)));
        self.lines
    }
}

/// What one agent published at one moment, then and now.
pub(super) struct Window {
    host: String,
    agent: String,
    recorded: Vec<Then>,
    produced: Vec<Now>,
    /// How many records of its cycles were recorded.
    cycles: u64,
}

struct Then {
    topic: Option<TopicSlot>,
    line: usize,
    cycle: u64,
    bytes: Vec<u8>,
}

struct Now {
    topic: TopicSlot,
    bytes: Vec<u8>,
    /// It has been compared.
    is_paired: bool,
}

impl Window {
    pub(super) fn new(host: &str, agent: &str) -> Window {
        let (host, agent) = (host.to_owned(), agent.to_owned());
        Window { host, agent, recorded: Vec::new(), produced: Vec::new(), cycles: 0 }
    }

    pub(super) fn produced(&mut self, topic: TopicSlot, bytes: Vec<u8>) {
        self.produced.push(Now { topic, bytes, is_paired: false });
    }

    pub(super) fn recorded(&mut self, topic: Option<TopicSlot>, line: usize, bytes: Vec<u8>) {
        self.recorded.push(Then { topic, line, cycle: 0, bytes });
    }

    /// Whether more was published then than now.
    pub(super) fn is_behind(&self) -> bool {
        self.recorded.len() > self.produced.len()
    }

    /// What was not recorded any more is no difference.
    pub(super) fn forget_what_is_ahead(&mut self) {
        self.produced.truncate(self.recorded.len());
    }

    /// Compares what there is, and forgets it. Of each topic the first message then belongs to the first one now, and so on.
    pub(super) fn compare(
        &mut self,
        hub: &Narukom,
        time: Moment,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
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
            differences += u64::from(!self.pair(then, time, ledger, told));
        }
        differences += self.tell_what_is_new(hub, time, ledger, told);
        if differences == 0 && !is_in_order {
            self.tell_of_order(&recorded, time, ledger, told);
        }
        self.produced.clear();
    }

    /// Compares a message of then with the first one on its topic that has no partner yet. False if it has none, or if they differ.
    fn pair(
        &mut self,
        then: &Then,
        time: Moment,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) -> bool {
        let partner = self.produced.iter().position(|now| !now.is_paired && Some(now.topic) == then.topic);
        let tally = &mut ledger.lines[then.line];
        let Some(place) = partner else {
            tally.only_recorded += 1;
            told(self.difference(&tally.topic, then.cycle, time, Some(&then.bytes), None));
            return false;
        };
        self.produced[place].is_paired = true;
        tally.compared += 1;
        let is_equal = self.produced[place].bytes == then.bytes;
        if !is_equal {
            tally.different += 1;
            let now = &self.produced[place].bytes;
            told(self.difference(&tally.topic, then.cycle, time, Some(&then.bytes), Some(now)));
        }
        is_equal
    }

    /// The first message that is not where it was.
    fn tell_of_order(
        &self,
        recorded: &[Then],
        time: Moment,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) {
        let pairs = recorded.iter().zip(&self.produced);
        if let Some((then, _)) = pairs.into_iter().find(|(then, now)| then.topic != Some(now.topic)) {
            let tally = &mut ledger.lines[then.line];
            tally.different += 1;
            told(self.difference(&tally.topic, then.cycle, time, Some(&then.bytes), Some(&then.bytes)));
        }
    }

    fn tell_what_is_new(
        &self,
        hub: &Narukom,
        time: Moment,
        ledger: &mut Ledger,
        told: &mut dyn FnMut(Difference),
    ) -> u64 {
        let mut count = 0;
        for now in self.produced.iter().filter(|now| !now.is_paired) {
            let topic = hub.declaration(now.topic).map_or("", |topic| topic.path());
            let line = ledger.line(&self.host, &self.agent, topic);
            ledger.lines[line].only_replayed += 1;
            told(self.difference(topic, self.cycles.max(1), time, None, Some(&now.bytes)));
            count += 1;
        }
        count
    }

    /// A list's cycle begins with its record, a step of a chart ends with it, after those of its micro-steps.
    fn number_cycles(&mut self, hub: &Narukom) {
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
        time: Moment,
        recorded: Option<&[u8]>,
        replayed: Option<&[u8]>,
    ) -> Difference {
        Difference {
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
