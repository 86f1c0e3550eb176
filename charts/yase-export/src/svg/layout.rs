//! Layout: sizes of boxes from the inside out, then positions from the outside in.

use std::ops::Range;

use super::drawing_layout::{DrawingLayout, LABEL_WIDTH, Shape, content_origin, moved};
use super::lettering::{LABEL_LINE, LABEL_SIZE, NAME_LINE, NAME_SIZE, formula_text, widest, wrap};
use super::{flow, placed, route};
use crate::highlights::Highlights;
use crate::notation::refinements;
use crate::outline::sound_transitions;
use yase::statechart::{Node, NodeId, NodeKind, Point, Statechart, Transition, TransitionId};

/// Distance between a border and the content.
const PADDING: f64 = 14.0;
/// Minimum width at which titles wrap.
const TITLE_WIDTH: f64 = 200.0;
/// Limit of the runs of neighbouring regions whose length is tried as that of shelves: of the
/// regions at which a run may begin, and of the regions in one.
const MOST_RUNS: usize = 16;
/// Margin of the drawing.
pub(crate) const MARGIN: f64 = 16.0;

/// Computes the layout of a chart.
pub(crate) fn layout<'m>(chart: &Statechart, marks: &'m Highlights) -> DrawingLayout<'m> {
    let shapes = chart.nodes().map(|(_, node)| lettered(node)).collect();
    let mut layout = DrawingLayout { marks, shapes, arrows: Vec::new() };
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
                let content = regions(chart, id, &mut layout);
                enclose(chart, id, content, &mut layout);
            }
            kind => {
                let shape = layout.shape_mut(id);
                shape.size = placed::at_least(chart, id, leaf_size(kind, shape));
                shape.name_width = if kind == NodeKind::Basic { 0.0 } else { beside(shape) };
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
fn transitions_inside(chart: &Statechart) -> Vec<Vec<(TransitionId, &Transition)>> {
    let mut inside = vec![Vec::new(); chart.nodes().len()];
    for (id, transition) in sound_transitions(chart) {
        if let Some(parent) = placed::among_rows(chart, id, transition) {
            inside[parent.0 as usize].push((id, transition));
        }
    }
    inside
}

/// For each OR the connections of its children by transitions that are not drawn among its rows.
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

/// Width of the name of a connector, in the font of labels.
fn beside(shape: &Shape) -> f64 {
    let width = widest(&shape.title, LABEL_SIZE).max(widest(&shape.notes, LABEL_SIZE));
    if width > 0.0 { width + 8.0 } else { 0.0 }
}

fn lettering_width(shape: &Shape) -> f64 {
    widest(&shape.title, NAME_SIZE).max(widest(&shape.notes, LABEL_SIZE))
}

/// Sizes a composite around its content; the title is wrapped to the width of the content. Content
/// is centred, unless a part of it has a given position, which is relative to the left border.
fn enclose(chart: &Statechart, id: NodeId, content: Point, layout: &mut DrawingLayout<'_>) {
    let has_places = placed::holds_placed(chart, id);
    let content = if has_places { placed::place_children(chart, id, layout) } else { content };
    let shape = layout.shape_mut(id);
    shape.title = wrap(&shape.title.join(" "), NAME_SIZE, content.0.max(TITLE_WIDTH));
    let head = shape.head();
    let width = content.0.max(lettering_width(shape));
    shape.size = placed::at_least(chart, id, (width + 2.0 * PADDING, head + content.1 + 2.0 * PADDING));
    let aside = if has_places { 0.0 } else { (shape.size.0 - 2.0 * PADDING - content.0) / 2.0 };
    shape.inset = (PADDING + aside, head + PADDING);
}

/// Places regions side by side and below each other, in their order: on shelves, or in columns, of
/// the length that gives the smallest drawing. Returns the total size.
fn regions(chart: &Statechart, id: NodeId, layout: &mut DrawingLayout) -> Point {
    let sizes: Vec<Point> = chart.children(id).iter().map(|&region| layout.shape(region).size).collect();
    let packings = [false, true].into_iter().flat_map(|is_column| {
        let sizes = sizes.iter().map(|&size| turned(size, is_column)).collect::<Vec<_>>();
        let limits = limits(&sizes);
        limits.into_iter().map(move |limit| RegionPacking::new(&sizes, limit, is_column))
    });
    let best = packings.min_by(|a, b| a.extent().total_cmp(&b.extent()));
    let Some(RegionPacking { rows, size, is_column }) = best else { return (0.0, 0.0) };
    let mut top = 0.0;
    for RegionRow { size: row, regions } in rows {
        let extra = (size.0 - row.0) / regions.len() as f64;
        let mut left = 0.0;
        for &region in &chart.children(id)[regions] {
            let shape = layout.shape_mut(region);
            let before = shape.size;
            let own = turned(before, is_column);
            shape.at = turned((left, top), is_column);
            shape.size = turned((own.0 + extra, row.1), is_column);
            if !placed::holds_placed(chart, region) {
                shape.inset.0 += (shape.size.0 - before.0) / 2.0;
            }
            left += own.0 + extra;
        }
        top += row.1;
    }
    turned(size, is_column)
}

/// The candidate lengths of shelves: those of runs of neighbouring regions.
fn limits(sizes: &[Point]) -> Vec<f64> {
    let longest = sizes.iter().fold(0.0, |longest, size| size.0.max(longest));
    let runs = (0..sizes.len().min(MOST_RUNS)).flat_map(|first| {
        sizes[first..].iter().take(MOST_RUNS).scan(0.0, |length, size| {
            *length += size.0;
            Some(*length)
        })
    });
    let mut limits: Vec<f64> = runs.filter(|length| *length > longest).collect();
    limits.push(longest);
    limits.sort_by(f64::total_cmp);
    limits.dedup();
    limits
}

/// A point, with right and down exchanged for columns.
fn turned(point: Point, is_column: bool) -> Point {
    if is_column { (point.1, point.0) } else { point }
}

/// Regions on shelves; columns are shelves with right and down exchanged.
struct RegionPacking {
    rows: Vec<RegionRow>,
    size: Point,
    is_column: bool,
}

struct RegionRow {
    size: Point,
    regions: Range<usize>,
}

impl RegionPacking {
    fn new(sizes: &[Point], limit: f64, is_column: bool) -> RegionPacking {
        let mut rows: Vec<RegionRow> = Vec::new();
        for (index, &size) in sizes.iter().enumerate() {
            match rows.last_mut() {
                Some(row) if row.size.0 + size.0 <= limit => {
                    row.size = (row.size.0 + size.0, row.size.1.max(size.1));
                    row.regions.end = index + 1;
                }
                _ => rows.push(RegionRow { size, regions: index..index + 1 }),
            }
        }
        let width = rows.iter().fold(0.0, |width, row| row.size.0.max(width));
        let height = rows.iter().map(|row| row.size.1).sum();
        RegionPacking { rows, size: (width, height), is_column }
    }

    /// The size to minimize: the longer side, of equals the shorter.
    fn extent(&self) -> f64 {
        let (longer, shorter) = (self.size.0.max(self.size.1), self.size.0.min(self.size.1));
        longer + shorter / 1000.0
    }
}

fn place_on_page(chart: &Statechart, layout: &mut DrawingLayout) {
    layout.shape_mut(Statechart::ROOT).at = (MARGIN, MARGIN);
    for (id, node) in chart.nodes() {
        if let Some(parent) = node.parent {
            let origin = content_origin(layout.shape(parent));
            let shape = layout.shape_mut(id);
            shape.at = moved(shape.at, origin);
        }
    }
    let DrawingLayout { shapes, arrows, .. } = layout;
    for arrow in arrows {
        let origin = content_origin(&shapes[arrow.frame.0 as usize]);
        arrow.label_at = moved(arrow.label_at, origin);
        arrow.points.iter_mut().for_each(|point| *point = moved(*point, origin));
    }
}
