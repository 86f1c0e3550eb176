//! M27: loops in which nothing waits.
//!
//! An activity without a duration may return at once. A loop of such activities that no timer, no
//! event and no message holds up runs as fast as the processor, and in simulated time stands at one
//! instant.

use std::collections::{BTreeMap, BTreeSet};

use yase::{Diagnostic, NodeId, NodeKind};
use yase_explore::Exploration;

use crate::checked_model::CheckedModel;
use crate::strongly_connected_components::strongly_connected_components;

/// The composites that loop without a wait, with a finding for each.
pub(crate) fn check(subject: &CheckedModel, found: &Exploration) -> Vec<Diagnostic> {
    let mut next = restless_steps(subject, found);
    let components = loop {
        let components = strongly_connected_components(&next);
        if !retain_loops(&mut next, &components) {
            break components;
        }
    };
    let mut loops: BTreeMap<(usize, Option<NodeId>), BTreeSet<NodeId>> = BTreeMap::new();
    for (from, steps) in next.iter().enumerate() {
        for &(_, returned) in steps {
            let region = region_of(subject, returned);
            loops.entry((components[from], region)).or_default().insert(returned);
        }
    }
    let composites: BTreeSet<NodeId> =
        loops.into_values().filter_map(|nodes| around(subject, &nodes)).collect();
    composites.into_iter().map(|composite| finding(subject, composite)).collect()
}

/// Removes returns of activities some outcome of which leaves the loop: what is read decides then
/// how long it goes on. Returns whether there were any.
fn retain_loops(next: &mut [Vec<(usize, NodeId)>], components: &[usize]) -> bool {
    let mut has_removed = false;
    for (from, steps) in next.iter_mut().enumerate() {
        let leaves = |&&(to, _): &&(usize, NodeId)| components[to] != components[from];
        let leaving: BTreeSet<NodeId> = steps.iter().filter(leaves).map(|&(_, node)| node).collect();
        has_removed |= !leaving.is_empty();
        steps.retain(|(_, node)| !leaving.contains(node));
    }
    has_removed
}

/// The steps out of each state in which an activity without a duration returns, and in none of
/// whose outcomes the chart waits for something else where the activity was.
fn restless_steps(subject: &CheckedModel, found: &Exploration) -> Vec<Vec<(usize, NodeId)>> {
    let states = found.states();
    let mut waits: BTreeSet<(usize, NodeId)> = BTreeSet::new();
    for edge in found.edges() {
        let Some(node) = edge.returned else { continue };
        let (from, to) = (&states[edge.from], &states[edge.to]);
        let stays = to.is_active(node) && !to.running.contains(&node);
        let is_new_start =
            |node: &&NodeId| subject.kind(**node) == NodeKind::Start && !from.is_active(**node);
        if stays || to.configuration.iter().any(|node| is_new_start(&node)) {
            waits.insert((edge.from, node));
        }
    }
    let mut next = vec![Vec::new(); states.len()];
    for edge in found.edges() {
        let Some(node) = edge.returned else { continue };
        let takes_time = subject.chart.node(node).duration.is_some_and(|it| !it.is_zero());
        if !takes_time && !waits.contains(&(edge.from, node)) {
            next[edge.from].push((edge.to, node));
        }
    }
    next
}

/// The innermost region of an AND around a node.
fn region_of(subject: &CheckedModel, node: NodeId) -> Option<NodeId> {
    subject.chart.ancestors(node).find(|&it| subject.is_region(it))
}

/// The innermost composite around some nodes.
fn around(subject: &CheckedModel, nodes: &BTreeSet<NodeId>) -> Option<NodeId> {
    let first = nodes.first()?;
    let holds = |outer: &NodeId| nodes.iter().all(|&node| subject.contains(*outer, node));
    subject.chart.ancestors(*first).find(holds)
}

fn finding(subject: &CheckedModel, composite: NodeId) -> Diagnostic {
    let path = subject.path(composite);
    let message = format!("nothing in the loop `{path}` waits: it runs as fast as its activities return");
    let hint = "let it wait for a timer, `X -> X : [t] / StartTimeout(t, 100ms)`, for an event or for a message, or give an activity its `duration`";
    subject.warn("M27", composite, message).with_hint(hint)
}
