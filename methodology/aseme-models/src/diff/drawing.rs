//! One drawing of two charts.

use std::collections::BTreeMap;

use yase::{Element, NodeId, Statechart, Transition};
use yase_export::{Highlights, Mark};

use super::{ChangeKind, ChartDifference};

/// The later chart with removed parts reinserted, and the parts to highlight
/// ([`yase_export::to_svg_marked`]).
#[derive(Clone, PartialEq, Debug)]
pub struct DiffDrawing {
    /// The chart, for drawing only.
    pub chart: Statechart,
    /// The added, removed and changed elements.
    pub marks: Highlights,
}

/// Draws two charts and their difference in one chart.
pub fn picture(before: &Statechart, after: &Statechart, difference: &ChartDifference) -> DiffDrawing {
    let mut picture = DiffDrawing { chart: after.clone(), marks: Highlights::default() };
    let mut nodes: BTreeMap<NodeId, NodeId> = BTreeMap::new();
    for (id, node) in before.nodes() {
        if let Some(later) = difference.pairs.later(id) {
            nodes.insert(id, later);
            continue;
        }
        // parents precede their children, so the parent was added
        let parent = node.parent.and_then(|parent| nodes.get(&parent)).copied().unwrap_or(Statechart::ROOT);
        nodes.insert(id, picture.chart.add(parent, node.clone()));
    }
    for change in &difference.changes {
        let Some(element) = change.element else { continue };
        let mark = match change.kind {
            ChangeKind::Added => Mark::Added,
            ChangeKind::Removed => Mark::Removed,
            ChangeKind::Moved | ChangeKind::Changed => Mark::Changed,
        };
        let element = match (mark, element) {
            (Mark::Removed, Element::Node(id)) => Element::Node(nodes[&id]),
            (Mark::Removed, Element::Transition(id)) => {
                let gone = before.transition(id).clone();
                let (source, target) = (nodes[&gone.source], nodes[&gone.target]);
                Element::Transition(picture.chart.connect(Transition { source, target, ..gone }))
            }
            (_, element) => element,
        };
        // an added element keeps that mark
        if !matches!(element, Element::Node(id) if picture.marks.has(id)) {
            picture.marks.set(&picture.chart, element, mark);
        }
    }
    picture
}
