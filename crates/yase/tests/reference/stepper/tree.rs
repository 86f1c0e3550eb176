//! The tree, and the ways through it: R2, R3, R6.

use super::{Stepper, Way};
use yase::RegionId;
use yase::statechart::{NodeId, NodeKind, Statechart, TransitionId};

impl Stepper<'_> {
    pub(super) fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    /// Every node, a parent before its children, siblings in order.
    pub(super) fn document(&self) -> Vec<NodeId> {
        fn visit(chart: &Statechart, node: NodeId, out: &mut Vec<NodeId>) {
            out.push(node);
            for &child in chart.children(node) {
                visit(chart, child, out);
            }
        }
        let mut out = vec![];
        visit(self.chart, Statechart::ROOT, &mut out);
        out
    }

    pub(super) fn position(&self, node: NodeId) -> usize {
        self.document().iter().position(|&other| other == node).unwrap()
    }

    pub(super) fn is_inside(&self, node: NodeId, outer: NodeId) -> bool {
        self.chart.ancestors(node).any(|ancestor| ancestor == outer)
    }

    pub(super) fn is_region(&self, node: NodeId) -> bool {
        self.chart.node(node).parent.is_some_and(|parent| self.kind(parent) == NodeKind::And)
    }

    pub(super) fn region_nodes(&self) -> Vec<NodeId> {
        let regions = self.document().into_iter().filter(|&node| self.is_region(node));
        std::iter::once(Statechart::ROOT).chain(regions).collect()
    }

    /// R19: the blackboard of a node: that of the nearest region around it, itself included.
    pub(super) fn region(&self, node: NodeId) -> RegionId {
        let regions = self.region_nodes();
        let owner =
            std::iter::once(node).chain(self.chart.ancestors(node)).find(|node| regions.contains(node));
        RegionId(regions.iter().position(|&region| Some(region) == owner).unwrap() as u32)
    }

    pub(super) fn active_in_document_order(&self) -> Vec<NodeId> {
        self.document().into_iter().filter(|node| self.active.contains(node)).collect()
    }

    pub(super) fn is_leaf(&self, node: NodeId) -> bool {
        !matches!(self.kind(node), NodeKind::Or | NodeKind::And)
    }

    pub(super) fn outgoing(&self, node: NodeId) -> Vec<TransitionId> {
        let mut out: Vec<TransitionId> = self
            .chart
            .transitions()
            .filter(|(_, transition)| transition.source == node)
            .map(|(id, _)| id)
            .collect();
        out.sort_by_key(|&id| {
            let transition = self.chart.transition(id);
            (-transition.priority, u8::from(transition.expression.guard.is_none()), id)
        });
        out
    }

    pub(super) fn ways(&self, node: NodeId) -> Vec<Way> {
        let mut all = vec![];
        for id in self.outgoing(node) {
            let target = self.chart.transition(id).target;
            if matches!(self.kind(target), NodeKind::Condition | NodeKind::Junction) {
                for rest in self.ways(target) {
                    all.push([vec![id], rest].concat());
                }
            } else {
                all.push(vec![id]);
            }
        }
        all
    }

    pub(super) fn source(&self, way: &Way) -> NodeId {
        self.chart.transition(way[0]).source
    }

    pub(super) fn target(&self, way: &Way) -> NodeId {
        self.chart.transition(*way.last().unwrap()).target
    }

    pub(super) fn is_internal(&self, way: &Way) -> bool {
        way.iter().any(|&id| self.chart.transition(id).internal)
    }

    pub(super) fn interrupts(&self, way: &Way) -> bool {
        way.iter().any(|&id| self.chart.transition(id).interrupts)
    }

    pub(super) fn scope(&self, way: &Way) -> NodeId {
        let (source, target) = (self.source(way), self.target(way));
        if self.is_internal(way) {
            return source;
        }
        self.chart
            .ancestors(source)
            .find(|&node| self.kind(node) == NodeKind::Or && self.is_inside(target, node))
            .unwrap()
    }

    /// The active states a way would leave, innermost first, the first region first.
    pub(super) fn exits(&self, way: &Way) -> Vec<NodeId> {
        fn visit(stepper: &Stepper<'_>, node: NodeId, out: &mut Vec<NodeId>) {
            for &child in stepper.chart.children(node) {
                if stepper.active.contains(&child) {
                    visit(stepper, child, out);
                    out.push(child);
                }
            }
        }
        let targetless = self.is_internal(way) && self.source(way) == self.target(way);
        let mut out = vec![];
        if !targetless && self.kind(self.target(way)) != NodeKind::Terminate {
            visit(self, self.scope(way), &mut out);
        }
        out
    }
}
