//! The roles of nodes in transitions.

use crate::compile::NodeOrder;
use crate::semantics::{Semantics, StructureRules};
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};

/// The role of a node in a transition.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum NodeRole {
    /// A state: transitions begin and end there. So they end at an entry point that leads nowhere,
    /// which stands for its composite.
    State,
    /// One of its outgoing segments is taken, selected before any action.
    Branch,
    /// All its outgoing segments are taken.
    Fork,
    /// All its incoming segments are taken.
    Join,
    /// One of its outgoing segments is taken, selected after the preceding actions.
    Choice,
    /// It represents the states that were active when its composite was left.
    History,
    /// It stops the chart.
    Terminate,
}

impl NodeRole {
    /// Whether transitions continue from it.
    pub(crate) fn is_connector(self) -> bool {
        !matches!(self, NodeRole::State | NodeRole::Terminate)
    }
}

/// The roles of all nodes, with their incoming and outgoing segments.
pub(crate) struct NodeRoles {
    roles: Vec<NodeRole>,
    /// The outgoing segments of each node, in the order of the model.
    pub(crate) outgoing: Vec<Vec<TransitionId>>,
    /// The incoming segments of each JOIN and exit point, in the order of the model.
    pub(crate) incoming: Vec<Vec<TransitionId>>,
}

impl NodeRoles {
    pub(crate) fn new(chart: &Statechart, layout: &NodeOrder, semantics: &Semantics) -> NodeRoles {
        let count = chart.nodes().len();
        let (mut outgoing, mut incoming) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for (id, transition) in chart.transitions() {
            outgoing[transition.source.0 as usize].push(id);
            if matches!(chart.node(transition.target).kind, NodeKind::Join | NodeKind::ExitPoint) {
                incoming[transition.target.0 as usize].push(id);
            }
        }
        let role = |id: NodeId| match (chart.node(id).kind, outgoing[id.0 as usize].as_slice()) {
            (NodeKind::EntryPoint, []) if semantics.structure == StructureRules::Uml => NodeRole::State,
            (_, outgoing) => role(chart, layout, id, outgoing),
        };
        let roles = chart.nodes().map(|(id, _)| role(id)).collect();
        NodeRoles { roles, outgoing, incoming }
    }

    pub(crate) fn of(&self, node: NodeId) -> NodeRole {
        self.roles[node.0 as usize]
    }
}

fn role(chart: &Statechart, layout: &NodeOrder, node: NodeId, outgoing: &[TransitionId]) -> NodeRole {
    match chart.node(node).kind {
        NodeKind::Condition | NodeKind::Junction | NodeKind::ExitPoint => NodeRole::Branch,
        NodeKind::EntryPoint if forks(chart, layout, node, outgoing) => NodeRole::Fork,
        NodeKind::EntryPoint => NodeRole::Branch,
        NodeKind::Fork => NodeRole::Fork,
        NodeKind::Join => NodeRole::Join,
        NodeKind::Choice => NodeRole::Choice,
        NodeKind::ShallowHistory | NodeKind::DeepHistory => NodeRole::History,
        NodeKind::Terminate => NodeRole::Terminate,
        NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End | NodeKind::Start => NodeRole::State,
    }
}

/// Whether an entry point of an AND leads into several of its regions without guards.
fn forks(chart: &Statechart, layout: &NodeOrder, point: NodeId, outgoing: &[TransitionId]) -> bool {
    let around = chart.node(point).parent.filter(|&parent| chart.node(parent).kind == NodeKind::And);
    let Some(and) = around.filter(|_| outgoing.len() > 1) else { return false };
    let mut regions: Vec<Option<NodeId>> = Vec::new();
    for &id in outgoing {
        let transition = chart.transition(id);
        let target = layout.index_of(transition.target);
        let holds = |region: &&NodeId| layout.contains(layout.index_of(**region), target);
        if transition.expression.guard.is_some() {
            return false;
        }
        regions.push(chart.children(and).iter().find(holds).copied());
    }
    regions.sort_unstable();
    let distinct = regions.windows(2).all(|pair| pair[0] != pair[1]);
    distinct && regions.iter().all(|region| region.is_some_and(|region| is_state(chart.node(region).kind)))
}

/// Whether a node can be a region of an AND.
pub(crate) fn is_state(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::Or | NodeKind::And | NodeKind::Basic)
}
