//! Other robots: obstacles on the carpet that are as high and wide as a robot.

use super::ImageContext;
use super::border::BorderScan;
use crate::colour::ColourClass;
use crate::detections::{DetectedRobot, GroundObject, Jersey, PixelBox};
use crate::{Detections, GoalPost};

/// Least height of what may be a robot, m: higher than a ball.
const LEAST_HEIGHT: f64 = 0.22;
/// Least and greatest width, m.
const LEAST_WIDTH: f64 = 0.085;
const MOST_WIDTH: f64 = 0.9;
/// Depth of a robot: its middle is behind the foot that is visible, m.
const HALF_DEPTH: f64 = 0.08;
/// Height of a robot, m (Nao: 0.57).
const HEIGHT: f64 = 0.57;
/// Greatest seeming width of an arm, and gap between it and the legs, m.
const MAX_ARM_WIDTH: f64 = 0.17;
const ARM_GAP: f64 = 0.12;
/// Cells between two columns that are scanned.
const COLUMN_SPACING: usize = 2;

/// The search for other robots.
#[derive(Clone, Debug, Default)]
pub(crate) struct RobotScan {
    /// The foot of an obstacle in each scanned column.
    feet: Vec<Option<usize>>,
    /// Bodies that the lower edge of the image cuts, so that their distance is not known.
    cut: Vec<PixelBox>,
}

impl RobotScan {
    pub(crate) fn scan(&mut self, context: &ImageContext<'_>, border: &BorderScan, seen: &mut Detections) {
        self.feet.clear();
        let columns = (0..context.map.columns).step_by(COLUMN_SPACING);
        self.feet.extend(columns.map(|column| {
            let is_post = seen.posts.iter().any(|post| is_beside(context, post, column));
            if is_post { None } else { foot(context, border, column) }
        }));
        self.cut.clear();
        let mut start = 0;
        while start < self.feet.len() {
            let end = self.end_of_group(context, start);
            let foot = self.feet[start..end].iter().copied().flatten().max();
            match foot.and_then(|foot| Body::new(context, start, end, foot)) {
                // Below the image, the distance of a foot is not known.
                Some(body) if body.foot + 2 >= context.map.rows => self.cut.push(body.area(context)),
                Some(body) if body.stands_out(context, &self.feet[start..end]) => {
                    seen.robots.extend(body.robot(context));
                }
                _ => {}
            }
            start = end.max(start + 1);
        }
        drop_arms(context, &mut seen.robots);
        seen.robots.retain(|robot| !self.cut.iter().any(|body| is_part_of(context, &robot.sight.area, body)));
    }

    /// The bodies that the lower edge of the image cuts.
    pub(crate) fn cut_bodies(&self) -> &[PixelBox] {
        &self.cut
    }

    /// The index after a group of neighbours whose feet are about as far away.
    fn end_of_group(&self, context: &ImageContext<'_>, start: usize) -> usize {
        let Some(mut last) = self.feet[start] else { return start };
        let (mut end, mut gap) = (start + 1, 0);
        let mut index = start + 1;
        while index < self.feet.len() && gap <= 2 {
            match self.feet[index] {
                Some(foot) if is_same_body(context, index, last, foot) => {
                    (last, end, gap) = (foot, index + 1, 0);
                }
                _ => gap += 1,
            }
            index += 1;
        }
        end
    }
}

/// An obstacle in a group of columns that is as high and wide as a robot, in cells.
#[derive(Clone, Copy, Debug)]
struct Body {
    left: usize,
    right: usize,
    foot: usize,
    /// Cells per metre at its foot.
    scale: f64,
}

impl Body {
    /// The body in scanned columns whose lowest foot is given; none if it is something else.
    fn new(context: &ImageContext<'_>, start: usize, end: usize, foot: usize) -> Option<Body> {
        let (map, step) = (context.map, context.map.step as f64);
        let (left, right) = (start * COLUMN_SPACING, (end * COLUMN_SPACING).min(map.columns));
        let middle = (left + right) as f64 / 2.0;
        let scale = context.camera.scale(middle * step, (foot + 1) as f64 * step, 0.0) / step;
        let width = (right - left) as f64 / scale.max(1e-6);
        let is_cut = left == 0 || right + COLUMN_SPACING >= map.columns || foot + 2 >= map.rows;
        if width < LEAST_WIDTH || (width > MOST_WIDTH && !is_cut) {
            return None;
        }
        // Neither legs nor chest show the carpet; a line that runs away gets narrower.
        let row = |height: f64| (foot as f64 - height * scale).max(0.0) as f32;
        let legs = map.shares(left as f32, row(0.3), right as f32, foot as f32);
        let side = |by: f64| (middle + by * scale) as f32;
        let chest = map.shares(side(-0.07), row(0.42), side(0.07), row(0.28));
        (legs.green <= 0.35 && chest.green <= 0.25).then_some(Body { left, right, foot, scale })
    }

    /// Whether the colour changes at once at most of its feet, which are given for each scanned
    /// column: light that bleaches the carpet does so little by little.
    fn stands_out(&self, context: &ImageContext<'_>, feet: &[Option<usize>]) -> bool {
        /// Least change of luma, as a part of that from carpet to white, and of chroma, as a part
        /// of that of the carpet.
        const MIN_CHANGE: f32 = 0.3;
        let model = context.table.model();
        let least_luma = MIN_CHANGE * (model.white_luma - model.green_luma);
        let chroma = libm::hypotf(model.green[0] - model.white[0], model.green[1] - model.white[1]);
        let least_chroma = MIN_CHANGE * chroma * model.green_luma;
        let (mut sharp, mut all) = (0, 0);
        for (index, foot) in feet.iter().enumerate() {
            let Some(foot) = *foot else { continue };
            let column = self.left + index * COLUMN_SPACING;
            // Two cells away from the foot, so that blur does not matter.
            let above = context.mean_yuv(column, foot.saturating_sub(4)..foot.saturating_sub(1));
            let below = context.mean_yuv(column, foot + 2..foot + 5);
            let change = [0, 1, 2].map(|k| above[k] - below[k]);
            let is_sharp = change[0].abs() > least_luma || libm::hypotf(change[1], change[2]) > least_chroma;
            (sharp, all) = (sharp + usize::from(is_sharp), all + 1);
        }
        2 * sharp >= all
    }

    /// The pixels that it takes at least.
    fn area(&self, context: &ImageContext<'_>) -> PixelBox {
        let step = context.map.step as f64;
        let top = (self.foot as f64 - HEIGHT * self.scale).max(0.0);
        PixelBox {
            left: self.left as f64 * step,
            top: top * step,
            right: self.right as f64 * step,
            bottom: (self.foot + 1) as f64 * step,
        }
    }

    fn robot(&self, context: &ImageContext<'_>) -> Option<DetectedRobot> {
        let area = self.area(context);
        let near = context.camera.point_at_height((area.left + area.right) / 2.0, area.bottom, 0.0)?;
        let away = near - context.camera.position().xy();
        let position = near + away.normalize() * HALF_DEPTH;
        Some(DetectedRobot { sight: GroundObject::new(position, area), jersey: self.jersey(context) })
    }

    /// The colour of the jersey: the more frequent one between hips and shoulders.
    fn jersey(&self, context: &ImageContext<'_>) -> Jersey {
        let Body { left, right, foot, scale } = *self;
        let row = |height: f64| (foot as f64 - height * scale).max(0.0) as usize;
        let (mut blue, mut red, mut all) = (0u32, 0u32, 0u32);
        for y in row(0.5)..row(0.22) {
            for x in left..right {
                let class = context.map.at(x, y);
                blue += u32::from(class == ColourClass::Blue);
                red += u32::from(matches!(class, ColourClass::Red | ColourClass::Orange));
                all += 1;
            }
        }
        match all {
            _ if blue > 2 * red && 12 * blue > all => Jersey::Blue,
            _ if red > 2 * blue && 12 * red > all => Jersey::Red,
            _ => Jersey::Unknown,
        }
    }
}

/// Whether a candidate is a part of a body that the lower edge of the image cuts: it touches the
/// body, or it is an arm.
fn is_part_of(context: &ImageContext<'_>, area: &PixelBox, body: &PixelBox) -> bool {
    let is_beside = |gap: f64| area.left <= body.right + gap && area.right >= body.left - gap;
    let touches = is_beside((2 * COLUMN_SPACING * context.map.step) as f64);
    let is_narrow = area.right - area.left < MAX_ARM_WIDTH * ground_scale(context, area);
    touches || (is_narrow && is_beside(ARM_GAP * ground_scale(context, body)))
}

/// Pixels per metre where the lower edge of a box is on the ground.
fn ground_scale(context: &ImageContext<'_>, area: &PixelBox) -> f64 {
    context.camera.scale((area.left + area.right) / 2.0, area.bottom, 0.0)
}

impl ImageContext<'_> {
    /// The mean luma and chroma of rows of cells in a column; those below the image do not count.
    fn mean_yuv(&self, column: usize, rows: std::ops::Range<usize>) -> [f32; 3] {
        let (step, rows) = (self.map.step, rows.start..rows.end.min(self.map.rows));
        let count = rows.len().max(1) as f32;
        rows.fold([0.0; 3], |sum, row| {
            let yuv = self.image.yuv(column * step, row * step);
            [0, 1, 2].map(|k| sum[k] + f32::from(yuv[k]) / count)
        })
    }
}

/// Removes arms beside a robot: their lower ends are above the ground, so they seem to be narrow
/// and farther away.
fn drop_arms(context: &ImageContext<'_>, robots: &mut Vec<DetectedRobot>) {
    let width = |area: &PixelBox| area.right - area.left;
    let is_arm = |one: &DetectedRobot, of: &DetectedRobot| {
        let (arm, body) = (&one.sight.area, &of.sight.area);
        let gap = ARM_GAP * ground_scale(context, body);
        one.sight.distance > of.sight.distance
            && width(arm) < MAX_ARM_WIDTH * ground_scale(context, arm)
            && arm.left < body.right + gap
            && arm.right > body.left - gap
    };
    let mut index = 0;
    while index < robots.len() {
        let one = robots[index];
        match robots.iter().any(|of| is_arm(&one, of)) {
            true => drop(robots.remove(index)),
            false => index += 1,
        }
    }
}

/// Whether a column shows a post that was found.
fn is_beside(context: &ImageContext<'_>, post: &GoalPost, column: usize) -> bool {
    let x = column as f64 * context.map.step as f64;
    let margin = 0.3 * (post.sight.area.right - post.sight.area.left) + 2.0;
    (post.sight.area.left - margin..post.sight.area.right + margin).contains(&x)
}

/// Whether two neighbouring columns show feet at about the same distance.
fn is_same_body(context: &ImageContext<'_>, index: usize, one: usize, other: usize) -> bool {
    let step = context.map.step as f64;
    let x = (index * COLUMN_SPACING) as f64 * step;
    let scale = context.camera.scale(x, one.max(other) as f64 * step, 0.0) / step;
    (one.abs_diff(other) as f64) < 0.14 * scale + 2.0
}

/// The foot of the nearest obstacle in a column that is high enough.
fn foot(context: &ImageContext<'_>, border: &BorderScan, column: usize) -> Option<usize> {
    let (map, step) = (context.map, context.map.step as f64);
    let x = (column as f64 + 0.5) * step;
    let edge = border.row(column);
    let (mut foot, mut carpet) = (None, 0);
    for row in (0..map.rows).rev() {
        let is_carpet = map.at(column, row) == ColourClass::Green;
        match foot {
            _ if is_carpet => {
                carpet += 1;
                // A single cell of carpet does not divide a body.
                if carpet >= 2 {
                    foot = None;
                }
            }
            None => {
                // Beyond the border there is no field to stand on.
                if (row as f32) < edge + 2.0 {
                    return None;
                }
                (foot, carpet) = (Some(row), 0);
            }
            Some(start) => {
                carpet = 0;
                let scale = context.camera.scale(x, (start + 1) as f64 * step, 0.0) / step;
                let height = (start - row) as f64;
                let is_inside = start as f64 > f64::from(edge) + 2.0 + 0.05 * scale;
                if height >= LEAST_HEIGHT * scale && scale > 0.0 {
                    return is_inside.then_some(start);
                }
            }
        }
    }
    None
}
