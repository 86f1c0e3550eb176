//! Checks connectors and the paths through them.

use std::collections::BTreeSet;

use super::ChartValidator;
use crate::compile::node_roles::{NodeRole, NodeRoles, is_state};
use crate::compile::node_span::{self, NodeSpan};
use crate::diagnostic::{Diagnostic, Span};
use crate::statechart::{Element, NodeId, NodeKind, TransitionId};

/// The maximum number of segments of a compound transition.
const MAX_SEGMENTS: usize = 256;

/// The length of the longest chain of connectors from a connector.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PathLength {
    Unknown,
    Open,
    Known(usize),
}

impl ChartValidator<'_> {
    pub(crate) fn connectors(&mut self, roles: &NodeRoles) {
        self.chains(roles);
        for (id, node) in self.chart.nodes() {
            self.about = Some(Element::Node(id));
            match node.kind {
                NodeKind::Fork => self.fork(id, roles),
                NodeKind::Join => self.join(id, roles),
                _ => {}
            }
        }
        if self.found.is_empty() {
            self.starts(roles);
        }
    }

    fn fork(&mut self, fork: NodeId, roles: &NodeRoles) {
        let outgoing = &roles.outgoing[fork.0 as usize];
        if outgoing.len() < 2 {
            let message = format!("FORK `{}` has fewer than two outgoing transitions", self.path(fork));
            self.error("M04", message);
        }
        if outgoing.iter().any(|&id| self.chart.transition(id).expression.guard.is_some()) {
            let message = format!("an outgoing transition of FORK `{}` has a guard", self.path(fork));
            self.error("M04", message).hint = Some("all outgoing transitions of a FORK are taken".into());
        }
    }

    fn join(&mut self, join: NodeId, roles: &NodeRoles) {
        let chart = self.chart;
        if roles.outgoing[join.0 as usize].len() != 1 {
            let message = format!("JOIN `{}` does not have exactly one outgoing transition", self.path(join));
            self.error("M04", message);
        }
        let incoming = &roles.incoming[join.0 as usize];
        let sources: Vec<NodeId> = incoming.iter().map(|&id| chart.transition(id).source).collect();
        if !self.can_join(&sources) {
            let message = format!("JOIN `{}` does not join states that are active together", self.path(join));
            self.error("M04", message).hint =
                Some("its two or more sources lie in different regions of one AND".into());
        }
    }

    /// Whether there are at least two states, each in a different region of one AND.
    fn can_join(&self, sources: &[NodeId]) -> bool {
        let hulls = sources.iter().map(|&source| NodeSpan::of(self.layout.index_of(source)));
        let Some(hull) = hulls.reduce(NodeSpan::with).filter(|_| sources.len() > 1) else { return false };
        let around = node_span::lowest_node(self.chart, self.layout, hull);
        let region = |&source: &NodeId| node_span::child_towards(self.chart, around, source);
        let regions: BTreeSet<Option<NodeId>> = sources.iter().map(region).collect();
        let are_states = sources.iter().all(|&source| is_state(self.kind(source)));
        self.kind(around) == NodeKind::And
            && are_states
            && regions.len() == sources.len()
            && regions.iter().all(Option::is_some)
    }

    /// Follows the paths through connectors: none may form a cycle, end nowhere, or be too long.
    fn chains(&mut self, roles: &NodeRoles) {
        let chart = self.chart;
        let mut lengths: Vec<PathLength> = vec![PathLength::Unknown; chart.nodes().len()];
        for (id, _) in chart.nodes() {
            if roles.of(id).is_connector() && lengths[id.0 as usize] == PathLength::Unknown {
                self.follow(id, roles, &mut lengths);
            }
        }
    }

    fn follow(&mut self, from: NodeId, roles: &NodeRoles, lengths: &mut [PathLength]) {
        let mut open = vec![(from, 0)];
        lengths[from.0 as usize] = PathLength::Open;
        while let Some((node, visited)) = open.pop() {
            let outgoing = &roles.outgoing[node.0 as usize];
            let Some(&id) = outgoing.get(visited) else {
                self.close(node, outgoing, roles, lengths);
                continue;
            };
            open.push((node, visited + 1));
            let target = self.chart.transition(id).target;
            if !roles.of(target).is_connector() {
                continue;
            }
            match lengths[target.0 as usize] {
                PathLength::Unknown => {
                    lengths[target.0 as usize] = PathLength::Open;
                    open.push((target, 0));
                }
                PathLength::Open => self.report_cycle(target, &open),
                PathLength::Known(_) => {}
            }
        }
    }

    /// Only a HISTORY may have no outgoing transition: without a record it then leads to START.
    fn close(
        &mut self,
        node: NodeId,
        outgoing: &[TransitionId],
        roles: &NodeRoles,
        lengths: &mut [PathLength],
    ) {
        self.about = Some(Element::Node(node));
        if outgoing.is_empty() && roles.of(node) != NodeRole::History {
            let message = format!("no path continues from `{}`", self.path(node));
            self.error("M06", message);
        }
        let longest = outgoing.iter().map(|&id| match lengths[self.chart.transition(id).target.0 as usize] {
            PathLength::Known(length) => length,
            _ => 0,
        });
        let length = longest.max().unwrap_or(0) + 1;
        lengths[node.0 as usize] = PathLength::Known(length);
        if length == MAX_SEGMENTS {
            let message =
                format!("more than {MAX_SEGMENTS} connectors follow one another at `{}`", self.path(node));
            self.error("M06", message);
        }
    }

    fn report_cycle(&mut self, target: NodeId, open: &[(NodeId, usize)]) {
        self.about = Some(Element::Node(target));
        let begin = open.iter().position(|&(node, _)| node == target).unwrap_or(0);
        let circle: Vec<String> =
            open[begin..].iter().map(|&(node, _)| node).chain([target]).map(|node| self.path(node)).collect();
        self.error("M06", format!("connectors lead in a circle: `{}`", circle.join("` -> `")));
    }

    /// Checks where STARTs lead, and whether STARTs and CHOICEs may lead nowhere.
    fn starts(&mut self, roles: &NodeRoles) {
        for (id, node) in self.chart.nodes() {
            let is_start = node.kind == NodeKind::Start;
            if !is_start && node.kind != NodeKind::Choice {
                continue;
            }
            self.about = Some(Element::Node(id));
            let (targets, is_sure) = self.reachable_ends(id, roles);
            if is_start {
                targets.into_iter().for_each(|target| self.start_target(id, target));
            }
            if !is_sure {
                let (code, then) = if is_start { ("M01", "stay there") } else { ("M05", "fail there") };
                let message = format!(
                    "every outgoing transition of `{}` has a guard: the chart may {then}",
                    self.path(id)
                );
                self.report(Diagnostic::warning(code, Span::default(), message));
            }
        }
    }

    fn start_target(&mut self, start: NodeId, target: NodeId) {
        let Some(parent) = self.chart.node(start).parent else { return };
        let is_inside = target != parent && self.contains(parent, target);
        if self.kind(target) != NodeKind::Terminate && !is_inside {
            let message =
                format!("`{}` leads out of its composite, to `{}`", self.path(start), self.path(target));
            self.error("M01", message);
        }
    }

    /// The ends of the paths out of a START or a CHOICE, and whether one of them has no guard up to
    /// there or to the next CHOICE.
    fn reachable_ends(&self, from: NodeId, roles: &NodeRoles) -> (BTreeSet<NodeId>, bool) {
        let (mut targets, mut is_sure) = (BTreeSet::new(), false);
        let mut open = vec![(from, true)];
        let mut seen = BTreeSet::new();
        while let Some((node, unguarded)) = open.pop() {
            for &id in &roles.outgoing[node.0 as usize] {
                let transition = self.chart.transition(id);
                let unguarded = unguarded && transition.expression.guard.is_none();
                let role = roles.of(transition.target);
                let goes_on =
                    matches!(role, NodeRole::Branch | NodeRole::Fork | NodeRole::Join | NodeRole::Choice);
                is_sure |= unguarded && (!goes_on || role == NodeRole::Choice);
                if !goes_on {
                    targets.insert(transition.target);
                } else if seen.insert((transition.target, unguarded)) {
                    open.push((transition.target, unguarded));
                }
            }
        }
        (targets, is_sure)
    }
}
