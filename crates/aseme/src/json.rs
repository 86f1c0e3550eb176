//! A chart as JSON, with the labels and encoded names of the thesis's model files.

use serde_json::{Value, json};
use yase::export::notation::{depth_first, kind_word};
use yase::{NodeId, Statechart, Transition};

use crate::names::{names, transition_name};

/// The chart as one JSON object.
///
/// `{"model", "nodes": [{"label", "name", "type", "parent"}], "transitions": [{"source", "target", "name", "te"}]}`: nodes with a
/// parent before its children and its children in order, `parent`, `source` and `target` being labels; transitions in the
/// chart's order, `te` being `null` where nothing is said.
pub fn to_json(chart: &Statechart) -> Value {
    let (names, labels) = (names(chart), chart.labels());
    let nodes: Vec<Value> = depth_first(chart).map(|id| node(chart, id, &names, &labels)).collect();
    let transitions: Vec<Value> =
        chart.transitions().map(|(_, transition)| self::transition(transition, &names, &labels)).collect();
    json!({ "model": chart.name, "nodes": nodes, "transitions": transitions })
}

fn node(chart: &Statechart, id: NodeId, names: &[String], labels: &[String]) -> Value {
    let index = id.0 as usize;
    let parent = chart.node(id).parent.map(|parent| &labels[parent.0 as usize]);
    json!({ "label": labels[index], "name": names[index], "type": kind_word(chart.node(id).kind), "parent": parent })
}

fn transition(transition: &Transition, names: &[String], labels: &[String]) -> Value {
    let te = (!transition.expression.is_empty()).then(|| transition.expression.to_string());
    let label = |node: NodeId| &labels[node.0 as usize];
    let (source, target) = (label(transition.source), label(transition.target));
    json!({ "source": source, "target": target, "name": transition_name(transition, names), "te": te })
}
