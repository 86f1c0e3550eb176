//! Comparison of two recordings of a run: their first difference, and how each ends.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use crate::chart_view::seconds;
use crate::run_view::CYCLE_TOPIC;
use crate::scene::Banner;
use crate::tape_run::{TapeChannel, TapeRun};

/// The topics with this prefix are the runtime's records about itself.
const RECORD_PREFIX: &str = "monas/";

/// The earliest message that two tapes do not share.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TapeDifference {
    /// When the earlier of both was published, s.
    pub time: f64,
    /// The host of the publisher.
    pub host: String,
    /// The publisher.
    pub publisher: String,
    /// The topic.
    pub topic: String,
    /// The number of the message among those of its publisher.
    pub sequence: u64,
    /// The message of the first tape; null if it has none of that number.
    pub first: Value,
    /// The message of the second tape.
    pub second: Value,
}

impl TapeDifference {
    /// The fields with different values, by their paths; all fields if one tape has no such
    /// message.
    pub fn fields(&self) -> Vec<(String, Value, Value)> {
        let mut fields = Vec::new();
        collect("", &self.first, &self.second, &mut fields);
        fields
    }
}

fn collect(path: &str, first: &Value, second: &Value, fields: &mut Vec<(String, Value, Value)>) {
    if first == second {
        return;
    }
    let keys = |value: &Value| -> Vec<String> {
        value.as_object().map(|fields| fields.keys().cloned().collect()).unwrap_or_default()
    };
    let mut names = keys(first);
    names.extend(keys(second));
    names.sort_unstable();
    names.dedup();
    if names.is_empty() {
        fields.push((path.to_owned(), first.clone(), second.clone()));
    }
    for name in names {
        let below = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        let of = |value: &Value| value.get(&name).cloned().unwrap_or_default();
        collect(&below, &of(first), &of(second), fields);
    }
}

/// An event of the scene on a tape.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TapeEvent {
    /// When it was, s.
    pub time: f64,
    /// Its kind, in one word.
    pub kind: String,
    /// The text.
    pub text: String,
}

/// Host, publisher, topic and number of a message.
type MessageKey<'a> = (&'a str, &'a str, &'a str, u32);

impl TapeRun {
    /// The earliest message on which two tapes differ before a time in seconds, besides the records
    /// of the runtime. Messages are equal if publisher, topic, number, time and bytes are. The time
    /// itself is left out, as in a simulated run up to it.
    pub fn first_difference(&self, other: &TapeRun, until: f64) -> Option<TapeDifference> {
        let (own, others) = (self.by_key(), other.by_key());
        let time = |tape: &TapeRun, index: Option<&usize>| {
            index.and_then(|index| tape.entry(*index)).map(|(entry, _)| entry.time)
        };
        let is_equal = |a: usize, b: usize| match (self.entry(a), other.entry(b)) {
            (Some((a, _)), Some((b, _))) => a.time == b.time && self.bytes(a) == other.bytes(b),
            _ => false,
        };
        let differing = own.keys().chain(others.keys()).filter(
            |key| !matches!((own.get(*key), others.get(*key)), (Some(a), Some(b)) if is_equal(*a, *b)),
        );
        let when = |key: &MessageKey<'_>| {
            let times = [time(self, own.get(key)), time(other, others.get(key))];
            times.into_iter().flatten().min()
        };
        // Of those of one time the one that was published first.
        let order = |key: &MessageKey<'_>| (when(key), own.get(key).or_else(|| others.get(key)).copied());
        let key = differing.min_by_key(|key| order(key))?;
        let (host, publisher, topic, sequence) = *key;
        let message = |tape: &TapeRun, index: Option<&usize>| {
            let found = index.and_then(|index| tape.entry(*index));
            found.map(|(entry, _)| tape.decoder().decode(topic, tape.bytes(entry))).unwrap_or_default()
        };
        Some(TapeDifference {
            time: seconds(when(key).filter(|time| seconds(*time) < until)?),
            host: host.to_owned(),
            publisher: publisher.to_owned(),
            topic: topic.to_owned(),
            sequence: sequence.into(),
            first: message(self, own.get(key)),
            second: message(other, others.get(key)),
        })
    }

    fn by_key(&self) -> BTreeMap<MessageKey<'_>, usize> {
        let key = |index: usize| {
            let (entry, channel) = self.entry(index)?;
            let key = (&*channel.host, &*channel.publisher, &*channel.topic, entry.sequence);
            (!channel.topic.starts_with(RECORD_PREFIX)).then_some((key, index))
        };
        (0..self.len()).filter_map(key).collect()
    }

    /// The scene's text above the plane right before a time in seconds: the score of a match.
    pub fn banner_at(&self, time: f64) -> Option<Banner> {
        let count = self.count_until(((time * 1e9).round() as u64).saturating_sub(1));
        let mut moment = self.moment_before(count).clone();
        moment.advance(self, count);
        moment.view.scene_picture(self.scene()?).banner
    }

    /// The events of the scene from a time on and before another, in seconds.
    pub fn events_between(&self, begin: f64, end: f64) -> Vec<TapeEvent> {
        let event = |event: &Value| {
            let word = |key: &str| event[key].as_str().unwrap_or_default().to_owned();
            let time = event["t"].as_f64().filter(|time| (begin..end).contains(time))?;
            Some(TapeEvent { time, kind: word("kind"), text: word("text") })
        };
        self.events().iter().filter_map(event).collect()
    }

    /// The time of the last message, s.
    pub fn end_seconds(&self) -> f64 {
        seconds(self.end())
    }

    /// Whether a host has an agent of this name.
    pub fn has_agent(&self, host: &str, agent: &str) -> bool {
        let is_own = |channel: &TapeChannel| {
            channel.topic == CYCLE_TOPIC && channel.host == host && channel.publisher == agent
        };
        self.channels().iter().any(is_own)
    }
}
