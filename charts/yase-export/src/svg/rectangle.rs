//! Rectangles on the page.

use yase::statechart::Point;

/// A rectangle; y grows downwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rectangle {
    /// From its upper left corner.
    pub(crate) fn new(at: Point, size: Point) -> Rectangle {
        Rectangle { left: at.0, top: at.1, right: at.0 + size.0, bottom: at.1 + size.1 }
    }

    /// From its centre.
    pub(crate) fn around(middle: Point, size: Point) -> Rectangle {
        Rectangle::new((middle.0 - size.0 / 2.0, middle.1 - size.1 / 2.0), size)
    }

    /// Bounding box of a horizontal or vertical line.
    pub(crate) fn between(from: Point, to: Point) -> Rectangle {
        Rectangle {
            left: from.0.min(to.0),
            top: from.1.min(to.1),
            right: from.0.max(to.0),
            bottom: from.1.max(to.1),
        }
    }

    /// Enlarged by this on each side.
    pub(crate) fn grown(self, by: f64) -> Rectangle {
        let Rectangle { left, top, right, bottom } = self;
        Rectangle { left: left - by, top: top - by, right: right + by, bottom: bottom + by }
    }

    pub(crate) fn centre(&self) -> Point {
        ((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0)
    }

    /// The border point on the line from the centre to a point; for a point inside, the border
    /// above or below it.
    pub(crate) fn border_towards(&self, point: Point) -> Point {
        let (x, y) = self.centre();
        let (right, down) = (point.0 - x, point.1 - y);
        let (half_width, half_height) = (self.right - x, self.bottom - y);
        if right.abs() * half_height > down.abs() * half_width {
            (x + half_width.copysign(right), y + down * half_width / right.abs())
        } else if down == 0.0 {
            (x, self.bottom)
        } else {
            (x + right * half_height / down.abs(), y + half_height.copysign(down))
        }
    }

    pub(crate) fn area(&self) -> f64 {
        (self.right - self.left) * (self.bottom - self.top)
    }

    /// The overlapping area of two rectangles.
    pub(crate) fn shared(&self, other: &Rectangle) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_leaves_by_the_facing_side() {
        let area = Rectangle::new((0.0, 0.0), (40.0, 20.0));
        assert_eq!(area.border_towards((100.0, 10.0)), (40.0, 10.0));
        assert_eq!(area.border_towards((-100.0, 10.0)), (0.0, 10.0));
        assert_eq!(area.border_towards((20.0, -50.0)), (20.0, 0.0));
        assert_eq!(area.border_towards((40.0, 30.0)), (30.0, 20.0), "aslant");
        assert_eq!(area.border_towards((20.0, 10.0)), (20.0, 20.0), "the middle itself");
    }
}
