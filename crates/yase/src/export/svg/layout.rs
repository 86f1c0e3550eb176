//! Where everything stands: first the size of each box from the inside out, then places from the outside in.

use super::lettering::{
    LABEL_LINE, LABEL_SIZE, NAME_LINE, NAME_SIZE, formula_text, widest, wrap, wrap_condition,
};
use super::rectangle::Rectangle;
use super::{flow, placed, route};
use crate::export::marks::{Mark, Marks};
use crate::export::notation::{inscription, refinements};
use crate::export::outline::sound_transitions;
use crate::statechart::{Node, NodeId, NodeKind, Statechart, Transition};

/// Between a border and what is inside.
const PADDING: f64 = 14.0;
/// Titles narrower than this do not wrap.
const TITLE_WIDTH: f64 = 200.0;
/// Labels wider than this wrap where they can.
const LABEL_WIDTH: f64 = 290.0;
/// Regions may share a shelf of this width even if each of them is narrower.
const SHELF_WIDTH: f64 = 700.0;
/// Around the whole drawing.
pub(super) const MARGIN: f64 = 16.0;

pub(super) use crate::statechart::Point;

/// The drawn shape of a node.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    /// Width and height.
    pub(super) size: Point,
    /// The upper left corner: in the content of its parent at first, on the page at last.
    pub(super) at: Point,
    /// From that corner to where its content begins.
    inset: Point,
    /// Lines of its name.
    pub(super) title: Vec<String>,
    /// Lines below the name: what else is said of it.
    pub(super) notes: Vec<String>,
    /// The width of what stands to the right of a connector: its name.
    pub(super) beside: f64,
}

impl Shape {
    /// The height of a composite's title.
    pub(super) fn head(&self) -> f64 {
        let lines = NAME_LINE * self.title.len() as f64 + LABEL_LINE * self.notes.len() as f64;
        if lines > 0.0 { lines + 8.0 } else { 0.0 }
    }

    /// All that it takes: itself and its name beside it.
    pub(super) fn area(&self) -> Rectangle {
        Rectangle::new(self.at, (self.size.0 + self.beside, self.size.1))
    }

    /// Where the name of a connector stands: beside it, and above the line through its middle.
    pub(super) fn name(&self) -> Option<Rectangle> {
        let middle = self.at.1 + self.size.1 / 2.0;
        let lines = (self.title.len() + self.notes.len()) as f64;
        let (left, top) = (self.at.0 + self.size.0 + 2.0, middle - LABEL_LINE);
        let height = LABEL_LINE * lines - 1.0;
        (self.beside > 0.0).then(|| Rectangle::new((left, top), (self.beside - 2.0, height)))
    }
}

/// The drawn shape of a transition.
#[derive(Clone, Debug)]
pub(super) struct Arrow {
    /// The composite in whose content it is drawn.
    pub(super) frame: NodeId,
    /// The corners of its line: in that content at first, on the page at last.
    pub(super) points: Vec<Point>,
    /// What is written on it.
    pub(super) label: Label,
    /// The middle of the label.
    pub(super) label_at: Point,
}

/// What is written on a transition.
#[derive(Clone, Debug)]
pub(super) struct Label {
    pub(super) lines: Vec<String>,
    /// Whether it says that the transition is never taken.
    pub(super) never: bool,
    /// What the transition is set apart as.
    pub(super) mark: Option<Mark>,
}

impl Label {
    pub(super) fn of(transition: &Transition, marks: &Marks) -> Label {
        let text = inscription(transition);
        Label {
            lines: wrap_condition(&text, LABEL_SIZE, LABEL_WIDTH),
            never: transition.expression.is_never(),
            mark: marks.of_transition(transition),
        }
    }

    /// Width and height; nothing if nothing is written.
    pub(super) fn size(&self) -> Point {
        match self.lines.len() {
            0 => (0.0, 0.0),
            lines => (widest(&self.lines, LABEL_SIZE) + 8.0, LABEL_LINE * lines as f64 + 4.0),
        }
    }
}

/// A drawing.
#[derive(Debug)]
pub(super) struct Layout<'m> {
    /// What is set apart.
    pub(super) marks: &'m Marks,
    /// By node.
    pub(super) shapes: Vec<Shape>,
    pub(super) arrows: Vec<Arrow>,
}

impl Layout<'_> {
    pub(super) fn shape(&self, id: NodeId) -> &Shape {
        &self.shapes[id.0 as usize]
    }

    pub(super) fn shape_mut(&mut self, id: NodeId) -> &mut Shape {
        &mut self.shapes[id.0 as usize]
    }
}

/// Lays a chart out.
pub(super) fn layout<'m>(chart: &Statechart, marks: &'m Marks) -> Layout<'m> {
    let shapes = chart.nodes().map(|(_, node)| lettered(node)).collect();
    let mut layout = Layout { marks, shapes, arrows: Vec::new() };
    let (inside, leads) = (transitions_inside(chart), leads(chart));
    let outside_in: Vec<NodeId> = chart.nodes().map(|(id, _)| id).collect();
    for id in outside_in.into_iter().rev() {
        match chart.node(id).kind {
            NodeKind::Or => {
                let (drawn, leads) = (&inside[id.0 as usize], &leads[id.0 as usize]);
                let content = flow::rows(chart, id, drawn, leads, &mut layout);
                enclose(chart, id, content, &mut layout);
            }
            NodeKind::And => {
                let content = shelves(chart, id, &mut layout);
                enclose(chart, id, content, &mut layout);
            }
            kind => {
                let shape = layout.shape_mut(id);
                shape.size = placed::at_least(chart, id, leaf_size(kind, shape));
                shape.beside = if kind == NodeKind::Basic { 0.0 } else { beside(shape) };
            }
        }
    }
    place_on_page(chart, &mut layout);
    route::across_borders(chart, &mut layout);
    layout
}

fn lettered(node: &Node) -> Shape {
    let title = Some(formula_text(&node.name)).filter(|title| !title.is_empty());
    let notes = refinements(node);
    let notes = notes.iter().flat_map(|note| wrap(note, LABEL_SIZE, LABEL_WIDTH)).collect();
    Shape { title: title.into_iter().collect(), notes, ..Shape::default() }
}

/// For each OR the transitions between its children that are drawn among its rows.
fn transitions_inside(chart: &Statechart) -> Vec<Vec<&Transition>> {
    let mut inside = vec![Vec::new(); chart.nodes().len()];
    for (id, transition) in sound_transitions(chart) {
        if let Some(parent) = placed::among_rows(chart, id, transition) {
            inside[parent.0 as usize].push(transition);
        }
    }
    inside
}

/// For each OR which of its children lead to which by transitions that are not drawn among its rows.
fn leads(chart: &Statechart) -> Vec<Vec<(NodeId, NodeId)>> {
    let mut leads = vec![Vec::new(); chart.nodes().len()];
    for (id, transition) in sound_transitions(chart) {
        if placed::among_rows(chart, id, transition).is_some() {
            continue;
        }
        let line =
            |end: NodeId| -> Vec<NodeId> { std::iter::once(end).chain(chart.ancestors(end)).collect() };
        let (from, to) = (line(transition.source), line(transition.target));
        let shared = from.iter().rev().zip(to.iter().rev()).take_while(|(a, b)| a == b).count();
        if let (Some(from), Some(to)) = (nth_from_root(&from, shared), nth_from_root(&to, shared))
            && let Some(parent) = chart.node(from).parent
        {
            leads[parent.0 as usize].push((from, to));
        }
    }
    leads
}

fn nth_from_root(line: &[NodeId], index: usize) -> Option<NodeId> {
    line.iter().rev().nth(index).copied()
}

/// The OR of which both ends of a transition are children.
pub(super) fn common_parent(chart: &Statechart, transition: &Transition) -> Option<NodeId> {
    let parent = chart.node(transition.source).parent?;
    let is_or = chart.node(parent).kind == NodeKind::Or;
    (is_or && chart.node(transition.target).parent == Some(parent)).then_some(parent)
}

fn leaf_size(kind: NodeKind, shape: &Shape) -> Point {
    match kind {
        NodeKind::Start => (14.0, 14.0),
        NodeKind::Basic => {
            let width = lettering_width(shape) + 2.0 * PADDING;
            let height = NAME_LINE * shape.title.len() as f64 + LABEL_LINE * shape.notes.len() as f64;
            (width.max(70.0), height + 15.0)
        }
        NodeKind::Fork | NodeKind::Join => (60.0, 5.0),
        _ => (20.0, 20.0),
    }
}

/// Room for the name of a connector, in the letters of labels.
fn beside(shape: &Shape) -> f64 {
    let width = widest(&shape.title, LABEL_SIZE).max(widest(&shape.notes, LABEL_SIZE));
    if width > 0.0 { width + 8.0 } else { 0.0 }
}

fn lettering_width(shape: &Shape) -> f64 {
    widest(&shape.title, NAME_SIZE).max(widest(&shape.notes, LABEL_SIZE))
}

/// Sizes a composite around its content, which is as large as said; its title is broken into lines of the content's width. Content stands in the
/// middle, but where some of it has a place: that counts from the left.
fn enclose(chart: &Statechart, id: NodeId, content: Point, layout: &mut Layout<'_>) {
    let has_places = placed::holds_placed(chart, id);
    let content = if has_places { placed::put(chart, id, layout) } else { content };
    let shape = layout.shape_mut(id);
    shape.title = wrap(&shape.title.join(" "), NAME_SIZE, content.0.max(TITLE_WIDTH));
    let head = shape.head();
    let width = content.0.max(lettering_width(shape));
    shape.size = placed::at_least(chart, id, (width + 2.0 * PADDING, head + content.1 + 2.0 * PADDING));
    let aside = if has_places { 0.0 } else { (shape.size.0 - 2.0 * PADDING - content.0) / 2.0 };
    shape.inset = (PADDING + aside, head + PADDING);
}

/// Regions in shelves: one goes beside another as long as the shelf does not become wider than the widest region,
/// or than [`SHELF_WIDTH`]. The size of it all.
fn shelves(chart: &Statechart, id: NodeId, layout: &mut Layout) -> Point {
    let regions = chart.children(id);
    let widths = regions.iter().map(|&region| layout.shape(region).size.0);
    let widest = widths.clone().fold(0.0, f64::max).max(widths.sum::<f64>().min(SHELF_WIDTH));
    let mut shelves: Vec<Shelf> = Vec::new();
    for &region in regions {
        let size = layout.shape(region).size;
        match shelves.last_mut() {
            Some(shelf) if shelf.size.0 + size.0 <= widest => shelf.add(region, size),
            _ => shelves.push(Shelf { size, regions: vec![region] }),
        }
    }
    let mut top = 0.0;
    for shelf in shelves {
        fill(chart, &shelf, top, widest, layout);
        top += shelf.size.1;
    }
    (widest, top)
}

struct Shelf {
    size: Point,
    regions: Vec<NodeId>,
}

impl Shelf {
    fn add(&mut self, region: NodeId, size: Point) {
        self.regions.push(region);
        self.size = (self.size.0 + size.0, self.size.1.max(size.1));
    }
}

/// Stretches the regions of a shelf until they fill it.
fn fill(chart: &Statechart, shelf: &Shelf, top: f64, width: f64, layout: &mut Layout) {
    let extra = (width - shelf.size.0) / shelf.regions.len() as f64;
    let mut left = 0.0;
    for &region in &shelf.regions {
        let shape = layout.shape_mut(region);
        shape.at = (left, top);
        shape.inset.0 += if placed::holds_placed(chart, region) { 0.0 } else { extra / 2.0 };
        shape.size = (shape.size.0 + extra, shelf.size.1);
        left += shape.size.0;
    }
}

fn place_on_page(chart: &Statechart, layout: &mut Layout) {
    layout.shape_mut(Statechart::ROOT).at = (MARGIN, MARGIN);
    for (id, node) in chart.nodes() {
        if let Some(parent) = node.parent {
            let origin = content_origin(layout.shape(parent));
            let shape = layout.shape_mut(id);
            shape.at = moved(shape.at, origin);
        }
    }
    let Layout { shapes, arrows, .. } = layout;
    for arrow in arrows {
        let origin = content_origin(&shapes[arrow.frame.0 as usize]);
        arrow.label_at = moved(arrow.label_at, origin);
        arrow.points.iter_mut().for_each(|point| *point = moved(*point, origin));
    }
}

pub(super) fn content_origin(shape: &Shape) -> Point {
    moved(shape.at, shape.inset)
}

pub(super) fn moved(point: Point, by: Point) -> Point {
    (point.0 + by.0, point.1 + by.1)
}
