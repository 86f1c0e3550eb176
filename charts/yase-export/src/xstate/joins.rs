//! Joins: XState has none, but a guard can test whether several states are active.

use super::super::loss_report::LossReport;
use super::transitions::{ConnectorRole, ResolvedTransition, TransitionResolver, role};
use yase::statechart::{NodeId, NodeKind, Statechart, Transition};

/// For each node the paths over joins that exit states in it. They belong to the innermost state
/// that contains all their sources.
pub(crate) fn joins<'a>(
    chart: &'a Statechart,
    resolver: &mut TransitionResolver<'a>,
    lost: &mut LossReport<'_>,
) -> Vec<Vec<ResolvedTransition<'a>>> {
    let mut joins = vec![Vec::new(); chart.nodes().len()];
    let mut incoming: Vec<Vec<&Transition>> = vec![Vec::new(); chart.nodes().len()];
    for (id, _) in chart.nodes().filter(|&(id, _)| role(chart, id) == ConnectorRole::Rest) {
        for &segment in resolver.outgoing(id) {
            incoming[segment.target.0 as usize].push(segment);
        }
    }
    for (join, _) in chart.nodes().filter(|&(id, _)| role(chart, id) == ConnectorRole::Join) {
        let segments = &incoming[join.0 as usize];
        let Some(around) = common_ancestor(chart, segments) else { continue };
        let triggers = segments.iter().filter_map(|it| it.expression.trigger.as_ref());
        if triggers.clone().any(|trigger| triggers.clone().any(|other| other != trigger)) {
            lost.report_omitted(format!(
                "the transitions into `{}` wait for different events",
                chart.path(join)
            ));
            continue;
        }
        completions(chart, segments, lost);
        for transition in resolver.from(join, lost) {
            joins[around.0 as usize].push(ResolvedTransition {
                joined: segments.iter().map(|segment| segment.source).collect(),
                segments: segments.iter().chain(&transition.segments).copied().collect(),
                targets: transition.targets,
            });
        }
    }
    joins
}

/// A join waits until its sources have completed; the guard tests whether they are active.
fn completions(chart: &Statechart, segments: &[&Transition], lost: &mut LossReport<'_>) {
    for segment in segments {
        let source = chart.node(segment.source);
        if source.kind != NodeKind::Basic || source.activity.is_some() {
            let arrow = lost.arrow(segment);
            lost.moment(format!("{arrow} waits until its source is complete, in XState until it is active"));
        }
    }
}

/// The innermost composite around the sources of all segments that is a state of XState.
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
