//! Transitions between composites, routed orthogonally around the boxes.
//!
//! Their lines run on a grid with lines slightly beside every box. Dijkstra's algorithm finds a
//! cheapest path, where a corner costs as much as a detour, and so does running along another line
//! or over a label. Composites that contain neither end are avoided; the border of one that
//! contains an end is crossed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::drawing_layout::{Arrow, DrawingLayout, Label, content_origin, moved};
use super::grid::{Direction, Grid, GridLines};
use super::placed;
use super::rectangle::Rectangle;
use crate::loss_report::is_box;
use crate::outline::sound_transitions;
use yase::statechart::{NodeId, NodeKind, Point, Statechart, Transition, TransitionId};

/// Distance from a box to the nearest line beside it.
const CLEARANCE: f64 = 8.0;
/// Cost of a corner, in pixels.
const CORNER_COST: u64 = 40;
/// Cost of an end that is not in the middle of a side.
const OFF_CENTRE_COST: u64 = 15;
/// Minimum length of sides with more than one position for arrows.
const MIN_SPLIT_LENGTH: f64 = 28.0;

/// Draws the transitions that are not drawn among the children of a composite.
pub(crate) fn across_borders(chart: &Statechart, layout: &mut DrawingLayout) {
    let open: Vec<(TransitionId, &Transition)> = sound_transitions(chart)
        .filter(|&(id, transition)| placed::among_rows(chart, id, transition).is_none())
        .collect();
    if open.is_empty() {
        return;
    }
    let mut router = Router::new(chart, layout, &open);
    // lines with given corners first, so that the others avoid them
    let (bent, others): (Vec<_>, Vec<_>) =
        open.into_iter().partition(|&(id, _)| !placed::bends(chart, id).is_empty());
    for (id, transition) in bent.into_iter().chain(others) {
        let points = match placed::bends(chart, id) {
            [] => router.cheapest_path(chart, transition),
            bends => router.around(chart, transition, bends, layout),
        };
        let label = Label::of(id, transition, layout.marks);
        let label_at = router.label_centre(&points, label.size());
        let arrow = Arrow { frame: Statechart::ROOT, points, label, label_at };
        router.occupy(&arrow);
        layout.arrows.push(arrow);
    }
}

/// The obstacles and routes on the page.
struct Router {
    /// By node: where arrows begin and end.
    boxes: Vec<Rectangle>,
    /// State of the page during routing.
    names: Vec<Option<Rectangle>>,
    /// By node: whether it is a bar, which has ends only above and below.
    bars: Vec<bool>,
    /// Areas that a label must not cover: leaves, titles, other labels.
    letters: Vec<Rectangle>,
    /// Areas that a label should not cover: lines.
    lines: Vec<Rectangle>,
    /// By node: the title of a composite.
    heads: Vec<Option<Rectangle>>,
    page: Rectangle,
    grid: Grid,
}

impl Router {
    fn new(chart: &Statechart, layout: &DrawingLayout, open: &[(TransitionId, &Transition)]) -> Router {
        let boxes: Vec<Rectangle> =
            chart.nodes().map(|(id, _)| Rectangle::new(layout.shape(id).at, layout.shape(id).size)).collect();
        let heads: Vec<Option<Rectangle>> = chart.nodes().map(|(id, _)| head(chart, layout, id)).collect();
        let names: Vec<Option<Rectangle>> = chart.nodes().map(|(id, _)| layout.shape(id).name()).collect();
        let bar = |kind| matches!(kind, NodeKind::Fork | NodeKind::Join);
        let bars = chart.nodes().map(|(_, node)| bar(node.kind)).collect();
        let leaves = chart.nodes().filter(|&(id, _)| !is_box(chart, id)).map(|(id, _)| boxes[id.0 as usize]);
        let titles = heads.iter().chain(&names).copied().flatten();
        let letters = leaves.chain(titles).collect();
        let page = boxes[Statechart::ROOT.0 as usize];
        let mut around: Vec<Rectangle> = boxes.clone();
        around.extend(names.iter().copied().flatten());
        around.extend(heads.iter().copied().flatten());
        let ends = open.iter().flat_map(|(_, it)| [it.source, it.target]).map(|id| boxes[id.0 as usize]);
        let ends: Vec<Rectangle> = ends.collect();
        let mut grid_lines = GridLines::beside(&around, &ends, page, CLEARANCE);
        for end in &ends {
            grid_lines.columns.extend(ports_along(end.left, end.right));
            grid_lines.rows.extend(ports_along(end.top, end.bottom));
        }
        let grid = Grid::new(grid_lines, page);
        let mut router = Router { boxes, names, bars, letters, lines: Vec::new(), heads, page, grid };
        layout.arrows.iter().for_each(|arrow| router.occupy(arrow));
        router
    }

    /// Records an arrow and its label so that others avoid them.
    fn occupy(&mut self, arrow: &Arrow) {
        for ends in arrow.points.windows(2) {
            self.grid.occupy(ends[0], ends[1]);
            self.lines.push(Rectangle::between(ends[0], ends[1]).grown(1.5));
        }
        let (width, height) = arrow.label.size();
        if width > 0.0 {
            let label = Rectangle::around(arrow.label_at, (width, height));
            self.grid.burden(&label);
            self.letters.push(label);
        }
    }

    /// The line through the given bends.
    fn around(
        &self,
        chart: &Statechart,
        transition: &Transition,
        bends: &[Point],
        layout: &DrawingLayout,
    ) -> Vec<Point> {
        let holder = innermost_around(chart, transition);
        let origin = content_origin(layout.shape(holder));
        let bends: Vec<Point> = bends.iter().map(|&bend| moved(bend, origin)).collect();
        let (from, to) =
            (&self.boxes[transition.source.0 as usize], &self.boxes[transition.target.0 as usize]);
        placed::line(from, &bends, to)
    }

    /// The cheapest path, or a straight line if there is none.
    fn cheapest_path(&mut self, chart: &Statechart, transition: &Transition) -> Vec<Point> {
        let (source, target) = (transition.source, transition.target);
        self.block(chart, source, target);
        let starts = self.ports(source, holds(chart, source, target));
        let goals = self.ports(target, holds(chart, target, source));
        self.search(&starts, &goals).unwrap_or_else(|| {
            let (from, to) = (self.boxes[source.0 as usize], self.boxes[target.0 as usize]);
            vec![from.centre(), to.centre()]
        })
    }

    /// Blocks every box that contains no end, and the titles of those that do.
    fn block(&mut self, chart: &Statechart, source: NodeId, target: NodeId) {
        let mut open = vec![false; self.boxes.len()];
        for end in [source, target] {
            chart.ancestors(end).for_each(|ancestor| open[ancestor.0 as usize] = true);
        }
        self.grid.clear();
        let mut closed_child = vec![false; self.boxes.len()];
        for (id, node) in chart.nodes() {
            let index = id.0 as usize;
            if node.parent.is_some_and(|parent| closed_child[parent.0 as usize]) {
                closed_child[index] = true;
            } else if !open[index] {
                closed_child[index] = true;
                self.grid.block(&self.boxes[index], CLEARANCE - 1.0);
                self.names[index].iter().for_each(|name| self.grid.block(name, 0.5));
            } else if let Some(head) = &self.heads[index] {
                self.grid.block(head, 1.0);
            }
        }
    }

    /// Positions at which arrows can leave or reach a box, with the grid point in front: the middle
    /// of each side, and its quarters if it is long enough.
    fn ports(&self, id: NodeId, inward: bool) -> Vec<Port> {
        let area = self.boxes[id.0 as usize];
        let distance = if inward { -CLEARANCE } else { CLEARANCE };
        let mut ports = Vec::new();
        for x in ports_along(area.left, area.right) {
            ports.push((Direction::Down, (x, area.bottom), (0.0, distance)));
            ports.push((Direction::Up, (x, area.top), (0.0, -distance)));
        }
        for y in ports_along(area.top, area.bottom).filter(|_| !self.bars[id.0 as usize]) {
            ports.push((Direction::Right, (area.right, y), (distance, 0.0)));
            ports.push((Direction::Left, (area.left, y), (-distance, 0.0)));
        }
        let port = |(side, at, (right, down)): (Direction, Point, Point)| {
            let side = if inward { side.reversed() } else { side };
            let index = self.grid.crossing_at((at.0 + right, at.1 + down))?;
            let (x, y) = area.centre();
            let cost = if at.0 == x || at.1 == y { 0 } else { OFF_CENTRE_COST };
            Some(Port { at, grid_point: index, side, cost })
        };
        ports.into_iter().filter_map(port).collect()
    }

    fn search(&self, starts: &[Port], goals: &[Port]) -> Option<Vec<Point>> {
        let mut costs = vec![u64::MAX; self.grid.len() * 4];
        let mut before = vec![usize::MAX; self.grid.len() * 4];
        let mut open = BinaryHeap::new();
        for start in starts.iter().filter(|start| self.grid.is_free(start.grid_point)) {
            let state = start.grid_point * 4 + start.side as usize;
            costs[state] = start.cost + self.grid.burden_of(start.grid_point, start.side);
            open.push(Reverse((costs[state], state)));
        }
        let mut best: Option<(u64, usize, &Port)> = None;
        while let Some(Reverse((cost, state))) = open.pop() {
            if cost > costs[state] {
                continue;
            }
            if best.is_some_and(|(min, ..)| min <= cost) {
                break;
            }
            let (index, heading) = (state / 4, Direction::ALL[state % 4]);
            for goal in goals.iter().filter(|goal| goal.grid_point == index) {
                let turn = corner(heading, goal.side.reversed());
                let total = cost + goal.cost + turn + self.grid.burden_of(index, goal.side);
                if best.is_none_or(|(min, ..)| total < min) {
                    best = Some((total, state, goal));
                }
            }
            for next in Direction::ALL {
                let Some((neighbour, length)) = self.grid.step(index, next) else { continue };
                if next == heading.reversed() {
                    continue;
                }
                let (total, reached) = (cost + length + corner(heading, next), neighbour * 4 + next as usize);
                if total < costs[reached] {
                    costs[reached] = total;
                    before[reached] = state;
                    open.push(Reverse((total, reached)));
                }
            }
        }
        let (_, last, goal) = best?;
        Some(self.trace(last, &before, starts, goal))
    }

    /// Reconstructs the path from its end.
    fn trace(&self, last: usize, before: &[usize], starts: &[Port], goal: &Port) -> Vec<Point> {
        let mut points = vec![goal.at];
        let mut state = last;
        loop {
            points.push(self.grid.point(state / 4));
            if before[state] == usize::MAX {
                break;
            }
            state = before[state];
        }
        let first = starts.iter().find(|start| start.grid_point * 4 + start.side as usize == state);
        points.extend(first.map(|start| start.at));
        points.reverse();
        without_straight_corners(&points)
    }

    /// The centre of a label: at the position on the line with the least overlap, the longest
    /// segment first.
    fn label_centre(&self, points: &[Point], size: Point) -> Point {
        let mut parts: Vec<(Point, Point)> = points.windows(2).map(|ends| (ends[0], ends[1])).collect();
        let length = |(from, to): &(Point, Point)| (to.0 - from.0).abs() + (to.1 - from.1).abs();
        parts.sort_by(|a, b| length(b).total_cmp(&length(a)));
        let mut best = (f64::INFINITY, parts.first().map_or((0.0, 0.0), |part| part.0));
        for (from, to) in &parts {
            for part in [0.5, 0.35, 0.65, 0.2, 0.8, 0.05, 0.95] {
                let on_line = (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part);
                for aside in [0.0, 0.5, -0.5] {
                    let centre = (on_line.0 + aside * (size.0 + 4.0), on_line.1);
                    let label = Rectangle::around(centre, size);
                    let covered: f64 = self.letters.iter().map(|letters| letters.shared(&label)).sum();
                    let crossed: f64 = self.lines.iter().map(|line| line.shared(&label)).sum();
                    let outside = label.area() - label.shared(&self.page);
                    let cost = covered + 2.0 * outside + crossed;
                    if cost + 0.01 < best.0 {
                        best = (cost, centre);
                    }
                }
            }
        }
        best.1
    }
}

/// A position at which an arrow can begin or end.
struct Port {
    /// On the border.
    at: Point,
    /// The grid point in front of it.
    grid_point: usize,
    /// The direction from the border to that grid point.
    side: Direction,
    cost: u64,
}

/// The middle of a side, and its quarters.
fn ports_along(from: f64, to: f64) -> impl Iterator<Item = f64> {
    let parts: &[f64] = if to - from < MIN_SPLIT_LENGTH { &[0.5] } else { &[0.5, 0.25, 0.75] };
    parts.iter().map(move |part| if *part == 0.5 { (from + to) / 2.0 } else { from + (to - from) * part })
}

fn corner(heading: Direction, next: Direction) -> u64 {
    if heading == next { 0 } else { CORNER_COST }
}

fn head(chart: &Statechart, layout: &DrawingLayout, id: NodeId) -> Option<Rectangle> {
    let shape = layout.shape(id);
    (is_box(chart, id) && !shape.title.is_empty())
        .then(|| Rectangle::new(shape.at, (shape.size.0, shape.head())))
}

fn holds(chart: &Statechart, outer: NodeId, inner: NodeId) -> bool {
    chart.ancestors(inner).any(|ancestor| ancestor == outer)
}

/// The innermost composite that contains both ends of a transition.
fn innermost_around(chart: &Statechart, transition: &Transition) -> NodeId {
    // limits the number of ancestors, in case the chart is not a tree
    let ancestors = |id: NodeId| chart.ancestors(id).take(chart.nodes().len());
    let around: Vec<NodeId> = ancestors(transition.target).collect();
    ancestors(transition.source).find(|id| around.contains(id)).unwrap_or(Statechart::ROOT)
}

fn without_straight_corners(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::with_capacity(points.len());
    for &point in points {
        if let [.., before, last] = kept.as_slice() {
            let straight = before.0 == last.0 && last.0 == point.0 || before.1 == last.1 && last.1 == point.1;
            if straight {
                kept.pop();
            }
        }
        kept.push(point);
    }
    kept
}
