//! A run at one moment of its tape.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use crate::chart_view::seconds;
use crate::run_view::{CHART_TOPIC, CYCLE_TOPIC, RunView, ViewedMessage};
use crate::tape_run::{TapeChannel, TapeRun};

/// The state of a run after some of the messages of its tape.
#[derive(Clone, Default, Debug)]
pub(crate) struct TapeMoment {
    pub(crate) view: RunView,
    /// By channel: how many messages it has had, and the last of them.
    channels: Vec<(u64, usize)>,
    /// The number of messages.
    pub(crate) count: usize,
}

impl TapeMoment {
    pub(crate) fn new(view: RunView, channels: usize) -> TapeMoment {
        TapeMoment { view, channels: vec![(0, 0); channels], count: 0 }
    }

    /// Takes messages up to a number of them.
    pub(crate) fn advance(&mut self, tape: &TapeRun, count: usize) {
        for index in self.count..count.min(tape.len()) {
            let Some((entry, channel)) = tape.entry(index) else { break };
            if let Some(known) = self.channels.get_mut(entry.channel as usize) {
                *known = (known.0 + 1, index);
            }
            if channel.is_viewed {
                let message = ViewedMessage {
                    host: &channel.host,
                    topic: &channel.topic,
                    publisher: &channel.publisher,
                    time: entry.time,
                    bytes: tape.bytes(entry),
                };
                self.view.take(&message, channel.is_of_scene);
            }
            self.count = index + 1;
        }
    }

    /// The newest message of a topic from a host.
    pub(crate) fn newest(&self, tape: &TapeRun, host: &str, topic: &str) -> Option<usize> {
        let fitting = tape.channels().iter().zip(&self.channels);
        let fitting = fitting
            .filter(|(channel, (count, _))| *count > 0 && channel.host == host && channel.topic == topic);
        fitting.map(|(_, (_, last))| *last).max()
    }

    /// The number of messages on a topic of a host.
    pub(crate) fn topic_count(&self, tape: &TapeRun, host: &str, topic: &str) -> u64 {
        let fitting = tape.channels().iter().zip(&self.channels);
        let fitting = fitting.filter(|(channel, _)| channel.host == host && channel.topic == topic);
        fitting.map(|(_, (count, _))| count).sum()
    }

    /// Brings the tables of agents and topics up to date. Each agent and each topic of a host is
    /// one row, whatever number of publishers and channels it has.
    pub(crate) fn set_tables(&mut self, tape: &TapeRun) {
        let mut topics: BTreeMap<(&str, &str), TopicRow<'_>> = BTreeMap::new();
        let mut known_agents = BTreeSet::new();
        let mut agents = Vec::new();
        for (channel, &(count, last)) in tape.channels().iter().zip(&self.channels) {
            let last = Some(last).filter(|_| count > 0);
            let row = TopicRow { count, last, channel };
            let key = (channel.host.as_str(), channel.topic.as_str());
            topics.entry(key).and_modify(|known| known.add(&row)).or_insert(row);
            if channel.topic == CYCLE_TOPIC && known_agents.insert((&channel.host, &channel.publisher)) {
                agents.push(self.agent(tape, &channel.host, &channel.publisher));
            }
        }
        let now = seconds(self.view.now.saturating_sub(tape.begin()));
        let topics = topics.values().map(|row| row.object(tape, now)).collect();
        self.view.set_table_objects(Value::Array(agents), topics);
    }

    fn agent(&self, tape: &TapeRun, host: &str, name: &str) -> Value {
        let count = |topic: &str| -> u64 {
            let fitting = tape.channels().iter().zip(&self.channels);
            let of_agent = fitting.filter(|(channel, _)| {
                channel.topic == topic && channel.host == host && channel.publisher == name
            });
            of_agent.map(|(_, (count, _))| count).sum()
        };
        json!({"host": host, "name": name, "state": "recorded", "reason": "", "frequency": 0.0, "cycles": count(CYCLE_TOPIC),
            "overruns": 0, "missed": 0, "steps": count(CHART_TOPIC), "time": null, "charts": [], "activities": []})
    }
}

/// A topic of a host in the table of topics.
struct TopicRow<'a> {
    count: u64,
    /// Index of the newest message, if there was one.
    last: Option<usize>,
    /// The channel of the newest message.
    channel: &'a TapeChannel,
}

impl<'a> TopicRow<'a> {
    /// Adds another channel of the topic.
    fn add(&mut self, other: &TopicRow<'a>) {
        self.count += other.count;
        if other.last > self.last {
            (self.last, self.channel) = (other.last, other.channel);
        }
    }

    /// The row as the page reads it; `now` is in seconds since the begin of the tape.
    fn object(&self, tape: &TapeRun, now: f64) -> Value {
        let TopicRow { count, last, channel } = self;
        let time = last.and_then(|last| tape.entry(last)).map(|(entry, _)| seconds(entry.time));
        let rate = (now > 0.0).then(|| *count as f64 / now);
        json!({"host": channel.host, "path": channel.topic, "kind": channel.kind, "type": channel.message_type,
            "count": count, "rate": rate, "publisher": channel.publisher, "t": time})
    }
}
