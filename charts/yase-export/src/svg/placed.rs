//! Elements with given positions: they are kept, and the rest of the composite is placed below.

use super::drawing_layout::{DrawingLayout, common_parent};
use super::rectangle::Rectangle;
use yase::statechart::{Frame, NodeId, Point, Statechart, Transition, TransitionId};

/// Gap between elements with and without given positions.
const GAP: f64 = 22.0;

/// The given position and size of a node.
pub(crate) fn frame(chart: &Statechart, id: NodeId) -> Frame {
    chart.layout.frames.get(&id).copied().unwrap_or_default()
}

/// The given corners of a transition.
pub(crate) fn bends(chart: &Statechart, id: TransitionId) -> &[Point] {
    chart.layout.bends.get(&id).map_or(&[], Vec::as_slice)
}

/// A size that is at least the given size of a node.
pub(crate) fn at_least(chart: &Statechart, id: NodeId, size: Point) -> Point {
    let (width, height) = frame(chart, id).size.unwrap_or_default();
    (size.0.max(width), size.1.max(height))
}

/// Whether a child of a node has a given position.
pub(crate) fn holds_placed(chart: &Statechart, id: NodeId) -> bool {
    !chart.layout.is_empty() && chart.children(id).iter().any(|&child| frame(chart, child).at.is_some())
}

/// The OR among whose rows a transition is drawn: the parent of both ends, unless the transition or
/// a child has a given position.
pub(crate) fn among_rows(chart: &Statechart, id: TransitionId, transition: &Transition) -> Option<NodeId> {
    let parent = common_parent(chart, transition)?;
    let is_free = bends(chart, id).is_empty() && !holds_placed(chart, parent);
    is_free.then_some(parent)
}

/// Places the children of a node, those without given positions below the others, and returns the
/// total size.
pub(crate) fn place_children(chart: &Statechart, id: NodeId, layout: &mut DrawingLayout<'_>) -> Point {
    let (mut placed, mut free) = (Vec::new(), Vec::new());
    for &child in chart.children(id) {
        match frame(chart, child).at {
            Some(at) => {
                layout.shape_mut(child).at = at;
                placed.push(child);
            }
            None => free.push(child),
        }
    }
    let edge =
        |layout: &DrawingLayout<'_>, ids: &[NodeId], of: fn(&Rectangle) -> f64, pick: fn(f64, f64) -> f64| {
            ids.iter().map(|&id| of(&layout.shape(id).area())).reduce(pick).unwrap_or(0.0)
        };
    let left = edge(layout, &free, |area| area.left, f64::min);
    let top = edge(layout, &free, |area| area.top, f64::min);
    let below = edge(layout, &placed, |area| area.bottom, f64::max) + GAP;
    for &id in &free {
        let at = &mut layout.shape_mut(id).at;
        *at = (at.0 - left, at.1 - top + below);
    }
    let all = chart.children(id);
    (edge(layout, all, |area| area.right, f64::max), edge(layout, all, |area| area.bottom, f64::max))
}

/// The line of a transition through its bends, which are page coordinates, from border to border.
pub(crate) fn line(from: &Rectangle, bends: &[Point], to: &Rectangle) -> Vec<Point> {
    let (Some(&first), Some(&last)) = (bends.first(), bends.last()) else { return Vec::new() };
    let ends = (from.border_towards(first), to.border_towards(last));
    std::iter::once(ends.0).chain(bends.iter().copied()).chain([ends.1]).collect()
}
