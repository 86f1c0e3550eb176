//! Properties of nodes and transitions besides names and expressions, in the notation of model
//! files.

use std::time::Duration;

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
    lines.extend(node.duration.map(|duration| format!("duration = {}", duration_text(duration))));
    lines
}

/// A duration in milliseconds, exact to the nanosecond.
pub fn duration_text(duration: Duration) -> String {
    let milliseconds = duration.as_millis();
    match duration.subsec_nanos() % 1_000_000 {
        0 => format!("{milliseconds}ms"),
        rest => format!("{milliseconds}.{}ms", format!("{rest:06}").trim_end_matches('0')),
    }
}

fn actions(key: &str, actions: &[Action]) -> Option<String> {
    (!actions.is_empty()).then(|| format!("{key} = {}", actions_text(actions)))
}

fn actions_text(actions: &[Action]) -> String {
    let expression = TransitionExpression { actions: actions.to_vec(), ..TransitionExpression::default() };
    expression.to_string().trim_start_matches(['/', ' ']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1001 ms are not a number of seconds that a floating-point number can represent.
    #[test]
    fn durations_are_exact() {
        let written = |nanoseconds| duration_text(Duration::from_nanos(nanoseconds));
        let exact = [1_001_000_000, 0, 1_500_000, 1, 86_400_000_000_001].map(written);
        assert_eq!(exact, ["1001ms", "0ms", "1.5ms", "0.000001ms", "86400000.000001ms"]);
        let mut chart = Statechart::new("r");
        let state = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "a"));
        chart.node_mut(state).duration = Some(Duration::from_millis(1_001));
        assert_eq!(refinements(chart.node(state)), ["duration = 1001ms"]);
        let document = crate::to_xstate(&chart).text;
        assert!(document.contains("\"milliseconds\": 1001"), "{document}");
        assert!(!document.contains("1001."), "{document}");
    }
}
