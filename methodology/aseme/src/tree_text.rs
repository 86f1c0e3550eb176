//! A chart as an indented tree, for reading.

use yase::statechart::ConstantValue;
use yase::{NodeId, NodeKind, Statechart, Transition};
use yase_export::notation::{depth_first, kind_word, modifiers, refinements};

/// The chart as text: one line for each node, its outgoing transitions and refinements below it,
/// its children further in.
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

/// The title of a node: its name and kind, or its kind and index.
fn title(chart: &Statechart, id: NodeId) -> String {
    let node = chart.node(id);
    let kind = kind_word(node.kind);
    match (node.name.as_str(), node.kind) {
        ("", NodeKind::Or) => format!("region {}", sibling_number(chart, id)),
        ("", _) => kind.to_string(),
        (name, _) => format!("{name} {kind}"),
    }
}

/// The name of a node as the target of an arrow.
fn target(chart: &Statechart, id: NodeId) -> String {
    let node = chart.node(id);
    if node.name.is_empty() { kind_word(node.kind).into() } else { node.name.clone() }
}

fn sibling_number(chart: &Statechart, id: NodeId) -> usize {
    let siblings = chart.node(id).parent.map_or(&[][..], |parent| chart.children(parent));
    siblings.iter().position(|&sibling| sibling == id).map_or(1, |index| index + 1)
}

fn arrow(chart: &Statechart, transition: &Transition) -> String {
    let expression = &transition.expression;
    let colon = if expression.is_empty() { String::new() } else { format!(" : {expression}") };
    format!("-> {}{}{colon}", target(chart, transition.target), modifiers(transition))
}

fn constants(chart: &Statechart) -> String {
    let line = |name: &str, value: &ConstantValue| match value {
        ConstantValue::Bool(value) => format!("{name} = {value}\n"),
        ConstantValue::Number(value) => format!("{name} = {value}\n"),
        ConstantValue::Text(value) => format!("{name} = \"{value}\"\n"),
    };
    chart.constants.iter().map(|constant| line(&constant.name, &constant.value)).collect()
}
