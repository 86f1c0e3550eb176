//! A run on this computer, seen through its control socket.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use monas::records::{AgentEntry, ChartChoice, Inquiry, Reply};
use monas_link::control::messages::{Seen, TopicEntry};
use monas_link::control::{ControlClient, WatchStream};
use prost::Message;
use serde_json::{Value, json};

use crate::chart_view::{ChartKey, seconds};
use crate::error::{Error, ErrorKind};
use crate::pace::Pace;
use crate::run_view::{CHART, LOG, Link, MODEL, RunView, ViewCursor, ViewedMessage};
use crate::scene::Scene;
use crate::source::{Session, Source};
use crate::time::now;
use crate::viewer_request::ViewerRequest;

/// The longest wait for a message before the rest is looked after.
const LOOK: Duration = Duration::from_millis(20);

/// The most messages that are taken at once.
const BATCH: usize = 2048;

/// The interval between two looks at agents and topics.
const TABLES: Duration = Duration::from_secs(1);

/// The interval between two attempts to connect.
const RETRY: Duration = Duration::from_millis(500);

/// The most messages of a watched topic that are skipped for the newest.
const SKIPPED: usize = 4096;

/// A connection to a run, which is renewed when the run is started again.
pub(crate) struct LiveRun {
    state: Arc<LiveState>,
    /// Dropped to end the thread.
    ends: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

struct LiveState {
    socket: PathBuf,
    scene: Option<Arc<dyn Scene>>,
    pace: Option<Pace>,
    view: Mutex<RunView>,
}

impl LiveRun {
    /// Connects to the run whose control socket is at a path.
    pub(crate) fn new(
        socket: &Path,
        scene: Option<Arc<dyn Scene>>,
        pace: Option<Pace>,
    ) -> Result<LiveRun, Error> {
        let (socket, view) = (socket.to_owned(), Mutex::default());
        let state = Arc::new(LiveState { socket, scene, pace, view });
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
        let state = self.state.clone();
        Box::new(LiveSession { state, cursor: ViewCursor::default(), pace: None, watched: None })
    }
}

impl LiveState {
    fn view(&self) -> MutexGuard<'_, RunView> {
        self.view.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Follows the run, and the next one with its name, until the studio ends.
    fn collect(&self, ended: &Receiver<()>) {
        loop {
            if let Err(error) = self.follow(ended) {
                self.view().link = Link::Lost(error.to_string());
            }
            if ended.recv_timeout(RETRY) == Err(RecvTimeoutError::Disconnected) {
                break;
            }
        }
    }

    /// Follows a run until it ends.
    fn follow(&self, ended: &Receiver<()>) -> Result<(), monas_link::Error> {
        let mut client = ControlClient::connect(&self.socket)?;
        let run = client.describe()?;
        let mut patterns = vec![CHART, MODEL, LOG];
        patterns.extend(self.scene.iter().flat_map(|scene| scene.topics()));
        let mut watch = ControlClient::connect(&self.socket)?.watch_all("", &patterns, true)?;
        {
            let mut view = self.view();
            view.begin();
            view.link = Link::Live;
            (view.name, view.process, view.is_simulated) = (run.name, run.process, run.simulated);
            (view.hosts, view.now) = (run.hosts, run.now);
        }
        let mut requests = RunRequests { client, sequences: BTreeMap::new(), last: 0 };
        let mut lost = 0;
        let mut due = now();
        while ended.try_recv() == Err(TryRecvError::Empty) {
            let seen = next_batch(&mut watch)?;
            self.learn_schemas(&seen, &mut requests.client)?;
            lost = self.take(&seen, lost);
            if now() >= due {
                self.look_after(&mut requests)?;
                due = now() + TABLES;
            }
        }
        Ok(())
    }

    fn is_of_scene(&self, topic: &str) -> bool {
        self.scene.as_ref().is_some_and(|scene| scene.topics().contains(&topic))
    }

    fn learn_schemas(&self, seen: &[Seen], client: &mut ControlClient) -> Result<(), monas_link::Error> {
        for seen in seen.iter().filter(|seen| self.is_of_scene(&seen.path)) {
            if !self.view().decoder.knows(&seen.path) {
                let schema = client.schema(&seen.path)?;
                self.view().decoder.learn(&seen.path, &schema.r#type, &schema.descriptors);
            }
        }
        Ok(())
    }

    /// Takes messages. Returns how many were lost so far.
    fn take(&self, batch: &[Seen], lost: u64) -> u64 {
        let Some(last) = batch.last() else { return lost };
        let mut view = self.view();
        for seen in batch {
            let message = ViewedMessage {
                host: &seen.from,
                topic: &seen.path,
                publisher: &seen.publisher,
                time: seen.local,
                bytes: &seen.payload,
            };
            view.take(&message, self.is_of_scene(&seen.path));
        }
        view.now = view.now.max(last.now);
        let all_lost = batch.iter().map(|seen| seen.lost).max().unwrap_or(lost).max(lost);
        if all_lost > lost {
            view.mark_stale();
        }
        all_lost
    }

    /// Asks for the tables, and for charts that are not known.
    fn look_after(&self, requests: &mut RunRequests) -> Result<(), monas_link::Error> {
        let run = requests.client.describe()?;
        let agents = requests.agents()?;
        let topics = requests.client.topics("", "")?;
        let topics = requests.topic_objects(&topics, run.now);
        let mut missing = Vec::new();
        {
            let mut view = self.view();
            view.set_tables(&agents, topics);
            (view.now, view.alarms) = (view.now.max(run.now), run.alarms);
            for agent in &agents {
                for (place, chart) in agent.charts.iter().enumerate() {
                    let (host, name) = (agent.host.clone(), agent.name.clone());
                    let key = ChartKey { host, agent: name, chart: place as u32 };
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
            // An agent that has just ended has no chart; the next look finds what is there.
            if let Ok(state) = requests.chart(&key) {
                self.view().load_chart(key, &state);
            }
        }
        Ok(())
    }
}

/// The next messages, at most one batch.
fn next_batch(watch: &mut WatchStream) -> Result<Vec<Seen>, monas_link::Error> {
    let mut batch = Vec::new();
    let mut patience = LOOK;
    while let Some(seen) = watch.wait(patience)? {
        batch.push(seen);
        if batch.len() == BATCH {
            break;
        }
        patience = Duration::ZERO;
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

    fn chart(&mut self, key: &ChartKey) -> Result<monas::records::ChartState, monas_link::Error> {
        let choice = ChartChoice { agent: key.agent.clone(), chart: (key.chart + 1).to_string() };
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

/// A viewer of a run.
struct LiveSession {
    state: Arc<LiveState>,
    cursor: ViewCursor,
    /// The pace that the viewer knows.
    pace: Option<f64>,
    watched: Option<WatchedTopic>,
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
            ViewerRequest::Picture(key) => {
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
            ViewerRequest::Pace(factor) => {
                if let Some(pace) = &self.state.pace {
                    pace.set(factor);
                }
                None
            }
            ViewerRequest::Seek(_) | ViewerRequest::Step { .. } | ViewerRequest::Why { .. } => None,
        }
    }

    fn frame(&mut self, _: Duration) -> Option<Value> {
        let sample = self.sample();
        let pace = self.state.pace.as_ref().map(Pace::factor);
        let mut view = self.state.view();
        let frame = view.frame(&mut self.cursor, self.state.scene.as_deref());
        if frame.is_none() && sample.is_none() && pace == self.pace {
            return None;
        }
        let mut frame = frame.unwrap_or_else(|| json!({"type": "frame", "now": seconds(view.now)}));
        if let Some(sample) = sample {
            frame["sample"] = sample;
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

    /// The newest message of the watched topic, if there is a new one.
    fn sample(&mut self) -> Option<Value> {
        let watched = self.watched.as_mut()?;
        let mut newest = None;
        for _ in 0..SKIPPED {
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
