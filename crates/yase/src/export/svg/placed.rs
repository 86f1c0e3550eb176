//! What a person, or an editor, has put somewhere: it stands there, and the rest of its composite below.

use super::layout::{Layout, Point, common_parent};
use super::rectangle::Rectangle;
use crate::statechart::{Frame, NodeId, Statechart, Transition, TransitionId};

/// Between what was put somewhere and what was not.
const GAP: f64 = 22.0;

/// What is said of where a node stands.
pub(super) fn frame(chart: &Statechart, id: NodeId) -> Frame {
    chart.layout.frames.get(&id).copied().unwrap_or_default()
}

/// The corners that are said of a transition.
pub(super) fn bends(chart: &Statechart, id: TransitionId) -> &[Point] {
    chart.layout.bends.get(&id).map_or(&[], Vec::as_slice)
}

/// A size that is at least what is said of a node.
pub(super) fn at_least(chart: &Statechart, id: NodeId, size: Point) -> Point {
    let (width, height) = frame(chart, id).size.unwrap_or_default();
    (size.0.max(width), size.1.max(height))
}

/// Whether some child of a node was put somewhere.
pub(super) fn holds_placed(chart: &Statechart, id: NodeId) -> bool {
    !chart.layout.is_empty() && chart.children(id).iter().any(|&child| frame(chart, child).at.is_some())
}

/// The OR among whose rows a transition is drawn: that of both its ends, unless it or one of the children has a place.
pub(super) fn among_rows(chart: &Statechart, id: TransitionId, transition: &Transition) -> Option<NodeId> {
    let parent = common_parent(chart, transition)?;
    let is_free = bends(chart, id).is_empty() && !holds_placed(chart, parent);
    is_free.then_some(parent)
}

/// Puts the children of a node where they belong, those of which nothing is said below the others, and returns the size of it all.
pub(super) fn put(chart: &Statechart, id: NodeId, layout: &mut Layout<'_>) -> Point {
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
    let edge = |layout: &Layout<'_>, ids: &[NodeId], of: fn(&Rectangle) -> f64, pick: fn(f64, f64) -> f64| {
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

/// The line of a transition around its bends, which are places on the page: from border to border.
pub(super) fn line(from: &Rectangle, bends: &[Point], to: &Rectangle) -> Vec<Point> {
    let (Some(&first), Some(&last)) = (bends.first(), bends.last()) else { return Vec::new() };
    let ends = (from.border_towards(first), to.border_towards(last));
    std::iter::once(ends.0).chain(bends.iter().copied()).chain([ends.1]).collect()
}
