//! Joins: XState has none, but a guard may ask whether several states are active.

use super::super::lost::Lost;
use super::ways::{Role, Way, Ways, role};
use crate::statechart::{NodeId, NodeKind, Statechart, Transition};

/// For each node the ways over joins that leave states in it: they belong to the innermost state that holds all their sources.
pub(super) fn joins<'a>(
    chart: &'a Statechart,
    ways: &mut Ways<'a>,
    lost: &mut Lost<'_>,
) -> Vec<Vec<Way<'a>>> {
    let mut joins = vec![Vec::new(); chart.nodes().len()];
    let mut incoming: Vec<Vec<&Transition>> = vec![Vec::new(); chart.nodes().len()];
    for (id, _) in chart.nodes().filter(|&(id, _)| role(chart, id) == Role::Rest) {
        for &segment in ways.outgoing(id) {
            incoming[segment.target.0 as usize].push(segment);
        }
    }
    for (join, _) in chart.nodes().filter(|&(id, _)| role(chart, id) == Role::Join) {
        let segments = &incoming[join.0 as usize];
        let Some(around) = common_ancestor(chart, segments) else { continue };
        let triggers = segments.iter().filter_map(|it| it.expression.trigger.as_ref());
        if triggers.clone().any(|trigger| triggers.clone().any(|other| other != trigger)) {
            lost.left_out(format!("the ways into `{}` wait for different events", chart.path(join)));
            continue;
        }
        completions(chart, segments, lost);
        for way in ways.from(join, lost) {
            joins[around.0 as usize].push(Way {
                joined: segments.iter().map(|segment| segment.source).collect(),
                segments: segments.iter().chain(&way.segments).copied().collect(),
                targets: way.targets,
            });
        }
    }
    joins
}

/// A join waits until its sources are complete; the guard asks whether they are active.
fn completions(chart: &Statechart, segments: &[&Transition], lost: &mut Lost<'_>) {
    for segment in segments {
        let source = chart.node(segment.source);
        if source.kind != NodeKind::Basic || source.activity.is_some() {
            let arrow = lost.arrow(segment);
            lost.moment(format!("{arrow} waits until its source is complete, in XState until it is active"));
        }
    }
}

/// The innermost composite around the sources of all segments: whatever else holds a node is no state of XState's.
fn common_ancestor(chart: &Statechart, segments: &[&Transition]) -> Option<NodeId> {
    let (first, others) = segments.split_first()?;
    let holds_all = |around: &NodeId| {
        matches!(chart.node(*around).kind, NodeKind::Or | NodeKind::And)
            && others
                .iter()
                .all(|segment| chart.ancestors(segment.source).any(|ancestor| ancestor == *around))
    };
    chart.ancestors(first.source).find(holds_all)
}
