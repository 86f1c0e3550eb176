//! The cameras of a body that delivers images.

use monas_robot::{Error, ErrorKind, Image, Images};
use monas_vision::render::{FieldMarkings, Light, Renderer, RobotFigure, Scene};
use monas_vision::{Camera, FieldObjects, HeadPose, Jersey};
use nalgebra::{Isometry3, Point2, UnitQuaternion, Vector3};
use narukom::Timestamp;

use crate::{Physics, SimulatedWorld, TeamColour};

/// Size of an image, pixels (Nao: 320 by 240 at 30 images a second).
const WIDTH: usize = 320;
const HEIGHT: usize = 240;
/// Standard deviation of noise and blur (chosen: those of an image that is sharp).
const NOISE: f64 = 3.0;
const BLUR: f64 = 0.6;
/// Time in which the light becomes brighter and weaker again, s (chosen: clouds before a window).
const LIGHT_PERIOD: f64 = 37.0;

/// The two cameras of a robot, which take images from their true pose.
///
/// The light changes with the time: its brightness, its colour and the side from which it comes.
#[derive(Default)]
pub(super) struct ImageCamera {
    renderer: Renderer,
    /// The number of images so far, which seeds their noise.
    taken: u64,
}

impl ImageCamera {
    /// The images of both cameras; none of a robot that does not stand on the field.
    pub(super) fn take(
        &mut self,
        world: &SimulatedWorld,
        robot: usize,
        now: Timestamp,
    ) -> Result<Images, Error> {
        let taken_at = now.as_nanos();
        let state = &world.robots()[robot];
        if !state.phase.is_upright() || !state.on_field {
            return Ok(Images { taken_at, ..Images::default() });
        }
        let physics = world.physics();
        let (scene, light) = (scene(world, robot), light(world.time(), world.seed()));
        let images = [0.0, physics.camera_tilt].map(|tilt| self.image(world, robot, tilt, &scene, &light));
        let [upper, lower] = images;
        Ok(Images { taken_at, images: vec![upper?, lower?], ..Images::default() })
    }

    fn image(
        &mut self,
        world: &SimulatedWorld,
        robot: usize,
        tilt: f64,
        scene: &Scene,
        light: &Light,
    ) -> Result<Image, Error> {
        let physics = world.physics();
        let state = &world.robots()[robot];
        let (torso_roll, torso_pitch) = world.torso_tilt(robot);
        let head = HeadPose {
            height: physics.camera_height,
            torso_roll,
            torso_pitch,
            yaw: state.head_yaw,
            pitch: state.head_pitch + tilt,
        };
        let position = state.pose.position;
        let (sin, cos) = libm::sincos(state.pose.heading / 2.0);
        let heading = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(cos, 0.0, 0.0, sin));
        let field_from_robot =
            Isometry3::from_parts(Vector3::new(position.x, position.y, 0.0).into(), heading);
        let pose = field_from_robot * head.robot_from_camera();
        let view = physics.camera_view_horizontal;
        let camera = Camera::new(WIDTH, HEIGHT, view, &pose).map_err(refused)?;
        self.taken += 1;
        let seed = world.seed().wrapping_mul(31).wrapping_add(robot as u64) << 32 | self.taken;
        let mut pixels = Vec::with_capacity(2 * WIDTH * HEIGHT);
        self.renderer.draw(scene, &camera, light, seed, &mut pixels).map_err(refused)?;
        Ok(Image {
            width: WIDTH as u32,
            height: HEIGHT as u32,
            angle_of_view: view,
            camera_height: physics.camera_height,
            camera_tilt: tilt,
            pixels,
        })
    }
}

fn refused(error: monas_vision::Error) -> Error {
    Error::new(ErrorKind::Hardware, format!("the camera takes no image: {error}"))
}

/// What there is to see for a robot, with the objects of 2010.
fn scene(world: &SimulatedWorld, robot: usize) -> Scene {
    let (field, physics) = (world.field(), world.physics());
    let colours = world.referee().colours();
    let others = world.robots().iter().enumerate().filter(|(index, other)| *index != robot && other.on_field);
    let robots = others.map(|(_, other)| RobotFigure {
        position: Point2::from(other.pose.position),
        heading: other.pose.heading,
        jersey: match colours[other.team] {
            TeamColour::Blue => Jersey::Blue,
            TeamColour::Red => Jersey::Red,
        },
        lies: other.phase.is_fallen(),
    });
    Scene {
        markings: FieldMarkings {
            length: field.length,
            width: field.width,
            border: field.border,
            goal_width: field.goal_width,
            goal_height: field.goal_height,
            goal_area_depth: field.goal_area_depth,
            goal_area_width: field.goal_area_width,
            centre_circle_radius: field.centre_circle_radius,
            mark_distance: field.mark_distance,
        },
        objects: objects(physics, field.post_radius, field.line_width),
        ball: Some(Point2::from(world.ball().position)),
        robots: robots.collect(),
        variant: world.seed(),
    }
}

fn objects(physics: &Physics, post_radius: f64, line_width: f64) -> FieldObjects {
    FieldObjects { ball_radius: physics.ball_radius, post_radius, line_width, ..FieldObjects::OF_2010 }
}

/// The light at a time.
fn light(time: f64, seed: u64) -> Light {
    let turn = std::f64::consts::TAU * (time / LIGHT_PERIOD + (seed % 16) as f64 / 16.0);
    let (sin, cos) = libm::sincos(turn);
    Light {
        exposure: 0.95 + 0.35 * sin,
        tint: [1.0 + 0.08 * cos as f32, 1.0, 1.0 - 0.14 * cos as f32],
        slope: 0.06 * cos,
        direction: turn / 3.0,
        noise: NOISE,
        blur: BLUR,
    }
}
