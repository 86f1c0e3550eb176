//! The state of a run at one time, and the changes that a viewer has not seen yet.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use monas::records::{self, AgentEntry, ChartState, Model, foxglove::Log};
use prost::Message;
use serde_json::{Value, json};

use crate::cameras::{self, Cameras};
use crate::chart_view::{ChartKey, ChartView, seconds};
use crate::message_decoder::MessageDecoder;
use crate::scene::{Scene, ScenePicture};

/// The number of log lines that are kept.
const KEPT_LINES: usize = 500;

/// The topics of records.
pub(crate) const CHART_TOPIC: &str = "monas/chart";
pub(crate) const CYCLE_TOPIC: &str = "monas/cycle";
pub(crate) const MODEL_TOPIC: &str = "monas/model";
pub(crate) const LOG_TOPIC: &str = "monas/log";

/// A message, from a run or a tape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ViewedMessage<'a> {
    /// The host on which it was published.
    pub(crate) host: &'a str,
    pub(crate) topic: &'a str,
    pub(crate) publisher: &'a str,
    /// Nanoseconds.
    pub(crate) time: u64,
    pub(crate) bytes: &'a [u8],
}

/// The newest message of a topic of a host.
#[derive(Clone, Debug)]
struct Latest {
    bytes: Vec<u8>,
    /// Decoded on demand.
    value: Option<Value>,
}

/// Whether a run can be reached.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub(crate) enum Link {
    #[default]
    Connecting,
    Live,
    /// It has ended or cannot be reached: the reason.
    Lost(String),
    /// A recording.
    Tape,
}

/// The state of a run.
#[derive(Clone, Default, Debug)]
pub(crate) struct RunView {
    /// Counts connections: when it changes, a viewer discards its state.
    pub(crate) epoch: u64,
    pub(crate) link: Link,
    pub(crate) name: String,
    pub(crate) process: u32,
    pub(crate) is_simulated: bool,
    pub(crate) hosts: Vec<String>,
    pub(crate) now: u64,
    pub(crate) alarms: Vec<String>,
    pub(crate) decoder: MessageDecoder,
    pub(crate) charts: BTreeMap<ChartKey, ChartView>,
    /// The names of events by chart.
    events: BTreeMap<ChartKey, Vec<String>>,
    latest: BTreeMap<(String, String), Latest>,
    /// Counts messages of the scene.
    scene_revision: u64,
    lines: VecDeque<Arc<Value>>,
    line_count: u64,
    agents: Value,
    topics: Value,
    table_revision: u64,
}

/// The changes that a viewer has seen.
#[derive(Clone, Default, Debug)]
pub(crate) struct ViewCursor {
    epoch: Option<u64>,
    link: Link,
    now: u64,
    scene: u64,
    ground: Option<Value>,
    /// The actions of the scene.
    actions: Option<Value>,
    table: u64,
    line: u64,
    /// By chart: its revision, and its steps.
    charts: BTreeMap<ChartKey, (u64, u64)>,
    alarms: Vec<String>,
}

impl RunView {
    /// Begins a new connection: discards the state of the previous one.
    pub(crate) fn begin(&mut self) {
        *self = RunView { epoch: self.epoch + 1, ..RunView::default() };
    }

    /// Applies a message of a watched topic.
    pub(crate) fn take(&mut self, message: &ViewedMessage<'_>, is_of_scene: bool) {
        match message.topic {
            CHART_TOPIC => self.take_step(message),
            MODEL_TOPIC => {
                if let Ok(model) = Model::decode(message.bytes) {
                    let key = key(message, model.chart);
                    // The chart may have been replaced: its shapes are requested again.
                    if let Some(view) = self.charts.get_mut(&key) {
                        view.mark_stale();
                    }
                    self.events.insert(key, model.events);
                }
            }
            LOG_TOPIC => self.take_line(message),
            _ => {}
        }
        if is_of_scene {
            let name = (message.host.to_owned(), message.topic.to_owned());
            self.latest.insert(name, Latest { bytes: message.bytes.to_vec(), value: None });
            self.scene_revision += 1;
        }
    }

    fn take_step(&mut self, message: &ViewedMessage<'_>) {
        let Ok(step) = records::Chart::decode(message.bytes) else { return };
        let key = key(message, step.chart);
        let event = step.event.checked_sub(1).and_then(|event| {
            let names = self.events.get(&key)?;
            names.get(event as usize).cloned()
        });
        self.charts.entry(key).or_default().step(message.time, &step, event.as_deref());
    }

    fn take_line(&mut self, message: &ViewedMessage<'_>) {
        let Ok(log) = Log::decode(message.bytes) else { return };
        if self.lines.len() == KEPT_LINES {
            self.lines.pop_front();
        }
        let level = log.level().as_str_name().to_lowercase();
        let line = json!({"number": self.line_count, "t": seconds(message.time), "host": message.host,
            "level": level, "name": log.name, "text": log.message});
        self.lines.push_back(Arc::new(line));
        self.line_count += 1;
    }

    /// Applies the state of a chart.
    pub(crate) fn load_chart(&mut self, key: ChartKey, state: &ChartState) {
        self.charts.entry(key).or_default().load(state);
    }

    /// Takes the shapes of a chart, and the states that are active in them.
    pub(crate) fn show_chart(&mut self, key: ChartKey, model: &str, picture: &str) {
        let view = self.charts.entry(key).or_default();
        model.clone_into(&mut view.model);
        view.show(picture);
    }

    /// Takes tables as JSON.
    pub(crate) fn set_table_objects(&mut self, agents: Value, topics: Value) {
        (self.agents, self.topics) = (agents, topics);
        self.table_revision += 1;
    }

    /// The state without its tables, and the tables as JSON text, which takes a small part of
    /// their memory.
    pub(crate) fn compact(&self) -> (RunView, Box<str>) {
        let tables = json!([self.agents, self.topics]).to_string().into_boxed_str();
        let mut view = RunView { agents: Value::Null, topics: Value::Null, ..self.clone() };
        // Messages are decoded again when they are shown.
        view.latest.values_mut().for_each(|latest| latest.value = None);
        (view, tables)
    }

    /// Takes the tables of [`compact`](RunView::compact) back.
    pub(crate) fn restore_tables(&mut self, tables: &str) {
        if let Ok((agents, topics)) = serde_json::from_str(tables) {
            (self.agents, self.topics) = (agents, topics);
        }
    }

    /// Takes the agents, and the topics as JSON.
    pub(crate) fn set_tables(&mut self, agents: &[AgentEntry], topics: Value) {
        self.set_table_objects(agents.iter().map(agent_object).collect(), topics);
    }

    /// The update for a viewer; `None` if nothing has changed.
    pub(crate) fn frame(&mut self, cursor: &mut ViewCursor, scene: Option<&dyn Scene>) -> Option<Value> {
        let mut frame = json!({"type": "frame", "now": seconds(self.now)});
        let is_new = cursor.epoch != Some(self.epoch);
        if is_new {
            *cursor = ViewCursor { epoch: Some(self.epoch), ..ViewCursor::default() };
        }
        let mut has_news = is_new || cursor.now != self.now;
        cursor.now = self.now;
        if is_new || cursor.link != self.link {
            has_news = true;
            cursor.link = self.link.clone();
            let (link, reason) = match &self.link {
                Link::Connecting => ("connecting", ""),
                Link::Live => ("live", ""),
                Link::Lost(reason) => ("lost", reason.as_str()),
                Link::Tape => ("tape", ""),
            };
            frame["run"] = json!({"epoch": self.epoch, "link": link, "reason": reason, "name": self.name,
                "process": self.process, "simulated": self.is_simulated, "hosts": self.hosts,
                "scene": scene.is_some(), "camera_topic": cameras::of(scene).map(Cameras::topic)});
        }
        if is_new || cursor.alarms != self.alarms {
            has_news = true;
            cursor.alarms.clone_from(&self.alarms);
            frame["alarms"] = json!(self.alarms);
        }
        if cursor.table != self.table_revision {
            has_news = true;
            cursor.table = self.table_revision;
            frame["agents"] = self.agents.clone();
            frame["topics"] = self.topics.clone();
        }
        if cursor.line != self.line_count {
            has_news = true;
            let skipped = (cursor.line + self.lines.len() as u64).saturating_sub(self.line_count) as usize;
            frame["log"] = self.lines.iter().skip(skipped).map(|line| Value::clone(line)).collect();
            cursor.line = self.line_count;
        }
        let charts = self.chart_news(cursor);
        if !charts.is_empty() {
            has_news = true;
            frame["charts"] = Value::Array(charts);
        }
        if let Some(scene) = scene.filter(|_| is_new || cursor.scene != self.scene_revision) {
            has_news = true;
            cursor.scene = self.scene_revision;
            frame["scene"] = self.scene_object(cursor, scene);
        }
        has_news.then_some(frame)
    }

    fn chart_news(&self, cursor: &mut ViewCursor) -> Vec<Value> {
        let mut news = Vec::new();
        for (key, view) in &self.charts {
            let (revision, steps) = cursor.charts.get(key).copied().unwrap_or_default();
            if revision != view.revision {
                news.push(view.object(key, steps));
                cursor.charts.insert(key.clone(), (view.revision, view.count()));
            }
        }
        news
    }

    /// The scene; its ground and actions only if they have changed.
    fn scene_object(&mut self, cursor: &mut ViewCursor, scene: &dyn Scene) -> Value {
        let picture = self.scene_picture(scene);
        let ground = json!(picture.ground);
        let mut object = json!({"bodies": picture.bodies, "objects": picture.objects, "beliefs": picture.beliefs,
            "seen_lines": picture.seen_lines, "banner": picture.banner});
        if cursor.ground.as_ref() != Some(&ground) {
            object["ground"] = ground.clone();
            cursor.ground = Some(ground);
        }
        let actions = json!(picture.actions);
        if cursor.actions.as_ref() != Some(&actions) {
            object["actions"] = actions.clone();
            cursor.actions = Some(actions);
        }
        object
    }

    /// Counts messages of the scene.
    pub(crate) fn scene_revision(&self) -> u64 {
        self.scene_revision
    }

    pub(crate) fn scene_picture(&mut self, scene: &dyn Scene) -> ScenePicture {
        for ((_, topic), latest) in &mut self.latest {
            if latest.value.is_none() && self.decoder.knows(topic) {
                latest.value = Some(self.decoder.decode(topic, &latest.bytes));
            }
        }
        let latest = self.latest.iter().filter_map(|((host, topic), latest)| {
            Some(((host.as_str(), topic.as_str()), latest.value.as_ref()?))
        });
        scene.draw(&latest.collect())
    }

    /// The shapes of a chart, by the text of its key.
    pub(crate) fn picture(&self, key: &str) -> Option<&Value> {
        let (_, view) = self.charts.iter().find(|(known, _)| known.text() == key)?;
        Some(view.picture()).filter(|picture| !picture.is_null())
    }

    /// Notes that records were lost.
    pub(crate) fn mark_stale(&mut self) {
        self.charts.values_mut().for_each(ChartView::mark_stale);
    }
}

/// The publisher of a record is the agent.
fn key(message: &ViewedMessage<'_>, chart: u32) -> ChartKey {
    ChartKey { host: message.host.to_owned(), agent: message.publisher.to_owned(), chart }
}

fn agent_object(agent: &AgentEntry) -> Value {
    let times = |times: Option<&records::Times>| {
        times.map(|times| {
            json!({"count": times.count, "mean": times.mean, "deviation": times.deviation, "p50": times.p50,
                "p90": times.p90, "p99": times.p99, "longest": times.longest})
        })
    };
    let activities: Vec<Value> = agent
        .activities
        .iter()
        .map(|activity| {
            let parameters =
                activity.parameters.iter().map(|one| (one.key.clone(), one.value.clone().into()));
            json!({"name": activity.name, "state": activity.state,
                "parameters": Value::Object(parameters.collect()), "calls": activity.calls,
                "failures": activity.failures, "time": times(activity.call_time.as_ref())})
        })
        .collect();
    let charts: Vec<Value> =
        agent.charts.iter().map(|chart| json!({"model": chart.model, "state": chart.state})).collect();
    json!({"host": agent.host, "name": agent.name, "charts": charts, "state": agent.state, "reason": agent.reason,
        "frequency": agent.frequency, "cycles": agent.cycles, "overruns": agent.overruns, "missed": agent.missed,
        "steps": agent.micro_steps, "time": times(agent.cycle_time.as_ref()), "activities": activities})
}
