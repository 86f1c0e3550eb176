//! The border of the field: where the carpet begins in each column.

use super::ImageContext;
use crate::Detections;
use crate::colour::ColourClass;
use crate::detections::GroundPoint;

/// Cells between two columns that are scanned.
const COLUMN_SPACING: usize = 4;

/// The search for the border of the field.
///
/// In each scanned column it is the row that maximises the carpet cells below it minus the other
/// cells below it (the method of the field border of B-Human and of the field contour of Nao-Team
/// HTWK). The upper convex hull of these points removes what stands on the field and hides the
/// border.
#[derive(Clone, Debug, Default)]
pub(crate) struct BorderScan {
    /// The first row of the field in each scanned column; `None` without carpet.
    raw: Vec<Option<usize>>,
    /// Points of the hull: column and row in cells.
    hull: Vec<(f32, f32)>,
    /// The border in each column of cells.
    rows: Vec<f32>,
}

impl BorderScan {
    /// The row of the border in a column of cells. Only called if the image shows a border.
    pub(crate) fn row(&self, column: usize) -> f32 {
        self.rows.get(column).copied().unwrap_or(f32::MAX)
    }

    pub(crate) fn scan(&mut self, context: &ImageContext<'_>, seen: &mut Detections) {
        let map = context.map;
        self.raw.clear();
        self.raw.extend(
            (COLUMN_SPACING / 2..map.columns)
                .step_by(COLUMN_SPACING)
                .map(|column| first_of_field(context, column)),
        );
        self.build_hull();
        self.rows.clear();
        if self.hull.len() < 2 {
            return;
        }
        let mut segment = 0;
        for column in 0..map.columns {
            let x = column as f32;
            while segment + 2 < self.hull.len() && x > self.hull[segment + 1].0 {
                segment += 1;
            }
            let ((x0, y0), (x1, y1)) = (self.hull[segment], self.hull[segment + 1]);
            let row = y0 + (y1 - y0) * (x.clamp(x0, x1) - x0) / (x1 - x0).max(1.0);
            // Beyond the ends of the hull there is no field.
            let outside = x + (COLUMN_SPACING as f32) < x0 || x > x1 + COLUMN_SPACING as f32;
            self.rows.push(if outside { map.rows as f32 } else { row });
        }
        let step = map.step as f64;
        seen.border
            .extend(self.hull.iter().map(|&(x, y)| [(f64::from(x) + 0.5) * step, f64::from(y) * step]));
        let columns = self.raw.iter().enumerate();
        seen.border_points.extend(columns.filter_map(|(index, row)| self.point(context, index, (*row)?)));
    }

    /// The point of the border in a scanned column, where carpet begins at a row; none if it leaves
    /// the image there, or something hides its end.
    fn point(&self, context: &ImageContext<'_>, index: usize, row: usize) -> Option<GroundPoint> {
        /// Cells between the end of the carpet and the hull.
        const TOLERANCE: f32 = 1.5;
        let step = context.map.step as f64;
        let column = index * COLUMN_SPACING + COLUMN_SPACING / 2;
        if row < 2 || (row as f32 - self.row(column)).abs() > TOLERANCE {
            return None;
        }
        // Of each cell one row of pixels is classified: its first.
        let pixel = [(column as f64 + 0.5) * step, (row as f64 - 0.5) * step + 0.5];
        let position = context.camera.point_at_height(pixel[0], pixel[1], 0.0)?;
        Some(GroundPoint { pixel, position })
    }

    /// The upper convex hull of the points, each of which is first the median of three, so that a
    /// single column does not lift it.
    fn build_hull(&mut self) {
        self.hull.clear();
        for index in 0..self.raw.len() {
            let Some(own) = self.raw[index] else { continue };
            let near =
                |at: Option<usize>| at.and_then(|at| self.raw.get(at).copied().flatten()).unwrap_or(own);
            let mut three = [near(index.checked_sub(1)), own, near(Some(index + 1))];
            three.sort_unstable();
            let point = ((index * COLUMN_SPACING + COLUMN_SPACING / 2) as f32, three[1] as f32);
            while let [.., a, b] = self.hull[..] {
                // Rows grow downwards: the middle point stays if it is above the line.
                let cross = (b.0 - a.0) * (point.1 - a.1) - (b.1 - a.1) * (point.0 - a.0);
                if cross > 0.0 {
                    break;
                }
                self.hull.pop();
            }
            self.hull.push(point);
        }
    }
}

/// The row that maximises the carpet cells below it minus the other cells below it.
fn first_of_field(context: &ImageContext<'_>, column: usize) -> Option<usize> {
    /// Least surplus of carpet, cells.
    const MIN_SURPLUS: i32 = 5;
    let map = context.map;
    let (mut score, mut best, mut row_of_best) = (0, MIN_SURPLUS, None);
    for row in (map.horizon(column)..map.rows).rev() {
        score += if map.at(column, row) == ColourClass::Green { 1 } else { -1 };
        if score > best {
            (best, row_of_best) = (score, Some(row));
        }
    }
    row_of_best
}
