//! Charts as text: a line is a node, with its kind after its name and its properties after bars,
//! nested by indentation; or, with an arrow, a transition between paths, with flags in braces and
//! its expression after a colon. A line `name = 1.5` is a constant.

use std::time::Duration;

use yase::expression::{parse_actions, parse_transition};
use yase::statechart::{Constant, ConstantValue};
use yase::{Diagnostic, Node, NodeId, NodeKind, Statechart, Transition};

pub(crate) fn chart(name: &str, text: &str) -> Statechart {
    let mut chart = Statechart::new(name);
    let mut parents = vec![Statechart::ROOT];
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        let level = (line.len() - line.trim_start().len()) / 2;
        let line = line.trim();
        if let Some((source, rest)) = line.split_once(" -> ") {
            let transition = transition(&chart, source, rest);
            chart.connect(transition);
        } else if let (Some((name, value)), false) = (line.split_once(" = "), line.contains('|')) {
            chart.constants.push(Constant { name: name.into(), value: constant(value) });
        } else {
            parents.truncate(level + 1);
            let id = chart.add(parents[level], node(line));
            parents.push(id);
        }
    }
    chart
}

fn constant(text: &str) -> ConstantValue {
    match text.parse() {
        Ok(number) => ConstantValue::Number(number),
        Err(_) => ConstantValue::Text(text.trim_matches('\'').into()),
    }
}

fn node(line: &str) -> Node {
    let mut parts = line.split(" | ");
    let head = parts.next().unwrap().trim();
    let (name, kind) = head.rsplit_once(' ').unwrap_or(("", head));
    let mut node = Node::new(kind_of(kind), name.trim());
    for part in parts {
        let (key, value) = part.trim().split_once('=').unwrap();
        match key {
            "run" => node.activity = Some(value.into()),
            "priority" => node.priority = value.parse().unwrap(),
            "entry" => node.entry = clean(parse_actions(value)),
            "exit" => node.exit = clean(parse_actions(value)),
            "defer" => node.defer = value.split(',').map(str::to_owned).collect(),
            "for" => node.duration = Some(Duration::from_millis(value.parse().unwrap())),
            _ => panic!("what is `{part}`?"),
        }
    }
    node
}

fn kind_of(word: &str) -> NodeKind {
    let kinds = super::KINDS;
    let found = kinds.iter().find(|kind| yase_export::notation::kind_word(**kind) == word);
    *found.unwrap_or_else(|| panic!("what is `{word}`?"))
}

fn clean<T>((value, found): (T, Vec<Diagnostic>)) -> T {
    assert!(found.is_empty(), "{found:?}");
    value
}

fn transition(chart: &Statechart, source: &str, rest: &str) -> Transition {
    let (ends, expression) = rest.split_once(" : ").unwrap_or((rest, ""));
    let flagged = ends.strip_suffix('}').and_then(|ends| ends.rsplit_once(" {"));
    let (target, flags) = flagged.unwrap_or((ends, ""));
    let mut transition = Transition::new(find(chart, source), find(chart, target));
    for flag in flags.split(',').filter(|flag| !flag.is_empty()) {
        match (flag, flag.split_at(1)) {
            ("interrupts", _) => transition.interrupts = true,
            ("internal", _) => transition.internal = true,
            (_, ("!", priority)) => transition.priority = priority.parse().unwrap(),
            (_, ("%", weight)) => transition.weight = Some(weight.parse().unwrap()),
            _ => panic!("what is `{flag}`?"),
        }
    }
    transition.expression = clean(parse_transition(expression));
    transition
}

/// Finds a node by its path below the root, or by a unique part of it.
pub(crate) fn find(chart: &Statechart, path: &str) -> NodeId {
    let whole = format!("{}/{}", chart.name, path.trim());
    let exact = chart.nodes().map(|(id, _)| id).find(|&id| chart.path(id) == whole);
    exact.or_else(|| chart.find(path.trim())).unwrap_or_else(|| panic!("no node `{path}`"))
}
