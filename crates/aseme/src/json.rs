//! A chart as JSON, with the labels and encoded names of the thesis's model files.

use std::fmt;

use serde_json::{Value, json};
use yase::{NodeId, NodeKind, Statechart, Transition};

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
    json!({ "label": labels[index], "name": names[index], "type": Type(chart.node(id).kind).to_string(), "parent": parent })
}

fn transition(transition: &Transition, names: &[String], labels: &[String]) -> Value {
    let te = (!transition.expression.is_empty()).then(|| transition.expression.to_string());
    let label = |node: NodeId| &labels[node.0 as usize];
    let (source, target) = (label(transition.source), label(transition.target));
    json!({ "source": source, "target": target, "name": transition_name(transition, names), "te": te })
}

/// Every node, each before its children.
pub(crate) fn depth_first(chart: &Statechart) -> impl Iterator<Item = NodeId> {
    let mut open = vec![Statechart::ROOT];
    std::iter::from_fn(move || {
        let id = open.pop()?;
        open.extend(chart.children(id).iter().rev());
        Some(id)
    })
}

/// A kind of node as model files spell it.
pub(crate) struct Type(pub(crate) NodeKind);

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            NodeKind::Or => "OR",
            NodeKind::And => "AND",
            NodeKind::Basic => "BASIC",
            NodeKind::Start => "START",
            NodeKind::End => "END",
            NodeKind::Condition => "CONDITION",
            NodeKind::Junction => "JUNCTION",
            NodeKind::Choice => "CHOICE",
            NodeKind::Fork => "FORK",
            NodeKind::Join => "JOIN",
            NodeKind::ShallowHistory => "SHALLOW_HISTORY",
            NodeKind::DeepHistory => "HISTORY",
            NodeKind::Terminate => "TERMINATE",
            NodeKind::EntryPoint => "ENTRY",
            NodeKind::ExitPoint => "EXIT",
        })
    }
}
