//! A viewer of a tape, with its moment.

use std::time::Duration;

use serde_json::{Value, json};
use yase::{NodeId, TransitionId};

use crate::cameras::{self, ChosenCamera};
use crate::chart_view::seconds;
use crate::run_view::ViewCursor;
use crate::source::Session;
use crate::tape_moment::TapeMoment;
use crate::tape_run::TapeRun;
use crate::viewer_request::ViewerRequest;

/// The fastest playback.
const MAX_SPEED: f64 = 1000.0;

/// The interval of updates of the tables, nanoseconds on the tape.
const TABLE_INTERVAL: u64 = 500_000_000;

/// The interval of updates of the values of a chart during playback, nanoseconds on the tape.
const VALUE_INTERVAL: u64 = 200_000_000;

/// The view of one viewer, which plays and seeks for itself.
pub(crate) struct TapeSession {
    tape: TapeRun,
    moment: TapeMoment,
    cursor: ViewCursor,
    /// The playback speed: seconds of the tape per second; 0 while it is held.
    factor: f64,
    /// Whether the data of the tape still have to be sent to the viewer.
    is_new: bool,
    /// Whether it has to discard its state, because the moment has moved backwards.
    is_elsewhere: bool,
    /// The moment of the last tables.
    tables: Option<u64>,
    watched: Option<(String, String)>,
    /// The message of the watched topic that was sent last.
    sent: Option<usize>,
    camera: Option<ChosenCamera>,
    /// The message with the images that were sent last.
    sent_images: Option<usize>,
    /// The chart whose values are seen, by its key.
    values: Option<String>,
    /// The moment of the values that were sent last: the number of messages, and the time.
    sent_values: Option<(usize, u64)>,
    /// Events on the timeline.
    events: Vec<Value>,
    other: Option<OtherMoment>,
}

/// The same moment of the tape beside.
struct OtherMoment {
    tape: TapeRun,
    moment: TapeMoment,
    cursor: ViewCursor,
}

impl OtherMoment {
    /// Goes to a time. Returns whether it is not a later moment.
    fn go_to(&mut self, time: u64) -> bool {
        let count = self.tape.count_until(time);
        let kept = self.tape.moment_before(count);
        let is_elsewhere = count < self.moment.count || kept.count > self.moment.count;
        if is_elsewhere {
            self.moment = kept.clone();
        }
        self.moment.advance(&self.tape, count);
        self.moment.view.now = time;
        is_elsewhere
    }

    fn frame(&mut self, is_elsewhere: bool) -> Option<Value> {
        if is_elsewhere {
            self.cursor = ViewCursor::default();
        }
        let mut frame = self.moment.view.frame(&mut self.cursor, self.tape.scene())?;
        if is_elsewhere {
            frame["elsewhere"] = json!(true);
        }
        Some(frame)
    }
}

impl TapeSession {
    pub(crate) fn new(tape: TapeRun) -> TapeSession {
        let moment = tape.moment_before(0).clone();
        let events = tape.events().to_vec();
        TapeSession {
            tape,
            moment,
            cursor: ViewCursor::default(),
            factor: 1.0,
            is_new: true,
            is_elsewhere: false,
            tables: None,
            watched: None,
            sent: None,
            camera: None,
            sent_images: None,
            values: None,
            sent_values: None,
            events,
            other: None,
        }
    }

    /// A view of two tapes, with what is marked on the timeline of both.
    pub(crate) fn beside(tape: TapeRun, other: TapeRun, events: Vec<Value>) -> TapeSession {
        let moment = other.moment_before(0).clone();
        let other = Some(OtherMoment { tape: other, moment, cursor: ViewCursor::default() });
        TapeSession { events, other, ..TapeSession::new(tape) }
    }

    fn picture(&self, key: &str, is_beside: bool) -> Value {
        let view = match &self.other {
            Some(other) if is_beside => &other.moment.view,
            _ => &self.moment.view,
        };
        json!({"type": "picture", "key": key, "beside": is_beside, "picture": view.picture(key)})
    }

    /// Goes to the moment after some messages, at a time.
    fn go_to(&mut self, count: usize, time: u64) {
        let kept = self.tape.moment_before(count);
        if count < self.moment.count || kept.count > self.moment.count {
            self.moment = kept.clone();
            self.is_elsewhere = true;
        }
        self.moment.advance(&self.tape, count);
        self.moment.view.now = time;
    }

    fn play(&mut self, elapsed: Duration) {
        if self.factor == 0.0 {
            return;
        }
        let passed = elapsed.as_secs_f64() * self.factor * 1e9;
        let time = self.moment.view.now.saturating_add(passed as u64).min(self.tape.end());
        self.go_to(self.tape.count_until(time), time);
        if time == self.tape.end() {
            self.factor = 0.0;
            self.is_new = true;
        }
    }

    /// Holds the tape after a number of its messages, or where it is.
    fn hold_at(&mut self, count: Option<usize>) {
        self.factor = 0.0;
        self.is_new = true;
        if let Some(count) = count {
            let time = self.tape.entry(count - 1).map_or(0, |(entry, _)| entry.time);
            self.go_to(count, time);
        }
    }

    fn sample(&mut self) -> Option<Value> {
        let (host, topic) = self.watched.as_ref()?;
        let index = self.moment.newest(&self.tape, host, topic).filter(|index| Some(*index) != self.sent)?;
        let (entry, channel) = self.tape.entry(index)?;
        let bytes = self.tape.bytes(entry);
        let message = self.tape.decoder().decode(topic, bytes);
        let count = self.moment.topic_count(&self.tape, host, topic);
        let sample = json!({"host": host, "from": host, "topic": topic, "publisher": channel.publisher,
            "sequence": count, "t": seconds(entry.time), "size": bytes.len(), "count": count, "message": message});
        self.sent = Some(index);
        Some(sample)
    }
}

impl TapeSession {
    /// The values of the chosen chart, if the moment has changed; during playback at intervals.
    fn chart_values(&mut self) -> Option<Value> {
        let key = self.values.as_ref()?;
        let (count, now) = (self.moment.count, self.moment.view.now);
        let is_due = self.sent_values.is_none_or(|(sent, at)| {
            (sent, at) != (count, now) && (self.factor == 0.0 || now.abs_diff(at) >= VALUE_INTERVAL)
        });
        let chart = self.tape.charts().iter().find(|chart| chart.key().text() == *key)?;
        let active = self.moment.view.charts.get(&chart.key()).filter(|_| is_due)?.active();
        self.sent_values = Some((count, now));
        Some(self.tape.values_until(chart, active, count, now))
    }

    /// The images at the moment, if they have changed.
    fn images(&mut self, elapsed: Duration) -> Option<Value> {
        let cameras = cameras::of(self.tape.scene())?;
        let camera = self.camera.as_mut()?;
        if !camera.is_due(elapsed) {
            return None;
        }
        let index = self.moment.newest(&self.tape, &camera.host, cameras.topic());
        let index = index.filter(|index| Some(*index) != self.sent_images)?;
        let (entry, _) = self.tape.entry(index)?;
        self.sent_images = Some(index);
        Some(camera.object(cameras, entry.time, self.tape.bytes(entry)))
    }
}

impl Session for TapeSession {
    fn handle(&mut self, request: ViewerRequest) -> Option<Value> {
        match request {
            ViewerRequest::Picture { key, is_beside } => return Some(self.picture(&key, is_beside)),
            ViewerRequest::Watch { host, topic } => {
                self.watched = Some((host, topic));
                self.sent = None;
            }
            ViewerRequest::Unwatch => self.watched = None,
            ViewerRequest::Camera(host) => {
                self.camera = host.map(ChosenCamera::new);
                self.sent_images = None;
            }
            ViewerRequest::Values(key) => (self.values, self.sent_values) = (key, None),
            ViewerRequest::Live | ViewerRequest::Model(..) => {}
            ViewerRequest::Control(id, _) => {
                let reason = "a tape cannot be changed";
                return Some(json!({"type": "reply", "id": id, "done": false, "reason": reason}));
            }
            ViewerRequest::Pace(factor) => {
                // At its end a tape is played again from its begin.
                if factor > 0.0 && self.moment.view.now >= self.tape.end() {
                    self.go_to(0, self.tape.begin());
                }
                self.factor = factor.min(MAX_SPEED);
                self.is_new = true;
            }
            ViewerRequest::Seek(time) => {
                let time = ((time * 1e9) as u64).clamp(self.tape.begin(), self.tape.end());
                self.go_to(self.tape.count_until(time), time);
            }
            ViewerRequest::Why { key, node } => {
                let chart = self.tape.charts().iter().find(|chart| chart.key().text() == key)?;
                let why = self.tape.explain_until(chart, NodeId(node), self.moment.count);
                return Some(json!({"type": "why", "key": key, "node": node, "why": why}));
            }
            ViewerRequest::WhyTransition { key, transition } => {
                let chart = self.tape.charts().iter().find(|chart| chart.key().text() == key)?;
                let (id, now) = (TransitionId(transition), self.moment.view.now);
                let why = self.tape.explain_transition_until(chart, id, self.moment.count, now)?;
                return Some(
                    json!({"type": "why transition", "key": key, "transition": transition, "why": why}),
                );
            }
            ViewerRequest::Step { key, is_backward } => {
                self.hold_at(self.tape.step_from(self.moment.count, &key, is_backward));
            }
            ViewerRequest::Jump { key, transition, is_backward } => {
                self.hold_at(self.tape.firing_from(self.moment.count, &key, transition, is_backward));
            }
        }
        None
    }

    fn frame(&mut self, elapsed: Duration) -> Option<Value> {
        self.play(elapsed);
        let now = self.moment.view.now;
        if self.is_elsewhere || self.tables.is_none_or(|tables| now.abs_diff(tables) >= TABLE_INTERVAL) {
            self.moment.set_tables(&self.tape);
            self.tables = Some(now);
        }
        if self.is_elsewhere {
            self.cursor = ViewCursor::default();
        }
        let (sample, images, values) = (self.sample(), self.images(elapsed), self.chart_values());
        let is_elsewhere = self.is_elsewhere;
        let beside = self.other.as_mut().and_then(|other| {
            let has_jumped = other.go_to(now) || is_elsewhere;
            other.frame(has_jumped)
        });
        let frame = self.moment.view.frame(&mut self.cursor, self.tape.scene());
        let has_news =
            frame.is_some() || sample.is_some() || images.is_some() || values.is_some() || beside.is_some();
        if !has_news && !self.is_new {
            return None;
        }
        let mut frame = frame.unwrap_or_else(|| json!({"type": "frame", "now": seconds(now)}));
        if let Some(sample) = sample {
            frame["sample"] = sample;
        }
        if let Some(images) = images {
            frame["camera"] = images;
        }
        if let Some(values) = values {
            frame["values"] = values;
        }
        if let Some(beside) = beside {
            frame["beside"] = beside;
        }
        if std::mem::take(&mut self.is_elsewhere) {
            frame["elsewhere"] = json!(true);
        }
        if std::mem::take(&mut self.is_new) || frame.get("run").is_some() {
            frame["tape"] = json!({"begin": seconds(self.tape.begin()), "end": seconds(self.tape.end()),
                "factor": self.factor, "events": self.events});
        }
        Some(frame)
    }
}
