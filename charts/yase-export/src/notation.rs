//! Properties of nodes and transitions besides names and expressions, in the notation of model
//! files.

use yase::expression::{Action, TransitionExpression};
use yase::statechart::{Node, NodeId, NodeKind, Statechart, Transition};

/// All nodes, each before its children.
pub fn depth_first(chart: &Statechart) -> impl Iterator<Item = NodeId> {
    let mut open = vec![Statechart::ROOT];
    std::iter::from_fn(move || {
        let id = open.pop()?;
        open.extend(chart.children(id).iter().rev());
        Some(id)
    })
}

/// The keyword of a kind of node in model files.
pub fn kind_word(kind: NodeKind) -> &'static str {
    match kind {
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
    }
}

/// Modifiers of a transition, each with a leading blank.
pub fn modifiers(transition: &Transition) -> String {
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
    if transition.internal {
        text.push_str(" internal");
    }
    text
}

/// The label of a transition: modifiers and expression.
pub(crate) fn inscription(transition: &Transition) -> String {
    let text = format!("{} {}", modifiers(transition), transition.expression);
    text.trim().to_owned()
}

/// Properties of a state besides its name, in the notation of model files.
pub fn refinements(node: &Node) -> Vec<String> {
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
    (!actions.is_empty()).then(|| format!("{key} = {}", actions_text(actions)))
}

fn actions_text(actions: &[Action]) -> String {
    let expression = TransitionExpression { actions: actions.to_vec(), ..TransitionExpression::default() };
    expression.to_string().trim_start_matches(['/', ' ']).to_owned()
}
