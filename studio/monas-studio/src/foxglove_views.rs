//! Channels of Foxglove's protocol that do not represent topics: the scene, and the states of
//! charts.

use std::collections::{BTreeMap, BTreeSet};

use prost::Message as _;
use serde_json::{Value, json};

use crate::base64::base64;
use crate::chart_view::ChartKey;
use crate::foxglove_frame::frame;
use crate::live_state::LiveState;
use crate::scene_update::SceneHistory;
use crate::scene_update::messages::SceneUpdate;
use crate::state_name::StateNames;

/// Messages that the studio defines for third-party viewers.
#[allow(missing_docs, unreachable_pub)]
mod messages {
    narukom::include_messages!("monas.studio");
}

use messages::ActiveState;

/// The channels of a client, and what has been sent on them.
#[derive(Default)]
pub(crate) struct FoxgloveViews {
    scene: Option<SceneChannel>,
    charts: BTreeMap<ChartKey, ChartChannel>,
}

struct SceneChannel {
    id: u64,
    history: SceneHistory,
    /// The last change of the scene that was sent, by subscription.
    sent: Option<(u64, Vec<u32>)>,
}

struct ChartChannel {
    id: u64,
    names: StateNames,
    /// The drawing from which the names were taken.
    drawing: u64,
    active: BTreeSet<u32>,
    steps: u64,
    sent: Option<(ActiveState, Vec<u32>)>,
}

impl FoxgloveViews {
    /// The channels that are new; their numbers come from `next_id`.
    pub(crate) fn look(&mut self, state: &LiveState, mut next_id: impl FnMut() -> u64) -> Vec<Value> {
        let mut news = Vec::new();
        let mut charts = Vec::new();
        if state.scene.is_some() && self.scene.is_none() {
            let id = next_id();
            self.scene = Some(SceneChannel { id, history: SceneHistory::default(), sent: None });
            news.push(channel(id, "/scene", <SceneUpdate as narukom::Message>::DESCRIPTOR));
        }
        let view = state.view();
        for key in view.charts.keys().filter(|key| !self.charts.contains_key(key)) {
            let id = next_id();
            // The second chart of an agent and further ones have numbers, as in the terminal.
            let number = if key.chart == 0 { String::new() } else { format!("/{}", key.chart + 1) };
            let path = format!("/{}/chart/{}{number}", key.host, key.agent);
            news.push(channel(id, &path, <ActiveState as narukom::Message>::DESCRIPTOR));
            charts.push((key.clone(), id));
        }
        for (key, id) in charts {
            let (names, active) = Default::default();
            let channel = ChartChannel { id, names, drawing: 0, active, steps: 0, sent: None };
            self.charts.insert(key, channel);
        }
        news
    }

    /// Whether a channel has this number.
    pub(crate) fn has(&self, id: u64) -> bool {
        self.scene.iter().any(|scene| scene.id == id) || self.charts.values().any(|chart| chart.id == id)
    }

    /// The frames with what the client has subscribed to and not got; `subscribers` are the numbers
    /// of the subscriptions of a channel.
    pub(crate) fn frames(
        &mut self,
        state: &LiveState,
        subscribers: impl Fn(u64) -> Vec<u32>,
    ) -> Vec<Vec<u8>> {
        let mut frames = Vec::new();
        let mut view = state.view();
        if let (Some(channel), Some(scene)) = (&mut self.scene, &state.scene) {
            let (ids, revision) = (subscribers(channel.id), view.scene_revision());
            let is_known = channel.sent.as_ref().is_some_and(|(sent, to)| (*sent, to) == (revision, &ids));
            if !ids.is_empty() && !is_known {
                // A new subscriber receives the whole scene.
                if channel.sent.as_ref().is_none_or(|(_, to)| *to != ids) {
                    channel.history = SceneHistory::default();
                }
                let update = channel.history.update(&view.scene_picture(&**scene), view.now);
                frames.extend(ids.iter().map(|id| frame(*id, view.now, &update.encode_to_vec())));
                channel.sent = Some((revision, ids));
            } else if ids.is_empty() {
                channel.sent = None;
            }
        }
        for (key, channel) in &mut self.charts {
            let (ids, Some(chart)) = (subscribers(channel.id), view.charts.get(key)) else { continue };
            if ids.is_empty() || chart.picture().is_null() {
                channel.sent = None;
                continue;
            }
            if channel.drawing != chart.drawing() {
                (channel.names, channel.drawing) = (StateNames::of(chart.picture()), chart.drawing());
            }
            if channel.sent.as_ref().is_some_and(|(_, to)| *to == ids) {
                for (time, exits, entries) in chart.steps_since(channel.steps) {
                    channel.active.retain(|node| !exits.contains(node));
                    channel.active.extend(entries);
                    frames.extend(channel.news(time, &ids));
                }
            } else {
                channel.sent = None;
            }
            // Steps may have been lost, or the client has just subscribed.
            channel.steps = chart.count();
            channel.active.clone_from(chart.active());
            frames.extend(channel.news(view.now, &ids));
        }
        frames
    }
}

impl ChartChannel {
    /// The frames with the present state, if it has changed.
    fn news(&mut self, time: u64, ids: &[u32]) -> Vec<Vec<u8>> {
        let (state, active) = self.names.active(&self.active);
        let message = ActiveState { state, active };
        if self.sent.as_ref().is_some_and(|(sent, _)| *sent == message) {
            return Vec::new();
        }
        let bytes = message.encode_to_vec();
        self.sent = Some((message, ids.to_vec()));
        ids.iter().map(|id| frame(*id, time, &bytes)).collect()
    }
}

/// The description of a channel.
pub(crate) fn channel(id: u64, path: &str, descriptor: &narukom::MessageDescriptor) -> Value {
    json!({"id": id, "topic": path, "encoding": "protobuf", "schemaName": descriptor.full_name,
        "schema": base64(descriptor.file_descriptor_set), "schemaEncoding": "protobuf"})
}
