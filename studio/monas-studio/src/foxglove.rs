//! The WebSocket protocol of Foxglove: topics of a run for third-party viewers.
//!
//! The server describes itself and its channels as JSON; a client subscribes to channels, and gets
//! their messages as frames of bytes. Each topic of each host is a channel, with its protobuf
//! schema; further channels are the scene and the states of charts. Clients can only read.

use std::collections::BTreeMap;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use monas_link::control::messages::Seen;
use monas_link::control::{ControlClient, WatchStream};
use serde_json::{Value, json};
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Message, WebSocket};

use crate::base64::base64;
use crate::cameras::{self, Cameras};
use crate::foxglove_cameras::CameraChannels;
use crate::foxglove_frame::frame;
use crate::foxglove_views::FoxgloveViews;
use crate::live_state::LiveState;
use crate::time::now;
use crate::viewer::next_request;

/// The names of the subprotocol, in order of preference.
pub(crate) const PROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// The longest wait for a request of the client, and for a message of the run.
const MAX_WAIT: Duration = Duration::from_millis(5);

/// The interval between checks for new topics.
const TOPIC_INTERVAL: Duration = Duration::from_secs(1);

/// The interval between updates of the scene and the states of charts.
const VIEW_INTERVAL: Duration = Duration::from_nanos(1_000_000_000 / 30);

/// The time limit for a client to receive a frame; slower clients are disconnected.
const SEND_TIMEOUT: Duration = Duration::from_secs(5);

/// The most messages that are sent between two requests.
const MAX_MESSAGES: usize = 512;

/// The longest request, in bytes, and the most subscriptions of a client.
const REQUEST_LIMIT: usize = 64 << 10;
const MAX_SUBSCRIPTIONS: usize = 1000;

/// Serves a client until it disconnects, is too slow, or the run or the studio ends.
pub(crate) fn serve(stream: TcpStream, state: &LiveState, is_over: &AtomicBool) {
    // A disconnected client needs no report, and the end of the run closes the connection.
    let _ = exchange(stream, state, is_over);
}

fn exchange(
    stream: TcpStream,
    state: &LiveState,
    is_over: &AtomicBool,
) -> Result<(), Box<dyn std::error::Error>> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(SEND_TIMEOUT))?;
    let limits =
        WebSocketConfig::default().max_message_size(Some(REQUEST_LIMIT)).max_frame_size(Some(REQUEST_LIMIT));
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(limits));
    let mut client = ControlClient::connect(&state.socket)?;
    let run = client.describe()?;
    let info = json!({"op": "serverInfo", "name": format!("monas: {}", run.name), "capabilities": [],
        "supportedEncodings": ["protobuf"], "metadata": {}, "sessionId": run.process.to_string()});
    socket.send(Message::text(info.to_string()))?;
    let mut channels = Channels::default();
    let mut watch: Option<WatchStream> = None;
    let (mut due, mut views_due) = (now(), now());
    while !is_over.load(Ordering::SeqCst) {
        if now() >= due {
            let news = channels.look(&mut client, state)?;
            if !news.is_empty() {
                let text = json!({"op": "advertise", "channels": news}).to_string();
                socket.send(Message::text(text))?;
            }
            due = now() + TOPIC_INTERVAL;
        }
        if let Some(request) = next_request(&mut socket, MAX_WAIT)? {
            match channels.handle(&request) {
                Ok(false) => {}
                Ok(true) => watch = channels.watch(&state.socket)?,
                Err(reason) => {
                    let status = json!({"op": "status", "level": 2, "message": reason});
                    socket.send(Message::text(status.to_string()))?;
                }
            }
        }
        if now() >= views_due {
            for frame in channels.view_frames(state) {
                socket.send(Message::binary(frame))?;
            }
            views_due = now() + VIEW_INTERVAL;
        }
        let Some(watch) = &mut watch else { continue };
        let mut timeout = MAX_WAIT;
        for _ in 0..MAX_MESSAGES {
            let Some(seen) = watch.wait(timeout)? else { break };
            for frame in channels.frames(&seen, cameras::of(state.scene.as_deref())) {
                socket.send(Message::binary(frame))?;
            }
            timeout = Duration::ZERO;
        }
    }
    Ok(())
}

/// The channels of a run, and what a client has subscribed to.
#[derive(Default)]
struct Channels {
    /// By host and topic.
    ids: BTreeMap<(String, String), u64>,
    views: FoxgloveViews,
    cameras: CameraChannels,
    /// The largest number of a channel.
    last: u64,
    /// The channel of each subscription, by the client's number.
    subscriptions: BTreeMap<u32, u64>,
}

impl Channels {
    /// The channels that are new.
    fn look(
        &mut self,
        client: &mut ControlClient,
        state: &LiveState,
    ) -> Result<Vec<Value>, monas_link::Error> {
        let mut news = Vec::new();
        for topic in client.topics("", "")? {
            let key = (topic.host.clone(), topic.path.clone());
            if self.ids.contains_key(&key) {
                continue;
            }
            let schema = client.schema(&topic.path)?;
            self.last += 1;
            let id = self.last;
            news.push(json!({"id": id, "topic": format!("/{}/{}", topic.host, topic.path),
                "encoding": "protobuf", "schemaName": schema.r#type, "schema": base64(&schema.descriptors),
                "schemaEncoding": "protobuf"}));
            self.ids.insert(key, id);
        }
        let Channels { ids, views, cameras, last, .. } = self;
        let mut next_id = || {
            *last += 1;
            *last
        };
        news.extend(views.look(state, &mut next_id));
        if let Some(known) = cameras::of(state.scene.as_deref()) {
            let hosts = ids.keys().filter(|(_, topic)| topic == known.topic()).map(|(host, _)| host);
            news.extend(cameras.look(known, hosts, next_id));
        }
        Ok(news)
    }

    /// The frames of the channels that do not represent topics.
    fn view_frames(&mut self, state: &LiveState) -> Vec<Vec<u8>> {
        let Channels { views, subscriptions, .. } = self;
        let subscribers = |channel: u64| {
            let of_channel = subscriptions.iter().filter(|(_, known)| **known == channel);
            of_channel.map(|(id, _)| *id).collect()
        };
        views.frames(state, subscribers)
    }

    /// Handles a request. Returns whether the subscriptions have changed.
    ///
    /// # Errors
    /// A message for people.
    fn handle(&mut self, request: &str) -> Result<bool, String> {
        let request: Value = serde_json::from_str(request).map_err(|error| error.to_string())?;
        let number = |value: &Value| value.as_u64().and_then(|number| u32::try_from(number).ok());
        let list = |key: &str| request[key].as_array().cloned().unwrap_or_default();
        match request["op"].as_str().unwrap_or_default() {
            "subscribe" => {
                for one in list("subscriptions") {
                    let (Some(id), Some(channel)) = (number(&one["id"]), one["channelId"].as_u64()) else {
                        return Err("a subscription has the numbers `id` and `channelId`".into());
                    };
                    let is_topic = self.ids.values().any(|known| *known == channel);
                    if !is_topic && !self.views.has(channel) && !self.cameras.has(channel) {
                        return Err(format!("there is no channel {channel}"));
                    }
                    if self.subscriptions.len() >= MAX_SUBSCRIPTIONS {
                        return Err(format!("no more than {MAX_SUBSCRIPTIONS} subscriptions"));
                    }
                    self.subscriptions.insert(id, channel);
                }
                Ok(true)
            }
            "unsubscribe" => {
                for id in list("subscriptionIds").iter().filter_map(number) {
                    self.subscriptions.remove(&id);
                }
                Ok(true)
            }
            other => Err(format!("`{other}` is not served: clients can only subscribe")),
        }
    }

    /// A stream of all topics with subscriptions; none without any.
    fn watch(&self, socket: &std::path::Path) -> Result<Option<WatchStream>, monas_link::Error> {
        let wanted = self.ids.iter().filter(|(_, id)| self.subscriptions.values().any(|known| known == *id));
        let mut topics: Vec<&str> = wanted.map(|((_, topic), _)| topic.as_str()).collect();
        topics
            .extend(self.cameras.topic(|channel| self.subscriptions.values().any(|known| *known == channel)));
        topics.sort_unstable();
        topics.dedup();
        if topics.is_empty() {
            return Ok(None);
        }
        ControlClient::connect(socket)?.watch_all("", &topics, true).map(Some)
    }

    /// The frames of a message.
    fn frames(&self, seen: &Seen, cameras: Option<&dyn Cameras>) -> Vec<Vec<u8>> {
        let subscribers = |channel: u64| {
            let of_channel = self.subscriptions.iter().filter(move |(_, known)| **known == channel);
            of_channel.map(|(id, _)| *id)
        };
        let mut frames = Vec::new();
        if let Some(channel) = self.ids.get(&(seen.from.clone(), seen.path.clone())) {
            frames.extend(subscribers(*channel).map(|id| frame(id, seen.local, &seen.payload)));
        }
        if let Some(cameras) = cameras.filter(|cameras| cameras.topic() == seen.path) {
            let wanted = |channel| subscribers(channel).next().is_some();
            for (channel, image) in self.cameras.images(cameras, seen, wanted) {
                frames.extend(subscribers(channel).map(|id| frame(id, seen.local, &image)));
            }
        }
        frames
    }
}
