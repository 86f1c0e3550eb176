//! Statecharts as in model files: the Intra-Agent Control model of a role (IAC) and the Inter-Agent
//! Control model of a protocol (EAC).
//!
//! An [`Iac`] keeps the file as written: names as the tools encode them, types and transition
//! expressions as text, faults included. A [`Statechart`](yase::Statechart) is its meaning.
//! [`Iac::to_statechart`] parses the expressions and reports those it does not understand;
//! [`Iac::from_statechart`] writes them.
//!
//! Files come in four dialects ([`Dialect`]), which differ in how nodes nest and refer to each
//! other, and in the text form of this project, which represents every chart completely:
//!
//! ```text
//! IAC: tiny
//!
//! Variable: gsm
//!   type = worldstate.State.GameStateMessage
//!
//! States:
//!   r OR
//!     START
//!     a BASIC
//!       functionality = motion
//!       variables = gsm
//!
//! Transitions:
//!   START -> a
//!   a -> a : [TimeoutCheck(t)]/TimeoutAction.t.100
//! ```
//!
//! In text a node is referred to by the shortest unique end of its path, written as in a formula,
//! `(play|wait)~`; a node without a name is referred to by its type or its number. `at = 40 120`
//! and `size = 160 60` below a node and `via = 40 80, 120 80` below a transition are its layout.
//! Labels and names of transitions are written only where they differ from the default.

mod chart;
mod from_text;
mod from_xmi;
mod lint;
mod multi_root;
mod path;
mod to_text;
mod to_xmi;

use std::time::Duration;

use yase::expression::TextPosition;
use yase::statechart::{Constant, Frame, Point};

use aseme::names::decode;

pub(crate) use chart::KINDS;
pub(crate) use from_text::{NODE_KEYS, TransitionLine, from_text, node_setting, transition_line};
pub(crate) use from_xmi::from_xmi;
pub(crate) use path::{NodePaths, name_of, name_text};
pub(crate) use to_text::to_text;

/// A statechart as written in a model file.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Iac {
    /// The kind of the chart.
    pub kind: ChartKind,
    /// The model's name.
    pub name: String,
    /// Its description.
    pub description: String,
    /// Metadata of a tool.
    pub metadata: String,
    /// The nodes: a parent before its children, children in order.
    pub nodes: Vec<IacNode>,
    /// The transitions, in order.
    pub transitions: Vec<IacTransition>,
    /// Messages that expressions use.
    pub variables: Vec<Variable>,
    /// Named constants.
    pub constants: Vec<Constant>,
}

/// The owner of a chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ChartKind {
    /// The chart of an agent.
    #[default]
    Intra,
    /// The chart of a protocol.
    Inter,
}

/// A node as written in a model file.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct IacNode {
    /// Its name, encoded.
    pub name: String,
    /// Its label.
    pub label: String,
    /// Its type: OR, AND, BASIC, START, END, CONDITION and others.
    pub kind: String,
    /// The activity according to the file: the description of a functionality, or the path of its
    /// source.
    pub functionality: String,
    /// The variables it uses, by their indices in [`Iac::variables`].
    pub variables: Vec<usize>,
    /// Its parent, by its index in [`Iac::nodes`].
    pub parent: Option<usize>,
    /// Its actions in the dialect of 2018.
    pub actions: String,
    /// Metadata of a tool.
    pub metadata: String,
    /// Settings that only the text form represents.
    pub refinement: StateRefinement,
    /// Its layout, which only the text form represents.
    pub frame: Frame,
    /// Its position in the source.
    pub position: TextPosition,
}

/// Settings of a state, as in the section `States:` of a role.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct StateRefinement {
    /// The activity it runs: `None` for the one with its name, empty for no activity.
    pub activity: Option<String>,
    /// The priority of its activity.
    pub priority: i32,
    /// Its entry actions.
    pub entry: String,
    /// Its exit actions.
    pub exit: String,
    /// Events that are deferred while it is active.
    pub defer: String,
    /// The duration of its activity in simulated time.
    pub duration: Option<Duration>,
}

/// A transition as written in a model file.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct IacTransition {
    /// Its name, usually `sourceTOtarget`.
    pub name: String,
    /// Its transition expression.
    pub te: String,
    /// The node it leaves, by its index in [`Iac::nodes`].
    pub source: usize,
    /// The node it leads to.
    pub target: usize,
    /// Metadata of a tool.
    pub metadata: String,
    /// Settings that only the text form represents.
    pub refinement: TransitionRefinement,
    /// The corners of its line in drawings.
    pub bends: Vec<Point>,
    /// Its position in the source.
    pub position: TextPosition,
    /// The position of its expression in the source.
    pub te_position: TextPosition,
}

/// Settings of a transition, as in the section `Transitions:` of a role.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct TransitionRefinement {
    /// Higher is tried first.
    pub priority: i32,
    /// The weight of a probabilistic branch.
    pub weight: Option<f64>,
    /// Whether it may exit a state whose activity is running.
    pub interrupts: bool,
    /// Whether it is internal: it does not exit its source.
    pub internal: bool,
}

/// A variable that expressions use, with a type of the ontology.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its type: `topic.Kind.Message` in files since 2012.
    pub kind: String,
    /// Its position in the source.
    pub position: TextPosition,
}

/// The dialects of XMI in which statecharts are kept.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Dialect {
    /// 2010: `xmi:XMI` with nodes, transitions and the model as separate roots.
    MultiRoot,
    /// 2011: `IAC:Model` with a flat list of nodes, each naming its parent.
    Flat,
    /// 2012: `statechart:Model` with nodes in nodes.
    Nested2012,
    /// 2018: the same, with descriptions, actions and metadata.
    Nested2018,
}

/// The nodes may nest this deep.
pub(crate) const MAX_LEVELS: usize = aseme::liveness::MAX_LEVELS;

impl Iac {
    /// The default label of each node, according to its position in the tree.
    pub(crate) fn labels(&self) -> Vec<String> {
        let mut labels: Vec<String> = Vec::with_capacity(self.nodes.len());
        let mut children = vec![0_usize; self.nodes.len()];
        let mut roots = 0;
        for node in &self.nodes {
            let label = match node.parent.filter(|&parent| parent < labels.len()) {
                Some(parent) => {
                    children[parent] += 1;
                    format!("{}.{}", labels[parent], children[parent])
                }
                None => {
                    roots += 1;
                    (roots - 1).to_string()
                }
            };
            labels.push(label);
        }
        labels
    }

    /// The index of a variable, which is added if it is missing.
    pub(crate) fn variable(&mut self, wanted: &Variable) -> usize {
        let same = |own: &Variable| (&own.name, &own.kind) == (&wanted.name, &wanted.kind);
        self.variables.iter().position(same).unwrap_or_else(|| {
            self.variables.push(wanted.clone());
            self.variables.len() - 1
        })
    }

    /// The children of each node, in order.
    pub(crate) fn children(&self) -> Vec<Vec<usize>> {
        let mut children = vec![Vec::new(); self.nodes.len()];
        for (index, parent) in
            self.nodes.iter().enumerate().filter_map(|(index, node)| Some((index, node.parent?)))
        {
            if let Some(children) = children.get_mut(parent) {
                children.push(index);
            }
        }
        children
    }

    /// The chart with every parent before its children and siblings contiguous, as in files that
    /// nest nodes.
    pub(crate) fn in_order(mut self) -> Iac {
        let children = self.children();
        self.arrange(&children);
        self
    }

    /// Puts every node before its children, given in their order, and these together. Returns the
    /// new place of each node; one that lies in no root is left out.
    pub(crate) fn arrange(&mut self, children: &[Vec<usize>]) -> Vec<usize> {
        let roots = (0..self.nodes.len()).filter(|&index| self.nodes[index].parent.is_none());
        let mut open: Vec<usize> = roots.collect();
        open.reverse();
        let mut order = Vec::with_capacity(self.nodes.len());
        while let Some(index) = open.pop() {
            order.push(index);
            open.extend(children[index].iter().rev());
        }
        let mut indices = vec![usize::MAX; self.nodes.len()];
        order.iter().enumerate().for_each(|(new, &old)| indices[old] = new);
        self.nodes = order.iter().map(|&old| std::mem::take(&mut self.nodes[old])).collect();
        for node in &mut self.nodes {
            node.parent = node.parent.map(|parent| indices[parent]);
        }
        self.transitions.retain(|it| indices[it.source] != usize::MAX && indices[it.target] != usize::MAX);
        for transition in &mut self.transitions {
            (transition.source, transition.target) = (indices[transition.source], indices[transition.target]);
        }
        indices
    }

    /// Gives a node and those in it the labels of their places, and the names that follow from
    /// labels.
    pub(crate) fn relabel(&mut self, top: usize) {
        let labels = self.labels();
        let is_within = |mut node: usize| loop {
            match self.nodes[node].parent {
                _ if node == top => return true,
                Some(parent) => node = parent,
                None => return false,
            }
        };
        let within: Vec<bool> = (0..self.nodes.len()).map(is_within).collect();
        let usual: Vec<bool> = self
            .transitions
            .iter()
            .map(|it| it.name.is_empty() || it.name == self.usual_name(it.source, it.target))
            .collect();
        for (index, label) in labels.into_iter().enumerate().filter(|(index, _)| within[*index]) {
            let node = &mut self.nodes[index];
            if node.name == node.label {
                node.name.clone_from(&label);
            }
            node.label = label;
        }
        for (index, is_usual) in usual.into_iter().enumerate() {
            let IacTransition { source, target, .. } = self.transitions[index];
            if is_usual && (within[source] || within[target]) {
                self.transitions[index].name = self.usual_name(source, target);
            }
        }
    }

    /// The default name of a transition between two nodes.
    pub(crate) fn usual_name(&self, source: usize, target: usize) -> String {
        format!("{}TO{}", self.nodes[source].name, self.nodes[target].name)
    }
}

impl IacNode {
    /// Its name in the notation of formulas, decoded if it is an encoded term.
    pub fn written(&self) -> String {
        let is_composite = matches!(self.kind.as_str(), "OR" | "AND");
        let term = if is_composite { decode(&self.name) } else { None };
        term.unwrap_or_else(|| self.name.clone())
    }
}

/// Removes `null`, which files of 2010 write for an absent value.
pub(crate) fn without_null(text: &str) -> String {
    if text == "null" { String::new() } else { text.into() }
}
