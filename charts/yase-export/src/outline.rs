//! Common parts of the block-structured formats: lines and nested blocks.

use std::fmt::{Arguments, Write};

use super::loss_report::has_ends;
use super::notation::{inscription, kind_word};
use yase::statechart::{ConstantValue, NodeId, NodeKind, Statechart, Transition, TransitionId};

/// Maximum indentation, or the text of a deep chart would consist mainly of blanks.
const MAX_DEPTH: usize = 40;

/// A text of indented lines.
#[derive(Default)]
pub(crate) struct IndentedText {
    pub(crate) text: String,
    pub(crate) depth: usize,
}

impl IndentedText {
    pub(crate) fn line(&mut self, content: Arguments<'_>) {
        self.indent();
        // writing to a String cannot fail
        let _ = writeln!(self.text, "{content}");
    }

    pub(crate) fn indent(&mut self) {
        let blanks = 2 * self.depth.min(MAX_DEPTH);
        self.text.extend(std::iter::repeat_n(' ', blanks));
    }
}

/// A visit of a tree walk, which reaches each node twice.
#[derive(Clone, Copy)]
pub(crate) enum TreeEvent {
    /// Before its children.
    Enter(NodeId),
    /// After them.
    Leave(NodeId),
}

/// A tree walk without recursion, since a chart may be deeper than the stack.
pub(crate) fn visits(chart: &Statechart) -> impl Iterator<Item = TreeEvent> {
    let mut open = vec![TreeEvent::Enter(Statechart::ROOT)];
    std::iter::from_fn(move || {
        let visit = open.pop()?;
        if let TreeEvent::Enter(id) = visit {
            open.push(TreeEvent::Leave(id));
            open.extend(chart.children(id).iter().rev().map(|&child| TreeEvent::Enter(child)));
        }
        Some(visit)
    })
}

/// Whether a node is a region: an OR in an AND.
pub(crate) fn is_region(chart: &Statechart, id: NodeId) -> bool {
    let node = chart.node(id);
    node.kind == NodeKind::Or && node.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And)
}

/// The position of a node among its siblings, from 1.
pub(crate) fn sibling_number(chart: &Statechart, id: NodeId) -> usize {
    let siblings = chart.node(id).parent.map_or(&[][..], |parent| chart.children(parent));
    siblings.iter().position(|&sibling| sibling == id).map_or(1, |index| index + 1)
}

/// The name of a node where one is required.
pub(crate) fn title(chart: &Statechart, id: NodeId) -> String {
    let node = chart.node(id);
    match node.name.as_str() {
        "" if is_region(chart, id) => format!("region {}", sibling_number(chart, id)),
        "" => kind_word(node.kind).to_owned(),
        name => name.to_owned(),
    }
}

/// The transitions whose ends exist.
pub(crate) fn sound_transitions(chart: &Statechart) -> impl Iterator<Item = (TransitionId, &Transition)> {
    chart.transitions().filter(|(_, it)| has_ends(chart, it))
}

/// The transitions between two children of a node, by that node, and all others.
pub(crate) fn by_parent(chart: &Statechart) -> (Vec<Vec<&Transition>>, Vec<&Transition>) {
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

/// The label of an arrow: empty, or ` : ` and the text of the transition.
pub(crate) fn after_colon(transition: &Transition, escape: fn(&str) -> String) -> String {
    match inscription(transition).as_str() {
        "" => String::new(),
        text => format!(" : {}", escape(text)),
    }
}

/// The constants, one per line.
pub(crate) fn constants(chart: &Statechart) -> impl Iterator<Item = String> {
    chart.constants.iter().map(|constant| match &constant.value {
        ConstantValue::Bool(value) => format!("{} = {value}", constant.name),
        ConstantValue::Number(value) => format!("{} = {value}", constant.name),
        ConstantValue::Text(value) => format!("{} = {value:?}", constant.name),
    })
}

/// A text as part of one line.
pub(crate) fn one_line(text: &str) -> String {
    text.chars().map(|character| if character.is_control() { ' ' } else { character }).collect()
}
