//! The classes of an image on a coarser grid, with sums over rectangles.

use crate::colour::{ColourClass, ColourTable};
use crate::{Camera, Image};

/// The classes with integral images.
const INTEGRAL_CLASSES: [ColourClass; 4] =
    [ColourClass::Green, ColourClass::White, ColourClass::Dark, ColourClass::Orange];

/// The classes of an image, one for each cell of `step` by `step` pixels.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClassMap {
    pub(crate) step: usize,
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    classes: Vec<ColourClass>,
    /// Counts of the summed classes above and to the left of each corner between cells.
    sums: Vec<[u32; 4]>,
    /// The first row at or below the horizon in each column; at most `rows`.
    horizon: Vec<usize>,
}

/// The share of each class in a rectangle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shares {
    pub(crate) green: f32,
    pub(crate) white: f32,
    pub(crate) dark: f32,
    pub(crate) orange: f32,
    /// The number of cells within the image.
    pub(crate) cells: f32,
}

impl ClassMap {
    /// Classifies an image.
    pub(crate) fn fill(&mut self, image: &Image<'_>, table: &ColourTable, camera: &Camera) {
        self.step = if image.width() >= 480 { 2 } else { 1 };
        self.columns = image.width() / self.step;
        self.rows = image.height() / self.step;
        self.classes.clear();
        for row in 0..self.rows {
            let bytes = image.row(row * self.step);
            match self.step {
                1 => self.classes.extend(
                    bytes
                        .chunks_exact(4)
                        .flat_map(|pair| [0, 2].map(|at| table.class([pair[at], pair[1], pair[3]]))),
                ),
                _ => self.classes.extend(
                    bytes
                        .chunks_exact(4)
                        .map(|pair| table.class([u8::midpoint(pair[0], pair[2]), pair[1], pair[3]])),
                ),
            }
        }
        self.sum();
        self.horizon.clear();
        let step = self.step as f64;
        let rows = self.rows as f64;
        self.horizon.extend(
            (0..self.columns)
                .map(|i| (camera.horizon((i as f64 + 0.5) * step) / step).clamp(0.0, rows) as usize),
        );
    }

    fn sum(&mut self) {
        let width = self.columns + 1;
        self.sums.clear();
        self.sums.resize(width * (self.rows + 1), [0; 4]);
        for (row, classes) in self.classes.chunks_exact(self.columns.max(1)).enumerate() {
            let (above, below) = self.sums.split_at_mut((row + 1) * width);
            let above = &above[row * width..];
            let mut counts = [0u32; 4];
            for (column, class) in classes.iter().enumerate() {
                for (count, summed) in counts.iter_mut().zip(INTEGRAL_CLASSES) {
                    *count += u32::from(*class == summed);
                }
                for k in 0..4 {
                    below[column + 1][k] = above[column + 1][k] + counts[k];
                }
            }
        }
    }

    /// The class of a cell; `Other` outside.
    pub(crate) fn at(&self, column: usize, row: usize) -> ColourClass {
        match column < self.columns && row < self.rows {
            true => self.classes[row * self.columns + column],
            false => ColourClass::Other,
        }
    }

    /// The first row at or below the horizon.
    pub(crate) fn horizon(&self, column: usize) -> usize {
        self.horizon.get(column).copied().unwrap_or(0)
    }

    /// The shares of classes in a rectangle, which is clipped to the image. Coordinates are cells.
    pub(crate) fn shares(&self, left: f32, top: f32, right: f32, bottom: f32) -> Shares {
        let column = |x: f32| (x + 0.5).clamp(0.0, self.columns as f32) as usize;
        let row = |y: f32| (y + 0.5).clamp(0.0, self.rows as f32) as usize;
        let (left, top, right, bottom) = (column(left), row(top), column(right), row(bottom));
        if left >= right || top >= bottom {
            return Shares::default();
        }
        let width = self.columns + 1;
        let corner = |x: usize, y: usize| &self.sums[y * width + x];
        let (a, b, c, d) =
            (corner(left, top), corner(right, top), corner(left, bottom), corner(right, bottom));
        let cells = ((right - left) * (bottom - top)) as f32;
        let share = |k: usize| (d[k] + a[k] - b[k] - c[k]) as f32 / cells;
        Shares { green: share(0), white: share(1), dark: share(2), orange: share(3), cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ColourModel, HeadPose, yuv_of_rgb};

    #[test]
    fn sums_count_the_cells_of_a_rectangle() {
        let (green, white) = (yuv_of_rgb([40, 130, 50]), yuv_of_rgb([230, 230, 230]));
        let mut pixels = Vec::new();
        for row in 0..32 {
            for pair in 0..16 {
                let colour = if row < 8 && pair < 4 { white } else { green };
                pixels.extend_from_slice(&[colour[0], colour[1], colour[0], colour[2]]);
            }
        }
        let image = Image::new(32, 32, &pixels).unwrap();
        let pose = HeadPose { height: 0.5, ..HeadPose::default() }.robot_from_camera();
        let camera = Camera::new(32, 32, 0.8, &pose).unwrap();
        let mut map = ClassMap::default();
        map.fill(&image, &ColourTable::new(ColourModel::default()), &camera);
        assert_eq!(
            (map.at(7, 7), map.at(8, 7), map.at(99, 0)),
            (ColourClass::White, ColourClass::Green, ColourClass::Other)
        );
        let shares = map.shares(0.0, 0.0, 16.0, 16.0);
        assert_eq!((shares.white, shares.green, shares.cells), (0.25, 0.75, 256.0));
        assert_eq!(map.shares(-5.0, -5.0, 4.0, 4.0).cells, 16.0);
        assert_eq!(map.shares(40.0, 0.0, 50.0, 9.0).cells, 0.0);
        assert_eq!(map.horizon(0), 16);
    }
}
