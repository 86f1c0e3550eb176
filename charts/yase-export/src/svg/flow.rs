//! Layout of an OR: its children in rows, sequences from top to bottom, alternatives side by side.
//!
//! Transitions to the next row turn half-way between the rows; their labels are above the target
//! or, where several arrows meet, below the source. Loops are to the right of their state, edges
//! over several rows to the left of all rows, back edges to the right. Space is reserved for every
//! label.

use std::collections::BTreeMap;

use super::drawing_layout::{Arrow, DrawingLayout, Label};
use super::ranks::{EdgeCourse, ranks};
use yase::statechart::{NodeId, NodeKind, Point, Statechart, Transition, TransitionId};

/// Gap between neighbours in a row.
const GAP: f64 = 22.0;
/// Distance between a row and the turn of its arrows, and after the turn.
const TURN_DISTANCE: f64 = 10.0;
/// Space for an arrow head.
const ARROW_HEAD_SPACE: f64 = 14.0;
/// Gap between a label and the line above it.
const LABEL_GAP: f64 = 6.0;
/// Width of a loop.
const LOOP_WIDTH: f64 = 18.0;
/// Gap between the ends of arrows at one side of a box.
const END_GAP: f64 = 8.0;
/// Height of a loop.
const LOOP_HEIGHT: f64 = 16.0;

/// Places the children of an OR from (0, 0), draws the transitions between them, and returns the
/// total size. `leads` are connections drawn elsewhere, which only determine the rows.
pub(crate) fn rows(
    chart: &Statechart,
    id: NodeId,
    transitions: &[Drawn<'_>],
    leads: &[(NodeId, NodeId)],
    layout: &mut DrawingLayout<'_>,
) -> Point {
    let children = chart.children(id);
    let mut flow = Flow::new(chart, children, transitions, leads, layout);
    flow.reserve_labels();
    flow.place_columns();
    flow.place_rows();
    let arrows: Vec<RoutedEdge> = (0..flow.edges.len()).map(|index| flow.draw(index)).collect();
    let shift = -flow.left;
    for (&child, cell) in children.iter().zip(&flow.cells) {
        let shape = layout.shape_mut(child);
        shape.at = (cell.axis - cell.size.0 / 2.0 + shift, cell.top);
        shape.size = cell.size;
    }
    let size = (flow.right - flow.left, flow.height);
    for (edge, drawn) in flow.edges.into_iter().zip(arrows) {
        let points = drawn.points.into_iter().map(|(x, y)| (x + shift, y)).collect();
        let label_at = (drawn.label_at.0 + shift, drawn.label_at.1);
        layout.arrows.push(Arrow { frame: id, points, label: edge.label, label_at });
    }
    size
}

/// One child: its box around a vertical axis, with reserved space.
#[derive(Default)]
struct FlowCell {
    size: Point,
    row: usize,
    /// Space to the left and right of the axis.
    left: f64,
    right: f64,
    /// The height of the labels above and below the box.
    above: f64,
    below: f64,
    /// The height of the box and its loops.
    height: f64,
    /// The height of the loops without the box.
    loops: f64,
    /// Whether there are several loops.
    is_stacked: bool,
    /// Whether its height may grow to provide space for arrows at its sides.
    grows: bool,
    /// The numbers of arrow ends at its left and right side, total and already drawn.
    ends: [SideEnds; 2],
    axis: f64,
    top: f64,
}

/// The ends of arrows at a side.
#[derive(Clone, Copy, Default)]
struct SideEnds {
    count: usize,
    drawn: usize,
}

impl FlowCell {
    /// Position of the next arrow end at a side: evenly spaced, on the right side below the loops.
    fn next_end(&mut self, side: usize) -> f64 {
        let above = if side == 1 && self.grows { self.loops } else { 0.0 };
        self.ends[side].drawn += 1;
        let SideEnds { count, drawn } = self.ends[side];
        let part = if self.grows { drawn as f64 / (count + 1) as f64 } else { 0.5 };
        self.top + above + (self.size.1 - above) * part
    }

    /// Increases the height of the box for all arrows at its sides and several loops.
    fn grow(&mut self) {
        let [left, right] = self.ends.map(|ends| END_GAP * (ends.count + 1) as f64);
        let has_ends = self.ends.iter().any(|ends| ends.count > 0);
        if self.grows && (has_ends || self.is_stacked) {
            let below_loops = if self.ends[1].count > 0 { self.loops + right } else { 0.0 };
            let loops = if self.is_stacked { self.loops } else { 0.0 };
            self.size.1 = self.size.1.max(left).max(below_loops).max(loops);
            self.height = self.height.max(self.size.1);
        }
    }

    fn keep_width(&mut self, width: f64) {
        self.left = self.left.max(width / 2.0);
        self.right = self.right.max(width / 2.0);
    }

    fn bottom(&self) -> f64 {
        self.top + self.size.1
    }

    fn middle(&self) -> f64 {
        self.top + self.size.1 / 2.0
    }
}

/// A transition among the rows.
type Drawn<'a> = (TransitionId, &'a Transition);

struct FlowEdge {
    source: usize,
    target: usize,
    course: EdgeCourse,
    label: Label,
    /// For an edge to the next row: whether its label is at the target, else at the source.
    at_target: bool,
    /// Distance of its label or loop from the box; several are stacked.
    offset: f64,
    /// Its number among the edges between the same two children, and how many these are.
    twin: (usize, usize),
}

impl FlowEdge {
    /// The distance of its end from the axis of a box, so that edges between the same two boxes
    /// are lines of their own.
    fn aside(&self, cell: &FlowCell) -> f64 {
        let (number, count) = self.twin;
        let gap = END_GAP.min((cell.size.0 - 2.0) / count as f64);
        gap * (number as f64 - (count - 1) as f64 / 2.0)
    }
}

struct RoutedEdge {
    points: Vec<Point>,
    label_at: Point,
}

struct Flow {
    cells: Vec<FlowCell>,
    edges: Vec<FlowEdge>,
    rows: Vec<Vec<usize>>,
    /// The positions at which arrows from each row turn.
    turns: Vec<f64>,
    left: f64,
    right: f64,
    height: f64,
}

impl Flow {
    fn new(
        chart: &Statechart,
        children: &[NodeId],
        transitions: &[Drawn<'_>],
        leads: &[(NodeId, NodeId)],
        layout: &DrawingLayout<'_>,
    ) -> Flow {
        let numbers: BTreeMap<NodeId, usize> =
            children.iter().enumerate().map(|(index, &child)| (child, index)).collect();
        let number = |node: NodeId| numbers.get(&node).copied().unwrap_or(0);
        let drawn = transitions.iter().map(|(_, it)| (it.source, it.target));
        let ends: Vec<(usize, usize)> =
            drawn.chain(leads.iter().copied()).map(|(from, to)| (number(from), number(to))).collect();
        let (row_of, courses) = ranks(children.len(), &ends);
        let mut rows = vec![Vec::new(); row_of.iter().max().map_or(0, |last| last + 1)];
        row_of.iter().enumerate().for_each(|(position, &row)| rows[row].push(position));
        let cell = |(&child, row): (&NodeId, usize)| {
            let (size, beside) = (layout.shape(child).size, layout.shape(child).name_width);
            let (left, right) = (size.0 / 2.0, size.0 / 2.0 + beside);
            let grows = matches!(chart.node(child).kind, NodeKind::Basic | NodeKind::Or | NodeKind::And);
            FlowCell { size, row, left, right, height: size.1, grows, ..FlowCell::default() }
        };
        let cells = children.iter().zip(row_of).map(cell).collect();
        let mut twins: BTreeMap<(usize, usize), (usize, usize)> = BTreeMap::new();
        ends.iter().take(transitions.len()).for_each(|ends| twins.entry(*ends).or_default().1 += 1);
        let edge = |((&(id, transition), &(source, target)), course): (
            (&Drawn<'_>, &(usize, usize)),
            EdgeCourse,
        )| {
            let twin = twins.entry((source, target)).or_default();
            twin.0 += 1;
            FlowEdge {
                twin: (twin.0 - 1, twin.1),
                source,
                target,
                course,
                label: Label::of(id, transition, layout.marks),
                at_target: true,
                offset: 0.0,
            }
        };
        let edges = transitions.iter().zip(&ends).zip(courses).map(edge).collect();
        Flow { cells, edges, rows, turns: Vec::new(), left: 0.0, right: 0.0, height: 0.0 }
    }

    /// Positions labels and reserves space for them.
    fn reserve_labels(&mut self) {
        let mut arriving = vec![0; self.cells.len()];
        let down = |edge: &&FlowEdge| edge.course == EdgeCourse::Down;
        self.edges.iter().filter(down).for_each(|edge| arriving[edge.target] += 1);
        for edge in &mut self.edges {
            let (width, height) = edge.label.size();
            match edge.course {
                EdgeCourse::Down => {
                    edge.at_target = arriving[edge.target] == 1;
                    let cell = &mut self.cells[if edge.at_target { edge.target } else { edge.source }];
                    let room = if edge.at_target { &mut cell.above } else { &mut cell.below };
                    edge.offset = *room;
                    *room += height;
                    cell.keep_width(width);
                }
                EdgeCourse::Loop => {
                    let cell = &mut self.cells[edge.source];
                    edge.offset = cell.loops;
                    cell.is_stacked = edge.offset > 0.0;
                    cell.loops = edge.offset + height.max(LOOP_HEIGHT + 8.0) + 4.0;
                    cell.height = cell.height.max(cell.loops);
                    cell.right = cell.right.max(cell.size.0 / 2.0 + LOOP_WIDTH + width);
                }
                EdgeCourse::Skip | EdgeCourse::Back => {
                    let side = usize::from(edge.course == EdgeCourse::Back);
                    self.cells[edge.source].ends[side].count += 1;
                    self.cells[edge.target].ends[side].count += 1;
                }
            }
        }
        self.cells.iter_mut().for_each(FlowCell::grow);
    }

    /// Sets the axes: a single child is on the centre line, several are centred about it.
    fn place_columns(&mut self) {
        for row in &self.rows {
            let width: f64 = row.iter().map(|&index| self.cells[index].left + self.cells[index].right).sum();
            let mut left = -(width + GAP * row.len().saturating_sub(1) as f64) / 2.0;
            for &cell in row {
                let cell = &mut self.cells[cell];
                cell.axis = if row.len() == 1 { 0.0 } else { left + cell.left };
                left += cell.left + cell.right + GAP;
                self.left = self.left.min(cell.axis - cell.left);
                self.right = self.right.max(cell.axis + cell.right);
            }
        }
    }

    fn place_rows(&mut self) {
        let mut top = 0.0;
        for row in &self.rows {
            let highest = |of: fn(&FlowCell) -> f64| {
                row.iter().map(|&index| of(&self.cells[index])).fold(0.0, f64::max)
            };
            let (above, height) =
                (highest(|cell| cell.above), highest(|cell| cell.height.max(cell.size.1 + cell.below)));
            if !self.turns.is_empty() {
                top += above + ARROW_HEAD_SPACE + if above > 0.0 { LABEL_GAP } else { 0.0 };
            }
            self.height = top + height;
            row.iter().for_each(|&position| self.cells[position].top = top);
            top = self.height + TURN_DISTANCE;
            self.turns.push(top);
        }
    }

    fn draw(&mut self, index: usize) -> RoutedEdge {
        match self.edges[index].course {
            EdgeCourse::Down => self.draw_down(&self.edges[index]),
            EdgeCourse::Loop => self.draw_loop(&self.edges[index]),
            EdgeCourse::Skip => self.draw_around(index, -1.0),
            EdgeCourse::Back => self.draw_around(index, 1.0),
        }
    }

    fn draw_down(&self, edge: &FlowEdge) -> RoutedEdge {
        let (source, target) = (&self.cells[edge.source], &self.cells[edge.target]);
        let turn = self.turns[source.row];
        let (from, to) = (source.axis + edge.aside(source), target.axis + edge.aside(target));
        let mut points = vec![(from, source.bottom()), (from, turn), (to, turn), (to, target.top)];
        if from == to {
            points.drain(1..3);
        }
        let half = edge.label.size().1 / 2.0;
        let label_at = match edge.at_target {
            true => (target.axis, target.top - ARROW_HEAD_SPACE - edge.offset - half),
            false => (source.axis, source.bottom() + 4.0 + edge.offset + half),
        };
        RoutedEdge { points, label_at }
    }

    fn draw_loop(&self, edge: &FlowEdge) -> RoutedEdge {
        let cell = &self.cells[edge.source];
        let (width, height) = edge.label.size();
        let side = cell.axis + cell.size.0 / 2.0;
        let middle = cell.top + edge.offset + (height / 2.0).max(LOOP_HEIGHT / 2.0 + 8.0);
        let middle = if edge.offset == 0.0 { middle.min(cell.middle()) } else { middle };
        let (upper, lower) = (middle - LOOP_HEIGHT / 2.0, middle + LOOP_HEIGHT / 2.0);
        let points =
            vec![(side, upper), (side + LOOP_WIDTH, upper), (side + LOOP_WIDTH, lower), (side, lower)];
        let label_middle = cell.top + edge.offset + (height / 2.0).max(middle - cell.top - edge.offset);
        RoutedEdge { points, label_at: (side + LOOP_WIDTH + width / 2.0, label_middle) }
    }

    /// A path around the rows: to the left of everything drawn so far for -1, to the right for 1.
    fn draw_around(&mut self, index: usize, side: f64) -> RoutedEdge {
        let FlowEdge { source, target, label, .. } = &self.edges[index];
        let (source, target) = (*source, *target);
        let room = (label.size().0 / 2.0).max(4.0);
        let border = if side < 0.0 { self.left } else { self.right };
        let lane = border + side * (TURN_DISTANCE + room);
        let mut end = |cell: usize| {
            let cell = &mut self.cells[cell];
            (cell.axis + side * cell.size.0 / 2.0, cell.next_end(usize::from(side > 0.0)))
        };
        let (from, to) = (end(source), end(target));
        let drawn = RoutedEdge {
            points: vec![from, (lane, from.1), (lane, to.1), to],
            label_at: (lane, (from.1 + to.1) / 2.0),
        };
        if side < 0.0 {
            self.left = lane - room;
        } else {
            self.right = lane + room;
        }
        drawn
    }
}
