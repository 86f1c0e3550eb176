//! The scene to draw: a field and its surroundings.

use nalgebra::{Point2, Point3, Vector2, Vector3};

use super::shapes::{Pattern, Solid};
use super::{Rgb, Shading};
use crate::{BallPattern, FieldObjects, GoalPaint, Jersey};

/// The measures of a field, m. The frame of the field has its origin in the centre; x points to the
/// yellow goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldMarkings {
    /// From goal line to goal line.
    pub length: f64,
    /// From touch line to touch line.
    pub width: f64,
    /// Carpet outside the lines.
    pub border: f64,
    /// Between the middles of the posts of a goal.
    pub goal_width: f64,
    /// Height of the posts.
    pub goal_height: f64,
    /// Depth of the goal areas.
    pub goal_area_depth: f64,
    /// Width of the goal areas.
    pub goal_area_width: f64,
    /// Radius of the centre circle.
    pub centre_circle_radius: f64,
    /// Distance of the penalty marks from the centre.
    pub mark_distance: f64,
}

impl Default for FieldMarkings {
    /// The field of 2010.
    fn default() -> FieldMarkings {
        FieldMarkings {
            length: 6.0,
            width: 4.0,
            border: 0.7,
            goal_width: 1.4,
            goal_height: 0.8,
            goal_area_depth: 0.6,
            goal_area_width: 2.2,
            centre_circle_radius: 0.6,
            mark_distance: 1.2,
        }
    }
}

/// A robot that stands on the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotFigure {
    /// Its position, m.
    pub position: Point2<f64>,
    /// Its heading, rad.
    pub heading: f64,
    /// The colour of its jersey.
    pub jersey: Jersey,
    /// Whether it lies on the ground.
    pub lies: bool,
}

/// The objects in view.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The field.
    pub markings: FieldMarkings,
    /// The appearance of ball, goals and lines.
    pub objects: FieldObjects,
    /// The position of the ball, m; none without a ball.
    pub ball: Option<Point2<f64>>,
    /// The robots in view.
    pub robots: Vec<RobotFigure>,
    /// Chooses the room around the field and how the ball is turned.
    pub variant: u64,
}

/// The light, and the faults of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Brightness: 1 shows white carpet lines near the top of the range; 2 saturates.
    pub exposure: f64,
    /// Factors on red, green and blue: the colour of the light, less what the camera balances.
    pub tint: [f32; 3],
    /// Change of brightness along a direction on the field, 1/m.
    pub slope: f64,
    /// That direction, rad.
    pub direction: f64,
    /// Standard deviation of the noise of a pixel, on the scale of 0 to 255.
    pub noise: f64,
    /// Standard deviation of the blur, pixels.
    pub blur: f64,
}

impl Default for Light {
    /// Even, white light, and a camera without faults.
    fn default() -> Light {
        Light { exposure: 1.0, tint: [1.0; 3], slope: 0.0, direction: 0.0, noise: 0.0, blur: 0.0 }
    }
}

const CARPET: Rgb = [0.15, 0.46, 0.19];
const LINE: Rgb = [0.86, 0.86, 0.86];
const FLOOR: Rgb = [0.42, 0.37, 0.33];
const ORANGE: Rgb = [0.98, 0.42, 0.10];
const YELLOW: Rgb = [0.93, 0.80, 0.10];
const BLUE: Rgb = [0.10, 0.32, 0.78];
const RED: Rgb = [0.78, 0.12, 0.14];
const WHITE: Rgb = [0.92, 0.92, 0.92];
const SHELL: Rgb = [0.74, 0.75, 0.77];
const DARK: Rgb = [0.06, 0.06, 0.07];

/// Distance of the walls of the room from the centre of the field, m.
const WALL_DISTANCE: f64 = 7.0;

impl Scene {
    /// The colour of carpet, floor or room that a ray meets, and the length of the ray in multiples
    /// of its vector.
    pub(super) fn behind_everything(
        &self,
        origin: &Point3<f64>,
        ray: &Vector3<f64>,
        shading: &Shading,
    ) -> (Rgb, f64) {
        /// Points nearer to the centre than this are certainly inside the room, m.
        const INSIDE_DISTANCE: f64 = 0.99 * WALL_DISTANCE;
        let is_inside =
            |point: &Point3<f64>| point.x * point.x + point.y * point.y < INSIDE_DISTANCE * INSIDE_DISTANCE;
        if ray.z < -1e-6 {
            let length = -origin.z / ray.z;
            let point = origin + ray * length;
            // Of most rays it is clear that they do not meet the wall first.
            if is_inside(origin) && is_inside(&point) || length <= wall(origin, ray) {
                return (shading.at(self.ground(point.xy()), &point, 0.87), length);
            }
        }
        let to_wall = wall(origin, ray);
        let point = origin + ray * to_wall;
        (shading.at(self.room(&point), &point, 0.8), to_wall)
    }

    /// The colour of the ground at a point.
    fn ground(&self, point: Point2<f64>) -> Rgb {
        let field = &self.markings;
        let (x, y) = (point.x.abs(), point.y.abs());
        let outside = x > field.length / 2.0 + field.border || y > field.width / 2.0 + field.border;
        let colour = match outside {
            true => FLOOR,
            false if self.is_line(point) => LINE,
            // The pile of the carpet is not even.
            false => {
                let grain =
                    0.94 + 0.12 * hash(self.variant, (point.x * 40.0) as i64, (point.y * 40.0) as i64);
                CARPET.map(|part| part * grain as f32)
            }
        };
        let shadow = self.shadow(point);
        colour.map(|part| part * shadow)
    }

    /// The light that reaches a point beside objects that stand there.
    fn shadow(&self, point: Point2<f64>) -> f32 {
        let under = |squared: f64, radius: f64| {
            // Most points are beside all shadows; a root for each would take long.
            if squared > 1.01 * radius * radius {
                return 1.0;
            }
            let away = squared.sqrt() / radius;
            if away < 1.0 { 0.55 + 0.45 * away * away } else { 1.0 }
        };
        let squared = |centre: Point2<f64>| (point - centre).norm_squared();
        let ball = self.ball.map_or(1.0, |ball| under(squared(ball), 1.25 * self.objects.ball_radius));
        let nearest = self.robots.iter().map(|robot| squared(robot.position)).fold(f64::MAX, f64::min);
        ball.min(under(nearest, 0.2)) as f32
    }

    /// Whether a point is on a line, the circle or a mark.
    pub(super) fn is_line(&self, point: Point2<f64>) -> bool {
        let field = &self.markings;
        let half = self.objects.line_width / 2.0;
        let (x, y) = (point.x.abs(), point.y.abs());
        let (length, width) = (field.length / 2.0, field.width / 2.0);
        let area_front = length - field.goal_area_depth;
        let area_side = field.goal_area_width / 2.0;
        let near = |value: f64, line: f64| (value - line).abs() <= half;
        let in_field = x <= length + half && y <= width + half;
        // Most points are beside the square around a circle; a root for each would take long.
        let on_circle = || {
            let reach = field.centre_circle_radius + half;
            x <= reach && y <= reach && near(libm::hypot(x, y), field.centre_circle_radius)
        };
        let on_mark = || {
            let (along, reach) = (x - field.mark_distance, 2.0 * half);
            along.abs() <= reach && y <= reach && libm::hypot(along, y) <= reach
        };
        in_field
            && (near(y, width)
                || near(x, length)
                || x <= half
                || on_circle()
                || (near(x, area_front) && y <= area_side + half)
                || (near(y, area_side) && x >= area_front - half)
                || on_mark())
    }

    /// The colour of the wall at a point: panels of many colours, none of them an object's.
    fn room(&self, point: &Point3<f64>) -> Rgb {
        const WALL_COLOURS: [Rgb; 8] = [
            [0.62, 0.60, 0.56],
            [0.48, 0.46, 0.45],
            [0.36, 0.28, 0.24],
            [0.70, 0.68, 0.62],
            [0.24, 0.26, 0.32],
            [0.55, 0.50, 0.42],
            [0.30, 0.30, 0.30],
            [0.42, 0.46, 0.50],
        ];
        let around = libm::atan2(point.y, point.x);
        let panel = (around * 6.0).floor() as i64;
        let level = (point.z * 1.3).floor() as i64;
        let chosen = (hash(self.variant ^ 0x5eed, panel, level) * WALL_COLOURS.len() as f64) as usize;
        WALL_COLOURS[chosen.min(WALL_COLOURS.len() - 1)]
    }

    /// Appends ball, goals and robots.
    pub(super) fn add_solids(&self, solids: &mut Vec<Solid>) {
        if let Some(ball) = self.ball {
            let radius = self.objects.ball_radius;
            let pattern = match self.objects.ball {
                BallPattern::Orange => Pattern::Plain(ORANGE),
                BallPattern::BlackAndWhite => Pattern::Patches(WHITE, DARK, self.turn_of_ball()),
            };
            solids.push(Solid::Sphere { centre: Point3::new(ball.x, ball.y, radius), radius, pattern });
        }
        for side in [-1.0, 1.0] {
            self.add_goal(side, solids);
        }
        for robot in &self.robots {
            if robot.lies { add_lying(robot, solids) } else { add_standing(robot, solids) }
        }
    }

    /// The paint of the goal on a side of the field.
    pub fn paint(&self, side: f64) -> GoalPaint {
        match self.objects.has_coloured_goals {
            false => GoalPaint::White,
            true if side > 0.0 => GoalPaint::Yellow,
            true => GoalPaint::Blue,
        }
    }

    fn add_goal(&self, side: f64, solids: &mut Vec<Solid>) {
        let colour = match self.paint(side) {
            GoalPaint::White => WHITE,
            GoalPaint::Yellow => YELLOW,
            GoalPaint::Blue => BLUE,
        };
        let (field, radius) = (&self.markings, self.objects.post_radius);
        let (x, half) = (side * field.length / 2.0, field.goal_width / 2.0);
        for y in [-half, half] {
            let foot = Point2::new(x, y);
            solids.push(Solid::Column { foot, radius, from: 0.0, to: field.goal_height, colour });
        }
        let low = Point3::new(x - radius, -half - radius, field.goal_height - radius);
        let high = Point3::new(x + radius, half + radius, field.goal_height + radius);
        solids.push(Solid::Block { low, high, colour });
    }

    fn turn_of_ball(&self) -> [f64; 2] {
        let turn = |salt| std::f64::consts::TAU * hash(self.variant, salt, 7);
        [turn(1), turn(2)]
    }
}

fn jersey_colour(jersey: Jersey) -> Rgb {
    match jersey {
        Jersey::Blue => BLUE,
        Jersey::Red => RED,
        Jersey::Unknown => SHELL,
    }
}

fn add_standing(robot: &RobotFigure, solids: &mut Vec<Solid>) {
    let (sin, cos) = libm::sincos(robot.heading);
    let left = Vector2::new(-sin, cos);
    let column = |aside: f64, radius, from, to, colour| Solid::Column {
        foot: robot.position + left * aside,
        radius,
        from,
        to,
        colour,
    };
    for side in [-0.055, 0.055] {
        solids.push(column(side, 0.065, 0.0, 0.05, SHELL));
        solids.push(column(side, 0.047, 0.05, 0.27, SHELL));
    }
    for side in [-0.125, 0.125] {
        solids.push(column(side, 0.035, 0.22, 0.44, SHELL));
    }
    solids.push(column(0.0, 0.09, 0.25, 0.46, jersey_colour(robot.jersey)));
    let centre = Point3::new(robot.position.x, robot.position.y, 0.52);
    solids.push(Solid::Sphere { centre, radius: 0.065, pattern: Pattern::Plain(SHELL) });
}

/// A robot on its front: a row of spheres.
fn add_lying(robot: &RobotFigure, solids: &mut Vec<Solid>) {
    let (sin, cos) = libm::sincos(robot.heading);
    let parts = [
        (-0.22, 0.05, SHELL),
        (-0.10, 0.06, SHELL),
        (0.05, 0.09, jersey_colour(robot.jersey)),
        (0.22, 0.065, SHELL),
    ];
    solids.extend(parts.map(|(along, radius, colour)| Solid::Sphere {
        centre: Point3::new(robot.position.x + along * cos, robot.position.y + along * sin, radius),
        radius,
        pattern: Pattern::Plain(colour),
    }));
}

/// The length of a ray to the round wall of the room.
fn wall(origin: &Point3<f64>, ray: &Vector3<f64>) -> f64 {
    let a = ray.x * ray.x + ray.y * ray.y;
    let b = origin.x * ray.x + origin.y * ray.y;
    let c = origin.x * origin.x + origin.y * origin.y - WALL_DISTANCE * WALL_DISTANCE;
    let root = (b * b - a * c).max(0.0).sqrt();
    if a < 1e-12 { f64::MAX } else { (root - b) / a }
}

/// A number from 0 to 1 that depends on all three in no simple way (the finaliser of SplitMix64).
fn hash(seed: u64, x: i64, y: i64) -> f64 {
    let mut bits = seed
        .wrapping_add((x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15))
        .wrapping_add((y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f));
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
