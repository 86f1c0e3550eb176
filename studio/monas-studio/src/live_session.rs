//! A viewer of a run on this computer, at the present moment or an earlier one.

use std::sync::Arc;
use std::time::Duration;

use monas::records::Chart;
use monas_link::control::{ControlClient, WatchStream};
use serde_json::{Value, json};

use crate::cameras::{self, ChosenCamera};
use crate::chart_values::ChartValues;
use crate::chart_view::seconds;
use crate::control_request::ControlRequest;
use crate::live_state::LiveState;
use crate::pace::Pace;
use crate::run_control;
use crate::run_view::{RunView, ViewCursor};
use crate::source::Session;
use crate::viewer_request::ViewerRequest;

/// The fastest playback of the past.
const MAX_SPEED: f64 = 1000.0;

/// A second in nanoseconds: the timeline grows in seconds.
const SECOND: u64 = 1_000_000_000;

/// The most messages of a watched topic that are skipped for the newest.
const MAX_SKIPPED: usize = 4096;

/// A viewer of a run.
pub(crate) struct LiveSession {
    state: Arc<LiveState>,
    cursor: ViewCursor,
    /// The pace that was last sent to the viewer.
    pace: Option<f64>,
    watched: Option<WatchedTopic>,
    /// The robot whose images are viewed, and their topic.
    camera: Option<(ChosenCamera, WatchedTopic)>,
    /// The chart whose values are viewed, and the revision that the viewer has.
    values: Option<(Arc<ChartValues>, u64)>,
    /// The moment that is viewed, if it is not the present one.
    past: Option<PastMoment>,
    /// Whether the viewer has to discard its state, because the moment has moved backwards.
    is_elsewhere: bool,
    /// The part of the ring that the viewer has: its events, its end in seconds.
    ring: Option<(u64, u64)>,
}

/// A past moment of a run in progress.
struct PastMoment {
    view: RunView,
    /// The number of the messages that it has.
    number: u64,
    /// The playback speed: played seconds per second; 0 while it is held.
    factor: f64,
}

/// The topic whose messages a viewer sees.
struct WatchedTopic {
    stream: WatchStream,
    /// The epoch of the run.
    epoch: u64,
    host: String,
    topic: String,
    count: u64,
}

impl Session for LiveSession {
    fn handle(&mut self, request: ViewerRequest) -> Option<Value> {
        match request {
            ViewerRequest::Picture { key, .. } => {
                let view = self.state.view();
                Some(json!({"type": "picture", "key": key, "picture": view.picture(&key)}))
            }
            ViewerRequest::Watch { host, topic } => {
                self.watched = None;
                match self.watch(&host, &topic) {
                    Ok(watched) => {
                        self.watched = Some(watched);
                        None
                    }
                    Err(error) => Some(
                        json!({"type": "refused", "host": host, "topic": topic, "reason": error.to_string()}),
                    ),
                }
            }
            ViewerRequest::Unwatch => {
                self.watched = None;
                None
            }
            ViewerRequest::Camera(host) => {
                self.camera = host.and_then(|host| self.watch_camera(host));
                None
            }
            ViewerRequest::Values(key) => {
                let chart =
                    key.and_then(|key| self.state.view().charts.keys().find(|it| it.text() == key).cloned());
                self.values = chart.map(|key| (self.state.watched_charts.watch(key), 0));
                None
            }
            ViewerRequest::Pace(factor) => {
                if let Some(past) = &mut self.past {
                    past.factor = factor.min(MAX_SPEED);
                    self.ring = None;
                } else if let Some(pace) = &self.state.pace {
                    pace.set(factor);
                }
                None
            }
            ViewerRequest::Seek(time) => {
                let time = (time * 1e9) as u64;
                let number = self.state.ring().number_until(time);
                self.go_to(number, time);
                None
            }
            ViewerRequest::Step { key, is_backward } => self.step(&key, is_backward, |_| true),
            ViewerRequest::Jump { key, transition, is_backward } => self.step(&key, is_backward, |step| {
                step.selected.contains(&transition) || step.taken.contains(&transition)
            }),
            ViewerRequest::Live => {
                self.go_live();
                None
            }
            ViewerRequest::Control(id, request) => Some(self.control(id, request)),
            ViewerRequest::Why { .. } | ViewerRequest::WhyTransition { .. } | ViewerRequest::Model(..) => {
                None
            }
        }
    }

    fn frame(&mut self, elapsed: Duration) -> Option<Value> {
        self.play(elapsed);
        let (sample, images, values) = (self.sample(), self.images(elapsed), self.chart_values());
        let pace = self.state.pace.as_ref().map(Pace::factor);
        let is_elsewhere = std::mem::take(&mut self.is_elsewhere);
        if is_elsewhere {
            self.cursor = ViewCursor::default();
        }
        let scene = self.state.scene.clone();
        let (frame, now) = match &mut self.past {
            Some(past) => {
                past.view.link = self.state.view().link.clone();
                (past.view.frame(&mut self.cursor, scene.as_deref()), past.view.now)
            }
            None => {
                let mut view = self.state.view();
                (view.frame(&mut self.cursor, scene.as_deref()), view.now)
            }
        };
        let is_new = frame.as_ref().is_some_and(|frame| frame.get("run").is_some());
        let facts = self.facts(is_new);
        let has_news =
            frame.is_some() || sample.is_some() || images.is_some() || values.is_some() || facts.is_some();
        if !has_news && pace == self.pace {
            return None;
        }
        let mut frame = frame.unwrap_or_else(|| json!({"type": "frame", "now": seconds(now)}));
        if is_new {
            frame["run"]["control"] = json!(self.state.allows_control);
        }
        if let Some(sample) = sample {
            frame["sample"] = sample;
        }
        if let Some(images) = images {
            frame["camera"] = images;
        }
        if let Some(values) = values {
            frame["values"] = values;
        }
        if let Some(facts) = facts {
            frame["tape"] = facts;
        }
        if is_elsewhere {
            frame["elsewhere"] = json!(true);
        }
        if pace != self.pace || frame.get("run").is_some() {
            self.pace = pace;
            // null for a run whose pace is its own; JSON has no infinity
            frame["pace"] =
                json!({"is_set_here": pace.is_some(), "factor": pace.filter(|pace| pace.is_finite())});
        }
        Some(frame)
    }
}

impl LiveSession {
    pub(crate) fn new(state: Arc<LiveState>) -> LiveSession {
        LiveSession {
            state,
            cursor: ViewCursor::default(),
            pace: None,
            watched: None,
            camera: None,
            values: None,
            past: None,
            is_elsewhere: false,
            ring: None,
        }
    }

    /// Changes the run, if viewers may; the reply has the number of the request.
    fn control(&self, id: Option<u64>, request: Result<ControlRequest, String>) -> Value {
        let mut reply = match request {
            _ if !self.state.allows_control => {
                json!({"done": false, "reason": "the studio was started without --allow-control: it only looks"})
            }
            Ok(request) => run_control::execute(&self.state, request),
            Err(reason) => json!({"done": false, "reason": format!("the request cannot be read: {reason}")}),
        };
        (reply["type"], reply["id"]) = (json!("reply"), json!(id));
        reply
    }

    /// The data of the timeline, if the viewer does not have them.
    fn facts(&mut self, is_new: bool) -> Option<Value> {
        let now = self.state.view().now;
        let ring = self.state.ring();
        let known = Some((ring.event_count, now / SECOND));
        if !ring.has_begun() || (self.ring == known && !is_new) {
            return None;
        }
        self.ring = known;
        let factor = self.past.as_ref().map(|past| past.factor);
        Some(
            json!({"begin": seconds(ring.begin_time()), "end": seconds(now), "factor": factor.unwrap_or(1.0),
            "events": ring.events(), "live": factor.is_none()}),
        )
    }

    /// The values of the chosen chart, if the viewer does not have them. They are those of the
    /// present moment only.
    fn chart_values(&mut self) -> Option<Value> {
        let (chart, revision) = self.values.as_mut().filter(|_| self.past.is_none())?;
        let latest = chart.latest();
        (latest.revision != *revision).then(|| {
            *revision = latest.revision;
            Value::clone(&latest.values)
        })
    }

    /// Seeks a moment of the run, or the present one.
    fn go_to(&mut self, number: u64, time: u64) {
        let (now, ring) = (self.state.view().now, self.state.ring());
        let time = time.max(ring.begin_time());
        let number = number.max(ring.number_until(ring.begin_time()));
        if !ring.has_begun() || time >= now {
            drop(ring);
            self.go_live();
        } else if let Some(view) = ring.moment(number, time) {
            drop(ring);
            self.past = Some(PastMoment { view, number, factor: 0.0 });
            (self.is_elsewhere, self.ring) = (true, None);
        }
    }

    fn go_live(&mut self) {
        self.is_elsewhere |= self.past.take().is_some();
        self.ring = None;
    }

    /// Seeks another step of a chart.
    fn step(&mut self, key: &str, is_backward: bool, is_wanted: impl Fn(&Chart) -> bool) -> Option<Value> {
        let ring = self.state.ring();
        let number = self.past.as_ref().map_or(ring.end(), |past| past.number);
        let found = ring.step_from(number, key, is_backward, is_wanted);
        drop(ring);
        if let Some((number, time)) = found {
            self.go_to(number, time);
        }
        None
    }

    /// Plays a past moment; at the present one it is live again.
    fn play(&mut self, elapsed: Duration) {
        let (now, epoch) = {
            let view = self.state.view();
            (view.now, view.epoch)
        };
        let Some(past) = self.past.as_mut() else { return };
        let time = past.view.now.saturating_add((elapsed.as_secs_f64() * past.factor * 1e9) as u64);
        if past.view.epoch != epoch || time >= now {
            return self.go_live();
        }
        if past.factor == 0.0 {
            return;
        }
        let ring = self.state.ring();
        let number = ring.number_until(time).max(past.number);
        if ring.advance(&mut past.view, past.number, number, time) {
            past.number = number;
        } else {
            // It is no longer kept.
            let begin = ring.begin_time();
            drop(ring);
            self.go_to(number, begin);
        }
    }

    fn watch(&self, host: &str, topic: &str) -> Result<WatchedTopic, monas_link::Error> {
        let mut client = ControlClient::connect(&self.state.socket)?;
        if !self.state.view().decoder.knows(topic) {
            let schema = client.schema(topic)?;
            self.state.view().decoder.learn(topic, &schema.r#type, &schema.descriptors);
        }
        let stream = client.watch(host, topic, true)?;
        let epoch = self.state.view().epoch;
        Ok(WatchedTopic { stream, epoch, host: host.into(), topic: topic.into(), count: 0 })
    }

    /// Watches the images of a host; none if they cannot be watched.
    fn watch_camera(&self, host: String) -> Option<(ChosenCamera, WatchedTopic)> {
        let topic = cameras::of(self.state.scene.as_deref())?.topic();
        let watched = self.watch(&host, topic).ok()?;
        Some((ChosenCamera::new(host), watched))
    }

    /// The newest images, if they are due and there are new ones. Images of a past moment are not
    /// kept.
    fn images(&mut self, elapsed: Duration) -> Option<Value> {
        let (camera, watched) = self.camera.as_mut()?;
        let is_due = camera.is_due(elapsed);
        let mut newest = None;
        for _ in 0..MAX_SKIPPED {
            match watched.stream.wait(Duration::ZERO) {
                Ok(Some(seen)) => newest = Some(seen),
                Ok(None) => break,
                Err(_) => {
                    // The run has ended or begun anew, which the page shows.
                    self.camera = None;
                    return None;
                }
            }
        }
        let seen = newest.filter(|_| is_due && self.past.is_none())?;
        let scene = self.state.scene.clone();
        Some(camera.object(cameras::of(scene.as_deref())?, seen.local, &seen.payload))
    }

    /// The newest message of the watched topic, if there is a new one.
    fn sample(&mut self) -> Option<Value> {
        let watched = self.watched.as_mut()?;
        let mut newest = None;
        for _ in 0..MAX_SKIPPED {
            match watched.stream.wait(Duration::ZERO) {
                Ok(Some(seen)) => {
                    watched.count += 1;
                    newest = Some(seen);
                }
                Ok(None) => break,
                Err(error) => {
                    let reason = error.to_string();
                    let (host, topic) = (watched.host.clone(), watched.topic.clone());
                    self.watched = None;
                    return Some(json!({"host": host, "topic": topic, "reason": reason}));
                }
            }
        }
        let seen = newest?;
        let (count, epoch) = (watched.count, watched.epoch);
        let view = self.state.view();
        if view.epoch != epoch {
            return None;
        }
        let message = view.decoder.decode(&seen.path, &seen.payload);
        Some(json!({"host": seen.host, "from": seen.from, "topic": seen.path, "publisher": seen.publisher,
            "sequence": seen.sequence, "t": seconds(seen.local), "size": seen.size, "count": count,
            "message": message}))
    }
}
