//! The time of an image on one core: `cargo bench -p monas-vision --bench see`.
//!
//! The images are rendered with ball, robots, goal and lines in view, with noise and blur. `draw`
//! is the time of rendering one, for comparison.
#![allow(clippy::unwrap_used, reason = "a bench that cannot go on ends")]

use divan::Bencher;
use monas_vision::render::{Light, Renderer, RobotFigure, Scene};
use monas_vision::{Camera, ColourModel, FieldObjects, HeadPose, Image, Jersey, ObjectHue, Vision};
use nalgebra::Point2;

fn main() {
    divan::main();
}

fn scene(objects: FieldObjects) -> Scene {
    let robot = |x, y, jersey| RobotFigure { position: Point2::new(x, y), heading: 1.0, jersey, lies: false };
    Scene {
        markings: Default::default(),
        objects,
        ball: Some(Point2::new(1.2, 0.1)),
        robots: vec![robot(2.0, 0.5, Jersey::Red), robot(2.4, -0.6, Jersey::Blue)],
        variant: 1,
    }
}

fn camera(width: usize) -> Camera {
    let pose = HeadPose { height: 0.5, pitch: 0.15, ..HeadPose::default() }.robot_from_camera();
    Camera::new(width, width * 3 / 4, 0.8343, &pose).unwrap()
}

fn pixels(objects: FieldObjects, width: usize) -> Vec<u8> {
    let mut pixels = Vec::new();
    let light = Light { noise: 3.5, blur: 0.7, ..Light::default() };
    Renderer::default().draw(&scene(objects), &camera(width), &light, 1, &mut pixels).unwrap();
    pixels
}

fn see(bencher: Bencher<'_, '_>, objects: FieldObjects, width: usize) {
    let (camera, pixels) = (camera(width), pixels(objects, width));
    let image = Image::new(width, width * 3 / 4, &pixels).unwrap();
    let mut vision = Vision::new(objects);
    bencher.bench_local(|| vision.see(&image, &camera).unwrap().ball.unwrap().distance);
}

#[divan::bench(args = [640, 320, 160])]
fn orange_ball(bencher: Bencher<'_, '_>, width: usize) {
    see(bencher, FieldObjects::OF_2010, width);
}

#[divan::bench(args = [640, 320])]
fn black_and_white_ball(bencher: Bencher<'_, '_>, width: usize) {
    see(bencher, FieldObjects::OF_TODAY, width);
}

/// Light that changes from image to image, so that each changes the whole table, with measured
/// hues.
#[divan::bench(args = [640, 320])]
fn changing_light(bencher: Bencher<'_, '_>, width: usize) {
    let objects = FieldObjects::OF_2010;
    let camera = camera(width);
    let images = [0.5, 1.3].map(|exposure| {
        let light = Light { noise: 3.5, blur: 0.7, exposure, ..Light::default() };
        let mut pixels = Vec::new();
        Renderer::default().draw(&scene(objects), &camera, &light, 1, &mut pixels).unwrap();
        pixels
    });
    let hue = |chroma| Some(ObjectHue { chroma, width: 0.12 });
    let hues = [hue([-0.46, 0.56]), hue([-0.49, 0.16]), hue([0.9, -0.5]), hue([-0.3, 1.0])];
    let mut vision = Vision::starting_from(objects, ColourModel { hues, ..ColourModel::default() });
    let mut number = 0;
    bencher.bench_local(|| {
        number += 1;
        let image = Image::new(width, width * 3 / 4, &images[number % 2]).unwrap();
        vision.see(&image, &camera).unwrap().line_points.len()
    });
}

#[divan::bench(args = [640, 320], sample_count = 10)]
fn draw(bencher: Bencher<'_, '_>, width: usize) {
    let (scene, camera, light) = (scene(FieldObjects::OF_2010), camera(width), Light::default());
    let (mut renderer, mut pixels) = (Renderer::default(), Vec::new());
    bencher.bench_local(|| renderer.draw(&scene, &camera, &light, 1, &mut pixels).unwrap().width());
}
