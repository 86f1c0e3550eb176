//! Vision for soccer robots: from a camera image to ball, goals, lines, border and robots.
//!
//! The two central types are [`Camera`], a pinhole with its pose over the ground, and [`Vision`],
//! which finds in an [`Image`] what is on the field. The pose of the camera follows from the joints
//! of the head at the time of the image ([`HeadPose`]); a pixel and the height of what it shows
//! then give its place on the ground, and a place gives the size that an object must have.
//!
//! The steps, in order: the colours are calibrated from the image itself ([`Calibration`]), each
//! second pixel gets a class from a table ([`ColourTable`]), scan lines find the border of the
//! field, candidates for the ball are squares that differ from the carpet around them, and are
//! checked in the image for size, roundness and content; posts cross the horizon and stand on the
//! field, with carpet beside them; robots are higher and wider than anything else on the carpet;
//! line points are bright bars between carpet as wide as a line.
//!
//! Everything is a function of the images: there are no threads, no clocks and no files. After a
//! few images [`Vision::see`] does not allocate. [`ColourSampler`] makes an initial colour table
//! from images with boxes of known colours. [`render`] draws images of a field from a known pose,
//! with noise, blur, exposure and changing light, so that recall and errors can be measured.
//!
//! ```
//! use monas_vision::render::{Light, Renderer, Scene};
//! use monas_vision::{Camera, FieldObjects, HeadPose, Vision};
//! use nalgebra::Point2;
//!
//! // A robot in the centre of the field looks at a ball one metre ahead.
//! let pose = HeadPose { height: 0.5, pitch: 0.4, ..HeadPose::default() };
//! let camera = Camera::new(640, 480, 0.8343, &pose.robot_from_camera())?;
//! let scene = Scene {
//!     markings: Default::default(),
//!     objects: FieldObjects::OF_2010,
//!     ball: Some(Point2::new(1.0, 0.1)),
//!     robots: Vec::new(),
//!     variant: 1,
//! };
//! let mut pixels = Vec::new();
//! let image = Renderer::default().draw(&scene, &camera, &Light::default(), 1, &mut pixels)?;
//!
//! let mut vision = Vision::new(FieldObjects::OF_2010);
//! let ball = vision.see(&image, &camera)?.ball.expect("the ball is in view");
//! assert!((ball.position() - Point2::new(1.0, 0.1)).norm() < 0.03);
//! # Ok::<(), monas_vision::Error>(())
//! ```

mod camera;
mod class_map;
mod colour;
mod colour_sampler;
mod detections;
mod error;
mod hue;
mod image;
mod objects;
mod overlay;
pub mod render;
mod vision;

pub use camera::{Camera, HeadPose};
pub use colour::{Calibration, ColourClass, ColourModel, ColourTable};
pub use colour_sampler::{ColourSampler, SampleBox};
pub use detections::{
    DetectedRobot, Detections, GoalPaint, GoalPost, GroundObject, GroundPoint, Jersey, LineSegment, PixelBox,
    PostSide,
};
pub use error::{Error, ErrorKind};
pub use hue::ObjectHue;
pub use image::{Image, rgb_of_yuv, yuv_of_rgb, yuv422_of_rgb};
pub use objects::{BallPattern, FieldObjects};
pub use overlay::overlay;
pub use vision::Vision;
