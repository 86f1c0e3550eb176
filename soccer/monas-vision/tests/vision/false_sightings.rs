//! No ball, post or robot is detected where there is none: near robots, near robots that lie, and
//! on carpet that a light bleaches.
#![allow(clippy::unwrap_used, reason = "a test")]

use monas_vision::render::{Light, Renderer, RobotFigure, Scene};
use monas_vision::{Camera, Detections, FieldObjects, HeadPose, Image, Jersey, Vision};
use nalgebra::{Isometry3, Point2};

use crate::examines_large_images;
use crate::measure::{CONDITIONS, Measures, Sequence, Views};

/// The sum over all lights of images of robots at 0.4 to 1.5 m.
fn near_robots(objects: FieldObjects, width: usize) -> Measures {
    let mut all = Measures::default();
    for condition in &CONDITIONS {
        let views = Views::NearRobots;
        all.add(&Sequence { views, objects, condition, images: 40, width, seed: 1 }.measure());
    }
    println!("{all}");
    all
}

/// Checks the measures; `robots` are the most false ones, `segments` the greatest part of the
/// straight parts of lines that are on no line.
fn check_near_robots(all: &Measures, robots: u32, segments: f64) {
    assert_eq!(all.images, 320);
    assert!(all.posts.wrong <= 1, "{} false posts", all.posts.wrong);
    assert!(all.robots.wrong <= robots, "{} false robots", all.robots.wrong);
    assert!(all.ball.wrong <= 1, "{} false balls", all.ball.wrong);
    assert!(all.false_segments() <= segments, "{} false parts of lines", all.segments.wrong);
    assert!(all.posts.shown >= 40 && all.posts.recall() >= 0.97, "posts: {}", all.posts.recall());
    assert!(all.robots.shown >= 12 && all.robots.recall() >= 0.85, "robots: {}", all.robots.recall());
    assert!(all.ball.shown >= 25 && all.ball.recall() >= 0.96, "ball: {}", all.ball.recall());
}

#[test]
fn near_robots_are_no_white_posts() {
    if examines_large_images() {
        check_near_robots(&near_robots(FieldObjects::OF_TODAY, 640), 1, 0.01);
    }
}

#[test]
fn near_robots_are_no_white_posts_in_small_images() {
    check_near_robots(&near_robots(FieldObjects::OF_TODAY, 320), 3, 0.015);
}

#[test]
fn near_robots_are_no_coloured_posts() {
    if examines_large_images() {
        check_near_robots(&near_robots(FieldObjects::OF_2010, 640), 1, 0.01);
    }
}

/// A camera in the middle of the field that looks along it.
fn camera(pitch: f64) -> Camera {
    let pose = HeadPose { height: 0.5, pitch, ..HeadPose::default() };
    let robot_from_camera: Isometry3<f64> = pose.robot_from_camera();
    Camera::new(640, 480, 0.8343, &robot_from_camera).unwrap()
}

/// Draws a scene, changes its pixels, and looks at them.
fn see(robots: Vec<RobotFigure>, camera: &Camera, change: impl Fn(&mut [u8])) -> Detections {
    let objects = FieldObjects::OF_TODAY;
    let scene = Scene { markings: Default::default(), objects, ball: None, robots, variant: 1 };
    let (mut pixels, light) = (Vec::new(), Light { noise: 3.5, blur: 0.7, ..Light::default() });
    Renderer::default().draw(&scene, camera, &light, 1, &mut pixels).unwrap();
    change(&mut pixels);
    let image = Image::new(640, 480, &pixels).unwrap();
    Vision::new(objects).see(&image, camera).unwrap().clone()
}

#[test]
fn a_robot_that_lies_is_no_ball() {
    let camera = camera(0.5);
    for number in 0..60 {
        let heading = 0.7 * f64::from(number);
        let position = Point2::new(1.0 + 0.01 * f64::from(number), 0.0);
        let jersey = if number % 2 == 0 { Jersey::Red } else { Jersey::Blue };
        let robot = RobotFigure { position, heading, jersey, lies: true };
        let seen = see(vec![robot], &camera, |_| {});
        assert_eq!(seen.ball, None, "a robot lies at {position} with heading {heading}");
    }
}

/// Makes a round patch of an image white: in its middle all, towards its edge less and less.
fn bleach(pixels: &mut [u8], middle: [f64; 2], radius: f64) {
    for (index, pair) in pixels.chunks_exact_mut(4).enumerate() {
        let (x, y) = (2.0 * (index % 320) as f64, (index / 320) as f64);
        let away = libm::hypot(x - middle[0], y - middle[1]) / radius;
        let part = (1.0 - away).max(0.0);
        for (byte, white) in pair.iter_mut().zip([235.0, 128.0, 235.0, 128.0]) {
            *byte = (f64::from(*byte) + part * (white - f64::from(*byte))) as u8;
        }
    }
}

#[test]
fn carpet_that_a_light_bleaches_is_no_robot() {
    let camera = camera(0.15);
    for radius in [170.0, 200.0, 240.0] {
        for x in [200.0, 320.0, 440.0] {
            let seen = see(Vec::new(), &camera, |pixels| bleach(pixels, [x, 190.0], radius));
            assert!(!seen.border.is_empty());
            assert_eq!(seen.robots, [], "a patch of {radius} pixels at {x}");
        }
    }
}

#[test]
fn a_robot_in_a_patch_of_light_is_seen() {
    let robot =
        RobotFigure { position: Point2::new(2.2, 0.0), heading: 0.3, jersey: Jersey::Red, lies: false };
    let seen = see(vec![robot], &camera(0.15), |pixels| bleach(pixels, [320.0, 130.0], 100.0));
    assert_eq!(seen.robots.len(), 1, "{:?}", seen.robots);
    assert!((seen.robots[0].sight.distance - 2.2).abs() < 0.2, "{:?}", seen.robots);
}
