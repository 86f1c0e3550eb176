//! Every complete way out of every state: compound transitions, in the order in which they are tried.

use crate::chart::{Condition, Layout, Place, RegionId, check};
use crate::diagnostic::{Diagnostic, Span};
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};

/// A chart with more compound transitions is refused: connectors that fan out and in again multiply.
const MAX_WAYS: usize = 1_000_000;

/// One compound transition.
#[derive(Clone, Debug)]
pub(super) struct Way {
    pub(super) segments: Vec<TransitionId>,
    pub(super) source: NodeId,
    /// What is left and entered happens inside this node.
    pub(super) scope: NodeId,
    pub(super) target: NodeId,
    /// The blackboard of its scope.
    pub(super) region: RegionId,
    /// Without a trigger: when it may be taken. Triggers are numbered later.
    pub(super) condition: Option<Condition>,
}

impl Way {
    /// Whether it happens inside its source without touching any state.
    pub(super) fn is_targetless(&self, chart: &Statechart) -> bool {
        self.source == self.target && self.segments.iter().any(|&id| chart.transition(id).internal)
    }
}

/// The ways out of each node, by [`NodeId`], each list in the order in which its ways are tried.
pub(super) fn find(
    chart: &Statechart,
    layout: &Layout,
    regions: &[RegionId],
) -> Result<Vec<Vec<Way>>, Vec<Diagnostic>> {
    let mut search =
        Search { chart, layout, regions, outgoing: outgoing(chart), count: 0, errors: Vec::new() };
    let mut ways = vec![Vec::new(); chart.nodes().len()];
    for (id, node) in chart.nodes() {
        if !check::is_connector(node.kind) {
            search.follow(id, id, &mut Vec::new(), &mut ways[id.0 as usize]);
        }
    }
    if search.errors.is_empty() { Ok(ways) } else { Err(search.errors) }
}

/// The segments that leave each node: higher priority first, then those with a guard, then as in the model.
fn outgoing(chart: &Statechart) -> Vec<Vec<TransitionId>> {
    let mut outgoing = vec![Vec::new(); chart.nodes().len()];
    for (id, transition) in chart.transitions() {
        outgoing[transition.source.0 as usize].push(id);
    }
    for segments in &mut outgoing {
        segments.sort_by_key(|&id| {
            let transition = chart.transition(id);
            (std::cmp::Reverse(transition.priority), transition.expression.guard.is_none(), id)
        });
    }
    outgoing
}

struct Search<'a> {
    chart: &'a Statechart,
    layout: &'a Layout,
    regions: &'a [RegionId],
    outgoing: Vec<Vec<TransitionId>>,
    count: usize,
    errors: Vec<Diagnostic>,
}

impl Search<'_> {
    /// Depth first; chains of connectors are short and free of circles, which has been checked.
    fn follow(&mut self, source: NodeId, at: NodeId, trail: &mut Vec<TransitionId>, ways: &mut Vec<Way>) {
        for index in 0..self.outgoing[at.0 as usize].len() {
            if self.count > MAX_WAYS {
                return;
            }
            let id = self.outgoing[at.0 as usize][index];
            let target = self.chart.transition(id).target;
            trail.push(id);
            if check::is_connector(self.chart.node(target).kind) {
                self.follow(source, target, trail, ways);
            } else {
                self.complete(source, target, trail, ways);
            }
            trail.pop();
        }
    }

    fn complete(&mut self, source: NodeId, target: NodeId, trail: &[TransitionId], ways: &mut Vec<Way>) {
        self.count += 1;
        if self.count > MAX_WAYS {
            let path = self.chart.path(source);
            let message = format!("more than {MAX_WAYS} compound transitions, up to those out of `{path}`");
            self.errors.push(Diagnostic::error("M06", Span::default(), message));
            return;
        }
        let internal = trail.iter().any(|&id| self.chart.transition(id).internal);
        let Some(scope) = self.scope(source, target, internal) else {
            self.refuse(source, target);
            return;
        };
        ways.push(Way {
            segments: trail.to_vec(),
            source,
            scope,
            target,
            region: self.regions[scope.0 as usize],
            condition: self.condition(source, target, trail),
        });
    }

    /// The lowest OR that properly contains both ends; the source itself if the transition is internal.
    fn scope(&self, source: NodeId, target: NodeId, internal: bool) -> Option<NodeId> {
        let (inner, outer) = (self.layout.place_of(target), self.layout.place_of(source));
        if internal {
            return self.layout.contains(outer, inner).then_some(source);
        }
        let common = self.chart.ancestors(source).find(|&ancestor| {
            let place = self.layout.place_of(ancestor);
            target != ancestor && self.layout.contains(place, inner)
        })?;
        if self.chart.node(common).kind != NodeKind::And {
            return Some(common);
        }
        // an AND lies in an OR, always
        if self.nested(source, target) { self.chart.node(common).parent } else { None }
    }

    /// Whether one is the other or lies in it.
    fn nested(&self, one: NodeId, other: NodeId) -> bool {
        let (one, other) = (self.layout.place_of(one), self.layout.place_of(other));
        self.layout.contains(one, other) || self.layout.contains(other, one)
    }

    fn refuse(&mut self, source: NodeId, target: NodeId) {
        let (source, target) = (self.chart.path(source), self.chart.path(target));
        let message = format!("no transition can lead from `{source}` to `{target}`");
        let hint = "regions that are active together cannot be left for each other, and what is internal stays inside";
        self.errors.push(Diagnostic::error("M03", Span::default(), message).with_hint(hint));
    }

    /// When a way without a trigger may be taken: guardedness is that of its first segment.
    fn condition(&self, source: NodeId, target: NodeId, trail: &[TransitionId]) -> Option<Condition> {
        let first = &self.chart.transition(*trail.first()?).expression;
        let composite = matches!(self.chart.node(source).kind, NodeKind::Or | NodeKind::And);
        let interrupts = trail.iter().any(|&id| self.chart.transition(id).interrupts);
        match &first.trigger {
            Some(_) => None,
            None if !composite || first.guard.is_none() || source == target => Some(Condition::Completed),
            None if interrupts => Some(Condition::NoStepInside),
            None => Some(Condition::Quiescent),
        }
    }
}

/// The places to be entered, outermost first, on the way from a scope to a target inside it: where the way enters an AND, all its
/// other regions are entered too; where it ends, composites are entered up to their START.
pub(super) fn entries(chart: &Statechart, layout: &Layout, scope: NodeId, target: NodeId) -> Vec<Place> {
    let mut way: Vec<NodeId> =
        std::iter::once(target).chain(chart.ancestors(target)).take_while(|&node| node != scope).collect();
    let mut entered = Vec::new();
    // what is still to be entered, the next one last, and whether it lies on the way
    let mut open: Vec<(NodeId, bool)> = Vec::new();
    push_children(chart, scope, way.pop(), &mut open);
    while let Some((node, on_way)) = open.pop() {
        entered.push(layout.place_of(node));
        let next = if on_way { way.pop() } else { None };
        push_children(chart, node, next, &mut open);
    }
    entered
}

/// Pushes the children of an entered node that are entered with it, the first one last.
fn push_children(chart: &Statechart, node: NodeId, next: Option<NodeId>, open: &mut Vec<(NodeId, bool)>) {
    let children = chart.children(node).iter().rev();
    match chart.node(node).kind {
        NodeKind::And => open.extend(children.map(|&child| (child, Some(child) == next))),
        NodeKind::Or => match next {
            Some(next) => open.push((next, true)),
            None => open.extend(
                children
                    .filter(|&&child| chart.node(child).kind == NodeKind::Start)
                    .map(|&start| (start, false)),
            ),
        },
        _ => {}
    }
}
