//! Recall, false sightings and errors of distance on rendered sequences with known truth.
//!
//! A robot walks over the field, turns its head, and looks with the upper or the lower camera. The
//! pose that vision receives has errors of joints and inertial unit. The light changes from
//! sequence to sequence, and in some from image to image.
#![allow(dead_code, reason = "not all programs with this module use all of it")]

use std::fmt;

use monas_vision::render::{FieldMarkings, Light, Renderer, RobotFigure, Scene};
use monas_vision::{Camera, Detections, FieldObjects, GroundObject, HeadPose, Jersey, LineSegment, Vision};
use nalgebra::{Isometry2, Isometry3, Point2, Point3, UnitQuaternion, Vector2, Vector3};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

mod near;

/// The camera of a Nao of 2010: 47.8 degrees from left to right.
const ANGLE_OF_VIEW: f64 = 0.8343;
/// Standard deviation of the angles of joints and inertial unit, rad: about 0.15 degrees.
const ANGLE_ERROR: f64 = 0.0026;

/// The distances up to which objects have to be seen, m.
pub(crate) const BALL_RANGE: f64 = 3.0;
pub(crate) const POST_RANGE: f64 = 4.5;
pub(crate) const ROBOT_RANGE: f64 = 3.0;
pub(crate) const LINE_RANGE: f64 = 2.5;
pub(crate) const BORDER_RANGE: f64 = 4.0;

/// A light, from image to image of a sequence (its progress is from 0 to 1).
pub(crate) struct Condition {
    /// Chooses the random numbers of its sequences.
    pub(crate) number: u64,
    pub(crate) name: &'static str,
    pub(crate) light: fn(f64) -> Light,
}

/// The lights under which vision is measured.
pub(crate) const CONDITIONS: [Condition; 8] = [
    Condition { number: 0, name: "even", light: |_| camera_light() },
    Condition { number: 1, name: "dim", light: |_| Light { exposure: 0.45, noise: 6.0, ..camera_light() } },
    Condition { number: 2, name: "bright", light: |_| Light { exposure: 1.6, ..camera_light() } },
    Condition { number: 3, name: "warm", light: |_| Light { tint: [1.12, 1.0, 0.72], ..camera_light() } },
    Condition { number: 4, name: "cold", light: |_| Light { tint: [0.78, 1.0, 1.15], ..camera_light() } },
    Condition {
        number: 5,
        name: "window",
        light: |_| Light { slope: 0.16, direction: 0.9, ..camera_light() },
    },
    Condition { number: 6, name: "blurred", light: |_| Light { blur: 1.6, noise: 7.0, ..camera_light() } },
    Condition {
        number: 7,
        name: "changing",
        light: |progress| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * 2.0 * progress);
            Light {
                exposure: 1.0 + 0.5 * sin,
                tint: [1.0 + 0.12 * cos as f32, 1.0, 1.0 - 0.2 * cos as f32],
                slope: 0.1 * cos,
                direction: 6.0 * progress,
                ..camera_light()
            }
        },
    },
];

/// Light in which orange is nearly red and yellow nearly white: a colour table helps.
pub(crate) const LAMPS: Condition =
    Condition { number: 8, name: "lamps", light: |_| Light { tint: [1.2, 1.0, 0.4], ..camera_light() } };

/// From that light to the one of a cold day.
pub(crate) const LAMPS_TO_DAY: Condition = Condition {
    number: 9,
    name: "lamps, then day",
    light: |progress| {
        let part = progress as f32;
        Light { tint: [1.2 - 0.35 * part, 1.0, 0.4 + 0.7 * part], ..camera_light() }
    },
};

/// The light of a hall, and the noise and blur of a camera.
fn camera_light() -> Light {
    Light { noise: 3.5, blur: 0.7, ..Light::default() }
}

/// The visible and the detected objects of a kind.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// Objects that were in view and in range, and how many of them were seen.
    pub(crate) shown: u32,
    pub(crate) found: u32,
    /// Sightings of what was not there.
    pub(crate) wrong: u32,
    /// Errors of distance, as parts of the distance, and of direction, rad.
    pub(crate) distance_errors: Vec<f64>,
    pub(crate) bearing_errors: Vec<f64>,
}

impl Tally {
    pub(crate) fn recall(&self) -> f64 {
        f64::from(self.found) / f64::from(self.shown.max(1))
    }

    fn note(&mut self, sight: &GroundObject, truth: &Point2<f64>) {
        let distance = truth.coords.norm();
        self.distance_errors.push((sight.distance - distance).abs() / distance);
        self.bearing_errors.push((sight.bearing - libm::atan2(truth.y, truth.x)).abs());
    }

    fn add(&mut self, other: &Tally) {
        self.shown += other.shown;
        self.found += other.found;
        self.wrong += other.wrong;
        self.distance_errors.extend(&other.distance_errors);
        self.bearing_errors.extend(&other.bearing_errors);
    }
}

/// The mean of numbers.
pub(crate) fn mean(errors: &[f64]) -> f64 {
    // The `sum` of no numbers is -0.
    errors.iter().fold(0.0, |sum, error| sum + error) / errors.len().max(1) as f64
}

/// The number that nine of ten do not exceed.
pub(crate) fn ninth_decile(errors: &[f64]) -> f64 {
    let mut sorted = errors.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() * 9 / 10).copied().unwrap_or_default()
}

/// The results of sequences.
#[derive(Clone, Debug, Default)]
pub(crate) struct Measures {
    pub(crate) images: u32,
    pub(crate) ball: Tally,
    pub(crate) posts: Tally,
    pub(crate) robots: Tally,
    /// Points every 5 cm along lines.
    pub(crate) lines: Tally,
    /// Columns in which the border is within a fortieth of the height of the image.
    pub(crate) border: Tally,
    /// Straight parts of lines: the points every 5 cm that one covers, and parts that are on no
    /// line.
    pub(crate) segments: Tally,
    /// The number of straight parts that are on a line; their distance from it, m, and their angle
    /// to it, rad.
    pub(crate) right_segments: u32,
    pub(crate) segment_offsets: Vec<f64>,
    pub(crate) segment_angles: Vec<f64>,
    /// Points of the border: right ones, with the errors of distance, and wrong ones.
    pub(crate) border_points: Tally,
    /// Jerseys of the robots that were seen, and how many had the wrong colour.
    pub(crate) jerseys: u32,
    pub(crate) wrong_jerseys: u32,
}

impl Measures {
    pub(crate) fn add(&mut self, other: &Measures) {
        self.images += other.images;
        self.ball.add(&other.ball);
        self.posts.add(&other.posts);
        self.robots.add(&other.robots);
        self.lines.add(&other.lines);
        self.border.add(&other.border);
        self.segments.add(&other.segments);
        self.right_segments += other.right_segments;
        self.segment_offsets.extend(&other.segment_offsets);
        self.segment_angles.extend(&other.segment_angles);
        self.border_points.add(&other.border_points);
        self.jerseys += other.jerseys;
        self.wrong_jerseys += other.wrong_jerseys;
    }
}

impl Measures {
    /// The part of the straight parts that are on no line.
    pub(crate) fn false_segments(&self) -> f64 {
        f64::from(self.segments.wrong) / f64::from((self.right_segments + self.segments.wrong).max(1))
    }

    /// The part of the points of the border that are not on it.
    pub(crate) fn false_border_points(&self) -> f64 {
        let points = &self.border_points;
        f64::from(points.wrong) / f64::from((points.found + points.wrong).max(1))
    }
}

impl fmt::Display for Measures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let object = |tally: &Tally| {
            format!(
                "{:>5}{:>6.1}{:>5}{:>6.1}{:>6.1}{:>5.1}",
                tally.shown,
                100.0 * tally.recall(),
                tally.wrong,
                100.0 * mean(&tally.distance_errors),
                100.0 * ninth_decile(&tally.distance_errors),
                mean(&tally.bearing_errors).to_degrees()
            )
        };
        write!(
            f,
            "{} |{} |{} |{:>6.1}{:>6.1} |{:>6.1} |{:>6.1}{:>6.1}{:>5.1}{:>5.1} |{:>6.1}{:>6.1}",
            object(&self.ball),
            object(&self.posts),
            object(&self.robots),
            100.0 * self.lines.recall(),
            100.0 * f64::from(self.lines.wrong) / f64::from((self.lines.found + self.lines.wrong).max(1)),
            100.0 * self.border.recall(),
            100.0 * self.segments.recall(),
            100.0 * self.false_segments(),
            100.0 * mean(&self.segment_offsets),
            mean(&self.segment_angles).to_degrees(),
            100.0 * mean(&self.border_points.distance_errors),
            100.0 * self.false_border_points(),
        )
    }
}

/// The subject of the images of a sequence.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Views {
    /// A robot that looks around anywhere on the field.
    Field,
    /// Robots near the camera.
    NearRobots,
}

/// One sequence: 640 by 480 pixels unless `width` is less.
pub(crate) struct Sequence {
    pub(crate) views: Views,
    pub(crate) objects: FieldObjects,
    pub(crate) condition: &'static Condition,
    pub(crate) images: u32,
    pub(crate) width: usize,
    pub(crate) seed: u64,
}

impl Sequence {
    pub(crate) fn measure(&self) -> Measures {
        self.measure_with(Vision::new(self.objects))
    }

    /// As [`measure`](Sequence::measure), with a vision that may know colours.
    pub(crate) fn measure_with(&self, mut vision: Vision) -> Measures {
        let mut random = Random(Pcg64::seed_from_u64(self.seed * 100 + self.condition.number));
        let (mut renderer, mut pixels) = (Renderer::default(), Vec::new());
        let mut measures = Measures { images: self.images, ..Measures::default() };
        for number in 0..self.images {
            let view = match self.views {
                Views::Field => View::choose(&mut random, self),
                Views::NearRobots => near::choose(&mut random, self),
            };
            let progress = f64::from(number) / f64::from(self.images);
            let light = (self.condition.light)(progress);
            let camera = view.camera(&view.head, self.width, true);
            let seed = self.seed * 1000 + u64::from(number);
            let image = renderer.draw(&view.scene, &camera, &light, seed, &mut pixels).unwrap();
            let believed = view.camera(&view.believed_head(&mut random), self.width, false);
            let seen = vision.see(&image, &believed).unwrap();
            view.compare(seen, &camera, &mut measures);
        }
        measures
    }
}

/// Random numbers of a sequence.
struct Random(Pcg64);

impl Random {
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self, deviation: f64) -> f64 {
        let sum: f64 = (0..12).map(|_| self.uniform(-0.5, 0.5)).sum();
        deviation * sum
    }

    /// The pose of the upper or the lower camera, and whether it is the lower one.
    fn head(&mut self) -> (HeadPose, bool) {
        let is_lower = self.uniform(0.0, 1.0) < 0.35;
        let tilt = if is_lower { 0.64 } else { 0.0 };
        let head = HeadPose {
            height: 0.5,
            torso_roll: self.normal(0.03),
            torso_pitch: self.normal(0.02),
            yaw: self.uniform(-0.8, 0.8),
            pitch: self.uniform(-0.05, 0.35) + tilt,
        };
        (head, is_lower)
    }
}

/// Where the robot is at the time of an image, and what is around it.
struct View {
    scene: Scene,
    field_from_robot: Isometry2<f64>,
    head: HeadPose,
}

impl View {
    fn choose(random: &mut Random, sequence: &Sequence) -> View {
        let (head, is_lower) = random.head();
        let position = Vector2::new(random.uniform(-2.6, 2.6), random.uniform(-1.8, 1.8));
        let field_from_robot = Isometry2::new(position, random.uniform(-3.1, 3.1));
        // Most balls are in view, or nearly.
        let bearing = head.yaw + random.uniform(-0.5, 0.5);
        let near = libm::sqrt(random.uniform(0.0, 1.0)) * (BALL_RANGE + 0.5);
        let distance = if is_lower { random.uniform(0.15, 0.9) } else { near.max(0.6) };
        let (sin, cos) = libm::sincos(bearing);
        let ball = field_from_robot * Point2::new(distance * cos, distance * sin);
        let is_on_carpet = ball.x.abs() < 3.4 && ball.y.abs() < 2.4;
        let has_ball = random.uniform(0.0, 1.0) < 0.8 && is_on_carpet;
        let mut robots = Vec::new();
        for number in 0..3 {
            let position = Point2::new(random.uniform(-2.8, 2.8), random.uniform(-1.9, 1.9));
            let heading = random.uniform(-3.1, 3.1);
            let jersey = if number == 0 { Jersey::Blue } else { Jersey::Red };
            let away = |other: Point2<f64>| (other - position).norm();
            let own = Point2::from(field_from_robot.translation.vector);
            if away(own) > 0.5 && (!has_ball || away(ball) > 0.35) {
                robots.push(RobotFigure { position, heading, jersey, lies: false });
            }
        }
        let scene = Scene {
            markings: FieldMarkings::default(),
            objects: sequence.objects,
            ball: has_ball.then_some(ball),
            robots,
            variant: random.0.next_u64(),
        };
        View { scene, field_from_robot, head }
    }

    /// The angles that the robot measures.
    fn believed_head(&self, random: &mut Random) -> HeadPose {
        HeadPose {
            torso_roll: self.head.torso_roll + random.normal(ANGLE_ERROR),
            torso_pitch: self.head.torso_pitch + random.normal(ANGLE_ERROR),
            yaw: self.head.yaw + random.normal(ANGLE_ERROR),
            pitch: self.head.pitch + random.normal(ANGLE_ERROR),
            ..self.head
        }
    }

    /// The camera, in the frame of the field or of the robot.
    fn camera(&self, head: &HeadPose, width: usize, on_field: bool) -> Camera {
        let pose = head.robot_from_camera();
        let translation = self.field_from_robot.translation.vector;
        let field_from_robot = Isometry3::from_parts(
            Vector3::new(translation.x, translation.y, 0.0).into(),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.field_from_robot.rotation.angle()),
        );
        let pose = if on_field { field_from_robot * pose } else { pose };
        Camera::new(width, width * 3 / 4, ANGLE_OF_VIEW, &pose).unwrap()
    }

    fn to_robot(&self, point: Point2<f64>) -> Point2<f64> {
        self.field_from_robot.inverse() * point
    }

    /// Whether a robot or a post, other than at `except`, is between the camera and a point.
    fn is_hidden(&self, point: Point2<f64>, except: Option<Point2<f64>>, margin: f64) -> bool {
        let target = self.to_robot(point);
        let robots = self.scene.robots.iter().map(|robot| (robot.position, 0.17));
        let posts = self.posts().map(|post| (post, 0.06));
        robots.chain(posts).filter(|(at, _)| except.is_none_or(|it| (it - at).norm() > 1e-9)).any(
            |(at, radius)| {
                let at = self.to_robot(at);
                let along = at.coords.dot(&target.coords) / target.coords.norm();
                let beside = (at.x * target.y - at.y * target.x).abs() / target.coords.norm();
                along > 0.0 && along < target.coords.norm() + 0.1 && beside < radius + margin
            },
        )
    }

    fn posts(&self) -> impl Iterator<Item = Point2<f64>> {
        let (x, y) = (self.scene.markings.length / 2.0, self.scene.markings.goal_width / 2.0);
        [(x, y), (x, -y), (-x, y), (-x, -y)].into_iter().map(|(x, y)| Point2::new(x, y))
    }

    fn compare(&self, seen: &Detections, camera: &Camera, measures: &mut Measures) {
        self.compare_ball(seen, camera, &mut measures.ball);
        self.compare_posts(seen, camera, &mut measures.posts);
        self.compare_robots(seen, camera, measures);
        self.compare_lines(seen, camera, &mut measures.lines);
        self.compare_border(seen, camera, &mut measures.border);
        self.compare_segments(seen, camera, measures);
        self.compare_border_points(seen, &mut measures.border_points);
    }

    fn compare_ball(&self, seen: &Detections, camera: &Camera, tally: &mut Tally) {
        let radius = self.scene.objects.ball_radius;
        let truth = self.scene.ball.map(|ball| (ball, self.to_robot(ball)));
        if let Some((ball, own)) = truth
            && within(camera, Point3::new(ball.x, ball.y, radius), 1.2 * radius)
            && own.coords.norm() <= BALL_RANGE
            && !self.is_hidden(ball, None, radius)
        {
            tally.shown += 1;
            if let Some(sight) = seen.ball.as_ref().filter(|sight| is_near(sight, &own, 0.2)) {
                tally.found += 1;
                tally.note(sight, &own);
            }
        }
        let is_true = |sight: &GroundObject| truth.is_some_and(|(_, own)| is_near(sight, &own, 0.25));
        tally.wrong += u32::from(seen.ball.as_ref().is_some_and(|sight| !is_true(sight)));
    }

    fn compare_posts(&self, seen: &Detections, camera: &Camera, tally: &mut Tally) {
        for post in self.posts() {
            let own = self.to_robot(post);
            let is_shown = within(camera, Point3::new(post.x, post.y, 0.0), 0.06)
                && within(camera, Point3::new(post.x, post.y, 0.5), 0.06);
            if !is_shown || own.coords.norm() > POST_RANGE || self.is_hidden(post, Some(post), 0.08) {
                continue;
            }
            tally.shown += 1;
            if let Some(found) = seen.posts.iter().find(|found| is_near(&found.sight, &own, 0.2)) {
                tally.found += 1;
                tally.note(&found.sight, &own);
            }
        }
        let is_true =
            |sight: &GroundObject| self.posts().any(|post| is_near(sight, &self.to_robot(post), 0.3));
        tally.wrong += seen.posts.iter().filter(|post| !is_true(&post.sight)).count() as u32;
    }

    fn compare_robots(&self, seen: &Detections, camera: &Camera, measures: &mut Measures) {
        let tally = &mut measures.robots;
        for robot in &self.scene.robots {
            let own = self.to_robot(robot.position);
            let is_shown = within(camera, Point3::new(robot.position.x, robot.position.y, 0.0), 0.15)
                && within(camera, Point3::new(robot.position.x, robot.position.y, 0.35), 0.15);
            let hidden = self.is_hidden(robot.position, Some(robot.position), 0.15);
            // A robot that lies is not higher than a ball.
            if robot.lies || !is_shown || own.coords.norm() > ROBOT_RANGE || hidden {
                continue;
            }
            tally.shown += 1;
            if let Some(found) = seen.robots.iter().find(|found| is_near(&found.sight, &own, 0.2)) {
                tally.found += 1;
                tally.note(&found.sight, &own);
                measures.jerseys += 1;
                measures.wrong_jerseys += u32::from(found.jersey != robot.jersey);
            }
        }
        let things = || self.scene.robots.iter().map(|robot| robot.position).chain(self.posts());
        let is_true =
            |sight: &GroundObject| things().any(|thing| is_near(sight, &self.to_robot(thing), 0.35));
        tally.wrong += seen.robots.iter().filter(|robot| !is_true(&robot.sight)).count() as u32;
    }

    /// The points of lines that are in view and in range, in the frame of the robot.
    fn shown_line_points(&self, camera: &Camera) -> Vec<Point2<f64>> {
        let is_shown = |point: &Point2<f64>| {
            let near_ball = |ball: Point2<f64>| (ball - point).norm() < 0.2;
            self.to_robot(*point).coords.norm() <= LINE_RANGE
                && within(camera, Point3::new(point.x, point.y, 0.0), 0.05)
                && !self.is_hidden(*point, None, 0.1)
                && !self.scene.ball.is_some_and(near_ball)
        };
        line_points(&self.scene.markings).filter(is_shown).map(|point| self.to_robot(point)).collect()
    }

    /// Straight parts of lines: which points of lines they cover, and where and how they lie.
    fn compare_segments(&self, seen: &Detections, camera: &Camera, measures: &mut Measures) {
        /// Greatest angle to the line, rad.
        const MOST_ANGLE: f64 = 0.2;
        let near: Vec<[Point2<f64>; 2]> = seen
            .lines
            .iter()
            .map(|line| line.ends.map(|end| end.position))
            .filter(|ends| ends.iter().all(|end| end.coords.norm() < LINE_RANGE))
            .collect();
        for own in self.shown_line_points(camera) {
            measures.segments.shown += 1;
            let tolerance = 0.08 + 0.03 * own.coords.norm();
            let is_covered = |line: &LineSegment| {
                let [a, b] = line.ends.map(|end| end.position);
                let part = ((own - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
                (a + (b - a) * part - own).norm() < tolerance
            };
            measures.segments.found += u32::from(seen.lines.iter().any(is_covered));
        }
        for [a, b] in near {
            let middle = nalgebra::center(&a, &b);
            let truth = strokes(&self.scene.markings).into_iter().map(|stroke| {
                let positions =
                    [0.1, 0.3, 0.5, 0.7, 0.9].map(|part| self.field_from_robot * (a + (b - a) * part));
                let offset = positions.iter().map(|position| stroke.distance(position)).sum::<f64>() / 5.0;
                let along = stroke.direction(&(self.field_from_robot * middle));
                let distance = self.field_from_robot.rotation * (b - a).normalize();
                (offset, libm::asin(distance.perp(&along).abs().min(1.0)))
            });
            let (offset, angle) = truth.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            let tolerance = 0.06 + 0.04 * middle.coords.norm();
            if offset > tolerance || angle > MOST_ANGLE {
                measures.segments.wrong += 1;
                continue;
            }
            measures.right_segments += 1;
            measures.segment_offsets.push(offset);
            measures.segment_angles.push(angle);
        }
    }

    /// The distance of the points of the border, along their direction.
    fn compare_border_points(&self, seen: &Detections, tally: &mut Tally) {
        let field = &self.scene.markings;
        let (length, width) = (field.length / 2.0 + field.border, field.width / 2.0 + field.border);
        for point in seen.border_points.iter().map(|point| point.position) {
            let distance = point.coords.norm();
            let origin = Point2::from(self.field_from_robot.translation.vector);
            let ray = self.field_from_robot.rotation * point.coords.normalize();
            let until =
                |at: f64, ray: f64, end: f64| if ray > 0.0 { (end - at) / ray } else { (-end - at) / ray };
            let truth = until(origin.x, ray.x, length).min(until(origin.y, ray.y, width));
            let error = (distance - truth).abs() / truth;
            if truth > BORDER_RANGE {
                continue;
            }
            if error > 0.2 {
                tally.wrong += 1;
            } else {
                tally.found += 1;
                tally.distance_errors.push(error);
            }
        }
    }

    fn compare_lines(&self, seen: &Detections, camera: &Camera, tally: &mut Tally) {
        for own in self.shown_line_points(camera) {
            tally.shown += 1;
            let tolerance = 0.06 + 0.03 * own.coords.norm();
            let is_found = seen.line_points.iter().any(|found| (found.position - own).norm() < tolerance);
            tally.found += u32::from(is_found);
        }
        let is_line = |found: &Point2<f64>| {
            let tolerance = 0.06 + 0.04 * found.coords.norm();
            line_points(&self.scene.markings).any(|point| (self.to_robot(point) - found).norm() < tolerance)
        };
        let near = seen.line_points.iter().filter(|point| point.position.coords.norm() < LINE_RANGE);
        tally.wrong += near.filter(|point| !is_line(&point.position)).count() as u32;
    }

    fn compare_border(&self, seen: &Detections, camera: &Camera, tally: &mut Tally) {
        let field = &self.scene.markings;
        let (length, width) = (field.length / 2.0 + field.border, field.width / 2.0 + field.border);
        let is_carpet = |x: f64, y: f64| {
            camera.point_at_height(x, y, 0.0).is_some_and(|p| p.x.abs() < length && p.y.abs() < width)
        };
        let height = camera.height() as f64;
        for column in (8..camera.width()).step_by(camera.width() / 20) {
            let x = column as f64;
            let Some(row) = (0..camera.height()).find(|&row| is_carpet(x, row as f64 + 0.5)) else {
                continue;
            };
            tally.shown += 1;
            let is_found = seen.border_at(x).is_some_and(|found| (found - row as f64).abs() < height / 40.0);
            tally.found += u32::from(is_found);
        }
    }
}

/// Whether the image shows a point with a margin of `radius` metres.
fn within(camera: &Camera, point: Point3<f64>, radius: f64) -> bool {
    camera.project(&point).is_some_and(|(x, y, depth)| {
        let margin = camera.focal() * radius / depth;
        x > margin && y > margin && x < camera.width() as f64 - margin && y < camera.height() as f64 - margin
    })
}

/// Whether a sighting is of an object: within a part of its distance, and at least 12 cm.
fn is_near(sight: &GroundObject, truth: &Point2<f64>, part: f64) -> bool {
    (sight.position() - truth).norm() < (part * truth.coords.norm()).max(0.12)
}

/// A line of the field, in its frame.
enum Stroke {
    Straight(Point2<f64>, Point2<f64>),
    /// The centre circle, with its radius.
    Circle(f64),
}

impl Stroke {
    fn distance(&self, point: &Point2<f64>) -> f64 {
        match self {
            Stroke::Straight(a, b) => {
                let part = ((point - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
                (a + (b - a) * part - point).norm()
            }
            Stroke::Circle(radius) => (point.coords.norm() - radius).abs(),
        }
    }

    /// The direction of the line at a point of it.
    fn direction(&self, point: &Point2<f64>) -> Vector2<f64> {
        match self {
            Stroke::Straight(a, b) => (b - a).normalize(),
            Stroke::Circle(_) => Vector2::new(-point.y, point.x).normalize(),
        }
    }
}

/// The lines of the field and the circle.
fn strokes(field: &FieldMarkings) -> Vec<Stroke> {
    let straight = straight_strokes(field)
        .map(|[from, to]| Stroke::Straight(Point2::new(from.0, from.1), Point2::new(to.0, to.1)));
    straight.into_iter().chain([Stroke::Circle(field.centre_circle_radius)]).collect()
}

fn straight_strokes(field: &FieldMarkings) -> [[(f64, f64); 2]; 11] {
    let (length, width) = (field.length / 2.0, field.width / 2.0);
    let (front, side) = (length - field.goal_area_depth, field.goal_area_width / 2.0);
    [
        [(-length, width), (length, width)],
        [(-length, -width), (length, -width)],
        [(-length, -width), (-length, width)],
        [(length, -width), (length, width)],
        [(0.0, -width), (0.0, width)],
        [(front, -side), (front, side)],
        [(-front, -side), (-front, side)],
        [(front, side), (length, side)],
        [(front, -side), (length, -side)],
        [(-front, side), (-length, side)],
        [(-front, -side), (-length, -side)],
    ]
}

/// Points every 5 cm along the lines, without those where lines meet.
fn line_points(field: &FieldMarkings) -> impl Iterator<Item = Point2<f64>> {
    let radius = field.centre_circle_radius;
    let straight = straight_strokes(field).into_iter().flat_map(|[from, to]| {
        let (from, to) = (Point2::new(from.0, from.1), Point2::new(to.0, to.1));
        let count = ((to - from).norm() / 0.05) as usize;
        (0..=count).map(move |k| from + (to - from) * (k as f64 / count as f64))
    });
    let around = (0..75).map(move |k| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 75.0);
        Point2::new(radius * cos, radius * sin)
    });
    let marks = [field.mark_distance, -field.mark_distance].map(|x| Point2::new(x, 0.0));
    straight.chain(around).chain(marks)
}
