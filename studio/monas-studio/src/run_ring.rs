//! The latest part of a run in progress, so that past moments can be viewed.

use std::collections::VecDeque;

use monas::records::Chart;
use prost::Message;
use serde_json::{Value, json};

use crate::chart_view::{ChartKey, seconds};
use crate::run_view::{CHART_TOPIC, RunView, ViewedMessage};
use crate::scene::SceneEvent;

/// The most bytes of messages and tables that are kept, and the overhead of a message besides its
/// content.
const MAX_BYTES: usize = 64 << 20;
const OVERHEAD: usize = 64;

/// The messages and the run's time between two kept moments.
const MOMENT_MESSAGES: u64 = 10_000;
const MOMENT_TIME: u64 = 10_000_000_000;

/// The most moments and events that are kept.
const MAX_MOMENTS: usize = 64;
const MAX_EVENTS: usize = 2000;

/// A kept message, by the number of its channel.
#[derive(Clone, Debug)]
struct KeptMessage {
    channel: u32,
    time: u64,
    bytes: Box<[u8]>,
}

/// The state of the run before the message with a number.
#[derive(Clone, Debug)]
struct KeptMoment {
    number: u64,
    view: RunView,
    tables: Box<str>,
}

impl KeptMoment {
    fn new(number: u64, view: &RunView) -> KeptMoment {
        let (view, tables) = view.compact();
        KeptMoment { number, view, tables }
    }
}

/// The common properties of messages.
#[derive(Clone, PartialEq, Debug)]
struct KeptChannel {
    host: String,
    topic: String,
    publisher: String,
    is_of_scene: bool,
}

/// Messages that a view has consumed, with snapshots at intervals. Memory is bounded: the oldest
/// are dropped.
#[derive(Clone, Default, Debug)]
pub(crate) struct RunRing {
    channels: Vec<KeptChannel>,
    messages: VecDeque<KeptMessage>,
    /// The number of the first message that is kept.
    first: u64,
    bytes: usize,
    moments: VecDeque<KeptMoment>,
    events: VecDeque<Value>,
    /// Counts events.
    pub(crate) event_count: u64,
}

impl RunRing {
    /// Begins with the present state of a run.
    pub(crate) fn begin(&mut self, view: &RunView) {
        *self = RunRing { event_count: self.event_count + 1, ..RunRing::default() };
        self.keep_moment(view);
    }

    /// Whether it has a starting state.
    pub(crate) fn has_begun(&self) -> bool {
        !self.moments.is_empty()
    }

    /// The number after the last message.
    pub(crate) fn end(&self) -> u64 {
        self.first + self.messages.len() as u64
    }

    /// The time of the earliest moment that is kept, in nanoseconds.
    pub(crate) fn begin_time(&self) -> u64 {
        self.moments.front().map_or(0, |moment| moment.view.now)
    }

    /// Keeps a message.
    pub(crate) fn push(&mut self, message: &ViewedMessage<'_>, is_of_scene: bool) {
        if !self.has_begun() {
            return;
        }
        let is_known = |channel: &KeptChannel| {
            channel.topic == message.topic
                && channel.host == message.host
                && channel.publisher == message.publisher
        };
        let channel = self.channels.iter().position(is_known).unwrap_or_else(|| {
            self.channels.push(KeptChannel {
                host: message.host.to_owned(),
                topic: message.topic.to_owned(),
                publisher: message.publisher.to_owned(),
                is_of_scene,
            });
            self.channels.len() - 1
        });
        self.bytes += message.bytes.len() + OVERHEAD;
        let (channel, bytes) = (channel as u32, message.bytes.into());
        self.messages.push_back(KeptMessage { channel, time: message.time, bytes });
    }

    /// Keeps the present state if the last kept one is old enough, and drops the oldest data beyond
    /// the limits.
    pub(crate) fn keep(&mut self, view: &RunView) {
        let Some(KeptMoment { number, view: last, .. }) = self.moments.back() else { return };
        let is_old =
            self.end() - number >= MOMENT_MESSAGES || view.now.saturating_sub(last.now) >= MOMENT_TIME;
        if is_old && self.end() > *number {
            self.keep_moment(view);
        }
        while (self.bytes > MAX_BYTES || self.moments.len() > MAX_MOMENTS) && self.moments.len() > 1 {
            self.bytes -= self.moments.pop_front().map_or(0, |moment| moment.tables.len());
            let next = self.moments.front().map_or(0, |moment| moment.number);
            while self.first < next
                && let Some(dropped) = self.messages.pop_front()
            {
                self.bytes -= dropped.bytes.len() + OVERHEAD;
                self.first += 1;
            }
        }
    }

    fn keep_moment(&mut self, view: &RunView) {
        let moment = KeptMoment::new(self.end(), view);
        self.bytes += moment.tables.len();
        self.moments.push_back(moment);
    }

    /// Notes an event at a time in nanoseconds.
    pub(crate) fn note(&mut self, time: u64, event: &SceneEvent) {
        if self.events.len() == MAX_EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(json!({"t": seconds(time), "kind": event.kind, "text": event.text}));
        self.event_count += 1;
    }

    /// The events since the earliest moment.
    pub(crate) fn events(&self) -> Vec<&Value> {
        let begin = seconds(self.begin_time());
        self.events.iter().filter(|event| event["t"].as_f64().is_some_and(|time| time >= begin)).collect()
    }

    /// The state of the run after the messages up to a number, at a time.
    pub(crate) fn moment(&self, number: u64, time: u64) -> Option<RunView> {
        let index = self.moments.partition_point(|moment| moment.number <= number);
        let kept = self.moments.get(index.checked_sub(1)?)?;
        let mut view = kept.view.clone();
        view.restore_tables(&kept.tables);
        self.advance(&mut view, kept.number, number, time).then_some(view)
    }

    /// Applies the messages from a number up to another to a view. Returns whether all of them are
    /// still kept.
    pub(crate) fn advance(&self, view: &mut RunView, from: u64, to: u64, time: u64) -> bool {
        if from < self.first {
            return false;
        }
        for number in from..to {
            let Some((message, channel)) = self.message(number) else { continue };
            let viewed = ViewedMessage {
                host: &channel.host,
                topic: &channel.topic,
                publisher: &channel.publisher,
                time: message.time,
                bytes: &message.bytes,
            };
            view.take(&viewed, channel.is_of_scene);
        }
        view.now = time;
        true
    }

    fn message(&self, number: u64) -> Option<(&KeptMessage, &KeptChannel)> {
        let message = self.messages.get(usize::try_from(number.checked_sub(self.first)?).ok()?)?;
        Some((message, self.channels.get(message.channel as usize)?))
    }

    /// The number after the last message up to a time.
    pub(crate) fn number_until(&self, time: u64) -> u64 {
        self.first + self.messages.partition_point(|message| message.time <= time) as u64
    }

    /// The next step of a chart from a number on, or the last one before it, for which `is_wanted`
    /// holds: the number after it, and its time.
    pub(crate) fn step_from(
        &self,
        number: u64,
        key: &str,
        is_backward: bool,
        is_wanted: impl Fn(&Chart) -> bool,
    ) -> Option<(u64, u64)> {
        let find = |number: u64| {
            let (message, channel) = self.message(number)?;
            if channel.topic != CHART_TOPIC {
                return None;
            }
            let step = Chart::decode(&*message.bytes).ok().filter(&is_wanted)?;
            let (host, agent) = (channel.host.clone(), channel.publisher.clone());
            let is_own = ChartKey { host, agent, chart: step.chart }.text() == key;
            is_own.then_some((number + 1, message.time))
        };
        match is_backward {
            false => (number..self.end()).find_map(find),
            true => (self.first..number.saturating_sub(1)).rev().find_map(find),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(time: u64, bytes: &[u8]) -> ViewedMessage<'_> {
        ViewedMessage { host: "a", topic: "t", publisher: "p", time, bytes }
    }

    #[test]
    fn memory_is_bounded_and_the_latest_moments_remain() {
        let (mut ring, mut view) = (RunRing::default(), RunView::default());
        ring.begin(&view);
        let (bytes, table) = (vec![7; 1 << 20], "x".repeat(1 << 20));
        for second in 1..=200 {
            view.now = second * 1_000_000_000;
            view.set_table_objects(json!({ "text": table }), json!(second));
            ring.push(&message(view.now, &bytes), true);
            ring.keep(&view);
        }
        // The messages up to the next moment, and its tables.
        assert!(ring.bytes <= MAX_BYTES + 12 * (bytes.len() + OVERHEAD), "{}", ring.bytes);
        let kept: usize = ring.messages.iter().map(|message| message.bytes.len() + OVERHEAD).sum();
        let tables: usize = ring.moments.iter().map(|moment| moment.tables.len()).sum();
        assert!(tables > 4 << 20 && ring.bytes == kept + tables, "{} {kept} {tables}", ring.bytes);
        assert!(ring.begin_time() >= 130_000_000_000, "{}", ring.begin_time());
        let number = ring.number_until(180_500_000_000);
        let moment = ring.moment(number, 180_500_000_000).unwrap();
        assert_eq!((number, moment.now), (180, 180_500_000_000));
        assert_eq!(moment.compact().1.len(), table.len() + r#"[{"text":""},180]"#.len());
        assert!(ring.moment(3, 3_000_000_000).is_none());
    }

    #[test]
    fn steps_are_found_in_both_directions() {
        let mut ring = RunRing::default();
        ring.begin(&RunView::default());
        let step = |selected: u32| Chart { selected: vec![selected], ..Chart::default() }.encode_to_vec();
        for (time, selected) in [(1, 5), (2, 6), (3, 5)] {
            let bytes = step(selected);
            ring.push(&ViewedMessage { topic: CHART_TOPIC, ..message(time, &bytes) }, false);
        }
        let of = |number, is_backward, segment: u32| {
            ring.step_from(number, "a/p/0", is_backward, |step| step.selected.contains(&segment))
        };
        assert_eq!(
            (of(0, false, 6), of(0, false, 5), of(1, false, 5)),
            (Some((2, 2)), Some((1, 1)), Some((3, 3)))
        );
        assert_eq!((of(3, true, 5), of(1, true, 5), of(3, true, 7)), (Some((1, 1)), None, None));
    }
}
