//! Shrinks a case that shows a difference: removes every element that the difference does not need.

use yase::statechart::{Node, NodeId, NodeKind, Statechart, Transition};

use crate::compare::{CaseResult, judge};
use crate::random::Case;

pub(crate) fn shrink(case: &Case) -> Case {
    let mut case = case.clone();
    loop {
        let smaller = smaller_cases(&case).into_iter().find(differs);
        match smaller {
            Some(smaller) => case = smaller,
            None => return case,
        }
    }
}

fn differs(case: &Case) -> bool {
    matches!(judge(case), CaseResult::Different(_))
}

/// Cases with one element fewer, the largest elements removed first.
fn smaller_cases(case: &Case) -> Vec<Case> {
    let nodes = case.chart.nodes().len() as u32;
    let transitions = case.chart.transitions().len();
    let mut all: Vec<Case> = vec![];
    let mut with = |chart: Option<Statechart>| {
        all.extend(chart.map(|chart| Case { chart, ..case.clone() }));
    };
    for node in 1..nodes {
        with(without_node(&case.chart, NodeId(node)));
    }
    for index in 0..transitions {
        with(rebuilt(&case.chart, &|_| true, &|at| at != index));
    }
    for node in 0..nodes {
        with(plainer_node(&case.chart, NodeId(node)));
    }
    for index in 0..transitions as u32 {
        for part in 0..7 {
            with(plainer_transition(&case.chart, index, part));
        }
    }
    for index in 0..case.script.inputs.len() {
        let mut smaller = case.clone();
        smaller.script.inputs.remove(index);
        all.push(smaller);
    }
    all
}

fn without_node(chart: &Statechart, node: NodeId) -> Option<Statechart> {
    if chart.node(node).kind == NodeKind::Start {
        return None;
    }
    let gone = |id: NodeId| id == node || chart.ancestors(id).any(|above| above == node);
    rebuilt(chart, &|id| !gone(id), &|_| true)
}

/// Keeps some nodes and transitions; transitions at removed nodes are removed.
fn rebuilt(
    chart: &Statechart,
    keeps_node: &dyn Fn(NodeId) -> bool,
    keeps_transition: &dyn Fn(usize) -> bool,
) -> Option<Statechart> {
    let mut out = Statechart::new(chart.name.clone());
    let mut new = vec![None; chart.nodes().len()];
    new[0] = Some(Statechart::ROOT);
    *out.node_mut(Statechart::ROOT) = chart.node(Statechart::ROOT).clone();
    for (id, node) in chart.nodes().skip(1) {
        let parent = node.parent.and_then(|parent| new[parent.0 as usize]);
        if let (true, Some(parent)) = (keeps_node(id), parent) {
            new[id.0 as usize] = Some(out.add(parent, node.clone()));
        }
    }
    for (index, (_, transition)) in chart.transitions().enumerate() {
        let ends = (new[transition.source.0 as usize], new[transition.target.0 as usize]);
        if let (true, (Some(source), Some(target))) = (keeps_transition(index), ends) {
            out.connect(Transition { source, target, ..transition.clone() });
        }
    }
    Some(out)
}

fn plainer_node(chart: &Statechart, node: NodeId) -> Option<Statechart> {
    let mut out = chart.clone();
    let it = out.node_mut(node);
    let plain = Node { parent: it.parent, ..Node::new(it.kind, it.name.clone()) };
    let changed = *it != plain;
    if !it.entry.is_empty() {
        it.entry.pop();
    } else if !it.exit.is_empty() {
        it.exit.pop();
    } else {
        *it = plain;
    }
    changed.then_some(out)
}

fn plainer_transition(chart: &Statechart, index: u32, part: usize) -> Option<Statechart> {
    let mut out = chart.clone();
    let it = out.transition_mut(yase::TransitionId(index));
    let before = it.clone();
    match part {
        0 => it.expression.guard = None,
        1 => {
            it.expression.actions.pop();
        }
        2 => it.weight = None,
        3 => it.interrupts = false,
        4 => it.priority = 0,
        5 => it.internal = false,
        _ if !it.expression.actions.is_empty() => {
            it.expression.actions.remove(0);
        }
        _ => {}
    }
    (*it != before).then_some(out)
}
