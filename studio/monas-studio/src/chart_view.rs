//! The view of a statechart: its shapes, active states and latest steps.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

use monas::records::{self, ChartState};
use serde_json::{Value, json};

/// The number of steps kept for viewers that connect later.
const KEPT_STEPS: usize = 64;

/// The chart of an agent.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct ChartKey {
    pub(crate) host: String,
    pub(crate) agent: String,
    /// Index of the chart in the agent.
    pub(crate) chart: u32,
}

impl ChartKey {
    /// The key in messages to viewers.
    pub(crate) fn text(&self) -> String {
        format!("{}/{}/{}", self.host, self.agent, self.chart)
    }
}

/// The state of a chart.
#[derive(Clone, Default, Debug)]
pub(crate) struct ChartView {
    pub(crate) model: String,
    /// `runs`, `pauses` or `stopped`.
    pub(crate) state: String,
    /// The shapes; null until they are known. Shared by the moments of a tape.
    picture: Arc<Value>,
    /// Counts changes of the shapes.
    drawing: u64,
    /// Whether the active states and shapes are out of date.
    is_stale: bool,
    active: BTreeSet<u32>,
    /// The latest steps. Shared by the moments of a run.
    steps: VecDeque<Arc<Value>>,
    /// The number of steps.
    count: u64,
    /// Counts changes.
    pub(crate) revision: u64,
}

impl ChartView {
    /// Whether its state has to be requested from the run.
    pub(crate) fn is_stale(&self) -> bool {
        self.is_stale || self.picture.is_null()
    }

    /// Applies the reply of a run.
    pub(crate) fn load(&mut self, state: &ChartState) {
        self.model.clone_from(&state.model);
        self.state.clone_from(&state.state);
        self.show(&state.picture);
    }

    /// Sets the shapes, and the active states in them.
    pub(crate) fn show(&mut self, picture: &str) {
        let mut picture: Value = serde_json::from_str(picture).unwrap_or_default();
        let active = picture.as_object_mut().and_then(|picture| picture.remove("active"));
        let active = active.iter().filter_map(Value::as_array).flatten();
        self.active = active.filter_map(|node| node.as_u64()?.try_into().ok()).collect();
        if *self.picture != picture {
            self.picture = Arc::new(picture);
            self.drawing += 1;
        }
        self.is_stale = false;
        self.revision += 1;
    }

    /// Applies a step, at a time in nanoseconds, with the name of its event.
    pub(crate) fn step(&mut self, time: u64, step: &records::Chart, event: Option<&str>) {
        for node in &step.exits {
            self.active.remove(node);
        }
        self.active.extend(&step.entries);
        let mut fired = step.selected.clone();
        fired.extend(&step.taken);
        if self.steps.len() == KEPT_STEPS {
            self.steps.pop_front();
        }
        let step = json!({"t": seconds(time), "number": self.count, "event": event, "fired": fired,
            "held": step.held, "exits": step.exits, "entries": step.entries});
        self.steps.push_back(Arc::new(step));
        self.count += 1;
        self.revision += 1;
    }

    /// Marks the view as stale: records were lost, or the chart may have been replaced.
    pub(crate) fn mark_stale(&mut self) {
        self.is_stale = true;
    }

    /// The state, with the steps from a number on.
    pub(crate) fn object(&self, key: &ChartKey, from: u64) -> Value {
        let skipped = (from + self.steps.len() as u64).saturating_sub(self.count) as usize;
        let steps: Vec<&Value> = self.steps.iter().skip(skipped).map(|step| &**step).collect();
        json!({"key": key.text(), "host": key.host, "agent": key.agent, "chart": key.chart, "model": self.model,
            "state": self.state, "drawing": self.drawing, "active": self.active, "steps": steps})
    }

    /// The number of steps.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// The active states.
    pub(crate) fn active(&self) -> &BTreeSet<u32> {
        &self.active
    }

    /// Counts changes of the shapes.
    pub(crate) fn drawing(&self) -> u64 {
        self.drawing
    }

    /// The steps from a number on that are kept: time in nanoseconds, exits and entries.
    pub(crate) fn steps_since(&self, from: u64) -> impl Iterator<Item = (u64, Vec<u32>, Vec<u32>)> {
        let skipped = (from + self.steps.len() as u64).saturating_sub(self.count) as usize;
        self.steps.iter().skip(skipped).map(|step| {
            let nodes = |key: &str| {
                let nodes = step[key].as_array().into_iter().flatten();
                nodes.filter_map(|node| node.as_u64()?.try_into().ok()).collect()
            };
            let time = step["t"].as_f64().unwrap_or_default();
            ((time * 1e9).round() as u64, nodes("exits"), nodes("entries"))
        })
    }

    /// The shapes, for a viewer that requests them.
    pub(crate) fn picture(&self) -> &Value {
        &self.picture
    }
}

/// Nanoseconds as seconds.
pub(crate) fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(exits: &[u32], entries: &[u32]) -> records::Chart {
        records::Chart {
            exits: exits.to_vec(),
            entries: entries.to_vec(),
            selected: vec![7],
            ..records::Chart::default()
        }
    }

    #[test]
    fn steps_change_what_is_active_and_only_new_ones_are_sent() {
        let key = ChartKey { host: "a".into(), agent: "b".into(), chart: 0 };
        let mut view = ChartView::default();
        view.load(&ChartState { picture: r#"{"active": [0, 1]}"#.into(), ..ChartState::default() });
        view.step(2_000_000_000, &step(&[1], &[2, 3]), Some("go"));
        let first = view.object(&key, 0);
        assert_eq!(first["active"], json!([0, 2, 3]));
        assert_eq!(first["steps"][0]["t"], json!(2.0));
        assert_eq!((&first["steps"][0]["fired"], &first["steps"][0]["event"]), (&json!([7]), &json!("go")));
        let seen = view.count();
        view.step(3_000_000_000, &step(&[2], &[4]), None);
        assert_eq!(view.object(&key, seen)["steps"].as_array().map(Vec::len), Some(1));
        assert_eq!(view.object(&key, view.count())["steps"], json!([]));
    }

    #[test]
    fn few_steps_are_kept() {
        let mut view = ChartView::default();
        (0..1000).for_each(|_| view.step(0, &step(&[], &[]), None));
        let key = ChartKey { host: "a".into(), agent: "b".into(), chart: 0 };
        assert_eq!(view.object(&key, 0)["steps"].as_array().map(Vec::len), Some(KEPT_STEPS));
    }
}
