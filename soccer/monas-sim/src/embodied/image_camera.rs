//! The cameras of a body that delivers images.

use monas_robot::{Error, ErrorKind, Image, Images, ObjectSet};
use monas_vision::render::{FieldMarkings, Light, Renderer, RobotFigure, Scene};
use monas_vision::{Camera, FieldObjects, HeadPose, Jersey};
use nalgebra::{Isometry3, Point2, UnitQuaternion, Vector3};
use narukom::Timestamp;

use crate::{SimulatedWorld, TeamColour};

/// The usual width of an image, pixels. Images of 640 by 480 take four times as long to draw, and
/// show objects up to twice as far away, which play on a field of 6 m hardly needs.
const DEFAULT_WIDTH: u32 = 320;
/// Standard deviation of noise and blur (chosen: those of an image that is sharp).
const NOISE: f64 = 3.0;
const BLUR: f64 = 0.6;
/// Time in which the light becomes brighter and weaker again, s (chosen: clouds before a window).
const LIGHT_PERIOD: f64 = 37.0;

/// The two cameras of a robot, which take images from their true pose.
///
/// The light changes with the time: its brightness, its colour and the side from which it comes.
pub(super) struct ImageCamera {
    renderer: Renderer,
    /// The width of an image, pixels.
    width: usize,
    /// The height of an image, pixels.
    height: usize,
    /// The number of images so far, which seeds their noise.
    taken: u64,
}

impl ImageCamera {
    /// A camera with images of this width, pixels, or of the usual one, and three quarters as high.
    pub(super) fn with_width(width: Option<u32>) -> ImageCamera {
        let width = width.unwrap_or(DEFAULT_WIDTH) as usize;
        ImageCamera { renderer: Renderer::default(), width, height: width * 3 / 4, taken: 0 }
    }

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
        let objects = world.objects().into();
        let physics = world.physics();
        let (scene, light) = (scene(world, robot), light(world.time(), world.seed()));
        let images = [0.0, physics.camera_tilt].map(|tilt| self.image(world, robot, tilt, &scene, &light));
        let [upper, lower] = images;
        Ok(Images { taken_at, images: vec![upper?, lower?], objects, ..Images::default() })
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
        let camera = Camera::new(self.width, self.height, view, &pose).map_err(refused)?;
        self.taken += 1;
        let seed = world.seed().wrapping_mul(31).wrapping_add(robot as u64) << 32 | self.taken;
        let mut pixels = Vec::with_capacity(2 * self.width * self.height);
        self.renderer.draw(scene, &camera, light, seed, &mut pixels).map_err(refused)?;
        Ok(Image {
            width: self.width as u32,
            height: self.height as u32,
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

/// The scene around a robot.
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
        objects: FieldObjects {
            ball_radius: physics.ball_radius,
            post_radius: field.post_radius,
            line_width: field.line_width,
            ..match world.objects() {
                ObjectSet::Of2010 => FieldObjects::OF_2010,
                ObjectSet::OfToday => FieldObjects::OF_TODAY,
            }
        },
        ball: Some(Point2::from(world.ball().position)),
        robots: robots.collect(),
        variant: world.seed(),
    }
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
