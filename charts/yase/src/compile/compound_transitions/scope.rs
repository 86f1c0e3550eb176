//! The scope of a path: the node inside which it leaves and enters states.

use std::collections::BTreeSet;

use super::{CompoundPathSearch, ConfigurationChange, PartialPath};
use crate::compile::node_roles::NodeRole;
use crate::compile::node_span::{self, NodeSpan};
use crate::semantics::{Firing, StructureRules, TerminateExit, TransitionToAncestor};
use crate::statechart::{NodeId, NodeKind, TransitionId};

impl CompoundPathSearch<'_> {
    /// The node inside which states are left and entered.
    pub(super) fn scope(
        &mut self,
        source: NodeId,
        others: &[NodeId],
        path: &PartialPath,
    ) -> Option<(NodeId, ConfigurationChange)> {
        let stops = self.semantics.terminate == TerminateExit::Nothing
            && path.ends.iter().all(|&end| self.leads_to_terminate(end));
        let mut hull = NodeSpan::of(self.layout.index_of(source));
        for &node in others {
            hull = hull.with(NodeSpan::of(self.layout.index_of(node)));
        }
        for &end in &path.ends {
            // only if there is no other end: this search can be long
            hull = hull.with(self.target_span(end).unwrap_or_else(|| self.terminate_span(end)));
        }
        if self.walks_segments() {
            hull = self.passed(path).fold(hull, NodeSpan::with);
        }
        if let Some(arrival) = path.arrival {
            let around = self.chart.node(arrival.region).parent.unwrap_or(arrival.region);
            hull = hull.with(NodeSpan::of(self.layout.index_of(around)));
        }
        let is_inside = node_span::lowest_node(self.chart, self.layout, hull) == source;
        match (self.is_internal(source, path), is_inside, self.semantics.structure) {
            (true, true, _) => {
                let passes = self.walks_segments() && path.segments.len() > 1;
                let still = stops || path.ends[..] == [source] && !passes;
                let change = if still { ConfigurationChange::None } else { ConfigurationChange::Scope };
                return Some((source, change));
            }
            (true, false, StructureRules::Strict) => return None,
            _ => {}
        }
        if let Some(vacated) = self.completes_ancestor(source, others, path) {
            return Some((vacated, ConfigurationChange::Vacates));
        }
        let scope = node_span::lowest_or(self.chart, self.layout, source, hull)?;
        Some((scope, if stops { ConfigurationChange::None } else { ConfigurationChange::Scope }))
    }

    fn walks_segments(&self) -> bool {
        self.semantics.firing == Firing::EachSegment
    }

    /// The connectors on a path.
    fn passed(&self, path: &PartialPath) -> impl Iterator<Item = NodeSpan> {
        let targets = path.segments.iter().map(|&id| self.chart.transition(id).target);
        let connectors = targets.filter(|&node| self.roles.of(node).is_connector());
        connectors.map(|node| NodeSpan::of(self.layout.index_of(node)))
    }

    /// In UML only the segment out of a state can be internal (local).
    fn is_internal(&self, source: NodeId, path: &PartialPath) -> bool {
        let internal = |&id: &TransitionId| self.chart.transition(id).internal;
        match self.semantics.structure {
            StructureRules::Strict => path.segments.iter().any(internal),
            StructureRules::Uml => {
                let from_source = |id: &&TransitionId| self.chart.transition(**id).source == source;
                path.segments.iter().filter(from_source).any(internal)
            }
        }
    }

    /// The composite that remains without an active child when the target is an ancestor of the
    /// source that then counts as complete.
    fn completes_ancestor(&self, source: NodeId, others: &[NodeId], path: &PartialPath) -> Option<NodeId> {
        let (&[target], TransitionToAncestor::Completed) = (path.ends.as_slice(), self.semantics.ancestor)
        else {
            return None;
        };
        if !others.is_empty() || !self.chart.ancestors(source).any(|ancestor| ancestor == target) {
            return None;
        }
        let vacated = match self.chart.node(target).kind {
            NodeKind::And => node_span::child_towards(self.chart, target, source)?,
            _ => target,
        };
        // a connector outside has it left
        let node = self.layout.index_of(vacated);
        let inside = |&id: &TransitionId| {
            let passed = self.layout.index_of(self.chart.transition(id).target);
            passed == self.layout.index_of(target) || self.layout.contains(node, passed)
        };
        (!self.walks_segments() || path.segments.iter().all(inside)).then_some(vacated)
    }

    /// The span of all possible ends of a path behind a node, except a TERMINATE at which nothing
    /// is left, and of the connectors to which segments lead.
    pub(super) fn target_span(&mut self, end: NodeId) -> Option<NodeSpan> {
        let own = NodeSpan::of(self.layout.index_of(end));
        match self.roles.of(end) {
            NodeRole::Terminate => (self.semantics.terminate == TerminateExit::Source).then_some(own),
            NodeRole::State | NodeRole::History => Some(own),
            _ => {
                if let Some(&hull) = self.hulls.get(&end) {
                    return hull;
                }
                let mut hull: Option<NodeSpan> = None;
                for index in 0..self.roles.outgoing[end.0 as usize].len() {
                    let target = self.chart.transition(self.roles.outgoing[end.0 as usize][index]).target;
                    let behind = self.target_span(target);
                    hull = hull.into_iter().chain(behind).reduce(NodeSpan::with);
                }
                if self.walks_segments() {
                    hull = hull.map(|hull| hull.with(own));
                }
                self.hulls.insert(end, hull);
                hull
            }
        }
    }

    /// The span of all TERMINATEs behind a node that leads to nothing else: its targets, as there
    /// are no others.
    fn terminate_span(&self, end: NodeId) -> NodeSpan {
        let found =
            self.ends_behind(end).into_iter().filter(|&node| self.roles.of(node) == NodeRole::Terminate);
        let spans = found.map(|node| NodeSpan::of(self.layout.index_of(node)));
        spans.reduce(NodeSpan::with).unwrap_or(NodeSpan::of(self.layout.index_of(end)))
    }

    /// Whether a node leads to nothing but TERMINATEs.
    pub(super) fn leads_to_terminate(&mut self, end: NodeId) -> bool {
        match (self.roles.of(end), self.terminates.get(&end)) {
            (NodeRole::Terminate, _) => return true,
            (NodeRole::State | NodeRole::History, _) => return false,
            (_, Some(&known)) => return known,
            _ => {}
        }
        let found = self.ends_behind(end).iter().all(|&node| self.roles.of(node) == NodeRole::Terminate);
        self.terminates.insert(end, found);
        found
    }

    /// The nodes at which paths behind a node may end.
    fn ends_behind(&self, end: NodeId) -> Vec<NodeId> {
        let mut ends = Vec::new();
        let (mut open, mut seen) = (vec![end], BTreeSet::new());
        while let Some(node) = open.pop() {
            match self.roles.of(node) {
                NodeRole::State | NodeRole::History | NodeRole::Terminate => ends.push(node),
                _ if seen.insert(node) => {
                    let outgoing = &self.roles.outgoing[node.0 as usize];
                    open.extend(outgoing.iter().map(|&id| self.chart.transition(id).target));
                }
                _ => {}
            }
        }
        ends
    }
}
