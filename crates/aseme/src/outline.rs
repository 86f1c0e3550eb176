//! A chart as an indented tree, for reading.

use yase::expression::{Action, TransitionExpression};
use yase::statechart::ConstantValue;
use yase::{Node, NodeId, NodeKind, Statechart, Transition};

use crate::json::{Type, depth_first};

/// The chart as text: one line for each node, its outgoing transitions and refinements below it, its children further in.
///
/// ```
/// # let (liveness, _) = aseme::liveness::parse("walk = Step~");
/// # let (chart, _) = aseme::liveness_to_statechart(&liveness);
/// assert_eq!(aseme::to_text(&chart), "\
/// walk OR
///   START
///     -> Step
///   Step BASIC
///     -> Step
/// ");
/// ```
pub fn to_text(chart: &Statechart) -> String {
    let mut outgoing: Vec<Vec<&Transition>> = vec![Vec::new(); chart.nodes().len()];
    for (_, transition) in chart.transitions() {
        outgoing[transition.source.0 as usize].push(transition);
    }
    let mut text = String::new();
    for id in depth_first(chart) {
        let indent = "  ".repeat(chart.ancestors(id).count());
        let mut line = |content: &str| text.extend([&indent, content, "\n"]);
        line(&title(chart, id));
        for refinement in refinements(chart.node(id)) {
            line(&format!("  {refinement}"));
        }
        for transition in &outgoing[id.0 as usize] {
            line(&format!("  {}", arrow(chart, transition)));
        }
    }
    text.push_str(&constants(chart));
    text
}

/// What a node is called in a tree: its name and kind, or its kind and its place.
fn title(chart: &Statechart, id: NodeId) -> String {
    let node = chart.node(id);
    let kind = Type(node.kind);
    match (node.name.as_str(), node.kind) {
        ("", NodeKind::Or) => format!("region {}", place(chart, id)),
        ("", _) => kind.to_string(),
        (name, _) => format!("{name} {kind}"),
    }
}

/// What a node is called by an arrow that leads to it.
fn target(chart: &Statechart, id: NodeId) -> String {
    let node = chart.node(id);
    if node.name.is_empty() { Type(node.kind).to_string() } else { node.name.clone() }
}

fn place(chart: &Statechart, id: NodeId) -> usize {
    let siblings = chart.node(id).parent.map_or(&[][..], |parent| chart.children(parent));
    siblings.iter().position(|&sibling| sibling == id).map_or(1, |index| index + 1)
}

fn arrow(chart: &Statechart, transition: &Transition) -> String {
    let expression = &transition.expression;
    let colon = if expression.is_empty() { String::new() } else { format!(" : {expression}") };
    format!("-> {}{}{colon}", target(chart, transition.target), modifiers(transition))
}

/// What is said of a transition besides its expression, each with a blank in front.
pub(crate) fn modifiers(transition: &Transition) -> String {
    let mut text = String::new();
    if transition.priority != 0 {
        text.push_str(&format!(" !{}", transition.priority));
    }
    if let Some(weight) = transition.weight {
        text.push_str(&format!(" %{weight}"));
    }
    if transition.interrupts {
        text.push_str(" interrupts");
    }
    text
}

/// What is said of a state besides its name, each thing in the words of a model file.
pub(crate) fn refinements(node: &Node) -> Vec<String> {
    let activity = node.activity.as_ref().filter(|activity| **activity != node.name);
    let mut lines: Vec<String> =
        activity.map(|activity| format!("activity = {activity}")).into_iter().collect();
    lines.extend((node.priority != 0).then(|| format!("priority = {}", node.priority)));
    lines.extend(actions("entry", &node.entry));
    lines.extend(actions("exit", &node.exit));
    lines.extend((!node.defer.is_empty()).then(|| format!("defer = {}", node.defer.join(" "))));
    lines.extend(node.duration.map(|duration| format!("duration = {}ms", duration.as_secs_f64() * 1000.0)));
    lines
}

fn actions(key: &str, actions: &[Action]) -> Option<String> {
    let expression = TransitionExpression { actions: actions.to_vec(), ..TransitionExpression::default() };
    let text = expression.to_string();
    (!actions.is_empty()).then(|| format!("{key} = {}", text.trim_start_matches(['/', ' '])))
}

fn constants(chart: &Statechart) -> String {
    let line = |name: &str, value: &ConstantValue| match value {
        ConstantValue::Bool(value) => format!("{name} = {value}\n"),
        ConstantValue::Number(value) => format!("{name} = {value}\n"),
        ConstantValue::Text(value) => format!("{name} = \"{value}\"\n"),
    };
    chart.constants.iter().map(|constant| line(&constant.name, &constant.value)).collect()
}
