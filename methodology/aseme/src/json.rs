//! A chart as JSON, with the labels and encoded names of the thesis's model files.

use serde::Serialize;
use yase::statechart::{Frame, Point};
use yase::{NodeId, Statechart, TransitionId};
use yase_export::notation::{depth_first, kind_word};

use crate::names::{names, transition_name};

/// The chart as an object for a serializer of JSON.
///
/// `{"model", "nodes": [{"label", "name", "type", "parent"}], "transitions": [{"source", "target",
/// "name", "te"}]}`: nodes in pre-order; `parent`, `source` and `target` are labels; transitions in
/// the chart's order, `te` is `null` for an empty expression. Nodes with a layout have `"at":
/// [right, down]` and `"size": [width, height]`, transitions with corners `"via": [[right, down],
/// ...]`.
pub fn to_json(chart: &Statechart) -> impl Serialize {
    let (names, labels) = (names(chart), chart.labels());
    JsonChart {
        model: &chart.name,
        nodes: depth_first(chart).map(|id| JsonNode::new(chart, id, &names, &labels)).collect(),
        transitions: chart
            .transitions()
            .map(|(id, _)| JsonTransition::new(chart, id, &names, &labels))
            .collect(),
    }
}

#[derive(Serialize)]
struct JsonChart<'a> {
    model: &'a str,
    nodes: Vec<JsonNode>,
    transitions: Vec<JsonTransition<'a>>,
}

#[derive(Serialize)]
struct JsonNode {
    label: String,
    name: String,
    #[serde(rename = "type")]
    kind: &'static str,
    parent: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    size: Option<Point>,
}

#[derive(Serialize)]
struct JsonTransition<'a> {
    source: String,
    target: String,
    name: String,
    te: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    via: Option<&'a [Point]>,
}

impl JsonNode {
    fn new(chart: &Statechart, id: NodeId, names: &[String], labels: &[String]) -> JsonNode {
        let index = id.0 as usize;
        let Frame { at, size } = chart.layout.frames.get(&id).copied().unwrap_or_default();
        JsonNode {
            label: labels[index].clone(),
            name: names[index].clone(),
            kind: kind_word(chart.node(id).kind),
            parent: chart.node(id).parent.map(|parent| labels[parent.0 as usize].clone()),
            at,
            size,
        }
    }
}

impl<'a> JsonTransition<'a> {
    fn new(
        chart: &'a Statechart,
        id: TransitionId,
        names: &[String],
        labels: &[String],
    ) -> JsonTransition<'a> {
        let transition = chart.transition(id);
        let label = |node: NodeId| labels[node.0 as usize].clone();
        JsonTransition {
            source: label(transition.source),
            target: label(transition.target),
            name: transition_name(transition, names),
            te: (!transition.expression.is_empty()).then(|| transition.expression.to_string()),
            via: chart.layout.bends.get(&id).map(Vec::as_slice),
        }
    }
}
