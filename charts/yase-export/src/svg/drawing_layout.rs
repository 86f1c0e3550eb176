//! A drawing: shapes of nodes, arrows of transitions. Lengths are in pixels.

use super::layout::MARGIN;
use super::lettering::{LABEL_LINE, LABEL_SIZE, NAME_LINE, widest, wrap_condition};
use super::rectangle::Rectangle;
use crate::highlights::{Highlights, Mark};
use crate::notation::inscription;
use yase::statechart::{NodeId, NodeKind, Point, Statechart, Transition, TransitionId};

/// Maximum width of a label line, where it can be broken.
pub(crate) const LABEL_WIDTH: f64 = 290.0;

/// The drawn shape of a node.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shape {
    /// Width and height.
    pub(crate) size: Point,
    /// The upper left corner: relative to the content of its parent during layout, on the page at
    /// the end.
    pub(crate) at: Point,
    /// Offset from that corner to its content.
    pub(crate) inset: Point,
    /// Lines of its name.
    pub(crate) title: Vec<String>,
    /// Lines below the name: its other properties.
    pub(crate) notes: Vec<String>,
    /// The width of the name to the right of a connector.
    pub(crate) name_width: f64,
}

impl Shape {
    /// The height of a composite's title.
    pub(crate) fn head(&self) -> f64 {
        let lines = NAME_LINE * self.title.len() as f64 + LABEL_LINE * self.notes.len() as f64;
        if lines > 0.0 { lines + 8.0 } else { 0.0 }
    }

    /// Its total area, including the name beside it.
    pub(crate) fn area(&self) -> Rectangle {
        Rectangle::new(self.at, (self.size.0 + self.name_width, self.size.1))
    }

    /// The area of a connector's name: beside it, above the line through its middle.
    pub(crate) fn name(&self) -> Option<Rectangle> {
        let middle = self.at.1 + self.size.1 / 2.0;
        let lines = (self.title.len() + self.notes.len()) as f64;
        let (left, top) = (self.at.0 + self.size.0 + 2.0, middle - LABEL_LINE);
        let height = LABEL_LINE * lines - 1.0;
        (self.name_width > 0.0).then(|| Rectangle::new((left, top), (self.name_width - 2.0, height)))
    }
}

/// The drawn shape of a transition.
#[derive(Clone, Debug)]
pub(crate) struct Arrow {
    /// The composite whose content contains it.
    pub(crate) frame: NodeId,
    /// The corners of its line: relative to that content during layout, on the page at the end.
    pub(crate) points: Vec<Point>,
    /// Its label.
    pub(crate) label: Label,
    /// The middle of the label.
    pub(crate) label_at: Point,
}

/// The label of a transition.
#[derive(Clone, Debug)]
pub(crate) struct Label {
    pub(crate) transition: TransitionId,
    pub(crate) lines: Vec<String>,
    /// Whether it marks a transition that is never taken.
    pub(crate) never: bool,
    /// The highlighting of the transition.
    pub(crate) mark: Option<Mark>,
}

impl Label {
    pub(crate) fn of(id: TransitionId, transition: &Transition, marks: &Highlights) -> Label {
        let text = inscription(transition);
        Label {
            transition: id,
            lines: wrap_condition(&text, LABEL_SIZE, LABEL_WIDTH),
            never: transition.expression.is_never(),
            mark: marks.of_transition(transition),
        }
    }

    /// Width and height; zero without text.
    pub(crate) fn size(&self) -> Point {
        match self.lines.len() {
            0 => (0.0, 0.0),
            lines => (widest(&self.lines, LABEL_SIZE) + 8.0, LABEL_LINE * lines as f64 + 4.0),
        }
    }
}

/// A drawing.
#[derive(Debug)]
pub(crate) struct DrawingLayout<'m> {
    /// Highlighted parts.
    pub(crate) marks: &'m Highlights,
    /// By node.
    pub(crate) shapes: Vec<Shape>,
    pub(crate) arrows: Vec<Arrow>,
}

impl DrawingLayout<'_> {
    pub(crate) fn shape(&self, id: NodeId) -> &Shape {
        &self.shapes[id.0 as usize]
    }

    /// The size of the page: encloses the root and the given corners of arrows.
    pub(crate) fn page_size(&self, chart: &Statechart) -> Point {
        let root = self.shape(Statechart::ROOT);
        let end = (root.at.0 + root.size.0, root.at.1 + root.size.1);
        let arrows = if chart.layout.bends.is_empty() { &[][..] } else { &self.arrows };
        let corners = arrows.iter().flat_map(|arrow| &arrow.points);
        let (right, bottom) = corners.fold(end, |end, corner| (end.0.max(corner.0), end.1.max(corner.1)));
        (right + MARGIN, bottom + MARGIN)
    }

    pub(crate) fn shape_mut(&mut self, id: NodeId) -> &mut Shape {
        &mut self.shapes[id.0 as usize]
    }
}

/// The OR that is the parent of both ends of a transition.
pub(crate) fn common_parent(chart: &Statechart, transition: &Transition) -> Option<NodeId> {
    let parent = chart.node(transition.source).parent?;
    let is_or = chart.node(parent).kind == NodeKind::Or;
    (is_or && chart.node(transition.target).parent == Some(parent)).then_some(parent)
}

pub(crate) fn content_origin(shape: &Shape) -> Point {
    moved(shape.at, shape.inset)
}

pub(crate) fn moved(point: Point, by: Point) -> Point {
    (point.0 + by.0, point.1 + by.1)
}
