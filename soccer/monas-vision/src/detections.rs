//! The objects, lines and border that an image shows.

use nalgebra::Point2;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelBox {
    /// The first column.
    pub left: f64,
    /// The first row.
    pub top: f64,
    /// The column after the last.
    pub right: f64,
    /// The row after the last.
    pub bottom: f64,
}

/// An object on the ground: its place in the ground frame of the camera, and in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundObject {
    /// Distance along the ground to its middle, m.
    pub distance: f64,
    /// Direction, rad, positive to the left.
    pub bearing: f64,
    /// Its bounding box in the image.
    pub area: PixelBox,
}

impl GroundObject {
    pub(crate) fn new(point: Point2<f64>, area: PixelBox) -> GroundObject {
        GroundObject { distance: libm::hypot(point.x, point.y), bearing: libm::atan2(point.y, point.x), area }
    }

    /// Its position on the ground, m.
    pub fn position(&self) -> Point2<f64> {
        let (sin, cos) = libm::sincos(self.bearing);
        Point2::new(self.distance * cos, self.distance * sin)
    }
}

/// The paint of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GoalPaint {
    /// One of the goals of 2010.
    Yellow,
    /// The other goal of 2010.
    Blue,
    /// A goal of today.
    White,
}

/// The side of a post in its goal, as seen from the field facing the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PostSide {
    /// The left one.
    Left,
    /// The right one.
    Right,
    /// Not known: only one post of the goal is in the image.
    Unknown,
}

/// A post of a goal, at its foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalPost {
    /// Where it is.
    pub sight: GroundObject,
    /// The paint of its goal.
    pub paint: GoalPaint,
    /// Which of the posts it is.
    pub side: PostSide,
}

/// The colour of a jersey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jersey {
    /// Blue.
    Blue,
    /// Red.
    Red,
    /// Neither, or not visible.
    Unknown,
}

/// Another robot, at its foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectedRobot {
    /// Where it is.
    pub sight: GroundObject,
    /// The colour of its jersey.
    pub jersey: Jersey,
}

/// A point on the ground: of the middle of a line, or of the border of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundPoint {
    /// Its pixel: column and row.
    pub pixel: [f64; 2],
    /// Its position on the ground, m.
    pub position: Point2<f64>,
}

/// A straight part of a line of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSegment {
    /// Its ends.
    pub ends: [GroundPoint; 2],
}

impl LineSegment {
    /// Its length on the ground, m.
    pub fn length(&self) -> f64 {
        (self.ends[1].position - self.ends[0].position).norm()
    }
}

/// The objects, lines and border that an image shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detections {
    /// The ball.
    pub ball: Option<GroundObject>,
    /// Posts of goals, from left to right.
    pub posts: Vec<GoalPost>,
    /// Other robots, from left to right.
    pub robots: Vec<DetectedRobot>,
    /// Points of lines.
    pub line_points: Vec<GroundPoint>,
    /// Straight parts of lines.
    pub lines: Vec<LineSegment>,
    /// The border of the field from left to right: columns and rows of pixels. Empty if the image
    /// shows no carpet.
    pub border: Vec<[f64; 2]>,
    /// Points of the border at which the carpet was seen to end, from left to right: not where it
    /// leaves the image, nor where an object hides its end.
    pub border_points: Vec<GroundPoint>,
}

impl Detections {
    /// The row at which the field begins in a column; none if the image shows no carpet.
    pub fn border_at(&self, x: f64) -> Option<f64> {
        let first = self.border.first()?;
        let last = self.border.last()?;
        if x <= first[0] {
            return Some(first[1]);
        }
        let pair = self.border.windows(2).find(|pair| x <= pair[1][0]);
        let Some([a, b]) = pair else { return Some(last[1]) };
        Some(a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]).max(1e-9))
    }

    pub(crate) fn clear(&mut self) {
        self.ball = None;
        self.posts.clear();
        self.robots.clear();
        self.line_points.clear();
        self.lines.clear();
        self.border.clear();
        self.border_points.clear();
    }
}
