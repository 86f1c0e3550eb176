//! The ball: candidates on the grid of classes, then checks of shape in the image.

use nalgebra::Point2;

use super::ImageContext;
use super::border::BorderScan;
use crate::colour::ColourClass;
use crate::detections::{GroundObject, PixelBox};
use crate::objects::BallPattern;

/// The most candidates that are checked.
const MAX_CANDIDATES: usize = 12;

/// Rays from the centre of a candidate to its edge.
const RAYS: usize = 32;

/// The search for the ball.
#[derive(Clone, Debug, Default)]
pub(crate) struct BallSearch {
    candidates: Vec<BallCandidate>,
    edges: Vec<(f64, f64)>,
}

/// A candidate for the ball, in cells.
#[derive(Clone, Copy, Debug)]
struct BallCandidate {
    x: f32,
    y: f32,
    radius: f32,
    score: f32,
}

/// A circle in the image, in pixels.
#[derive(Clone, Copy, Debug)]
struct Circle {
    x: f64,
    y: f64,
    radius: f64,
}

impl BallSearch {
    pub(crate) fn search(&mut self, context: &ImageContext<'_>, border: &BorderScan) -> Option<GroundObject> {
        self.collect(context, border);
        let mut best: Option<(f64, Circle)> = None;
        for index in 0..self.candidates.len() {
            if let Some((quality, circle)) = self.check(context, self.candidates[index])
                && best.is_none_or(|(min, _)| quality > min)
            {
                best = Some((quality, circle));
            }
        }
        let (_, circle) = best?;
        let position = context.camera.point_at_height(circle.x, circle.y, context.objects.ball_radius)?;
        Some(GroundObject::new(position, circle.area()))
    }

    /// Collects the best places, where a square of the size of the ball differs from the carpet
    /// around it.
    fn collect(&mut self, context: &ImageContext<'_>, border: &BorderScan) {
        self.candidates.clear();
        let (map, step) = (context.map, context.map.step as f64);
        let radius_at = |x: f32, y: f32| {
            let scale =
                context.camera.scale(f64::from(x) * step, f64::from(y) * step, context.objects.ball_radius);
            (scale * context.objects.ball_radius / step) as f32
        };
        let mut y = 0.0f32;
        while y < map.rows as f32 {
            // The radius changes little along a row.
            let middle = radius_at(map.columns as f32 / 2.0, y);
            let pace = (middle / 3.0).max(1.0);
            let mut x = 0.0f32;
            while x < map.columns as f32 {
                let radius = radius_at(x, y);
                if radius >= 1.2 && y + 1.2 * radius > border.row(x as usize) {
                    self.consider(context, x, y, radius);
                }
                x += pace;
            }
            y += pace;
        }
    }

    fn consider(&mut self, context: &ImageContext<'_>, x: f32, y: f32, radius: f32) {
        let map = context.map;
        let inner = 0.7 * radius;
        let inside = map.shares(x - inner, y - inner, x + inner, y + inner);
        if inside.cells == 0.0 {
            return;
        }
        let likeness = match context.objects.ball {
            BallPattern::Orange if inside.orange >= 0.45 => inside.orange,
            BallPattern::BlackAndWhite if inside.green <= 0.25 && inside.white >= 0.12 => {
                1.0 - inside.green + 2.0 * inside.dark.min(0.25)
            }
            _ => return,
        };
        // Carpet beside and below.
        let outer = 1.7 * radius + 1.0;
        let clear = 1.15 * radius + 0.5;
        let sides = [
            map.shares(x - outer, y - radius, x - clear, y + radius),
            map.shares(x + clear, y - radius, x + outer, y + radius),
            map.shares(x - radius, y + clear, x + radius, y + outer),
        ];
        let seen_sides = sides.iter().filter(|side| side.cells > 0.0).count() as f32;
        let carpet = sides.iter().map(|side| side.green).sum::<f32>() / seen_sides.max(1.0);
        if carpet < 0.3 && seen_sides > 0.0 {
            return;
        }
        self.keep(BallCandidate { x, y, radius, score: likeness + carpet });
    }

    /// Keeps a candidate, if it is better than those near it and among the best.
    fn keep(&mut self, candidate: BallCandidate) {
        let is_near = |other: &BallCandidate| {
            let (x, y) = (other.x - candidate.x, other.y - candidate.y);
            x * x + y * y < candidate.radius * candidate.radius
        };
        if let Some(near) = self.candidates.iter_mut().find(|other| is_near(other)) {
            if candidate.score > near.score {
                *near = candidate;
            }
            return;
        }
        if self.candidates.len() < MAX_CANDIDATES {
            self.candidates.push(candidate);
            return;
        }
        let worst = self.candidates.iter_mut().min_by(|a, b| a.score.total_cmp(&b.score));
        if let Some(worst) = worst
            && worst.score < candidate.score
        {
            *worst = candidate;
        }
    }

    /// Fits a circle to the edge of a candidate and checks its size, its roundness and what it
    /// encloses. Returns a quality.
    fn check(&mut self, context: &ImageContext<'_>, candidate: BallCandidate) -> Option<(f64, Circle)> {
        /// Least radius at which the patches of a ball are visible, pixels.
        const MIN_PATCH_RADIUS: f64 = 4.5;
        let step = context.map.step as f64;
        let radius = f64::from(candidate.radius) * step;
        if context.objects.ball == BallPattern::BlackAndWhite && radius < MIN_PATCH_RADIUS {
            return None;
        }
        let mut circle = Circle {
            x: (f64::from(candidate.x) + 0.5) * step,
            y: (f64::from(candidate.y) + 0.5) * step,
            radius,
        };
        for _ in 0..3 {
            self.find_edges(context, &circle);
            circle = self.fit(context, circle)?;
        }
        let expected = context.expected_radius(circle.x, circle.y);
        let ratio = circle.radius / expected.max(0.1);
        // An edge is found to a pixel, which matters for a small ball.
        let slack = 1.0 / expected.max(1.0);
        if !(0.68 - slack..=1.40 + slack).contains(&ratio) {
            return None;
        }
        // Most of it is in the image and the patches are visible, or they do not count.
        let shows_patches =
            circle.radius >= MIN_PATCH_RADIUS && context.rays_within(&circle) >= 0.7 * RAYS as f64;
        if context.objects.ball == BallPattern::BlackAndWhite && !shows_patches {
            return None;
        }
        self.find_edges(context, &circle);
        let tolerance = 0.16 * circle.radius + 0.9;
        let is_on = |&(x, y): &(f64, f64)| {
            (libm::hypot(x - circle.x, y - circle.y) - circle.radius).abs() < tolerance
        };
        let round =
            self.edges.iter().filter(|edge| is_on(edge)).count() as f64 / context.rays_within(&circle);
        if round < 0.62 {
            return None;
        }
        let content = context.content(&circle)?;
        Some((round + content - 0.3 * (ratio - 1.0).abs(), circle))
    }

    /// The points at which rays from the centre leave the ball for the carpet.
    fn find_edges(&mut self, context: &ImageContext<'_>, circle: &Circle) {
        self.edges.clear();
        let pace = (circle.radius / 16.0).max(0.5);
        for ray in 0..RAYS {
            let (sin, cos) = direction(ray);
            let (mut at, mut outside_from, mut outside) = (0.3 * circle.radius, 0.0, 0);
            while at < 1.7 * circle.radius + 2.0 {
                let Some(class) = context.class_at(circle.x + at * cos, circle.y + at * sin) else { break };
                let is_ball = match context.objects.ball {
                    BallPattern::Orange => is_orange(class),
                    BallPattern::BlackAndWhite => class != ColourClass::Green,
                };
                if is_ball {
                    outside = 0;
                } else {
                    if outside == 0 {
                        outside_from = at - pace / 2.0;
                    }
                    outside += 1;
                }
                // Two pixels beyond the edge suffice.
                if f64::from(outside) * pace >= 1.6 {
                    self.edges.push((circle.x + outside_from * cos, circle.y + outside_from * sin));
                    break;
                }
                at += pace;
            }
        }
    }

    /// The circle through the edge points, by the method of Kåsa (1976): least squares of a linear
    /// equation; then again without the points far from it.
    fn fit(&mut self, context: &ImageContext<'_>, start: Circle) -> Option<Circle> {
        let mut circle = start;
        for round in 0..2 {
            if round == 1 {
                let Circle { x, y, radius } = circle;
                let tolerance = 0.2 * radius + 1.0;
                self.edges.retain(|edge| (libm::hypot(edge.0 - x, edge.1 - y) - radius).abs() < tolerance);
            }
            if self.edges.len() < RAYS * 2 / 5 {
                return None;
            }
            circle = fitted(&self.edges)?;
            let expected = context.expected_radius(circle.x, circle.y);
            let moved = libm::hypot(circle.x - start.x, circle.y - start.y);
            if moved > 1.5 * start.radius + 2.0 || circle.radius > 2.0 * expected + 2.0 {
                return None;
            }
        }
        Some(circle)
    }
}

fn is_orange(class: ColourClass) -> bool {
    matches!(class, ColourClass::Orange | ColourClass::Red)
}

fn direction(ray: usize) -> (f64, f64) {
    libm::sincos(std::f64::consts::TAU * ray as f64 / RAYS as f64)
}

impl Circle {
    fn area(&self) -> PixelBox {
        let Circle { x, y, radius } = *self;
        PixelBox { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius }
    }
}

/// The circle with the least squares of `x² + y² + a x + b y + c` over the points.
fn fitted(points: &[(f64, f64)]) -> Option<Circle> {
    let count = points.len() as f64;
    let mean = points.iter().fold(Point2::origin(), |sum, p| sum + nalgebra::Vector2::new(p.0, p.1) / count);
    let (mut xx, mut xy, mut yy, mut xz, mut yz, mut zz) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for &(x, y) in points {
        let (x, y) = (x - mean.x, y - mean.y);
        let z = x * x + y * y;
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        (xz, yz, zz) = (xz + x * z, yz + y * z, zz + z);
    }
    let determinant = xx * yy - xy * xy;
    if determinant.abs() < 1e-6 {
        return None;
    }
    let x = (xz * yy - yz * xy) / (2.0 * determinant);
    let y = (yz * xx - xz * xy) / (2.0 * determinant);
    let radius = (x * x + y * y + zz / count).sqrt();
    Some(Circle { x: mean.x + x, y: mean.y + y, radius })
}

impl ImageContext<'_> {
    /// The radius of a ball at a pixel, pixels.
    fn expected_radius(&self, x: f64, y: f64) -> f64 {
        self.camera.scale(x, y, self.objects.ball_radius) * self.objects.ball_radius
    }

    fn class_at(&self, x: f64, y: f64) -> Option<ColourClass> {
        let inside = x >= 0.0 && y >= 0.0 && x < self.image.width() as f64 && y < self.image.height() as f64;
        inside.then(|| self.table.class(self.image.yuv(x as usize, y as usize)))
    }

    /// The number of rays whose edge is within the image.
    fn rays_within(&self, circle: &Circle) -> f64 {
        let reach = 1.25 * circle.radius + 1.0;
        let is_within = |ray: &usize| {
            let (sin, cos) = direction(*ray);
            self.class_at(circle.x + reach * cos, circle.y + reach * sin).is_some()
        };
        // A ball of which less than half is visible has too few.
        (0..RAYS).filter(is_within).count().max(RAYS / 2) as f64
    }

    /// The similarity of the content of a circle to a ball, from 0 to 1; none if it is no ball.
    fn content(&self, circle: &Circle) -> Option<f64> {
        let pace = (circle.radius / 8.0).max(1.0);
        let reach = (0.85 * circle.radius / pace) as i32;
        let (mut count, mut orange, mut green, mut white) = (0u32, 0u32, 0u32, 0u32);
        let (mut brightest, mut darkest, mut sum) = (0u8, 255u8, 0u32);
        let (mut dark, mut upper, mut dark_above) = (0u32, 0u32, 0u32);
        let limit = self.table.model().white_luma;
        for row in -reach..=reach {
            for column in -reach..=reach {
                let (x, y) = (f64::from(column) * pace, f64::from(row) * pace);
                if x * x + y * y > 0.7225 * circle.radius * circle.radius {
                    continue;
                }
                let Some(class) = self.class_at(circle.x + x, circle.y + y) else { continue };
                let luma = self.image.luma((circle.x + x) as usize, (circle.y + y) as usize);
                count += 1;
                sum += u32::from(luma);
                (brightest, darkest) = (brightest.max(luma), darkest.min(luma));
                orange += u32::from(is_orange(class));
                green += u32::from(class == ColourClass::Green);
                white += u32::from(class == ColourClass::White);
                // A patch is black: a jersey and the carpet are dark, but have a colour.
                let is_black = matches!(class, ColourClass::Dark | ColourClass::Other | ColourClass::White);
                let is_dark = u32::from(f32::from(luma) < 0.45 * limit && is_black);
                dark += is_dark;
                if 2 * row < reach {
                    (upper, dark_above) = (upper + 1, dark_above + is_dark);
                }
            }
        }
        let share = |part: u32| f64::from(part) / f64::from(count.max(1));
        match self.objects.ball {
            BallPattern::Orange => (share(orange) > 0.7).then(|| share(orange)),
            BallPattern::BlackAndWhite => {
                let contrast = f64::from(darkest) / f64::from(brightest.max(1));
                // A white object is dark at its lower end, which the light does not reach.
                let has_patch_above = 50 * dark_above > upper;
                let is_patched =
                    share(dark) > 0.04 && share(dark) < 0.75 && contrast < 0.48 && has_patch_above;
                let is_pale = share(white) > 0.2 && share(green) < 0.2;
                (is_patched && is_pale && sum > 0).then(|| share(white).min(0.6) + share(dark).min(0.3))
            }
        }
    }
}
