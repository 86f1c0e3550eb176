//! A chart as JSON, with the labels and encoded names of the thesis's model files.

use serde_json::{Value, json};
use yase::statechart::Frame;
use yase::{NodeId, Statechart, TransitionId};
use yase_export::notation::{depth_first, kind_word};

use crate::names::{names, transition_name};

/// The chart as a JSON object.
///
/// `{"model", "nodes": [{"label", "name", "type", "parent"}], "transitions": [{"source", "target",
/// "name", "te"}]}`: nodes in pre-order; `parent`, `source` and `target` are labels; transitions in
/// the chart's order, `te` is `null` for an empty expression. Nodes with a layout have `"at":
/// [right, down]` and `"size": [width, height]`, transitions with corners `"via": [[right, down],
/// ...]`.
pub fn to_json(chart: &Statechart) -> Value {
    let (names, labels) = (names(chart), chart.labels());
    let nodes: Vec<Value> = depth_first(chart).map(|id| node(chart, id, &names, &labels)).collect();
    let transitions: Vec<Value> =
        chart.transitions().map(|(id, _)| transition(chart, id, &names, &labels)).collect();
    json!({ "model": chart.name, "nodes": nodes, "transitions": transitions })
}

fn node(chart: &Statechart, id: NodeId, names: &[String], labels: &[String]) -> Value {
    let index = id.0 as usize;
    let parent = chart.node(id).parent.map(|parent| &labels[parent.0 as usize]);
    let mut node = json!({ "label": labels[index], "name": names[index], "type": kind_word(chart.node(id).kind), "parent": parent });
    if let Some(Frame { at, size }) = chart.layout.frames.get(&id) {
        at.iter().for_each(|at| node["at"] = json!(at));
        size.iter().for_each(|size| node["size"] = json!(size));
    }
    node
}

fn transition(chart: &Statechart, id: TransitionId, names: &[String], labels: &[String]) -> Value {
    let transition = chart.transition(id);
    let te = (!transition.expression.is_empty()).then(|| transition.expression.to_string());
    let label = |node: NodeId| &labels[node.0 as usize];
    let (source, target) = (label(transition.source), label(transition.target));
    let mut transition =
        json!({ "source": source, "target": target, "name": transition_name(transition, names), "te": te });
    chart.layout.bends.get(&id).into_iter().for_each(|bends| transition["via"] = json!(bends));
    transition
}
