//! The state of a running chart, for status queries and statistics.

use std::fmt::Write;

use narukom::{AnySample, Hub, Timestamp, TopicDeclaration, TopicSlot};
use serde_json::{Value, json};
use yase::{Element, Machine, NodeId, NodeKind, Status};
use yase_export::{Highlights, Mark, to_picture, to_svg_marked};

use super::ChartRunner;
use crate::coverage::ChartCoverage;
use crate::statistics::ActivityStatistics;

/// The part of a chart's state that is inspected.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ChartAspect {
    /// A snapshot of its machine in JSON, the chart as SVG with the active states highlighted, and
    /// its shapes for viewers.
    State,
    /// The values that its guards read and whether they hold, its timers and its blackboards, as
    /// one JSON object: see `ChartState.values` of the records.
    Values,
}

impl ChartRunner {
    /// The documents of an aspect.
    pub fn inspect(&self, aspect: ChartAspect) -> Vec<String> {
        match aspect {
            ChartAspect::State => self.inspect_state(),
            ChartAspect::Values => vec![self.values().to_string()],
        }
    }

    fn values(&self) -> Value {
        let chart = self.machine.chart();
        let guards = self.machine.guard_values(&self.host).into_iter().map(
            |guard| json!({"transition": guard.transition.0, "scope": guard.scope.0, "holds": guard.holds}),
        );
        let timers = chart.timers().map(|(scope, name)| {
            let deadline = self.machine.deadline(scope, name).map(|deadline| deadline.as_nanos());
            json!({"scope": scope.0, "name": name, "deadline": deadline})
        });
        let scopes = chart.regions().map(|scope| {
            let name = chart.region_node(scope).map(|node| chart.short_path(node)).unwrap_or_default();
            let messages = self.host.blackboards.visible(scope).into_iter();
            let messages = messages.map(|sample| message(self.hub(), sample));
            json!({"scope": scope.0, "name": name, "is_lent": self.host.blackboards.is_lent(scope),
                "messages": messages.collect::<Vec<_>>()})
        });
        json!({"time": self.host.now.as_nanos(), "guards": guards.collect::<Vec<_>>(),
            "timers": timers.collect::<Vec<_>>(), "scopes": scopes.collect::<Vec<_>>()})
    }

    /// A snapshot of its machine in JSON, the chart as SVG with the active states highlighted, and
    /// its shapes for viewers.
    fn inspect_state(&self) -> Vec<String> {
        let chart = self.machine.chart().statechart();
        let mut marks = Highlights::default();
        let active = self.machine.configuration();
        for &node in &active {
            marks.set(chart, Element::Node(node), Mark::Active);
        }
        // A snapshot always serializes; an empty text would be noticed.
        let snapshot = serde_json::to_string(&self.machine.snapshot()).unwrap_or_default();
        vec![snapshot, to_svg_marked(chart, &marks), to_picture(chart, &active)]
    }

    /// The paths of the BASIC states that are active.
    pub fn active_states(&self) -> Vec<String> {
        let chart = self.machine.chart();
        let is_basic = |node: &NodeId| chart.statechart().node(*node).kind == NodeKind::Basic;
        let active = self.machine.configuration();
        active.into_iter().filter(is_basic).map(|node| chart.short_path(node)).collect()
    }

    /// Whether the chart has ended.
    pub fn is_over(&self) -> bool {
        matches!(self.machine.status(), Status::Finished | Status::Stopped)
    }

    /// Whether the chart is paused.
    pub fn is_paused(&self) -> bool {
        self.is_paused
    }

    pub(crate) fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The name of the model.
    pub fn name(&self) -> &str {
        &self.machine.chart().statechart().name
    }

    /// The hub on which its agent publishes.
    pub fn hub(&self) -> &Hub {
        &self.hub
    }

    /// The host of its agent.
    pub fn host(&self) -> &str {
        &self.host.host
    }

    /// The agent of the chart.
    pub(crate) fn agent(&self) -> &str {
        &self.host.agent
    }

    /// Index of the chart among the charts of the agent.
    pub fn chart_index(&self) -> u32 {
        self.host.number
    }

    /// The part of its agent under which it publishes.
    pub fn part(&self) -> u16 {
        self.host.blackboards.part()
    }

    /// The name of a state, unique in the chart.
    pub fn state_name(&self, node: NodeId) -> String {
        self.machine.chart().short_path(node)
    }

    /// The names of states in sequence.
    pub fn state_names(&self, nodes: &[NodeId]) -> String {
        let names: Vec<String> = nodes.iter().map(|node| self.state_name(*node)).collect();
        names.join(" -> ")
    }

    /// Marks the states of a loop without a wait, and no others, in the statistics.
    pub fn set_loop(&mut self, nodes: &[NodeId]) {
        self.host.slots.set_loop(nodes);
    }

    /// The topics whose messages wake the chart.
    pub fn topics_of_guards(&self) -> Vec<TopicSlot> {
        self.machine.chart().reads().iter().map(|topic| TopicSlot::new(topic.0)).collect()
    }

    /// The number of publications on the hub when its blackboards were created: as a chart that has
    /// not been started sees those after it.
    pub fn position(&self) -> u64 {
        self.host.blackboards.position()
    }

    /// Index of the activity that has been running for the longest time, and since when.
    pub fn longest_running(&self) -> Option<(usize, Timestamp)> {
        self.host.slots.longest_running()
    }

    /// Number of micro-steps since the start.
    pub fn micro_steps(&self) -> u64 {
        self.micro_steps
    }

    /// Statistics of each activity.
    pub fn activity_statistics(&self) -> impl Iterator<Item = ActivityStatistics> {
        self.host.slots.statistics(self.machine.chart())
    }

    /// The number of uses of each state and transition.
    pub fn coverage(&self) -> ChartCoverage {
        self.host.coverage.table(self.machine.chart(), &self.host.host, &self.host.agent)
    }

    /// The number of threads that its activities can use at once.
    pub fn max_activities(&self) -> usize {
        self.machine.chart().max_activities()
    }
}

/// A message of a blackboard; its content is the protobuf encoding in hexadecimal.
fn message(hub: &Hub, sample: &AnySample) -> Value {
    let AnySample { message, header } = sample;
    let mut bytes = Vec::new();
    message.encode_to(&mut bytes);
    let hexadecimal = bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        // Writing to a string does not fail.
        let _ = write!(text, "{byte:02x}");
        text
    });
    let topic = hub.declaration(header.topic).map(TopicDeclaration::path);
    json!({"topic": topic, "host": hub.host_name(header.host).as_deref(),
        "publisher": hub.publisher_name(header.publisher).as_deref(), "sequence": header.sequence,
        "published": header.local.as_nanos(), "bytes": hexadecimal})
}
