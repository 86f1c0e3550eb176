//! Names for the parts of a chart that do not depend on its numbering.
//!
//! A node is named by its [path](Statechart::path), a segment of a transition by the paths of its
//! ends, a timer by its scope and name, an event by its name. Items of equal name are distinguished
//! by a number in document order, from the second on: `c/CONDITION`, `c/CONDITION#2`.

use std::collections::BTreeMap;

use crate::compile::{CompiledChart, NodeIndex};
use crate::expression::EventId;
use crate::ids::{CompoundTransitionId, ScopeId};
use crate::machine::snapshot::{EventName, TimerName, TransitionPath};
use crate::statechart::{NodeId, Statechart, TransitionId};

/// The names in a chart, and the items they denote.
#[derive(Clone, Debug)]
pub(crate) struct PathTable {
    nodes: Vec<String>,
    by_path: BTreeMap<String, NodeId>,
    segments: Vec<String>,
    by_segment: BTreeMap<String, TransitionId>,
}

impl PathTable {
    pub(crate) fn new(chart: &CompiledChart) -> PathTable {
        let (nodes, by_path) = node_paths(chart);
        let (segments, by_segment) = segment_names(chart.statechart(), &nodes);
        PathTable { nodes, by_path, segments, by_segment }
    }

    pub(crate) fn node(&self, node: NodeId) -> &str {
        self.nodes.get(node.0 as usize).map_or("", String::as_str)
    }

    pub(crate) fn find_node(&self, path: &str) -> Option<NodeId> {
        self.by_path.get(path).copied()
    }

    pub(crate) fn node_path(&self, chart: &CompiledChart, node: NodeIndex) -> String {
        self.node(chart.layout.node(node)).to_owned()
    }

    pub(crate) fn find_index(&self, chart: &CompiledChart, path: &str) -> Option<NodeIndex> {
        self.find_node(path).and_then(|node| chart.layout.find_index(node))
    }

    pub(crate) fn region(&self, chart: &CompiledChart, region: ScopeId) -> String {
        chart.region_node(region).map(|node| self.node(node).to_owned()).unwrap_or_default()
    }

    pub(crate) fn find_region(&self, chart: &CompiledChart, path: &str) -> Option<ScopeId> {
        chart.region_at(self.find_node(path)?)
    }

    pub(crate) fn segment(&self, segment: TransitionId) -> &str {
        self.segments.get(segment.0 as usize).map_or("", String::as_str)
    }

    pub(crate) fn find_segment(&self, name: &str) -> Option<TransitionId> {
        self.by_segment.get(name).copied()
    }

    pub(crate) fn transition_path(
        &self,
        chart: &CompiledChart,
        compound: CompoundTransitionId,
    ) -> TransitionPath {
        chart.segments(compound).iter().map(|&segment| self.segment(segment).to_owned()).collect()
    }

    pub(crate) fn find_compound(
        &self,
        ways: &BTreeMap<&[TransitionId], CompoundTransitionId>,
        way: &TransitionPath,
    ) -> Option<CompoundTransitionId> {
        let segments: Option<Vec<TransitionId>> =
            way.iter().map(|segment| self.find_segment(segment)).collect();
        ways.get(segments?.as_slice()).copied()
    }

    pub(crate) fn timer(&self, chart: &CompiledChart, timer: usize) -> TimerName {
        let Some(timer) = chart.timers.get(timer) else { return TimerName::default() };
        TimerName { region: self.region(chart, timer.region), name: timer.name.to_string() }
    }

    pub(crate) fn find_timer(&self, chart: &CompiledChart, name: &TimerName) -> Option<usize> {
        let region = self.find_region(chart, &name.region)?;
        chart.timers.iter().position(|timer| timer.region == region && *timer.name == *name.name)
    }
}

/// The name of an event; arrivals of messages have separate names.
pub(crate) fn event_name(chart: &CompiledChart, event: EventId) -> EventName {
    let name = chart.events().name(event).to_owned();
    match chart.events().topic(event) {
        Some(_) => EventName::Message(name),
        None => EventName::Name(name),
    }
}

pub(crate) fn find_event(chart: &CompiledChart, name: &EventName) -> Option<EventId> {
    let events = chart.events();
    match name {
        EventName::Name(name) => events.find(name),
        EventName::Message(message) => (0..events.len() as u32)
            .map(EventId)
            .find(|&event| events.topic(event).is_some() && events.name(event) == message),
    }
}

/// Compound transitions by their segments.
pub(crate) fn compounds_by_segments(
    chart: &CompiledChart,
) -> BTreeMap<&[TransitionId], CompoundTransitionId> {
    let ids = (0..chart.compounds.len() as u32).map(CompoundTransitionId);
    ids.map(|compound| (chart.segments(compound), compound)).collect()
}

fn node_paths(chart: &CompiledChart) -> (Vec<String>, BTreeMap<String, NodeId>) {
    let (statechart, layout) = (chart.statechart(), &chart.layout);
    let mut order: Vec<NodeId> = statechart.nodes().map(|(id, _)| id).collect();
    order.sort_by_key(|&node| layout.rank(layout.index_of(node)));
    let mut paths = vec![String::new(); order.len()];
    let mut by_path = BTreeMap::new();
    for node in order {
        let segment = statechart.segment(node);
        let path = match statechart.node(node).parent {
            Some(parent) => format!("{}/{segment}", paths[parent.0 as usize]),
            None => segment,
        };
        paths[node.0 as usize] = distinct(&mut by_path, path, node);
    }
    (paths, by_path)
}

fn segment_names(statechart: &Statechart, nodes: &[String]) -> (Vec<String>, BTreeMap<String, TransitionId>) {
    let mut by_segment = BTreeMap::new();
    let name = |(id, transition): (TransitionId, &crate::Transition)| {
        let ends = [transition.source, transition.target].map(|end| nodes[end.0 as usize].as_str());
        distinct(&mut by_segment, ends.join(" -> "), id)
    };
    (statechart.transitions().map(name).collect(), by_segment)
}

/// Registers a name, with a number if it is taken.
fn distinct<T>(taken: &mut BTreeMap<String, T>, name: String, of: T) -> String {
    let mut found = name.clone();
    let mut number = 2;
    while taken.contains_key(&found) {
        found = format!("{name}#{number}");
        number += 1;
    }
    taken.insert(found.clone(), of);
    found
}
