//! A run on this computer, seen through its control socket.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use monas::records::{AgentEntry, ChartChoice, Inquiry, Reply};
use monas_link::control::messages::{Seen, TopicEntry};
use monas_link::control::{ControlClient, WatchStream};
use prost::Message;
use serde_json::{Value, json};

use crate::chart_values;
use crate::chart_view::{ChartKey, seconds};
use crate::error::{Error, ErrorKind};
use crate::live_session::LiveSession;
use crate::live_state::LiveState;
use crate::pace::Pace;
use crate::run_ring::RunRing;
use crate::run_view::{CHART_TOPIC, LOG_TOPIC, Link, MODEL_TOPIC, ViewedMessage};
use crate::scene::{Scene, SceneEvent};
use crate::source::{Session, Source};
use crate::time::now;

/// The longest wait for a message before other work is done.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// The most messages that are taken at once.
const MAX_MESSAGES: usize = 2048;

/// The interval between updates of agents and topics.
const TABLE_INTERVAL: Duration = Duration::from_secs(1);

/// The interval between updates of the chart values that are being viewed.
const VALUE_INTERVAL: Duration = Duration::from_millis(33);

/// The interval between two attempts to connect.
const RETRY_INTERVAL: Duration = Duration::from_millis(500);

/// A connection to a run, which is renewed when the run is started again.
pub(crate) struct LiveRun {
    state: Arc<LiveState>,
    /// Dropped to end the thread.
    ends: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl LiveRun {
    /// Connects to the run whose control socket is at a path; viewers may change it if
    /// `allows_control`.
    pub(crate) fn new(
        socket: &Path,
        scene: Option<Arc<dyn Scene>>,
        pace: Option<Pace>,
        allows_control: bool,
    ) -> Result<LiveRun, Error> {
        let state = Arc::new(LiveState::new(socket.to_owned(), scene, pace, allows_control));
        let collector = state.clone();
        let (ends, ended) = mpsc::channel();
        let thread =
            thread::Builder::new().name("studio run".into()).spawn(move || collector.collect(&ended));
        let thread = thread.map_err(|error| Error::new(ErrorKind::System, error))?;
        Ok(LiveRun { state, ends: Some(ends), thread: Some(thread) })
    }
}

impl Drop for LiveRun {
    fn drop(&mut self) {
        self.ends = None;
        // A thread that panicked has reported it.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Source for LiveRun {
    fn open(&self) -> Box<dyn Session> {
        Box::new(LiveSession::new(self.state.clone()))
    }

    fn allows_control(&self) -> bool {
        self.state.allows_control
    }

    fn live_state(&self) -> Option<Arc<LiveState>> {
        Some(self.state.clone())
    }
}

impl LiveState {
    /// Follows the run, and the next one with its name, until the studio ends.
    fn collect(&self, ended: &Receiver<()>) {
        loop {
            if let Err(error) = self.follow(ended) {
                self.view().link = Link::Lost(error.to_string());
            }
            if ended.recv_timeout(RETRY_INTERVAL) == Err(RecvTimeoutError::Disconnected) {
                break;
            }
        }
    }

    /// Follows a run until it ends.
    fn follow(&self, ended: &Receiver<()>) -> Result<(), monas_link::Error> {
        let mut client = ControlClient::connect(&self.socket)?;
        let run = client.describe()?;
        let mut patterns = vec![CHART_TOPIC, MODEL_TOPIC, LOG_TOPIC];
        let of_scene = self.scene.iter().flat_map(|scene| scene.topics().iter().chain(scene.event_topics()));
        patterns.extend(of_scene);
        let mut watch = ControlClient::connect(&self.socket)?.watch_all("", &patterns, true)?;
        {
            let mut view = self.view();
            view.begin();
            view.link = Link::Live;
            (view.name, view.process, view.is_simulated) = (run.name, run.process, run.simulated);
            (view.hosts, view.now) = (run.hosts, run.now);
            *self.ring() = RunRing::default();
        }
        let mut requests = RunRequests { client, sequences: BTreeMap::new(), last: 0 };
        let mut events = EventLog::default();
        let mut lost = 0;
        let (mut due, mut values_due) = (now(), now());
        while ended.try_recv() == Err(TryRecvError::Empty) {
            let seen = next_batch(&mut watch)?;
            self.learn_schemas(&seen, &mut requests.client)?;
            lost = self.take(&seen, &mut events, lost);
            if now() >= due {
                self.look_after(&mut requests, &mut events)?;
                due = now() + TABLE_INTERVAL;
            }
            if now() >= values_due {
                self.look_at_values(&mut requests)?;
                values_due = now() + VALUE_INTERVAL;
            }
        }
        Ok(())
    }

    fn is_of_scene(&self, topic: &str) -> bool {
        self.scene.as_ref().is_some_and(|scene| scene.topics().contains(&topic))
    }

    fn learn_schemas(&self, seen: &[Seen], client: &mut ControlClient) -> Result<(), monas_link::Error> {
        for seen in seen.iter().filter(|seen| self.is_of_scene(&seen.path)) {
            self.learn_schema(&seen.path, client)?;
        }
        Ok(())
    }

    fn learn_schema(&self, topic: &str, client: &mut ControlClient) -> Result<(), monas_link::Error> {
        if !self.view().decoder.knows(topic) {
            let schema = client.schema(topic)?;
            self.view().decoder.learn(topic, &schema.r#type, &schema.descriptors);
        }
        Ok(())
    }

    /// Takes messages. Returns how many were lost so far.
    fn take(&self, batch: &[Seen], events: &mut EventLog, lost: u64) -> u64 {
        let Some(last) = batch.last() else { return lost };
        let mut view = self.view();
        let mut ring = self.ring();
        for seen in batch {
            let message = ViewedMessage {
                host: &seen.from,
                topic: &seen.path,
                publisher: &seen.publisher,
                time: seen.local,
                bytes: &seen.payload,
            };
            let is_of_scene = self.is_of_scene(&seen.path);
            if is_of_scene || [CHART_TOPIC, MODEL_TOPIC, LOG_TOPIC].contains(&seen.path.as_str()) {
                view.take(&message, is_of_scene);
                ring.push(&message, is_of_scene);
            }
            if let Some(event) = self.scene.as_ref().and_then(|scene| events.event(&**scene, &message)) {
                ring.note(message.time, &event);
            }
        }
        view.now = view.now.max(last.now);
        ring.keep(&view);
        let all_lost = batch.iter().map(|seen| seen.lost).max().unwrap_or(lost).max(lost);
        if all_lost > lost {
            view.mark_stale();
        }
        all_lost
    }

    /// Requests the values of the charts that are being viewed.
    fn look_at_values(&self, requests: &mut RunRequests) -> Result<(), monas_link::Error> {
        for chart in self.watched_charts.all() {
            // An agent that has just ended has no values.
            let Ok(state) = requests.chart(&chart.key, true) else { continue };
            let Ok(values) = serde_json::from_str::<Value>(&state.values) else { continue };
            for topic in chart_values::topics(&values) {
                self.learn_schema(topic, &mut requests.client)?;
            }
            chart.set(chart_values::shown(&chart.key, &values, &self.view().decoder));
        }
        Ok(())
    }

    /// Requests the tables, and the charts that are not known.
    fn look_after(&self, requests: &mut RunRequests, events: &mut EventLog) -> Result<(), monas_link::Error> {
        let run = requests.client.describe()?;
        let agents = requests.agents()?;
        let topics = requests.client.topics("", "")?;
        let topics = requests.topic_objects(&topics, run.now);
        let mut missing = Vec::new();
        {
            let mut view = self.view();
            view.set_tables(&agents, topics);
            (view.now, view.alarms) = (view.now.max(run.now), run.alarms);
            let mut ring = self.ring();
            for event in events.overruns(&agents) {
                ring.note(view.now, &event);
            }
            for agent in &agents {
                for (index, chart) in agent.charts.iter().enumerate() {
                    let (host, name) = (agent.host.clone(), agent.name.clone());
                    let key = ChartKey { host, agent: name, chart: index as u32 };
                    let known = view.charts.get_mut(&key);
                    match known.filter(|known| !known.is_stale() && known.model == chart.model) {
                        Some(known) if known.state != chart.state => {
                            known.state.clone_from(&chart.state);
                            known.revision += 1;
                        }
                        Some(_) => {}
                        None => missing.push(key),
                    }
                }
            }
        }
        for key in missing {
            // An agent that has just ended has no chart; the next update has the present ones.
            if let Ok(state) = requests.chart(&key, false) {
                self.view().load_chart(key, &state);
            }
        }
        // Before, the active states of charts are not known.
        let view = self.view();
        let mut ring = self.ring();
        if !ring.has_begun() {
            ring.begin(&view);
        }
        Ok(())
    }
}

/// The last event of each channel, and the overruns of each agent.
#[derive(Default)]
struct EventLog {
    last: BTreeMap<(String, String), Option<SceneEvent>>,
    overruns: BTreeMap<(String, String), u64>,
}

impl EventLog {
    /// The event that a message represents, unless it continues the previous event.
    fn event(&mut self, scene: &dyn Scene, message: &ViewedMessage<'_>) -> Option<SceneEvent> {
        if !scene.event_topics().contains(&message.topic) {
            return None;
        }
        let event = scene.event(message.host, message.topic, message.bytes);
        let key = (message.host.to_owned(), message.topic.to_owned());
        let before = self.last.insert(key, event.clone()).flatten();
        event.filter(|event| !event.lasts || before.as_ref() != Some(event))
    }

    /// The agents that have had overruns since the last call.
    fn overruns(&mut self, agents: &[AgentEntry]) -> Vec<SceneEvent> {
        let mut events = Vec::new();
        for AgentEntry { host, name, overruns, .. } in agents {
            let before = self.overruns.insert((host.clone(), name.clone()), *overruns);
            if let Some(before) = before.filter(|before| before < overruns) {
                let text = format!("{host} {name} overran its period {} times", overruns - before);
                events.push(SceneEvent { kind: "overrun".into(), text, lasts: false });
            }
        }
        events
    }
}

/// The next messages, at most one batch.
fn next_batch(watch: &mut WatchStream) -> Result<Vec<Seen>, monas_link::Error> {
    let mut batch = Vec::new();
    let mut timeout = CHECK_INTERVAL;
    while let Some(seen) = watch.wait(timeout)? {
        batch.push(seen);
        if batch.len() == MAX_MESSAGES {
            break;
        }
        timeout = Duration::ZERO;
    }
    Ok(batch)
}

/// Requests to a run.
struct RunRequests {
    client: ControlClient,
    /// By host and topic: the number of the last message.
    sequences: BTreeMap<(String, String), u64>,
    /// When they were read.
    last: u64,
}

impl RunRequests {
    fn reply(&mut self, inquiry: &Inquiry) -> Result<Reply, monas_link::Error> {
        let reply = self.client.manage(inquiry.encode_to_vec())?;
        Ok(Reply::decode(reply.as_slice()).unwrap_or_default())
    }

    fn agents(&mut self) -> Result<Vec<AgentEntry>, monas_link::Error> {
        let reply = self.reply(&Inquiry { agents: true, ..Inquiry::default() })?;
        Ok(reply.agents.map(|agents| agents.agents).unwrap_or_default())
    }

    /// The state of a chart, or its values alone.
    fn chart(
        &mut self,
        key: &ChartKey,
        values: bool,
    ) -> Result<monas::records::ChartState, monas_link::Error> {
        let choice = ChartChoice { agent: key.agent.clone(), chart: (key.chart + 1).to_string(), values };
        let host = key.host.clone();
        let reply = self.reply(&Inquiry { host, chart: Some(choice), ..Inquiry::default() })?;
        Ok(reply.chart.unwrap_or_default())
    }

    /// The topics with their rates since the last call, in messages per second of the run.
    fn topic_objects(&mut self, topics: &[TopicEntry], now: u64) -> Value {
        let span = seconds(now.saturating_sub(self.last));
        let is_first = self.last == 0;
        self.last = now;
        let mut objects = Vec::new();
        for topic in topics {
            let name = (topic.host.clone(), topic.path.clone());
            let sequence = topic.last.as_ref().map_or(0, |last| last.sequence);
            let before = self.sequences.insert(name, sequence);
            let rate = before.filter(|_| !is_first && span > 0.0);
            let rate = rate.map(|before| sequence.saturating_sub(before) as f64 / span);
            let last = topic.last.as_ref();
            objects.push(
                json!({"host": topic.host, "path": topic.path, "kind": topic.kind, "type": topic.r#type,
                "count": sequence, "rate": rate, "publisher": last.map(|last| &last.publisher),
                "t": last.map(|last| seconds(last.published))}),
            );
        }
        Value::Array(objects)
    }
}
