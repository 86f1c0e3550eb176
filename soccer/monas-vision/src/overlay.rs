//! Draws detections over their image.

use crate::image::rgb_of_yuv;
use crate::{Detections, GoalPaint, Image, Jersey, PixelBox};

const BORDER: [u8; 3] = [255, 0, 255];
const BORDER_POINT: [u8; 3] = [255, 255, 80];
const LINE_POINT: [u8; 3] = [255, 40, 40];
const LINE: [u8; 3] = [0, 230, 255];
const BALL: [u8; 3] = [255, 150, 0];
const WHITE_POST: [u8; 3] = [160, 0, 255];
const YELLOW_POST: [u8; 3] = [255, 255, 0];
const BLUE_POST: [u8; 3] = [60, 120, 255];
const ROBOT: [u8; 3] = [255, 255, 255];

/// The image in RGB, with the border of the field (magenta) and its points (yellow crosses), lines
/// (cyan) and their points (red), the ball (an orange circle), posts (boxes in the colour of the
/// goal, violet if it is white) and robots (boxes in the colour of the jersey, white without).
pub fn overlay(image: &Image<'_>, seen: &Detections) -> Vec<u8> {
    let mut canvas = Canvas::of(image);
    for pair in seen.border.windows(2) {
        canvas.line(pair[0], pair[1], BORDER);
    }
    for point in &seen.border_points {
        let [x, y] = point.pixel.map(|at| at as i64);
        (0..3).for_each(|aside| canvas.dot(x + aside - 1, y, BORDER_POINT));
        (0..3).for_each(|aside| canvas.dot(x, y + aside - 1, BORDER_POINT));
    }
    for line in &seen.lines {
        canvas.line(line.ends[0].pixel, line.ends[1].pixel, LINE);
    }
    for point in &seen.line_points {
        let [x, y] = point.pixel;
        canvas.dot(x as i64, y as i64, LINE_POINT);
    }
    for post in &seen.posts {
        let colour = match post.paint {
            GoalPaint::White => WHITE_POST,
            GoalPaint::Yellow => YELLOW_POST,
            GoalPaint::Blue => BLUE_POST,
        };
        canvas.frame(&post.sight.area, colour);
    }
    for robot in &seen.robots {
        let colour = match robot.jersey {
            Jersey::Blue => BLUE_POST,
            Jersey::Red => LINE_POINT,
            Jersey::Unknown => ROBOT,
        };
        canvas.frame(&robot.sight.area, colour);
    }
    if let Some(ball) = &seen.ball {
        canvas.circle(&ball.area, BALL);
    }
    canvas.rgb
}

/// An image in RGB.
struct Canvas {
    width: i64,
    height: i64,
    rgb: Vec<u8>,
}

impl Canvas {
    fn of(image: &Image<'_>) -> Canvas {
        let pixels = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| image.yuv(x, y)));
        Canvas {
            width: image.width() as i64,
            height: image.height() as i64,
            rgb: pixels.flat_map(rgb_of_yuv).collect(),
        }
    }

    fn dot(&mut self, x: i64, y: i64, colour: [u8; 3]) {
        if (0..self.width).contains(&x) && (0..self.height).contains(&y) {
            let at = 3 * (y * self.width + x) as usize;
            self.rgb[at..at + 3].copy_from_slice(&colour);
        }
    }

    /// A line between two points, which may lie outside the image.
    fn line(&mut self, from: [f64; 2], to: [f64; 2], colour: [u8; 3]) {
        let longest = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        let steps = longest.clamp(1.0, 20_000.0) as u32;
        for step in 0..=steps {
            let part = f64::from(step) / f64::from(steps);
            let at = [0, 1].map(|k| from[k] + part * (to[k] - from[k]));
            self.dot(at[0] as i64, at[1] as i64, colour);
        }
    }

    fn frame(&mut self, area: &PixelBox, colour: [u8; 3]) {
        let PixelBox { left, top, right, bottom } = *area;
        let (right, bottom) = (right - 1.0, bottom - 1.0);
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
        corners.windows(2).for_each(|pair| self.line(pair[0], pair[1], colour));
    }

    /// Two circles, one within the other, so that they are visible on small balls.
    fn circle(&mut self, area: &PixelBox, colour: [u8; 3]) {
        const PARTS: u32 = 48;
        let centre = [(area.left + area.right) / 2.0, (area.top + area.bottom) / 2.0];
        for radius in [(area.right - area.left) / 2.0, (area.right - area.left) / 2.0 + 1.0] {
            let point = |part: u32| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(part) / f64::from(PARTS));
                [centre[0] + radius * cos, centre[1] + radius * sin]
            };
            (0..PARTS).for_each(|part| self.line(point(part), point(part + 1), colour));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GroundObject;
    use nalgebra::Point2;

    #[test]
    fn a_ball_is_circled_and_the_rest_stays() {
        let pixels = vec![128; 2 * 64 * 48];
        let image = Image::new(64, 48, &pixels).unwrap();
        let area = PixelBox { left: 20.0, top: 20.0, right: 30.0, bottom: 30.0 };
        let ball = Some(GroundObject::new(Point2::new(1.0, 0.0), area));
        let rgb = overlay(&image, &Detections { ball, ..Detections::default() });
        let at = |x: usize, y: usize| &rgb[3 * (y * 64 + x)..3 * (y * 64 + x) + 3];
        assert_eq!((at(30, 25), at(25, 25), at(5, 5)), (&BALL[..], &[128; 3][..], &[128; 3][..]));
        assert_eq!(rgb.len(), 3 * 64 * 48);
    }

    #[test]
    fn what_is_partly_outside_is_cut() {
        let pixels = vec![128; 2 * 64 * 48];
        let image = Image::new(64, 48, &pixels).unwrap();
        let border = vec![[-1e9, 10.0], [1e9, 10.0]];
        assert_eq!(overlay(&image, &Detections { border, ..Detections::default() }).len(), 3 * 64 * 48);
    }
}
