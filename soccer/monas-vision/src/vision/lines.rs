//! Field lines: bright bars between carpet, as wide as a line, and straight parts of them.

use super::ImageContext;
use super::border::BorderScan;
use crate::Detections;
use crate::colour::ColourClass;
use crate::detections::{GroundObject, GroundPoint, LineSegment, PixelBox};

/// Pixels between scanned columns and between scanned rows, in an image of 640 columns.
const COLUMN_SPACING: usize = 6;
const ROW_SPACING: usize = 8;

/// The most line points of an image.
const MOST_POINTS: usize = 1500;

/// Least length of a straight part, m.
const LEAST_LENGTH: f64 = 0.15;

/// The search for lines.
#[derive(Clone, Debug, Default)]
pub(crate) struct LineScan {
    profile: Vec<u8>,
    chains: Vec<PointChain>,
    /// Points of chains, each with the index of the next of its chain.
    linked: Vec<(GroundPoint, usize)>,
    run: Vec<GroundPoint>,
}

/// Line points of neighbouring scans that follow each other.
#[derive(Clone, Copy, Debug)]
struct PointChain {
    first: usize,
    last: usize,
    count: usize,
    scan: usize,
    /// Change across the scan from one scan to the next, pixels.
    slope: f64,
}

const END: usize = usize::MAX;

/// The direction of a scan.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ScanAxis {
    Column,
    Row,
}

impl LineScan {
    /// Finds line points and straight parts, none of them on what was seen or on a body that the
    /// lower edge of the image cuts.
    pub(crate) fn scan(
        &mut self,
        context: &ImageContext<'_>,
        border: &BorderScan,
        cut: &[PixelBox],
        seen: &mut Detections,
    ) {
        let (width, height) = (context.image.width(), context.image.height());
        let part = |spacing: usize| (spacing * width / 640).max(2);
        for (axis, spacing, count) in
            [(ScanAxis::Column, part(COLUMN_SPACING), width), (ScanAxis::Row, part(ROW_SPACING), height)]
        {
            self.chains.clear();
            self.linked.clear();
            for (scan, at) in (spacing / 2..count).step_by(spacing).enumerate() {
                let first = seen.line_points.len();
                self.scan_one(context, border, cut, axis, at, seen);
                for index in first..seen.line_points.len() {
                    self.link(seen.line_points[index], axis, scan, spacing);
                }
            }
            for index in 0..self.chains.len() {
                self.split(self.chains[index], &mut seen.lines);
            }
        }
        merge(&mut seen.lines);
    }

    /// Finds the line points of a column or row of pixels.
    fn scan_one(
        &mut self,
        context: &ImageContext<'_>,
        border: &BorderScan,
        cut: &[PixelBox],
        axis: ScanAxis,
        at: usize,
        seen: &mut Detections,
    ) {
        let step = context.map.step;
        let (start, end) = match axis {
            ScanAxis::Column => ((border.row(at / step) * step as f32) as usize + 2, context.image.height()),
            ScanAxis::Row => (0, context.image.width()),
        };
        if start + 8 >= end {
            return;
        }
        let pixel = |along: usize| match axis {
            ScanAxis::Column => (at, along),
            ScanAxis::Row => (along, at),
        };
        self.read_profile(context, axis, at, start, end);
        let model = context.table.model();
        // A far line is blurred: a part of the step from carpet to white is enough, if it is not
        // noise, of which the smoothed difference has about half the deviation.
        let min = (0.15 * (model.white_luma - model.green_luma)).max(2.3 * model.deviation).max(6.0) as i32;
        let luma = |index: usize| i32::from(self.profile[index]);
        let gradient = |index: usize| luma(index + 1) - luma(index - 1);
        let mut rise: Option<(usize, i32)> = None;
        let mut index = 1;
        while index + 1 < self.profile.len() {
            let change = gradient(index);
            if change >= min {
                // The steepest place of the rise.
                if rise.is_none_or(|(position, steepest)| change > steepest || index > position + 3) {
                    rise = Some((index, change));
                }
            } else if change <= -min
                && let Some((begin, _)) = rise.take()
            {
                let (mut fall, mut steepest) = (index, change);
                while fall + 2 < self.profile.len() && gradient(fall + 1) < steepest {
                    fall += 1;
                    steepest = gradient(fall);
                }
                let (begin, finish) = ((start + begin) as f64, (start + fall) as f64);
                if let Some(point) = line_point(context, axis, pixel, begin, finish, (start, end))
                    && is_on_field(context, border, &point)
                    && !is_on_object(seen, cut, &point)
                    && seen.line_points.len() < MOST_POINTS
                {
                    seen.line_points.push(point);
                }
                index = fall;
            }
            index += 1;
        }
    }

    /// Reads the luma of two neighbouring columns or rows, smoothed with the weights 1, 2, 1.
    fn read_profile(
        &mut self,
        context: &ImageContext<'_>,
        axis: ScanAxis,
        at: usize,
        start: usize,
        end: usize,
    ) {
        self.profile.clear();
        let mean = |along: usize| {
            let (one, other) = match axis {
                ScanAxis::Column => (context.image.luma(at, along), context.image.luma(at + 1, along)),
                ScanAxis::Row => (context.image.luma(along, at), context.image.luma(along, at + 1)),
            };
            u16::from(one) + u16::from(other)
        };
        let mut three = [mean(start.saturating_sub(1)), mean(start), 0];
        for along in start..end {
            three[2] = mean(along + 1);
            self.profile.push(((three[0] + 2 * three[1] + three[2]) / 8) as u8);
            three = [three[1], three[2], 0];
        }
    }

    /// Appends a point to the chain that leads to it, or begins one.
    fn link(&mut self, point: GroundPoint, axis: ScanAxis, scan: usize, spacing: usize) {
        let across = |point: &GroundPoint| point.pixel[usize::from(axis == ScanAxis::Column)];
        let index = self.linked.len();
        let linked = &self.linked;
        let error = |chain: &PointChain| {
            let gap = (scan - chain.scan) as f64;
            (across(&point) - across(&linked[chain.last].0) - gap * chain.slope).abs()
        };
        let is_open = |chain: &PointChain| {
            let tolerance = if chain.count < 2 { 1.2 * spacing as f64 } else { 1.5 + 0.2 * spacing as f64 };
            chain.scan < scan && scan <= chain.scan + 3 && error(chain) <= tolerance
        };
        let open = self.chains.iter().enumerate().filter(|(_, chain)| is_open(chain));
        let best = open.min_by(|(_, a), (_, b)| error(a).total_cmp(&error(b))).map(|(at, _)| at);
        self.linked.push((point, END));
        match best {
            Some(at) => {
                let last = self.chains[at].last;
                let gap = (scan - self.chains[at].scan) as f64;
                let change = (across(&point) - across(&self.linked[last].0)) / gap;
                self.linked[last].1 = index;
                let chain = &mut self.chains[at];
                chain.slope = if chain.count < 2 { change } else { 0.5 * (chain.slope + change) };
                (chain.last, chain.scan, chain.count) = (index, scan, chain.count + 1);
            }
            None => {
                self.chains.push(PointChain { first: index, last: index, count: 1, scan, slope: 0.0 });
            }
        }
    }

    /// Splits a chain into straight parts, at the point farthest from the line between the ends, as
    /// Douglas and Peucker (1973) do.
    fn split(&mut self, chain: PointChain, lines: &mut Vec<LineSegment>) {
        if chain.count < 4 {
            return;
        }
        self.run.clear();
        let mut next = chain.first;
        while let Some((point, following)) = self.linked.get(next) {
            self.run.push(*point);
            next = *following;
        }
        split_run(&self.run, lines);
    }
}

fn split_run(run: &[GroundPoint], lines: &mut Vec<LineSegment>) {
    /// Greatest distance of a point from its straight part, pixels.
    const MAX_LINE_DISTANCE: f64 = 2.2;
    let [first, .., last] = run else { return };
    if run.len() < 4 {
        return;
    }
    let (index, away) = (1..run.len() - 1).fold((0, 0.0), |best, index| {
        let away = distance_from(first.pixel, last.pixel, run[index].pixel);
        if away > best.1 { (index, away) } else { best }
    });
    if away > MAX_LINE_DISTANCE {
        split_run(&run[..=index], lines);
        split_run(&run[index..], lines);
        return;
    }
    let segment = LineSegment { ends: [*first, *last] };
    if segment.length() >= LEAST_LENGTH {
        lines.push(segment);
    }
}

/// The distance of a point from the line through two others.
fn distance_from(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> f64 {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    let length = libm::hypot(x, y).max(1e-9);
    ((point[0] - a[0]) * y - (point[1] - a[1]) * x).abs() / length
}

/// The point in the middle of a bright bar, if it is as wide as a line and between carpet.
fn line_point(
    context: &ImageContext<'_>,
    axis: ScanAxis,
    pixel: impl Fn(usize) -> (usize, usize),
    begin: f64,
    finish: f64,
    (start, end): (usize, usize),
) -> Option<GroundPoint> {
    let middle = (begin + finish) / 2.0;
    let pixel_of = |along: f64| match axis {
        ScanAxis::Column => [pixel(0).0 as f64 + 0.5, along + 0.5],
        ScanAxis::Row => [along + 0.5, pixel(0).1 as f64 + 0.5],
    };
    let centre = pixel_of(middle);
    let position = context.camera.point_at_height(centre[0], centre[1], 0.0)?;
    let ends = [begin, finish].map(|along| {
        let [x, y] = pixel_of(along);
        context.camera.point_at_height(x, y, 0.0)
    });
    // On the ground, as a scan crosses it: a line is met at an angle. Blur adds two pixels.
    let width = (ends[1]? - ends[0]?).norm();
    let per_pixel = width / (finish - begin).max(1.0);
    let line = context.objects.line_width;
    if width > 3.0 * line + 2.0 * per_pixel || width < 0.25 * line - per_pixel {
        return None;
    }
    let is_carpet = |along: f64| {
        let inside = along >= start as f64 && along < end as f64;
        let (x, y) = pixel(along.max(0.0) as usize);
        inside && context.table.class(context.image.yuv(x, y)) == ColourClass::Green
    };
    let reach = 2.0 + 0.25 * (finish - begin);
    let carpet_before = is_carpet(begin - reach) || is_carpet(begin - reach - 2.0);
    let carpet_after = is_carpet(finish + reach) || is_carpet(finish + reach + 2.0);
    // Bright pixels are white, unless the line is too thin to show its colour.
    let (x, y) = pixel(middle as usize);
    let class = context.table.class(context.image.yuv(x, y));
    let is_pale = class == ColourClass::White || (finish - begin < 5.0 && is_colourless(class));
    (carpet_before && carpet_after && is_pale).then_some(GroundPoint { pixel: centre, position })
}

fn is_colourless(class: ColourClass) -> bool {
    matches!(class, ColourClass::White | ColourClass::Other | ColourClass::Green)
}

fn is_on_field(context: &ImageContext<'_>, border: &BorderScan, point: &GroundPoint) -> bool {
    let step = context.map.step as f64;
    point.pixel[1] / step > f64::from(border.row((point.pixel[0] / step) as usize)) + 0.5
}

/// Whether a point belongs to a ball, a post, a robot or another body.
fn is_on_object(seen: &Detections, bodies: &[PixelBox], point: &GroundPoint) -> bool {
    let [x, y] = point.pixel;
    let holds = |area: &PixelBox, margin: f64| {
        (area.left - margin..area.right + margin).contains(&x)
            && (area.top - margin..area.bottom + margin).contains(&y)
    };
    let within = |area: &PixelBox| holds(area, 0.1 * (area.right - area.left) + 2.0);
    let of = |sight: &GroundObject| within(&sight.area);
    seen.ball.as_ref().is_some_and(of)
        || seen.posts.iter().any(|post| of(&post.sight))
        || seen.robots.iter().any(|robot| of(&robot.sight))
        || bodies.iter().any(within)
}

/// Removes straight parts that lie on longer ones: rows and columns may find the same.
fn merge(lines: &mut Vec<LineSegment>) {
    lines.sort_unstable_by(|a, b| b.length().total_cmp(&a.length()));
    let mut kept = 0;
    for index in 0..lines.len() {
        let line = lines[index];
        let lies_on = |longer: &LineSegment| {
            let [a, b] = longer.ends.map(|end| end.pixel);
            line.ends.iter().all(|end| distance_from(a, b, end.pixel) < 4.0 && is_between(a, b, end.pixel))
        };
        if !lines[..kept].iter().any(lies_on) {
            lines[kept] = line;
            kept += 1;
        }
    }
    lines.truncate(kept);
}

/// Whether the foot of a point on a line is between two points of it, with a few pixels to spare.
fn is_between(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> bool {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    let length = libm::hypot(x, y).max(1e-9);
    let along = ((point[0] - a[0]) * x + (point[1] - a[1]) * y) / length;
    (-8.0..=length + 8.0).contains(&along)
}
