//! What the block-structured texts have in common: lines, and boxes within boxes.

use std::fmt::{Arguments, Write};

use super::lost::has_ends;
use super::notation::{inscription, kind_word};
use crate::statechart::{ConstantValue, NodeId, NodeKind, Statechart, Transition, TransitionId};

/// Deeper lines stand no further in, or the text of a deep chart would consist of blanks.
const MAX_DEPTH: usize = 40;

/// A text of indented lines.
#[derive(Default)]
pub(super) struct Lines {
    pub(super) text: String,
    pub(super) depth: usize,
}

impl Lines {
    pub(super) fn line(&mut self, content: Arguments<'_>) {
        self.indent();
        // writing to a String cannot fail
        let _ = writeln!(self.text, "{content}");
    }

    pub(super) fn indent(&mut self) {
        let blanks = 2 * self.depth.min(MAX_DEPTH);
        self.text.extend(std::iter::repeat_n(' ', blanks));
    }
}

/// A walk around a tree comes to each node twice.
#[derive(Clone, Copy)]
pub(super) enum Visit {
    /// Before its children.
    Enter(NodeId),
    /// After them.
    Leave(NodeId),
}

/// Around the tree, without recursion: a chart may be deeper than the stack.
pub(super) fn visits(chart: &Statechart) -> impl Iterator<Item = Visit> {
    let mut open = vec![Visit::Enter(Statechart::ROOT)];
    std::iter::from_fn(move || {
        let visit = open.pop()?;
        if let Visit::Enter(id) = visit {
            open.push(Visit::Leave(id));
            open.extend(chart.children(id).iter().rev().map(|&child| Visit::Enter(child)));
        }
        Some(visit)
    })
}

/// Whether a node is a region: an OR in an AND.
pub(super) fn is_region(chart: &Statechart, id: NodeId) -> bool {
    let node = chart.node(id);
    node.kind == NodeKind::Or && node.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And)
}

/// The place of a node among its siblings, from 1.
pub(super) fn place(chart: &Statechart, id: NodeId) -> usize {
    let siblings = chart.node(id).parent.map_or(&[][..], |parent| chart.children(parent));
    siblings.iter().position(|&sibling| sibling == id).map_or(1, |index| index + 1)
}

/// What a node is called where a name is needed.
pub(super) fn title(chart: &Statechart, id: NodeId) -> String {
    let node = chart.node(id);
    match node.name.as_str() {
        "" if is_region(chart, id) => format!("region {}", place(chart, id)),
        "" => kind_word(node.kind).to_owned(),
        name => name.to_owned(),
    }
}

/// The transitions whose ends exist.
pub(super) fn sound_transitions(chart: &Statechart) -> impl Iterator<Item = (TransitionId, &Transition)> {
    chart.transitions().filter(|(_, it)| has_ends(chart, it))
}

/// The transitions that join two children of a node, by that node, and all others.
pub(super) fn by_parent(chart: &Statechart) -> (Vec<Vec<&Transition>>, Vec<&Transition>) {
    let (mut inside, mut others) = (vec![Vec::new(); chart.nodes().len()], Vec::new());
    for (_, transition) in sound_transitions(chart) {
        match chart.node(transition.source).parent {
            Some(parent) if chart.node(transition.target).parent == Some(parent) => {
                inside[parent.0 as usize].push(transition);
            }
            _ => others.push(transition),
        }
    }
    (inside, others)
}

/// What follows an arrow: nothing, or ` : ` and what is written on it.
pub(super) fn after_colon(transition: &Transition, escape: fn(&str) -> String) -> String {
    match inscription(transition).as_str() {
        "" => String::new(),
        text => format!(" : {}", escape(text)),
    }
}

/// The constants, a line each.
pub(super) fn constants(chart: &Statechart) -> impl Iterator<Item = String> {
    chart.constants.iter().map(|constant| match &constant.value {
        ConstantValue::Bool(value) => format!("{} = {value}", constant.name),
        ConstantValue::Number(value) => format!("{} = {value}", constant.name),
        ConstantValue::Text(value) => format!("{} = {value:?}", constant.name),
    })
}

/// A text as part of one line.
pub(super) fn one_line(text: &str) -> String {
    text.chars().map(|character| if character.is_control() { ' ' } else { character }).collect()
}
