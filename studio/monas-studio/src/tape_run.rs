//! A recorded run with random access by time.

use std::collections::BTreeMap;
use std::sync::Arc;

use monas_tape::{Recording, RecordingItem};
use narukom::Timestamp;
use serde_json::{Value, json};
use yase::Statechart;

use crate::chart_view::{ChartKey, seconds};
use crate::error::{Error, ErrorKind};
use crate::message_decoder::MessageDecoder;
use crate::run_view::{CHART_TOPIC, LOG_TOPIC, Link, MODEL_TOPIC, RunView};
use crate::scene::{Scene, SceneEvent};
use crate::source::{Session, Source};
use crate::tape_moment::TapeMoment;
use crate::tape_session::TapeSession;

/// The number of messages between two moments that are kept.
const MOMENT_MESSAGES: usize = 20_000;

/// A chart of a recorded run.
#[derive(Clone, PartialEq, Debug)]
pub struct TapeChart {
    /// The host of its agent.
    pub host: String,
    /// Its agent.
    pub agent: String,
    /// Its index in the agent.
    pub chart: u32,
    /// The name of its model.
    pub model: String,
    /// The chart.
    pub statechart: Statechart,
}

/// A message of a tape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TapeEntry {
    /// Nanoseconds.
    pub(crate) time: u64,
    pub(crate) channel: u32,
    begin: usize,
    size: u32,
    /// The number of the message among those of its channel, from 1.
    pub(crate) sequence: u32,
}

/// The common properties of messages.
#[derive(Clone, Debug)]
pub(crate) struct TapeChannel {
    pub(crate) host: String,
    pub(crate) topic: String,
    pub(crate) publisher: String,
    pub(crate) kind: String,
    pub(crate) message_type: String,
    pub(crate) is_of_scene: bool,
    /// Whether a view uses its messages.
    pub(crate) is_viewed: bool,
}

/// A recording that is read once and indexed, so that each moment can be viewed. Clones share it.
#[derive(Clone)]
pub struct TapeRun(Arc<TapeIndex>);

struct TapeIndex {
    recording: Recording,
    scene: Option<Arc<dyn Scene>>,
    charts: Vec<TapeChart>,
    channels: Vec<TapeChannel>,
    entries: Vec<TapeEntry>,
    decoder: MessageDecoder,
    /// Events on the timeline.
    events: Vec<Value>,
    /// After each [`MOMENT_MESSAGES`] messages.
    moments: Vec<TapeMoment>,
}

impl TapeRun {
    /// Reads a recording once from begin to end.
    ///
    /// # Errors
    /// The recording is damaged.
    pub fn new(
        name: &str,
        recording: Recording,
        charts: &[TapeChart],
        scene: Option<Arc<dyn Scene>>,
    ) -> Result<TapeRun, Error> {
        let failed = |error: monas_tape::Error| Error::new(ErrorKind::Recording, error);
        let mut index = TapeIndex {
            recording,
            scene,
            charts: charts.to_vec(),
            channels: Vec::new(),
            entries: Vec::new(),
            decoder: MessageDecoder::default(),
            events: Vec::new(),
            moments: Vec::new(),
        };
        let mut numbers: BTreeMap<*const monas_tape::Channel, u32> = BTreeMap::new();
        let mut last_events = BTreeMap::new();
        // Channels are kept, so that their addresses stay different.
        let mut kept = Vec::new();
        let recording = index.recording.clone();
        for item in recording.contents().map_err(failed)? {
            let RecordingItem::Message(message) = item.map_err(failed)? else { continue };
            // A message received from another host is shown where it was published.
            if message.channel.received_by.is_some() {
                continue;
            }
            let channel = *numbers.entry(Arc::as_ptr(&message.channel)).or_insert_with(|| {
                kept.push(message.channel.clone());
                index.add_channel(&message.channel)
            });
            let range = recording.range_of(&message);
            let time = message.published.as_nanos();
            let size = u32::try_from(range.len()).unwrap_or(u32::MAX);
            index.entries.push(TapeEntry {
                time,
                channel,
                begin: range.start,
                size,
                sequence: message.sequence,
            });
            index.note_event(&mut last_events, channel, time, message.bytes);
        }
        sort_events(&mut index.events);
        // By time of publication; equal times stay in the order of the tape.
        index.entries.sort_by_key(|entry| entry.time);
        let mut tape = TapeRun(Arc::new(index));
        let first = tape.first_moment(name);
        let moments = tape.moments(first);
        if let Some(index) = Arc::get_mut(&mut tape.0) {
            index.moments = moments;
        }
        Ok(tape)
    }

    /// Marks further events on the timeline. To be called before the tape is shared; afterwards it
    /// has no effect.
    pub fn mark(&mut self, events: impl IntoIterator<Item = (Timestamp, SceneEvent)>) {
        let Some(index) = Arc::get_mut(&mut self.0) else { return };
        let marked = events.into_iter().map(
            |(time, event)| json!({"t": seconds(time.as_nanos()), "kind": event.kind, "text": event.text}),
        );
        index.events.extend(marked);
        sort_events(&mut index.events);
    }

    fn moments(&self, first: TapeMoment) -> Vec<TapeMoment> {
        let mut moments = vec![first.clone()];
        let mut moment = first;
        while moment.count + MOMENT_MESSAGES < self.len() {
            moment.advance(self, moment.count + MOMENT_MESSAGES);
            moments.push(moment.clone());
        }
        moments
    }

    /// The run before its first message; of a tape that begins later, with the states that were
    /// active there.
    fn first_moment(&self, name: &str) -> TapeMoment {
        let mut view = RunView::default();
        view.begin();
        view.link = Link::Tape;
        name.clone_into(&mut view.name);
        view.is_simulated = true;
        view.decoder = self.decoder().clone();
        view.hosts = self.channels().iter().map(|channel| channel.host.clone()).collect();
        view.hosts.sort_unstable();
        view.hosts.dedup();
        view.now = self.begin();
        for chart in self.charts() {
            let before = self.is_cut(chart).then(|| self.history(chart).active_before());
            let picture = yase_export::to_picture(&chart.statechart, &before.unwrap_or_default());
            view.show_chart(chart.key(), &chart.model, &picture);
        }
        TapeMoment::new(view, self.channels().len())
    }

    pub(crate) fn len(&self) -> usize {
        self.0.entries.len()
    }

    /// Its charts.
    pub fn charts(&self) -> &[TapeChart] {
        &self.0.charts
    }

    /// The hosts with charts.
    pub fn chart_hosts(&self) -> Vec<&str> {
        let mut hosts: Vec<&str> = self.charts().iter().map(|chart| chart.host.as_str()).collect();
        hosts.dedup();
        hosts
    }

    /// # Errors
    /// No chart of this host is on the tape; the message names the hosts.
    pub fn check_chart_host(&self, host: &str) -> Result<(), String> {
        let hosts = self.chart_hosts();
        match hosts[..] {
            _ if hosts.contains(&host) => Ok(()),
            [] => Err("no statecharts are recorded in this tape".to_owned()),
            _ => Err(format!("no host with charts is named `{host}`; there are `{}`", hosts.join("`, `"))),
        }
    }

    pub(crate) fn channels(&self) -> &[TapeChannel] {
        &self.0.channels
    }

    pub(crate) fn scene(&self) -> Option<&dyn Scene> {
        self.0.scene.as_deref()
    }

    pub(crate) fn decoder(&self) -> &MessageDecoder {
        &self.0.decoder
    }

    pub(crate) fn events(&self) -> &[Value] {
        &self.0.events
    }

    pub(crate) fn entry(&self, index: usize) -> Option<(TapeEntry, &TapeChannel)> {
        let entry = *self.0.entries.get(index)?;
        Some((entry, self.0.channels.get(entry.channel as usize)?))
    }

    pub(crate) fn bytes(&self, entry: TapeEntry) -> &[u8] {
        self.0.recording.bytes_at(entry.begin..entry.begin + entry.size as usize).unwrap_or_default()
    }

    /// The time of the first message.
    pub(crate) fn begin(&self) -> u64 {
        self.0.entries.first().map_or(0, |entry| entry.time)
    }

    /// The time of the last message.
    pub(crate) fn end(&self) -> u64 {
        self.0.entries.last().map_or(0, |entry| entry.time)
    }

    /// The number of messages up to a time.
    pub(crate) fn count_until(&self, time: u64) -> usize {
        self.0.entries.partition_point(|entry| entry.time <= time)
    }

    /// The latest kept moment with at most so many messages.
    pub(crate) fn moment_before(&self, count: usize) -> &TapeMoment {
        let moments = &self.0.moments;
        let index = moments.partition_point(|moment| moment.count <= count);
        &moments[index.max(1) - 1]
    }

    /// The number of messages up to and with the next step of a chart after `count` messages, or
    /// the last one before.
    pub(crate) fn step_from(&self, count: usize, key: &str, is_backward: bool) -> Option<usize> {
        let is_step = |index: &usize| {
            self.entry(*index).is_some_and(|(entry, channel)| {
                channel.topic == CHART_TOPIC
                    && key_of(channel, self.bytes(entry)).is_some_and(|known| known == key)
            })
        };
        match is_backward {
            false => (count..self.len()).find(is_step).map(|index| index + 1),
            true => (0..count.saturating_sub(1)).rev().find(is_step).map(|index| index + 1),
        }
    }
}

/// Sorts events by time.
fn sort_events(events: &mut [Value]) {
    let time = |event: &Value| event["t"].as_f64().unwrap_or_default();
    events.sort_by(|a, b| time(a).total_cmp(&time(b)));
}

fn key_of(channel: &TapeChannel, bytes: &[u8]) -> Option<String> {
    let step = <monas::records::Chart as prost::Message>::decode(bytes).ok()?;
    let key = ChartKey { host: channel.host.clone(), agent: channel.publisher.clone(), chart: step.chart };
    Some(key.text())
}

impl TapeIndex {
    fn add_channel(&mut self, channel: &monas_tape::Channel) -> u32 {
        let scene = self.scene.as_deref();
        let is_of_scene = scene.is_some_and(|scene| scene.topics().contains(&channel.topic.as_str()));
        let is_record = [CHART_TOPIC, MODEL_TOPIC, LOG_TOPIC].contains(&channel.topic.as_str());
        if !self.decoder.knows(&channel.topic) {
            self.decoder.learn(&channel.topic, &channel.schema.name, &channel.schema.data);
        }
        self.channels.push(TapeChannel {
            host: channel.host.clone(),
            topic: channel.topic.clone(),
            publisher: channel.publisher.clone(),
            kind: channel.kind.clone(),
            message_type: channel.schema.name.clone(),
            is_of_scene,
            is_viewed: is_of_scene || is_record,
        });
        self.channels.len() as u32 - 1
    }

    /// Notes the event that a message is; `last` has the last one of each channel.
    fn note_event(
        &mut self,
        last: &mut BTreeMap<u32, Option<SceneEvent>>,
        channel: u32,
        time: u64,
        bytes: &[u8],
    ) {
        let Some(scene) = self.scene.as_deref() else { return };
        let TapeChannel { host, topic, .. } = &self.channels[channel as usize];
        if !scene.event_topics().contains(&topic.as_str()) {
            return;
        }
        let event = scene.event(host, topic, bytes);
        let before = last.insert(channel, event.clone()).flatten();
        if let Some(event) = event.filter(|event| !event.lasts || before.as_ref() != Some(event)) {
            self.events.push(json!({"t": seconds(time), "kind": event.kind, "text": event.text}));
        }
    }
}

impl std::fmt::Debug for TapeRun {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "TapeRun({} messages)", self.len())
    }
}

impl Source for TapeRun {
    fn open(&self) -> Box<dyn Session> {
        Box::new(TapeSession::new(self.clone()))
    }
}
