//! A statechart as data: a tree of nodes, and transitions between them.
//!
//! Model files, formulas and editors produce a [`Statechart`]; checks, drawings and the compiler
//! read it. It holds parsed expressions, not compiled ones, and has no behaviour.

mod brief_names;
mod layout;
mod state_names;

use std::sync::Arc;
use std::time::Duration;

pub use brief_names::BriefNames;
pub use layout::{Frame, Layout, Point};
pub use state_names::{StateNames, UnknownState};

pub use crate::expression::{Constant, ConstantValue, NodeId};

use crate::expression::{Action, TransitionExpression};

/// A transition (one segment), by its index in [`Statechart::transitions`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TransitionId(pub u32);

/// A part of a chart to which diagnostics refer.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Element {
    /// A node.
    Node(NodeId),
    /// A transition.
    Transition(TransitionId),
}

/// The kind of a node. `Or`, `And`, `Basic` and `End` are states. The others are connectors, which
/// are never active, except for START.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum NodeKind {
    /// A composite of which one child is active at a time.
    Or,
    /// A composite whose children are active together: its regions, each an OR, a BASIC state or an
    /// AND.
    And,
    /// A state without children; it may have an activity.
    Basic,
    /// The final state of a composite.
    End,
    /// The initial pseudostate of a composite.
    Start,
    /// A branch whose guards are evaluated before any action.
    Condition,
    /// Segments joined into one transition, evaluated before any action.
    Junction,
    /// A branch whose guards are evaluated after the preceding actions.
    Choice,
    /// One source, targets in several regions.
    Fork,
    /// Sources in several regions, one target.
    Join,
    /// The last active child of the composite.
    ShallowHistory,
    /// The last active configuration of the composite.
    DeepHistory,
    /// Stops the whole chart.
    Terminate,
    /// A named entry into a composite.
    EntryPoint,
    /// A named exit from a composite.
    ExitPoint,
}

/// A node of a chart.
#[derive(Clone, PartialEq, Debug)]
pub struct Node {
    /// Its kind.
    pub kind: NodeKind,
    /// Its name as written (a term of a formula, blanks removed, `~` for forever), or empty for
    /// connectors and regions that are identified by their position only.
    pub name: String,
    /// The composite that contains it; none for the root.
    pub parent: Option<NodeId>,
    /// The activity that a BASIC state runs, by the name it is registered under.
    pub activity: Option<String>,
    /// Priority of its activity in the thread pool; higher runs first.
    pub priority: i32,
    /// Actions executed on every entry.
    pub entry: Vec<Action>,
    /// Actions executed on every exit.
    pub exit: Vec<Action>,
    /// Events deferred while it is active.
    pub defer: Vec<String>,
    /// The duration of its activity in simulated time.
    pub duration: Option<Duration>,
}

impl Node {
    /// A node with a kind and a name, and default values otherwise.
    pub fn new(kind: NodeKind, name: impl Into<String>) -> Node {
        Node {
            kind,
            name: name.into(),
            parent: None,
            activity: None,
            priority: 0,
            entry: Vec::new(),
            exit: Vec::new(),
            defer: Vec::new(),
            duration: None,
        }
    }
}

/// One segment of a transition.
#[derive(Clone, PartialEq, Debug)]
pub struct Transition {
    /// The node that it leaves.
    pub source: NodeId,
    /// The node to which it leads.
    pub target: NodeId,
    /// Trigger, guard and actions.
    pub expression: TransitionExpression,
    /// Higher is tried first among the segments that leave one node.
    pub priority: i32,
    /// Weight of a probabilistic branch.
    pub weight: Option<f64>,
    /// Whether it may leave states whose activities are running: these are requested to return, and
    /// the transition is taken when they have.
    pub interrupts: bool,
    /// Whether it is executed inside its source, without leaving it.
    pub internal: bool,
}

impl Transition {
    /// A transition without trigger, guard or actions.
    pub fn new(source: NodeId, target: NodeId) -> Transition {
        let expression = TransitionExpression::default();
        Transition {
            source,
            target,
            expression,
            priority: 0,
            weight: None,
            interrupts: false,
            internal: false,
        }
    }
}

/// A statechart: nodes in a tree, transitions between them, constants for their expressions.
///
/// Cloning is cheap for charts of any size: clones share their data until one is changed. Two
/// charts are equal if their content is, regardless of their layout.
#[derive(Clone, Debug)]
pub struct Statechart {
    /// The model's name.
    pub name: String,
    /// Constants that its expressions may use.
    pub constants: Vec<Constant>,
    /// The positions of its parts in drawings.
    pub layout: Layout,
    parts: Arc<Parts>,
}

impl PartialEq for Statechart {
    fn eq(&self, other: &Statechart) -> bool {
        self.name == other.name && self.constants == other.constants && self.parts == other.parts
    }
}

#[derive(Clone, PartialEq, Debug)]
struct Parts {
    nodes: Vec<Node>,
    children: Vec<Vec<NodeId>>,
    transitions: Vec<Transition>,
}

impl Statechart {
    /// A chart with only its root, an OR.
    pub fn new(name: impl Into<String>) -> Statechart {
        let name = name.into();
        let root = Node::new(NodeKind::Or, name.clone());
        let parts = Parts { nodes: vec![root], children: vec![vec![]], transitions: vec![] };
        Statechart { name, constants: vec![], layout: Layout::default(), parts: Arc::new(parts) }
    }

    /// The root.
    pub const ROOT: NodeId = NodeId(0);

    /// Adds a node as the last child of `parent`.
    ///
    /// # Panics
    /// If `parent` is not a node of this chart.
    pub fn add(&mut self, parent: NodeId, mut node: Node) -> NodeId {
        let parts = Arc::make_mut(&mut self.parts);
        let id = NodeId(parts.nodes.len() as u32);
        node.parent = Some(parent);
        parts.nodes.push(node);
        parts.children.push(Vec::new());
        parts.children[parent.0 as usize].push(id);
        id
    }

    /// Adds a transition after all others.
    pub fn connect(&mut self, transition: Transition) -> TransitionId {
        let transitions = &mut Arc::make_mut(&mut self.parts).transitions;
        transitions.push(transition);
        TransitionId(transitions.len() as u32 - 1)
    }

    /// All nodes, in the order they were added: a parent before its children.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = (NodeId, &Node)> {
        self.parts.nodes.iter().enumerate().map(|(index, node)| (NodeId(index as u32), node))
    }

    /// Whether a step considers the transitions out of a node: it is active, or it is a condition,
    /// junction or choice in an active composite.
    pub fn is_considered(&self, source: NodeId, is_active: impl Fn(NodeId) -> bool) -> bool {
        let node = self.node(source);
        let branches = matches!(node.kind, NodeKind::Condition | NodeKind::Junction | NodeKind::Choice);
        is_active(source) || branches && node.parent.is_some_and(is_active)
    }

    /// All transitions, in the order they were added.
    pub fn transitions(&self) -> impl ExactSizeIterator<Item = (TransitionId, &Transition)> {
        self.parts
            .transitions
            .iter()
            .enumerate()
            .map(|(index, transition)| (TransitionId(index as u32), transition))
    }

    /// A node.
    ///
    /// # Panics
    /// If the node does not belong to this chart.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.parts.nodes[id.0 as usize]
    }

    /// A node, for modification.
    ///
    /// # Panics
    /// If the node does not belong to this chart.
    pub fn node_mut(&mut self, id: NodeId) -> &mut Node {
        &mut Arc::make_mut(&mut self.parts).nodes[id.0 as usize]
    }

    /// A transition.
    ///
    /// # Panics
    /// If the transition does not belong to this chart.
    pub fn transition(&self, id: TransitionId) -> &Transition {
        &self.parts.transitions[id.0 as usize]
    }

    /// A transition, for modification.
    ///
    /// # Panics
    /// If the transition does not belong to this chart.
    pub fn transition_mut(&mut self, id: TransitionId) -> &mut Transition {
        &mut Arc::make_mut(&mut self.parts).transitions[id.0 as usize]
    }

    /// The children of a node, in the order they were added, which is that of their ids.
    ///
    /// # Panics
    /// If the node does not belong to this chart.
    pub fn children(&self, id: NodeId) -> &[NodeId] {
        &self.parts.children[id.0 as usize]
    }

    /// From a node's parent up to the root.
    pub fn ancestors(&self, id: NodeId) -> impl Iterator<Item = NodeId> {
        std::iter::successors(self.node(id).parent, |&node| self.node(node).parent)
    }

    /// The hierarchical label of each node, by [`NodeId`]: the root is `0`, the k-th child of `L`
    /// is `L.k`.
    pub fn labels(&self) -> Vec<String> {
        let mut labels = vec![String::from("0"); self.parts.nodes.len()];
        for (id, _) in self.nodes() {
            for (index, child) in self.children(id).iter().enumerate() {
                labels[child.0 as usize] = format!("{}.{}", labels[id.0 as usize], index + 1);
            }
        }
        labels
    }

    /// The names from the root down to a node, separated by `/`; a node without a name is
    /// identified by its number among its siblings (from 1), with the kind in capitals for
    /// connectors. The path is a state's identity: a label changes with every edit, a path does
    /// not.
    pub fn path(&self, id: NodeId) -> String {
        let mut segments: Vec<String> =
            std::iter::once(id).chain(self.ancestors(id)).map(|node| self.segment(node)).collect();
        segments.reverse();
        segments.join("/")
    }

    /// The node that a path names: segments as in [`path`](Statechart::path), from any ancestor or
    /// the node itself down; none if no node or several match.
    pub fn find(&self, path: &str) -> Option<NodeId> {
        let mut fitting = self.nodes().map(|(id, _)| id).filter(|&id| self.is_at(id, path));
        let found = fitting.next()?;
        fitting.next().is_none().then_some(found)
    }

    pub(crate) fn is_at(&self, id: NodeId, path: &str) -> bool {
        let mut nodes = std::iter::once(id).chain(self.ancestors(id));
        path.rsplit('/').all(|segment| nodes.next().is_some_and(|node| self.segment(node) == segment))
    }

    /// The last segment of its path.
    pub(crate) fn segment(&self, id: NodeId) -> String {
        let node = self.node(id);
        let place = || node.parent.and_then(|parent| self.children(parent).binary_search(&id).ok());
        segment_of(node, || place().map_or(1, |index| index + 1))
    }

    /// The last segment of each node's path, by [`NodeId`].
    pub(crate) fn segments(&self) -> Vec<String> {
        let mut segments = vec![segment_of(self.node(Statechart::ROOT), || 1); self.parts.nodes.len()];
        for children in &self.parts.children {
            for (&child, number) in children.iter().zip(1..) {
                segments[child.0 as usize] = segment_of(self.node(child), || number);
            }
        }
        segments
    }
}

fn segment_of(node: &Node, number: impl FnOnce() -> usize) -> String {
    if !node.name.is_empty() {
        return node.name.clone();
    }
    match node.kind {
        NodeKind::Start => "START".into(),
        NodeKind::End => "END".into(),
        NodeKind::Condition => "CONDITION".into(),
        _ => number().to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nested() -> (Statechart, NodeId, NodeId) {
        let mut chart = Statechart::new("c");
        let and = chart.add(Statechart::ROOT, Node::new(NodeKind::And, "both"));
        let first = chart.add(and, Node::new(NodeKind::Or, ""));
        let second = chart.add(and, Node::new(NodeKind::Or, ""));
        chart.add(first, Node::new(NodeKind::Basic, "A"));
        chart.add(second, Node::new(NodeKind::Basic, "A"));
        let start = chart.add(second, Node::new(NodeKind::Start, ""));
        (chart, second, start)
    }

    #[test]
    fn a_path_names_what_has_no_name_by_its_number_or_kind() {
        let (chart, second, start) = nested();
        assert_eq!(chart.path(Statechart::ROOT), "c");
        assert_eq!(chart.path(second), "c/both/2");
        assert_eq!(chart.path(start), "c/both/2/START");
    }

    #[test]
    fn a_node_is_found_by_as_much_of_its_path_as_makes_it_the_only_one() {
        let (chart, second, start) = nested();
        assert_eq!(chart.find("START"), Some(start));
        assert_eq!(chart.find("both/2"), Some(second));
        assert_eq!(chart.find("A"), None, "there are two");
        assert_eq!(chart.find("2/A").map(|node| chart.path(node)), Some("c/both/2/A".into()));
        assert_eq!(chart.find("x/2/A"), None);
        assert_eq!(chart.find("c/both/2/A/more"), None);
        assert_eq!(chart.find(""), None);
    }

    #[test]
    fn charts_that_are_drawn_elsewhere_are_equal() {
        let (chart, second, _) = nested();
        let mut moved = chart.clone();
        moved.layout.frames.insert(second, Frame { at: Some((1.0, 2.0)), size: None });
        assert_eq!(moved, chart);
        assert!(!moved.layout.is_empty());
    }

    #[test]
    fn labels_number_children_from_one() {
        let (chart, second, start) = nested();
        let labels = chart.labels();
        assert_eq!(labels[second.0 as usize], "0.1.2");
        assert_eq!(labels[start.0 as usize], "0.1.2.2");
    }
}
