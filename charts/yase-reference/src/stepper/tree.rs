//! The tree and the order of segments: R1, R3, R19.

use yase::statechart::{NodeId, NodeKind, Statechart, TransitionId};
use yase::{ScopeId, SegmentOrder};

use super::Stepper;

/// Structure of the chart, derived once.
pub(crate) struct Tree {
    /// Structure of the chart, derived once.
    pub document: Vec<NodeId>,
    pub position: Vec<usize>,
    /// Whether a node lies inside another, indexed by the outer node, then the inner one.
    pub inside: Vec<Vec<bool>>,
    /// The root and every region of an AND, in document order.
    pub regions: Vec<NodeId>,
    pub region: Vec<ScopeId>,
    /// The segments that leave a node, in the order of R3.
    pub outgoing: Vec<Vec<TransitionId>>,
    /// The sources of each JOIN.
    pub joined: Vec<Vec<NodeId>>,
    pub names: Vec<String>,
    /// The words in the guard of each segment.
    pub words: Vec<Vec<String>>,
}

impl Tree {
    pub(crate) fn new(chart: &Statechart, order: SegmentOrder) -> Tree {
        let document = document(chart);
        let mut position = vec![0; document.len()];
        for (index, node) in document.iter().enumerate() {
            position[node.0 as usize] = index;
        }
        let is_inside =
            |outer| chart.nodes().map(|(id, _)| chart.ancestors(id).any(|it| it == outer)).collect();
        let inside = chart.nodes().map(|(id, _)| is_inside(id)).collect();
        let regions: Vec<NodeId> =
            document.iter().copied().filter(|&node| owns_blackboard(chart, node)).collect();
        let owner = |node: NodeId| {
            let shared = |node: &NodeId| *node == Statechart::ROOT || is_region(chart, *node);
            let found = std::iter::once(node).chain(chart.ancestors(node)).find(shared);
            regions.iter().position(|&region| Some(region) == found).unwrap()
        };
        let region = chart.nodes().map(|(id, _)| ScopeId(owner(id) as u32)).collect();
        let outgoing = chart.nodes().map(|(id, _)| outgoing(chart, id, order)).collect();
        let joins = chart.nodes().filter(|(_, node)| node.kind == NodeKind::Join);
        let joined = joins.map(|(id, _)| sources(chart, id)).collect();
        let names = chart.nodes().map(|(id, _)| name(chart, id)).collect();
        let words = chart.transitions().map(|(_, it)| words(&it.expression)).collect();
        Tree { document, position, inside, regions, region, outgoing, joined, names, words }
    }
}

fn document(chart: &Statechart) -> Vec<NodeId> {
    fn visit(chart: &Statechart, node: NodeId, out: &mut Vec<NodeId>) {
        out.push(node);
        for &child in chart.children(node) {
            visit(chart, child, out);
        }
    }
    let mut out = vec![];
    visit(chart, Statechart::ROOT, &mut out);
    out
}

/// Nodes with a blackboard: the root, regions, and composites with an activity.
fn owns_blackboard(chart: &Statechart, node: NodeId) -> bool {
    let it = chart.node(node);
    let runs = it.activity.is_some() && it.kind != NodeKind::Basic;
    node == Statechart::ROOT || is_region(chart, node) || runs
}

/// A child of an AND that is a state.
fn is_region(chart: &Statechart, node: NodeId) -> bool {
    let states = [NodeKind::Or, NodeKind::And, NodeKind::Basic];
    let it = chart.node(node);
    it.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And) && states.contains(&it.kind)
}

/// R3: by priority, then guarded before unguarded, then in the order of the model.
fn outgoing(chart: &Statechart, node: NodeId, order: SegmentOrder) -> Vec<TransitionId> {
    let leaving = chart.transitions().filter(|(_, transition)| transition.source == node);
    let mut out: Vec<TransitionId> = leaving.map(|(id, _)| id).collect();
    out.sort_by_key(|&id| {
        let transition = chart.transition(id);
        let guarded_first = order == SegmentOrder::GuardedFirst;
        (-transition.priority, guarded_first && transition.expression.guard.is_none(), id)
    });
    out
}

fn sources(chart: &Statechart, join: NodeId) -> Vec<NodeId> {
    chart.transitions().filter(|(_, it)| it.target == join).map(|(_, it)| it.source).collect()
}

fn name(chart: &Statechart, node: NodeId) -> String {
    let path = chart.path(node);
    path.split_once('/').map_or(path.clone(), |(_, rest)| rest.to_owned())
}

fn words(expression: &yase::expression::TransitionExpression) -> Vec<String> {
    let text = expression.guard.as_ref().map(ToString::to_string).unwrap_or_default();
    text.split(|c: char| !c.is_alphanumeric()).map(str::to_owned).collect()
}

impl Stepper<'_> {
    pub(crate) fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    pub(crate) fn parent(&self, node: NodeId) -> NodeId {
        self.chart.node(node).parent.unwrap()
    }

    pub(crate) fn position(&self, node: NodeId) -> usize {
        self.tree.position[node.0 as usize]
    }

    pub(crate) fn is_inside(&self, node: NodeId, outer: NodeId) -> bool {
        self.tree.inside[outer.0 as usize][node.0 as usize]
    }

    pub(crate) fn is_region(&self, node: NodeId) -> bool {
        is_region(self.chart, node)
    }

    /// R19: the blackboard of a node, which is that of the innermost region that contains it; a
    /// region contains itself.
    pub(crate) fn region(&self, node: NodeId) -> ScopeId {
        self.tree.region[node.0 as usize]
    }

    pub(crate) fn active_in_document_order(&self) -> Vec<NodeId> {
        self.tree.document.iter().copied().filter(|node| self.active.contains(node)).collect()
    }

    pub(crate) fn active_children(&self, node: NodeId) -> Vec<NodeId> {
        self.chart.children(node).iter().copied().filter(|child| self.active.contains(child)).collect()
    }

    pub(crate) fn active_inside(&self, node: NodeId) -> Vec<NodeId> {
        let inside = |inner: &NodeId| self.is_inside(*inner, node) && self.active.contains(inner);
        self.tree.document.iter().copied().filter(inside).collect()
    }

    /// Active nodes without an active child: states without children, START, END, vacated regions.
    pub(crate) fn active_leaves(&self) -> Vec<NodeId> {
        let leaf = |node: &NodeId| self.active_children(*node).is_empty();
        self.active_in_document_order().into_iter().filter(leaf).collect()
    }

    /// The node and its ancestors, up to the root.
    pub(crate) fn outward(&self, node: NodeId) -> Vec<NodeId> {
        std::iter::once(node).chain(self.chart.ancestors(node)).collect()
    }

    pub(crate) fn outgoing(&self, node: NodeId) -> Vec<TransitionId> {
        self.tree.outgoing[node.0 as usize].clone()
    }

    pub(crate) fn name(&self, node: NodeId) -> String {
        self.tree.names[node.0 as usize].clone()
    }
}
