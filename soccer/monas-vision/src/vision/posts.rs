//! Goal posts: vertical bars across the horizon with a foot on the field.

use super::ImageContext;
use super::border::BorderScan;
use crate::colour::ColourClass;
use crate::detections::{GoalPaint, GoalPost, GroundObject, PixelBox, PostSide};

/// The number of rows that are scanned for posts.
const ROWS: usize = 5;

/// Least height of a post that is visible above the ground, m.
const LEAST_HEIGHT: f64 = 0.3;
/// Least height of a white post whose upper end is in the image, m: robots are white and lower.
const LEAST_WHITE: f64 = 0.62;

/// The search for goal posts.
///
/// Coloured posts are higher than the camera, so each crosses the horizon, or leaves the image at
/// its top. What is behind a white post above the field may be white too, so white posts are
/// searched where they cross the border of the field.
#[derive(Clone, Debug, Default)]
pub(crate) struct PostScan {
    /// In each column, whether most of the scanned rows have the colour of a post.
    columns: Vec<bool>,
}

impl PostScan {
    pub(crate) fn scan(
        &mut self,
        context: &ImageContext<'_>,
        border: &BorderScan,
        posts: &mut Vec<GoalPost>,
    ) {
        let paints: &[(GoalPaint, ColourClass)] = match context.objects.has_coloured_goals {
            true => &[(GoalPaint::Yellow, ColourClass::Yellow), (GoalPaint::Blue, ColourClass::Blue)],
            false => &[(GoalPaint::White, ColourClass::White)],
        };
        for &(paint, class) in paints {
            let first = posts.len();
            self.mark(context, border, class);
            let mut column = 0;
            while column < self.columns.len() {
                let end = self.end_of_run(column);
                if end > column
                    && let Some(sight) = post(context, border, paint, class, column, end)
                {
                    posts.push(GoalPost { sight, paint, side: PostSide::Unknown });
                }
                column = end.max(column + 1);
            }
            if let [left, right] = &mut posts[first..] {
                (left.side, right.side) = (PostSide::Left, PostSide::Right);
            }
        }
        posts.sort_unstable_by(|a, b| a.sight.area.left.total_cmp(&b.sight.area.left));
    }

    fn mark(&mut self, context: &ImageContext<'_>, border: &BorderScan, class: ColourClass) {
        self.columns.clear();
        self.columns.extend((0..context.map.columns).map(|column| {
            let found =
                scan_rows(context, border, class, column).filter(|&row| context.map.at(column, row) == class);
            2 * found.count() > ROWS
        }));
    }

    /// The column after a run of marked columns, which may have gaps of one column.
    fn end_of_run(&self, start: usize) -> usize {
        let is_marked = |column: usize| self.columns.get(column).copied().unwrap_or(false);
        let mut end = start;
        while is_marked(end) || (end > start && is_marked(end + 1)) {
            end += 1;
        }
        end
    }
}

/// The rows that are scanned: around the horizon, or from the border of the field downwards; those
/// at the top of the image if both are above it.
fn scan_rows(
    context: &ImageContext<'_>,
    border: &BorderScan,
    class: ColourClass,
    column: usize,
) -> impl Iterator<Item = usize> {
    /// Cells between rows.
    const ROW_SPACING: usize = 3;
    let (first, spacing) = match class {
        ColourClass::White => (border.row(column) as usize + 1, 1),
        _ => (
            (context.map.horizon(column) + ROW_SPACING).saturating_sub((ROWS - 1) * ROW_SPACING),
            ROW_SPACING,
        ),
    };
    (0..ROWS).map(move |row| first.saturating_add(row * spacing))
}

/// The post in a run of columns, if it is one.
fn post(
    context: &ImageContext<'_>,
    border: &BorderScan,
    paint: GoalPaint,
    class: ColourClass,
    left: usize,
    right: usize,
) -> Option<GroundObject> {
    let (map, step) = (context.map, context.map.step as f64);
    let middle = (left + right) / 2;
    // Where the field fills the image to its upper edge, a leg of a robot and a post look the same.
    if paint == GoalPaint::White && border.row(middle) < 2.0 {
        return None;
    }
    let start = scan_rows(context, border, class, middle).nth(ROWS / 2)?;
    let bar = Bar::new(context, class, start, left, right);
    let foot = bar.last_row(context, start..map.rows);
    let top = bar.last_row(context, (0..start).rev());
    let foot_middle = bar.middle_at(foot);
    let width = (right - left) as f64 * step;
    let centre = foot_middle * step;
    let bottom = (foot + 1) as f64 * step;
    let is_cut = foot + 2 >= map.rows;
    // An object that is cut on two sides has neither foot nor width.
    if is_cut && (left == 0 || right >= map.columns) {
        return None;
    }
    let diameter = 2.0 * context.objects.post_radius;
    let expected = diameter * context.camera.scale(centre, bottom, 0.0);
    if expected <= 0.0 {
        return None;
    }
    let position = match is_cut {
        // Below the image: the distance follows from the width, which cannot be checked then.
        true => {
            let ray = context.camera.ray(centre, bottom);
            let depth = context.camera.focal() * diameter / width;
            (width >= 1.0).then(|| context.camera.position().xy() + ray.xy() * depth)?
        }
        false => {
            let ratio = width / expected;
            let slack = 2.0 * step / expected;
            let max = if paint == GoalPaint::White { 1.5 } else { 1.7 };
            if !(0.5 - slack..=max + slack).contains(&ratio) {
                return None;
            }
            // The foot is on the field, with carpet below it.
            let [from, to] = [-bar.half, bar.half].map(|aside| (foot_middle + aside) as f32);
            let below = map.shares(from, foot as f32 + 1.0, to, foot as f32 + 6.0);
            if below.green < 0.25 || (foot as f32) + 4.0 < border.row(foot_middle as usize) {
                return None;
            }
            let near = context.camera.point_at_height(centre, bottom, 0.0)?;
            let away = near - context.camera.position().xy();
            near + away.normalize() * context.objects.post_radius
        }
    };
    let height = (foot + 1 - top) as f64 * step / expected * diameter;
    let is_high = match (paint, top > 1) {
        // Without its foot or its height, white may be a line or a robot.
        (GoalPaint::White, true) => !is_cut && height > LEAST_WHITE,
        (GoalPaint::White, false) => !is_cut && height > LEAST_HEIGHT,
        (_, true) => is_cut || height > LEAST_HEIGHT,
        (_, false) => true,
    };
    if !is_high {
        return None;
    }
    if !bar.stands_alone(context, top, start.max(foot))
        || !bar.is_on_carpet(context, border, foot, expected / step)
    {
        return None;
    }
    let area =
        PixelBox { left: left as f64 * step, top: top as f64 * step, right: right as f64 * step, bottom };
    Some(GroundObject::new(position, area))
}

/// A bar of one colour that is upright on the ground, in cells.
#[derive(Clone, Copy, Debug)]
struct Bar {
    class: ColourClass,
    /// A row that it crosses, and its middle there.
    row: usize,
    middle: f64,
    /// Half of its width.
    half: f64,
    /// Columns from one row to the next: a camera that is rolled sees an inclined bar.
    slope: f64,
}

impl Bar {
    fn new(context: &ImageContext<'_>, class: ColourClass, row: usize, left: usize, right: usize) -> Bar {
        let step = context.map.step as f64;
        let middle = (left + right) as f64 / 2.0;
        let slope = context.camera.slope_of_vertical(middle * step, row as f64 * step);
        Bar { class, row, middle, half: (right - left) as f64 / 2.0, slope }
    }

    fn middle_at(&self, row: usize) -> f64 {
        self.middle + self.slope * (row as f64 - self.row as f64)
    }

    /// The class of a cell, given by its distance from the middle.
    fn class_at(&self, context: &ImageContext<'_>, aside: f64, row: usize) -> ColourClass {
        self.seen_at(context, aside, row).unwrap_or_default()
    }

    /// As [`class_at`](Bar::class_at); none outside the image.
    fn seen_at(&self, context: &ImageContext<'_>, aside: f64, row: usize) -> Option<ColourClass> {
        let column = (self.middle_at(row) + aside).floor();
        (column >= 0.0 && column < context.map.columns as f64).then(|| context.map.at(column as usize, row))
    }

    /// The last of the rows that has the colour, with gaps of two rows.
    fn last_row(&self, context: &ImageContext<'_>, rows: impl Iterator<Item = usize>) -> usize {
        let third = self.half * 2.0 / 3.0;
        let mut last = self.row;
        for row in rows {
            if row.abs_diff(last) > 3 {
                break;
            }
            let own = [-third, 0.0, third].map(|aside| self.class_at(context, aside, row));
            if own.iter().filter(|class| **class == self.class).count() >= 2 {
                last = row;
            }
        }
        last
    }

    /// Whether what is beside it has another class in most rows, unlike in front of a wall. A white
    /// post may stand in front of a white wall.
    fn stands_alone(&self, context: &ImageContext<'_>, top: usize, bottom: usize) -> bool {
        let away = 2.0 * self.half + 2.0;
        let rows = bottom.saturating_sub(top).max(1);
        let is_free = |aside: f64| {
            2 * (top..bottom).filter(|&row| self.class_at(context, aside, row) == self.class).count() <= rows
        };
        self.class == ColourClass::White || (is_free(-away) && is_free(away))
    }

    /// Whether there is carpet on both sides of it between the border of the field and its foot:
    /// an arm or a leg has a body beside it. The shaded side of a post may be too dark for its
    /// class, so that it seems narrower than the `expected` cells.
    fn is_on_carpet(
        &self,
        context: &ImageContext<'_>,
        border: &BorderScan,
        foot: usize,
        expected: f64,
    ) -> bool {
        let from = border.row(self.middle as usize).max(0.0) as usize + 1;
        let half = self.half.max(expected / 2.0);
        [-1.0, 1.0].into_iter().all(|side| {
            let (mut carpet, mut cells) = (0, 0);
            for aside in [1.5 * half + 1.0, 3.0 * half + 1.0] {
                let seen = (from..foot).filter_map(|row| self.seen_at(context, side * aside, row));
                for class in seen {
                    cells += 1;
                    carpet += usize::from(class == ColourClass::Green);
                }
            }
            2 * carpet >= cells
        })
    }
}
