//! Grid of the lines on which arrows run between boxes.

use super::rectangle::Rectangle;
use yase::statechart::Point;

/// Maximum size of a grid that is searched; in a larger one, arrows are straight lines.
const MAX_POINTS: usize = 400_000;
/// Lines closer than this are merged.
const MERGE_DISTANCE: f64 = 5.0;
/// Cost of a grid point through which another line runs in the same direction.
const OVERLAP_COST: u64 = 60;
/// Cost of a grid point covered by text.
const TEXT_COST: u64 = 150;

/// Direction of a line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Direction {
    Down,
    Right,
    Left,
    Up,
}

impl Direction {
    /// In the order of their indices.
    pub(crate) const ALL: [Direction; 4] =
        [Direction::Down, Direction::Right, Direction::Left, Direction::Up];

    pub(crate) fn reversed(self) -> Direction {
        match self {
            Direction::Down => Direction::Up,
            Direction::Right => Direction::Left,
            Direction::Left => Direction::Right,
            Direction::Up => Direction::Down,
        }
    }
}

/// Horizontal and vertical lines, and the state of the points where they cross. The index of a grid
/// point is its row times the number of columns plus its column.
pub(crate) struct Grid {
    columns: Vec<f64>,
    rows: Vec<f64>,
    blocked: Vec<bool>,
    /// Numbers of drawn lines through each point, horizontally and vertically.
    across: Vec<u8>,
    down: Vec<u8>,
    letters: Vec<bool>,
}

/// The lines of a grid.
pub(crate) struct GridLines {
    pub(crate) columns: Vec<f64>,
    pub(crate) rows: Vec<f64>,
}

impl GridLines {
    /// The lines beside all boxes and through their centres, and inside those at which arrows end.
    pub(crate) fn beside(
        boxes: &[Rectangle],
        ends: &[Rectangle],
        page: Rectangle,
        clearance: f64,
    ) -> GridLines {
        let (mut columns, mut rows) = (Vec::new(), Vec::new());
        let mut beside = |area: &Rectangle, distance: f64| {
            columns.extend([area.left - distance, area.right + distance]);
            rows.extend([area.top - distance, area.bottom + distance]);
        };
        for area in boxes {
            beside(area, clearance);
            beside(area, 2.0 * clearance);
        }
        ends.iter().for_each(|area| beside(area, -clearance));
        beside(&page, -clearance);
        for (x, y) in boxes.iter().map(Rectangle::centre) {
            columns.push(x);
            rows.push(y);
        }
        GridLines { columns, rows }
    }
}

impl Grid {
    /// A grid of these lines, clipped to the page.
    pub(crate) fn new(lines: GridLines, page: Rectangle) -> Grid {
        let GridLines { columns, rows } = lines;
        let (columns, rows) = (sorted(columns, page.left, page.right), sorted(rows, page.top, page.bottom));
        let count = columns.len().saturating_mul(rows.len());
        let (columns, rows, count) =
            if count > MAX_POINTS { (vec![], vec![], 0) } else { (columns, rows, count) };
        let (blocked, letters) = (vec![false; count], vec![false; count]);
        Grid { columns, rows, blocked, across: vec![0; count], down: vec![0; count], letters }
    }

    /// The number of grid points.
    pub(crate) fn len(&self) -> usize {
        self.blocked.len()
    }

    pub(crate) fn point(&self, index: usize) -> Point {
        let width = self.columns.len();
        (self.columns[index % width], self.rows[index / width])
    }

    /// The grid point at a position, if lines cross there.
    pub(crate) fn crossing_at(&self, (x, y): Point) -> Option<usize> {
        let column = self.columns.binary_search_by(|line| line.total_cmp(&x)).ok()?;
        let row = self.rows.binary_search_by(|line| line.total_cmp(&y)).ok()?;
        Some(row * self.columns.len() + column)
    }

    pub(crate) fn is_free(&self, index: usize) -> bool {
        !self.blocked[index]
    }

    /// The next grid point in a direction and the cost to reach it; `None` if it is blocked.
    pub(crate) fn step(&self, index: usize, direction: Direction) -> Option<(usize, u64)> {
        let (width, height) = (self.columns.len(), self.rows.len());
        let (column, row) = (index % width, index / width);
        let next = match direction {
            Direction::Down if row + 1 < height => index + width,
            Direction::Right if column + 1 < width => index + 1,
            Direction::Left if column > 0 => index - 1,
            Direction::Up if row > 0 => index - width,
            _ => return None,
        };
        if self.blocked[next] {
            return None;
        }
        let ((x, y), (next_x, next_y)) = (self.point(index), self.point(next));
        let length = ((next_x - x).abs() + (next_y - y).abs()) as u64;
        Some((next, length + self.burden_of(next, direction)))
    }

    /// Cost of a grid point for a line in a direction.
    pub(crate) fn burden_of(&self, index: usize, direction: Direction) -> u64 {
        let along = match direction {
            Direction::Down | Direction::Up => self.down[index],
            Direction::Right | Direction::Left => self.across[index],
        };
        let letters = if self.letters[index] { TEXT_COST } else { 0 };
        OVERLAP_COST * u64::from(along) + letters
    }

    /// Unblocks all grid points.
    pub(crate) fn clear(&mut self) {
        self.blocked.fill(false);
    }

    /// Blocks the grid points in an area and within a distance of it.
    pub(crate) fn block(&mut self, area: &Rectangle, distance: f64) {
        self.within(area, distance).for_each(|index| self.blocked[index] = true);
    }

    /// Records that text covers an area.
    pub(crate) fn burden(&mut self, area: &Rectangle) {
        self.within(area, 1.0).for_each(|index| self.letters[index] = true);
    }

    /// Records a line between two points.
    pub(crate) fn occupy(&mut self, from: Point, to: Point) {
        let area = Rectangle::between(from, to);
        let lines = if from.1 == to.1 { &mut self.across } else { &mut self.down };
        let mut taken = std::mem::take(lines);
        self.within(&area, MERGE_DISTANCE).for_each(|index| taken[index] = taken[index].saturating_add(1));
        if from.1 == to.1 { self.across = taken } else { self.down = taken }
    }

    fn within(&self, area: &Rectangle, distance: f64) -> impl Iterator<Item = usize> + use<> {
        let columns = between(&self.columns, area.left - distance, area.right + distance);
        let rows = between(&self.rows, area.top - distance, area.bottom + distance);
        let width = self.columns.len();
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}

/// The indices of the lines between two coordinates.
fn between(lines: &[f64], from: f64, to: f64) -> std::ops::Range<usize> {
    lines.partition_point(|line| *line < from)..lines.partition_point(|line| *line <= to)
}

fn sorted(mut lines: Vec<f64>, from: f64, to: f64) -> Vec<f64> {
    lines.retain(|line| *line > from && *line < to);
    lines.sort_by(f64::total_cmp);
    lines.dedup();
    lines
}
