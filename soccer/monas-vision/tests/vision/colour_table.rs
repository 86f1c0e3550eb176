//! A colour table made in one light finds more there than the calibration alone, and is not worse
//! when the light changes.
#![allow(clippy::unwrap_used, reason = "a test")]

use monas_vision::render::{FieldMarkings, Renderer, Scene};
use monas_vision::{
    Camera, ColourClass, ColourModel, ColourSampler, ErrorKind, FieldObjects, HeadPose, Image, SampleBox,
    Vision,
};
use nalgebra::{Isometry3, Point2, Point3, UnitQuaternion, Vector3};

use crate::measure::{Condition, LAMPS, LAMPS_TO_DAY, Measures, Sequence, Views};

const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// A camera near the centre of the field that looks along x, or the other way.
fn camera(turned: bool) -> Camera {
    let pose = HeadPose { height: 0.5, pitch: 0.1, yaw: 0.2, ..HeadPose::default() };
    let heading = if turned { std::f64::consts::PI } else { 0.0 };
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
    let position = Vector3::new(if turned { -1.2 } else { 1.2 }, 0.0, 0.0);
    Camera::new(
        WIDTH,
        HEIGHT,
        0.8343,
        &(Isometry3::from_parts(position.into(), turn) * pose.robot_from_camera()),
    )
    .unwrap()
}

/// The ball, 1.1 m ahead of the camera.
fn ball(turned: bool) -> Point2<f64> {
    if turned { Point2::new(-2.3, -0.1) } else { Point2::new(2.3, 0.1) }
}

/// The box within an object: a part of its size around its centre.
fn inside(camera: &Camera, centre: Point3<f64>, half: [f64; 2]) -> SampleBox {
    let (x, y, depth) = camera.project(&centre).unwrap();
    let [across, along] = half.map(|half| camera.focal() * half / depth);
    SampleBox {
        left: (x - across) as usize,
        top: (y - along) as usize,
        width: (2.0 * across) as usize,
        height: (2.0 * along) as usize,
    }
}

/// The boxes that show ball and post in an image.
fn boxes(turned: bool) -> [(ColourClass, SampleBox); 2] {
    let (camera, ball) = (camera(turned), ball(turned));
    let (side, paint) = if turned { (-1.0, ColourClass::Blue) } else { (1.0, ColourClass::Yellow) };
    // The left post as seen from the camera.
    let post = Point3::new(3.0 * side, 0.7 * side, 0.4);
    [
        (ColourClass::Orange, inside(&camera, Point3::new(ball.x, ball.y, 0.0325), [0.02, 0.02])),
        (paint, inside(&camera, post, [0.03, 0.2])),
    ]
}

fn drawn(condition: &Condition, turned: bool) -> Vec<u8> {
    let scene = Scene {
        markings: FieldMarkings::default(),
        objects: FieldObjects::OF_2010,
        ball: Some(ball(turned)),
        robots: Vec::new(),
        variant: 11,
    };
    let mut pixels = Vec::new();
    Renderer::default().draw(&scene, &camera(turned), &(condition.light)(0.0), 5, &mut pixels).unwrap();
    pixels
}

/// The colour model that the tool calibrates on two images: one of each goal.
fn table(condition: &Condition) -> ColourModel {
    let mut sampler = ColourSampler::default();
    for turned in [false, true] {
        let pixels = drawn(condition, turned);
        let image = Image::new(WIDTH, HEIGHT, &pixels).unwrap();
        assert!(sampler.add_image(&image, &camera(turned)), "the carpet is found");
        for (class, area) in boxes(turned) {
            sampler.add_sample(class, &image, area).unwrap();
        }
    }
    sampler.model().unwrap()
}

fn measures(condition: &'static Condition, vision: Vision) -> Measures {
    Sequence {
        views: Views::Field,
        objects: FieldObjects::OF_2010,
        condition,
        images: 60,
        width: WIDTH,
        seed: 3,
    }
    .measure_with(vision)
}

#[test]
fn a_table_finds_more_in_its_light() {
    if !crate::examines_large_images() {
        return;
    }
    let known = Vision::starting_from(FieldObjects::OF_2010, table(&LAMPS));
    let (alone, begun) = (measures(&LAMPS, Vision::new(FieldObjects::OF_2010)), measures(&LAMPS, known));
    println!("alone: {alone}\nbegun: {begun}");
    assert!(alone.ball.shown >= 15 && alone.posts.shown >= 5, "{alone}");
    assert!(alone.ball.recall() < 0.5, "the light is not one in which a table helps: {alone}");
    assert!(begun.ball.recall() >= 0.97 && begun.posts.recall() >= 0.9, "{begun}");
    assert!(begun.ball.wrong + begun.posts.wrong <= 1, "{begun}");
}

#[test]
fn a_table_is_not_worse_when_the_light_changes() {
    if !crate::examines_large_images() {
        return;
    }
    let known = Vision::starting_from(FieldObjects::OF_2010, table(&LAMPS));
    let (alone, begun) =
        (measures(&LAMPS_TO_DAY, Vision::new(FieldObjects::OF_2010)), measures(&LAMPS_TO_DAY, known));
    println!("alone: {alone}\nbegun: {begun}");
    assert!(
        begun.ball.found >= alone.ball.found && begun.posts.found >= alone.posts.found,
        "{alone}\n{begun}"
    );
    assert!(begun.ball.recall() >= 0.95, "{begun}");
    assert!(begun.ball.wrong <= alone.ball.wrong && begun.posts.wrong <= alone.posts.wrong.max(1), "{begun}");
}

#[test]
fn samples_that_cannot_be_used_are_refused() {
    let pixels = drawn(&LAMPS, false);
    let image = Image::new(WIDTH, HEIGHT, &pixels).unwrap();
    let [(_, of_ball), (_, of_post)] = boxes(false);
    let made = |samples: &[(ColourClass, SampleBox)]| {
        let mut sampler = ColourSampler::default();
        sampler.add_image(&image, &camera(false));
        samples.iter().try_for_each(|(class, area)| sampler.add_sample(*class, &image, *area))?;
        sampler.model()
    };
    let refused = |samples: &[(ColourClass, SampleBox)]| {
        let error = made(samples).unwrap_err();
        (error.kind(), error.to_string())
    };
    let area = |left, top, width, height| SampleBox { left, top, width, height };
    let (orange, yellow) = (ColourClass::Orange, ColourClass::Yellow);

    assert!(made(&[(orange, of_ball), (yellow, of_post)]).is_ok());
    let (kind, message) = refused(&[(orange, area(630, 10, 20, 20))]);
    assert_eq!(kind, ErrorKind::Sample);
    assert_eq!(message, "the box 630,10,20,20 is not within the image of 640 x 480 pixels");
    assert_eq!(refused(&[(orange, area(10, 10, 0, 5))]).1, "a box of 0 x 5 pixels is empty");
    assert_eq!(refused(&[(ColourClass::Dark, of_ball)]).1, "`dark` is not the colour of an object");
    assert!(refused(&[(orange, area(10, 10, 3, 3))]).1.contains("at least 12 are needed"));
    // The same pixels cannot have two colours, and the carpet none of an object.
    let (kind, message) = refused(&[(orange, of_ball), (yellow, of_ball)]);
    assert_eq!(kind, ErrorKind::Colours);
    assert!(message.starts_with("ambiguous colours: ") && message.contains('%'), "{message}");
    let (kind, message) = refused(&[(orange, area(100, 392, 60, 16))]);
    assert_eq!(kind, ErrorKind::Colours, "{message}");
    assert!(message.contains("% of the carpet would be `orange`"), "{message}");
}

#[test]
fn images_without_carpet_need_a_sample_of_it() {
    let pixels = vec![128; 2 * 64 * 48];
    let image = Image::new(64, 48, &pixels).unwrap();
    let pose = HeadPose { height: 0.5, pitch: 0.5, ..HeadPose::default() }.robot_from_camera();
    let camera = Camera::new(64, 48, 0.8343, &pose).unwrap();
    let mut sampler = ColourSampler::default();
    assert!(!sampler.add_image(&image, &camera));
    assert_eq!(sampler.model().unwrap_err().kind(), ErrorKind::Colours);
    // The person's name for a colour counts.
    let green: Vec<u8> = (0..32 * 48).flat_map(|_| [90, 110, 90, 105]).collect();
    let image = Image::new(64, 48, &green).unwrap();
    let area = SampleBox { left: 0, top: 0, width: 32, height: 32 };
    sampler.add_sample(ColourClass::Green, &image, area).unwrap();
    let model = sampler.model().unwrap();
    let errors = [model.green[0] + 18.0 / 90.0, model.green[1] + 23.0 / 90.0];
    assert!(model.green_luma == 90.0 && errors.iter().all(|error| error.abs() < 1e-4), "{model:?}");
}
