//! The lines on which arrows run between boxes.

use super::layout::Point;
use super::rectangle::Rectangle;

/// A larger grid is not searched: its arrows are straight lines.
const MAX_PLACES: usize = 400_000;
/// Lines closer than this are taken for one.
const NEAR: f64 = 5.0;
/// What it costs to come to a place where another line runs the same way.
const ALONG: u64 = 60;
/// What it costs to come to a place with letters.
const LETTERS: u64 = 150;

/// Where a line goes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Direction {
    Down,
    Right,
    Left,
    Up,
}

impl Direction {
    /// In the order of their numbers.
    pub(super) const ALL: [Direction; 4] =
        [Direction::Down, Direction::Right, Direction::Left, Direction::Up];

    pub(super) fn reversed(self) -> Direction {
        match self {
            Direction::Down => Direction::Up,
            Direction::Right => Direction::Left,
            Direction::Left => Direction::Right,
            Direction::Up => Direction::Down,
        }
    }
}

/// Lines across and down, and what is at the places where they meet. A place is the number of its row times the number of columns, and the
/// number of its column.
pub(super) struct Grid {
    columns: Vec<f64>,
    rows: Vec<f64>,
    blocked: Vec<bool>,
    /// Lines that run across each place, and down.
    across: Vec<u8>,
    down: Vec<u8>,
    letters: Vec<bool>,
}

/// The lines of a grid.
pub(super) struct GridLines {
    pub(super) columns: Vec<f64>,
    pub(super) rows: Vec<f64>,
}

impl GridLines {
    /// The lines beside all boxes and through their middles, and inside those where arrows end.
    pub(super) fn beside(
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
    /// A grid of these lines, as far as they lie on the page.
    pub(super) fn new(lines: GridLines, page: Rectangle) -> Grid {
        let GridLines { columns, rows } = lines;
        let (columns, rows) = (sorted(columns, page.left, page.right), sorted(rows, page.top, page.bottom));
        let places = columns.len().saturating_mul(rows.len());
        let (columns, rows, places) =
            if places > MAX_PLACES { (vec![], vec![], 0) } else { (columns, rows, places) };
        let (blocked, letters) = (vec![false; places], vec![false; places]);
        Grid { columns, rows, blocked, across: vec![0; places], down: vec![0; places], letters }
    }

    /// How many places there are.
    pub(super) fn len(&self) -> usize {
        self.blocked.len()
    }

    pub(super) fn point(&self, place: usize) -> Point {
        let width = self.columns.len();
        (self.columns[place % width], self.rows[place / width])
    }

    /// The place at a point, if lines meet there.
    pub(super) fn place(&self, (x, y): Point) -> Option<usize> {
        let column = self.columns.binary_search_by(|line| line.total_cmp(&x)).ok()?;
        let row = self.rows.binary_search_by(|line| line.total_cmp(&y)).ok()?;
        Some(row * self.columns.len() + column)
    }

    pub(super) fn is_free(&self, place: usize) -> bool {
        !self.blocked[place]
    }

    /// The next place that way and what it costs to go there; none if it is closed.
    pub(super) fn step(&self, place: usize, direction: Direction) -> Option<(usize, u64)> {
        let (width, height) = (self.columns.len(), self.rows.len());
        let (column, row) = (place % width, place / width);
        let next = match direction {
            Direction::Down if row + 1 < height => place + width,
            Direction::Right if column + 1 < width => place + 1,
            Direction::Left if column > 0 => place - 1,
            Direction::Up if row > 0 => place - width,
            _ => return None,
        };
        if self.blocked[next] {
            return None;
        }
        let ((x, y), (next_x, next_y)) = (self.point(place), self.point(next));
        let length = ((next_x - x).abs() + (next_y - y).abs()) as u64;
        Some((next, length + self.burden_of(next, direction)))
    }

    /// What it costs to be at a place on a line that way.
    pub(super) fn burden_of(&self, place: usize, direction: Direction) -> u64 {
        let along = match direction {
            Direction::Down | Direction::Up => self.down[place],
            Direction::Right | Direction::Left => self.across[place],
        };
        let letters = if self.letters[place] { LETTERS } else { 0 };
        ALONG * u64::from(along) + letters
    }

    /// Opens all places.
    pub(super) fn clear(&mut self) {
        self.blocked.fill(false);
    }

    /// Closes the places in an area and as near to it as this.
    pub(super) fn block(&mut self, area: &Rectangle, distance: f64) {
        self.within(area, distance).for_each(|place| self.blocked[place] = true);
    }

    /// Notes that letters stand in an area.
    pub(super) fn burden(&mut self, area: &Rectangle) {
        self.within(area, 1.0).for_each(|place| self.letters[place] = true);
    }

    /// Notes that a line runs from a point to another.
    pub(super) fn occupy(&mut self, from: Point, to: Point) {
        let area = Rectangle::between(from, to);
        let lines = if from.1 == to.1 { &mut self.across } else { &mut self.down };
        let mut taken = std::mem::take(lines);
        self.within(&area, NEAR).for_each(|place| taken[place] = taken[place].saturating_add(1));
        if from.1 == to.1 { self.across = taken } else { self.down = taken }
    }

    fn within(&self, area: &Rectangle, distance: f64) -> impl Iterator<Item = usize> + use<> {
        let columns = between(&self.columns, area.left - distance, area.right + distance);
        let rows = between(&self.rows, area.top - distance, area.bottom + distance);
        let width = self.columns.len();
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}

/// The numbers of the lines from one coordinate to another.
fn between(lines: &[f64], from: f64, to: f64) -> std::ops::Range<usize> {
    lines.partition_point(|line| *line < from)..lines.partition_point(|line| *line <= to)
}

fn sorted(mut lines: Vec<f64>, from: f64, to: f64) -> Vec<f64> {
    lines.retain(|line| *line > from && *line < to);
    lines.sort_by(f64::total_cmp);
    lines.dedup();
    lines
}
