//! What a node is to a transition that comes by.

use crate::chart::Layout;
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};

/// What a node is to a transition that comes by.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Role {
    /// A state: transitions begin and end there.
    State,
    /// One of the segments that leave it is taken, which is decided before anything happens.
    Branch,
    /// All segments that leave it are taken.
    Fork,
    /// All segments that enter it are taken.
    Join,
    /// One of the segments that leave it is taken, which is decided when the actions before it have been done.
    Choice,
    /// It stands for what was active when its composite was left.
    History,
    /// It stops the chart.
    Terminate,
}

impl Role {
    /// Whether transitions go on from there.
    pub(super) fn is_connector(self) -> bool {
        !matches!(self, Role::State | Role::Terminate)
    }
}

/// The roles of all nodes, and the segments that enter and leave them.
pub(super) struct Roles {
    roles: Vec<Role>,
    /// The segments that leave each node, in the order of the model.
    pub(super) outgoing: Vec<Vec<TransitionId>>,
    /// The segments that enter each JOIN, in the order of the model.
    pub(super) incoming: Vec<Vec<TransitionId>>,
}

impl Roles {
    pub(super) fn new(chart: &Statechart, layout: &Layout) -> Roles {
        let count = chart.nodes().len();
        let (mut outgoing, mut incoming) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for (id, transition) in chart.transitions() {
            outgoing[transition.source.0 as usize].push(id);
            if chart.node(transition.target).kind == NodeKind::Join {
                incoming[transition.target.0 as usize].push(id);
            }
        }
        let roles = chart.nodes().map(|(id, _)| role(chart, layout, id, &outgoing[id.0 as usize])).collect();
        Roles { roles, outgoing, incoming }
    }

    pub(super) fn of(&self, node: NodeId) -> Role {
        self.roles[node.0 as usize]
    }
}

fn role(chart: &Statechart, layout: &Layout, node: NodeId, outgoing: &[TransitionId]) -> Role {
    match chart.node(node).kind {
        NodeKind::Condition | NodeKind::Junction | NodeKind::ExitPoint => Role::Branch,
        NodeKind::EntryPoint if forks(chart, layout, node, outgoing) => Role::Fork,
        NodeKind::EntryPoint => Role::Branch,
        NodeKind::Fork => Role::Fork,
        NodeKind::Join => Role::Join,
        NodeKind::Choice => Role::Choice,
        NodeKind::ShallowHistory | NodeKind::DeepHistory => Role::History,
        NodeKind::Terminate => Role::Terminate,
        NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End | NodeKind::Start => Role::State,
    }
}

/// Whether an entry point of an AND leads into several of its regions without asking.
fn forks(chart: &Statechart, layout: &Layout, point: NodeId, outgoing: &[TransitionId]) -> bool {
    let around = chart.node(point).parent.filter(|&parent| chart.node(parent).kind == NodeKind::And);
    let Some(and) = around.filter(|_| outgoing.len() > 1) else { return false };
    let mut regions: Vec<Option<NodeId>> = Vec::new();
    for &id in outgoing {
        let transition = chart.transition(id);
        let target = layout.place_of(transition.target);
        let holds = |region: &&NodeId| layout.contains(layout.place_of(**region), target);
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
pub(super) fn is_state(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::Or | NodeKind::And | NodeKind::Basic)
}
