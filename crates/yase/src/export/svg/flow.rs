//! The content of an OR: its children in rows, what follows below, alternatives side by side.
//!
//! Transitions to the next row turn aside half-way between the rows; their labels stand above the target or, where several
//! arrows meet, below the source. Loops stand to the right of their state, ways over several rows to the left of all rows, ways
//! back to the right. Room is kept for every label.

use std::collections::BTreeMap;

use super::layout::{Arrow, Label, Layout, Point};
use super::ranks::{Course, ranks};
use crate::statechart::{NodeId, NodeKind, Statechart, Transition};

/// Between what stands side by side.
const GAP: f64 = 22.0;
/// From a row to where its arrows turn aside, and on from there.
const TURN: f64 = 10.0;
/// Room for the head of an arrow.
const HEAD: f64 = 14.0;
/// Between a label and the line above it.
const LABEL_GAP: f64 = 6.0;
/// How far a loop stands out.
const LOOP: f64 = 18.0;
/// Between the ends of arrows at one side of a box.
const END_GAP: f64 = 8.0;
/// The height of a loop.
const LOOP_HEIGHT: f64 = 16.0;

/// Arranges the children of an OR from (0, 0) on, draws the transitions between them, and returns the size of it all. What leads to what by
/// transitions drawn elsewhere is told, since it stands below.
pub(super) fn rows(
    chart: &Statechart,
    id: NodeId,
    transitions: &[&Transition],
    leads: &[(NodeId, NodeId)],
    layout: &mut Layout<'_>,
) -> Point {
    let children = chart.children(id);
    let mut flow = Flow::new(chart, children, transitions, leads, layout);
    flow.reserve_labels();
    flow.place_columns();
    flow.place_rows();
    let arrows: Vec<Drawn> = (0..flow.edges.len()).map(|index| flow.draw(index)).collect();
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

/// One child: its box around a vertical axis, with the room to be kept around it.
#[derive(Default)]
struct Cell {
    size: Point,
    row: usize,
    /// What is needed to the left and right of the axis.
    left: f64,
    right: f64,
    /// The height of the labels above and below the box.
    above: f64,
    below: f64,
    /// The height of the box and its loops.
    height: f64,
    /// The height of the loops alone.
    loops: f64,
    /// Whether there are several loops.
    is_stacked: bool,
    /// Whether it may be made higher, to have room for arrows at its sides.
    grows: bool,
    /// How many arrows begin or end at its left side and its right, and how many of them are drawn.
    ends: [Ends; 2],
    axis: f64,
    top: f64,
}

/// The ends of arrows at a side.
#[derive(Clone, Copy, Default)]
struct Ends {
    count: usize,
    drawn: usize,
}

impl Cell {
    /// Where the next arrow at a side ends: those at the right side below the loops, spread evenly.
    fn next_end(&mut self, side: usize) -> f64 {
        let above = if side == 1 && self.grows { self.loops } else { 0.0 };
        self.ends[side].drawn += 1;
        let Ends { count, drawn } = self.ends[side];
        let part = if self.grows { drawn as f64 / (count + 1) as f64 } else { 0.5 };
        self.top + above + (self.size.1 - above) * part
    }

    /// Makes the box high enough for all arrows at its sides, and for several loops.
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

struct Edge {
    source: usize,
    target: usize,
    course: Course,
    label: Label,
    /// For an edge to the next row: whether its label stands at the target; else at the source.
    at_target: bool,
    /// How far from the box its label or loop begins, several being stacked.
    offset: f64,
}

struct Drawn {
    points: Vec<Point>,
    label_at: Point,
}

struct Flow {
    cells: Vec<Cell>,
    edges: Vec<Edge>,
    rows: Vec<Vec<usize>>,
    /// Where arrows out of each row turn aside.
    turns: Vec<f64>,
    left: f64,
    right: f64,
    height: f64,
}

impl Flow {
    fn new(
        chart: &Statechart,
        children: &[NodeId],
        transitions: &[&Transition],
        leads: &[(NodeId, NodeId)],
        layout: &Layout<'_>,
    ) -> Flow {
        let places: BTreeMap<NodeId, usize> =
            children.iter().enumerate().map(|(place, &child)| (child, place)).collect();
        let place = |node: NodeId| places.get(&node).copied().unwrap_or(0);
        let drawn = transitions.iter().map(|it| (it.source, it.target));
        let ends: Vec<(usize, usize)> =
            drawn.chain(leads.iter().copied()).map(|(from, to)| (place(from), place(to))).collect();
        let (row_of, courses) = ranks(children.len(), &ends);
        let mut rows = vec![Vec::new(); row_of.iter().max().map_or(0, |last| last + 1)];
        row_of.iter().enumerate().for_each(|(place, &row)| rows[row].push(place));
        let cell = |(&child, row): (&NodeId, usize)| {
            let (size, beside) = (layout.shape(child).size, layout.shape(child).beside);
            let (left, right) = (size.0 / 2.0, size.0 / 2.0 + beside);
            let grows = matches!(chart.node(child).kind, NodeKind::Basic | NodeKind::Or | NodeKind::And);
            Cell { size, row, left, right, height: size.1, grows, ..Cell::default() }
        };
        let cells = children.iter().zip(row_of).map(cell).collect();
        let edge =
            |((&transition, &(source, target)), course): ((&&Transition, &(usize, usize)), Course)| Edge {
                source,
                target,
                course,
                label: Label::of(transition, layout.marks),
                at_target: true,
                offset: 0.0,
            };
        let edges = transitions.iter().zip(&ends).zip(courses).map(edge).collect();
        Flow { cells, edges, rows, turns: Vec::new(), left: 0.0, right: 0.0, height: 0.0 }
    }

    /// Decides where labels stand and keeps room for them.
    fn reserve_labels(&mut self) {
        let mut arriving = vec![0; self.cells.len()];
        let down = |edge: &&Edge| edge.course == Course::Down;
        self.edges.iter().filter(down).for_each(|edge| arriving[edge.target] += 1);
        for edge in &mut self.edges {
            let (width, height) = edge.label.size();
            match edge.course {
                Course::Down => {
                    edge.at_target = arriving[edge.target] == 1;
                    let cell = &mut self.cells[if edge.at_target { edge.target } else { edge.source }];
                    let room = if edge.at_target { &mut cell.above } else { &mut cell.below };
                    edge.offset = *room;
                    *room += height;
                    cell.keep_width(width);
                }
                Course::Loop => {
                    let cell = &mut self.cells[edge.source];
                    edge.offset = cell.loops;
                    cell.is_stacked = edge.offset > 0.0;
                    cell.loops = edge.offset + height.max(LOOP_HEIGHT + 8.0) + 4.0;
                    cell.height = cell.height.max(cell.loops);
                    cell.right = cell.right.max(cell.size.0 / 2.0 + LOOP + width);
                }
                Course::Skip | Course::Back => {
                    let side = usize::from(edge.course == Course::Back);
                    self.cells[edge.source].ends[side].count += 1;
                    self.cells[edge.target].ends[side].count += 1;
                }
            }
        }
        self.cells.iter_mut().for_each(Cell::grow);
    }

    /// Sets the axes: a child alone in its row stands on the middle line, several are centred about it.
    fn place_columns(&mut self) {
        for row in &self.rows {
            let width: f64 = row.iter().map(|&place| self.cells[place].left + self.cells[place].right).sum();
            let mut left = -(width + GAP * row.len().saturating_sub(1) as f64) / 2.0;
            for &place in row {
                let cell = &mut self.cells[place];
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
            let highest =
                |of: fn(&Cell) -> f64| row.iter().map(|&place| of(&self.cells[place])).fold(0.0, f64::max);
            let (above, height) =
                (highest(|cell| cell.above), highest(|cell| cell.height.max(cell.size.1 + cell.below)));
            if !self.turns.is_empty() {
                top += above + HEAD + if above > 0.0 { LABEL_GAP } else { 0.0 };
            }
            self.height = top + height;
            row.iter().for_each(|&place| self.cells[place].top = top);
            top = self.height + TURN;
            self.turns.push(top);
        }
    }

    fn draw(&mut self, index: usize) -> Drawn {
        match self.edges[index].course {
            Course::Down => self.draw_down(&self.edges[index]),
            Course::Loop => self.draw_loop(&self.edges[index]),
            Course::Skip => self.draw_around(index, -1.0),
            Course::Back => self.draw_around(index, 1.0),
        }
    }

    fn draw_down(&self, edge: &Edge) -> Drawn {
        let (source, target) = (&self.cells[edge.source], &self.cells[edge.target]);
        let turn = self.turns[source.row];
        let mut points = vec![
            (source.axis, source.bottom()),
            (source.axis, turn),
            (target.axis, turn),
            (target.axis, target.top),
        ];
        if source.axis == target.axis {
            points.drain(1..3);
        }
        let half = edge.label.size().1 / 2.0;
        let label_at = match edge.at_target {
            true => (target.axis, target.top - HEAD - edge.offset - half),
            false => (source.axis, source.bottom() + 4.0 + edge.offset + half),
        };
        Drawn { points, label_at }
    }

    fn draw_loop(&self, edge: &Edge) -> Drawn {
        let cell = &self.cells[edge.source];
        let (width, height) = edge.label.size();
        let side = cell.axis + cell.size.0 / 2.0;
        let middle = cell.top + edge.offset + (height / 2.0).max(LOOP_HEIGHT / 2.0 + 8.0);
        let middle = if edge.offset == 0.0 { middle.min(cell.middle()) } else { middle };
        let (upper, lower) = (middle - LOOP_HEIGHT / 2.0, middle + LOOP_HEIGHT / 2.0);
        let points = vec![(side, upper), (side + LOOP, upper), (side + LOOP, lower), (side, lower)];
        let label_middle = cell.top + edge.offset + (height / 2.0).max(middle - cell.top - edge.offset);
        Drawn { points, label_at: (side + LOOP + width / 2.0, label_middle) }
    }

    /// Around the rows: to the left of all that is drawn so far for -1, to the right for 1.
    fn draw_around(&mut self, index: usize, side: f64) -> Drawn {
        let Edge { source, target, label, .. } = &self.edges[index];
        let (source, target) = (*source, *target);
        let room = (label.size().0 / 2.0).max(4.0);
        let border = if side < 0.0 { self.left } else { self.right };
        let lane = border + side * (TURN + room);
        let mut end = |cell: usize| {
            let cell = &mut self.cells[cell];
            (cell.axis + side * cell.size.0 / 2.0, cell.next_end(usize::from(side > 0.0)))
        };
        let (from, to) = (end(source), end(target));
        let drawn = Drawn {
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
