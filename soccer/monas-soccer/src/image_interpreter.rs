//! Derives sightings, lines and border from images.

use monas_robot::{Colour, FieldColours, Image, Images, ObjectKind, ObjectSet, Sensors, Sighting, Sightings};
use monas_vision::{
    Camera, FieldObjects, GoalPaint, GoalPost, GroundObject, GroundPoint, HeadPose, Jersey, LineSegment,
    PostSide, Vision,
};
use nalgebra::Point2;

use crate::field_colours::colour_model;
use crate::{FieldLine, FieldLines, FieldPoint};

/// Interprets the images of a robot's cameras: derives from pixels what other bodies deliver as
/// finished sightings.
///
/// The pose of a camera follows from the head joints and the inclination of the torso at the time
/// of the image. The appearance of ball and goals, and the initial colours of the calibration, are
/// in the message of the images: the source of the images knows the field, so that roles do not
/// depend on it.
#[derive(Clone, Debug, Default)]
pub struct ImageInterpreter {
    /// None before the first images: most bodies deliver none, and its table of colours takes a
    /// while to compute.
    vision: Option<Vision>,
    /// The appearance of the objects that `vision` detects.
    objects: ObjectSet,
    /// The colours of the images with which the calibration began.
    colours: Option<FieldColours>,
}

/// The interpretation of a set of images.
#[derive(Clone, Debug, PartialEq)]
pub struct Interpretation {
    /// Ball, posts and robots.
    pub sightings: Sightings,
    /// Field lines and the border of the field.
    pub lines: FieldLines,
}

/// The most lines, and the most points of the border, of a message.
const MOST_LINES: usize = 32;
const MOST_POINTS: usize = 32;

/// Directions of two posts below which they are one, rad.
const SAME_POST: f64 = 0.12;

impl ImageInterpreter {
    /// Interprets images, with the sensor readings of the time when they were taken.
    ///
    /// # Errors
    /// An image has no possible size or camera, or its bytes are not those of its size.
    pub fn interpret(
        &mut self,
        images: &Images,
        sensors: &Sensors,
    ) -> Result<Interpretation, monas_vision::Error> {
        self.begin_anew(images);
        let mut sightings = Sightings {
            taken_at: images.taken_at,
            head_yaw: sensors.head_yaw,
            head_pitch: sensors.head_pitch,
            objects: Vec::new(),
        };
        // The lower camera first: it shows the feet of what both show.
        let mut order: Vec<&Image> = images.images.iter().collect();
        order.sort_by(|a, b| b.camera_tilt.total_cmp(&a.camera_tilt));
        let (mut lines, mut border) = (Vec::new(), Vec::new());
        for image in order {
            self.add(image, sensors, &mut sightings.objects, &mut lines, &mut border)?;
        }
        let lines = FieldLines { taken_at: images.taken_at, lines: longest(lines), border: spread(border) };
        Ok(Interpretation { sightings, lines })
    }

    /// Begins the calibration anew if the images have other objects or colours than those before.
    fn begin_anew(&mut self, images: &Images) {
        let has_new_colours = images.colours.is_some() && images.colours != self.colours;
        if has_new_colours {
            self.colours.clone_from(&images.colours);
        }
        if has_new_colours || images.objects() != self.objects {
            self.objects = images.objects();
            self.vision = None;
        }
    }

    fn vision(&mut self) -> &mut Vision {
        self.vision.get_or_insert_with(|| {
            let objects = field_objects(self.objects);
            match &self.colours {
                Some(colours) => Vision::starting_from(objects, colour_model(colours)),
                None => Vision::new(objects),
            }
        })
    }

    fn add(
        &mut self,
        message: &Image,
        sensors: &Sensors,
        objects: &mut Vec<Sighting>,
        lines: &mut Vec<LineSegment>,
        border: &mut Vec<GroundPoint>,
    ) -> Result<(), monas_vision::Error> {
        let (width, height) = (message.width as usize, message.height as usize);
        let image = monas_vision::Image::new(width, height, &message.pixels)?;
        let head = HeadPose {
            height: message.camera_height,
            torso_roll: sensors.torso_roll,
            torso_pitch: sensors.torso_pitch,
            yaw: sensors.head_yaw,
            pitch: sensors.head_pitch + message.camera_tilt,
        };
        let camera = Camera::new(width, height, message.angle_of_view, &head.robot_from_camera())?;
        let ball_colour = match self.objects {
            ObjectSet::Of2010 => Colour::Orange,
            ObjectSet::OfToday => Colour::White,
        };
        let seen = self.vision().see(&image, &camera)?;
        lines.extend_from_slice(&seen.lines);
        border.extend_from_slice(&seen.border_points);
        let is_known =
            |objects: &[Sighting], found: &Sighting| objects.iter().any(|known| is_same(known, found));
        let ball = seen.ball.iter().map(|ball| sighting(ObjectKind::Ball, ball_colour, ball));
        let posts = seen.posts.iter().map(post);
        let robots = seen.robots.iter().map(|robot| {
            let colour = match robot.jersey {
                Jersey::Blue => Colour::Blue,
                Jersey::Red => Colour::Red,
                Jersey::Unknown => Colour::NoColour,
            };
            sighting(ObjectKind::Robot, colour, &robot.sight)
        });
        for found in ball.chain(posts).chain(robots) {
            if !is_known(objects, &found) {
                objects.push(found);
            }
        }
        Ok(())
    }
}

fn field_objects(objects: ObjectSet) -> FieldObjects {
    match objects {
        ObjectSet::Of2010 => FieldObjects::OF_2010,
        ObjectSet::OfToday => FieldObjects::OF_TODAY,
    }
}

/// The longest lines, without those that lie on a longer one: both cameras may show the same.
fn longest(mut lines: Vec<LineSegment>) -> Vec<FieldLine> {
    lines.sort_by(|a, b| b.length().total_cmp(&a.length()));
    let mut kept: Vec<LineSegment> = Vec::new();
    for line in lines {
        if kept.len() < MOST_LINES && !kept.iter().any(|longer| lies_on(&line, longer)) {
            kept.push(line);
        }
    }
    let message = |line: &LineSegment| {
        let [a, b] = line.ends.map(|end| end.position);
        FieldLine { x1: a.x, y1: a.y, x2: b.x, y2: b.y }
    };
    kept.iter().map(message).collect()
}

/// Whether the ends of a line are on another, or near it.
fn lies_on(line: &LineSegment, other: &LineSegment) -> bool {
    /// Distance that is near, m: lines of a field are farther apart.
    const SAME_LINE_DISTANCE: f64 = 0.12;
    let [a, b] = other.ends.map(|end| end.position);
    let along = (b - a) / (b - a).norm().max(1e-9);
    let is_on = |point: Point2<f64>| {
        let away = point - a;
        let position = away.dot(&along);
        away.perp(&along).abs() < SAME_LINE_DISTANCE
            && position > -SAME_LINE_DISTANCE
            && position < (b - a).norm() + SAME_LINE_DISTANCE
    };
    line.ends.iter().all(|end| is_on(end.position))
}

/// As many points as a message holds, evenly chosen.
fn spread(points: Vec<GroundPoint>) -> Vec<FieldPoint> {
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let point = |point: &GroundPoint| FieldPoint { x: point.position.x, y: point.position.y };
    points.iter().step_by(every).map(point).collect()
}

/// Whether two sightings from different cameras show the same object.
fn is_same(known: &Sighting, found: &Sighting) -> bool {
    let is_post = |kind| matches!(kind, ObjectKind::LeftPost | ObjectKind::RightPost | ObjectKind::SomePost);
    let beside = (known.bearing - found.bearing).abs();
    match (known.kind(), found.kind()) {
        (ObjectKind::Ball, ObjectKind::Ball) => true,
        (a, b) if is_post(a) && is_post(b) => known.colour == found.colour && beside < SAME_POST,
        (ObjectKind::Robot, ObjectKind::Robot) => beside * known.distance < 0.3,
        _ => false,
    }
}

fn post(post: &GoalPost) -> Sighting {
    let kind = match post.side {
        PostSide::Left => ObjectKind::LeftPost,
        PostSide::Right => ObjectKind::RightPost,
        PostSide::Unknown => ObjectKind::SomePost,
    };
    let colour = match post.paint {
        GoalPaint::Yellow => Colour::Yellow,
        GoalPaint::Blue => Colour::Blue,
        GoalPaint::White => Colour::White,
    };
    sighting(kind, colour, &post.sight)
}

fn sighting(kind: ObjectKind, colour: Colour, sight: &GroundObject) -> Sighting {
    Sighting { kind: kind.into(), bearing: sight.bearing, distance: sight.distance, colour: colour.into() }
}

#[cfg(test)]
mod tests {
    use monas_vision::render::{Light, Renderer, Scene};

    use super::*;

    #[test]
    fn a_broken_image_is_an_error() {
        let image =
            Image { width: 64, height: 48, angle_of_view: 0.8, camera_height: 0.5, ..Image::default() };
        let images = Images { taken_at: 1, images: vec![image], ..Images::default() };
        let error = ImageInterpreter::default().interpret(&images, &Sensors::default()).unwrap_err();
        assert_eq!(error.kind(), monas_vision::ErrorKind::Length);
    }

    /// An image of a ball 1 m ahead and of a goal 2 m behind it, with the objects of a time.
    fn image(objects: ObjectSet) -> Images {
        let (width, height, angle_of_view, camera_height) = (640, 480, 0.8343, 0.5);
        let head = HeadPose { height: camera_height, pitch: 0.25, ..HeadPose::default() };
        let camera = Camera::new(width, height, angle_of_view, &head.robot_from_camera()).unwrap();
        let scene = Scene {
            markings: Default::default(),
            objects: field_objects(objects),
            ball: Some(Point2::new(1.0, 0.0)),
            robots: vec![],
            variant: 1,
        };
        let mut pixels = Vec::new();
        Renderer::default().draw(&scene, &camera, &Light::default(), 1, &mut pixels).unwrap();
        let (width, height) = (width as u32, height as u32);
        let image = Image { width, height, angle_of_view, camera_height, camera_tilt: 0.25, pixels };
        Images { images: vec![image], objects: objects.into(), ..Images::default() }
    }

    #[test]
    fn it_looks_for_the_objects_that_images_have() {
        let mut interpreter = ImageInterpreter::default();
        let mut colours = |images: &Images| {
            let seen = interpreter.interpret(images, &Sensors::default()).unwrap().sightings.objects;
            let of = |is_it: fn(ObjectKind) -> bool| {
                seen.iter().filter(|one| is_it(one.kind())).map(Sighting::colour).collect::<Vec<_>>()
            };
            (of(|kind| kind == ObjectKind::Ball), of(|kind| kind != ObjectKind::Ball))
        };
        let (today, of_2010) = (image(ObjectSet::OfToday), image(ObjectSet::Of2010));
        assert_eq!(colours(&of_2010), (vec![Colour::Orange], vec![Colour::Yellow; 2]));
        assert_eq!(colours(&today), (vec![Colour::White], vec![Colour::White; 2]));
        assert_eq!(colours(&of_2010), (vec![Colour::Orange], vec![Colour::Yellow; 2]));
        let unmarked = Images { objects: ObjectSet::Of2010.into(), ..today };
        assert_eq!(colours(&unmarked).0, [], "no orange ball is there");
    }

    #[test]
    fn a_post_in_both_images_counts_once() {
        let sight = |kind, bearing, colour: Colour| Sighting {
            kind: i32::from(kind),
            bearing,
            distance: 2.0,
            colour: colour.into(),
        };
        let known = sight(ObjectKind::SomePost, 0.2, Colour::Blue);
        assert!(is_same(&known, &sight(ObjectKind::LeftPost, 0.25, Colour::Blue)));
        assert!(!is_same(&known, &sight(ObjectKind::LeftPost, 0.25, Colour::Yellow)));
        assert!(!is_same(&known, &sight(ObjectKind::LeftPost, 0.6, Colour::Blue)));
    }
}
