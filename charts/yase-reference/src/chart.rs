//! Charts as text.
//!
//! A line is a node or, with an arrow, a transition. Nodes are nested by indentation, two blanks a
//! level; the root is not written:
//!
//! ```text
//! START
//! & both                      an AND
//!   one                       a region; what holds nodes is an OR
//!     START
//!     A | run | for=20ms      a BASIC state with an activity `A` that takes 20 ms
//!     END
//! ? c                         a CONDITION, `% j` a JUNCTION, `x t` a TERMINATE, `! c` a CHOICE, `< f` a FORK, `> j` a JOIN,
//!                             `h h` and `H h` a shallow and a deep HISTORY, `i p` and `o p` an ENTRY and an EXIT point
//! END done                    an END with a name
//! B | entry=raise(e) | exit=raise(f) | defer=g,h
//! both -> B {interrupts,internal,!2,w0.5} : trigger [guard] / actions
//! ```

use std::time::Duration;

use yase::expression::{parse_actions, parse_transition};
use yase::statechart::{Node, NodeId, NodeKind, Statechart, Transition};

/// The chart that a text describes, named `c`.
pub fn chart(text: &str) -> Statechart {
    let mut chart = Statechart::new("c");
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    let margin = lines.iter().map(|line| indent(line)).min().unwrap_or(0);
    let mut parents = vec![Statechart::ROOT];
    for line in &lines {
        let level = (indent(line) - margin) / 2;
        let text = line.trim();
        if let Some((source, rest)) = text.split_once(" -> ") {
            let transition = transition(&chart, source.trim(), rest);
            chart.connect(transition);
        } else {
            parents.truncate(level + 1);
            let parent = parents[level];
            let id = chart.add(parent, node(text));
            if chart.node(parent).kind == NodeKind::Basic {
                chart.node_mut(parent).kind = NodeKind::Or;
            }
            parents.push(id);
        }
    }
    chart
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

fn node(text: &str) -> Node {
    let mut parts = text.split(" | ");
    let head = parts.next().unwrap().trim();
    let (kind, name) = match head.split_once(' ') {
        Some(("&", name)) => (NodeKind::And, name),
        Some(("?", name)) => (NodeKind::Condition, name),
        Some(("%", name)) => (NodeKind::Junction, name),
        Some(("x", name)) => (NodeKind::Terminate, name),
        Some(("!", name)) => (NodeKind::Choice, name),
        Some(("<", name)) => (NodeKind::Fork, name),
        Some((">", name)) => (NodeKind::Join, name),
        Some(("h", name)) => (NodeKind::ShallowHistory, name),
        Some(("H", name)) => (NodeKind::DeepHistory, name),
        Some(("i", name)) => (NodeKind::EntryPoint, name),
        Some(("o", name)) => (NodeKind::ExitPoint, name),
        Some(("END", name)) => (NodeKind::End, name),
        _ if head == "START" => (NodeKind::Start, ""),
        _ if head == "END" => (NodeKind::End, ""),
        _ => (NodeKind::Basic, head),
    };
    let mut node = Node::new(kind, name);
    for part in parts {
        option(&mut node, part.trim());
    }
    node
}

fn option(node: &mut Node, text: &str) {
    match text.split_once('=') {
        None if text == "run" => node.activity = Some(node.name.clone()),
        Some(("run", name)) => node.activity = Some(name.to_owned()),
        Some(("for", time)) => node.duration = Some(millis(time)),
        Some(("entry", actions)) => node.entry = clean(parse_actions(actions)),
        Some(("exit", actions)) => node.exit = clean(parse_actions(actions)),
        Some(("defer", events)) => node.defer = events.split(',').map(str::to_owned).collect(),
        _ => panic!("what is `{text}`?"),
    }
}

fn millis(text: &str) -> Duration {
    Duration::from_millis(text.trim_end_matches("ms").parse().unwrap())
}

fn clean<T>((value, found): (T, Vec<yase::Diagnostic>)) -> T {
    assert!(found.is_empty(), "{found:?}");
    value
}

fn transition(chart: &Statechart, source: &str, rest: &str) -> Transition {
    let (ends, expression) = rest.split_once(" : ").unwrap_or((rest, ""));
    let (target, flags) = ends.split_once('{').unwrap_or((ends, ""));
    let mut transition = Transition::new(find(chart, source), find(chart, target.trim()));
    for flag in flags.trim_end_matches('}').split(',').map(str::trim).filter(|flag| !flag.is_empty()) {
        match flag {
            "interrupts" => transition.interrupts = true,
            "internal" => transition.internal = true,
            _ if flag.starts_with('w') => transition.weight = Some(flag[1..].parse().unwrap()),
            _ => transition.priority = flag.trim_start_matches('!').parse().unwrap(),
        }
    }
    transition.expression = clean(parse_transition(expression));
    transition
}

/// The node of a path below the root.
pub fn find(chart: &Statechart, path: &str) -> NodeId {
    let whole = format!("c/{path}");
    let exact = chart.nodes().map(|(id, _)| id).find(|&id| chart.path(id) == whole);
    exact.or_else(|| chart.find(path)).unwrap_or_else(|| panic!("no node `{path}`"))
}
