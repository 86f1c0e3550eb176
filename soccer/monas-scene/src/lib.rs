//! Drawings of soccer for the studio.
//!
//! The studio knows no sport and no body: a program gives it a [`monas_studio::Scene`], which draws
//! what lies on the plane, and [`monas_studio::Cameras`], which reads images. [`SoccerField`] is
//! both for matches on the embedded field. It draws the ground truth if there is one, what each
//! robot believes, the score, and the calls of the referee that a viewer may make; falls and the
//! referee's decisions become events of the timeline. The images of robots on `body/images` become
//! PNG. [`RgbImage`] is an image in a file.
//!
//! It is a separate crate, because the command line does not depend on soccer, and matches do not
//! depend on the studio.
//!
//! ```
//! use monas_scene::SoccerField;
//! use monas_studio::Scene;
//! use serde_json::json;
//!
//! let robot = json!({"team": 1, "number": 2, "x": -1.0, "y": 0.0, "heading": 0.0,
//!     "on_field": true, "upright": true});
//! let truth = json!({"ball_x": 0.5, "ball_y": 0.0, "ball_vx": 0.0, "ball_vy": 0.0,
//!     "robots": [robot]});
//! let messages = [(("field", "sim/truth"), &truth)].into_iter().collect();
//! let picture = SoccerField.draw(&messages);
//! assert_eq!((picture.bodies.len(), picture.objects.len()), (1, 1));
//! ```

mod png_image;
mod rgb_image;
mod robot_cameras;
mod soccer_field;

pub use png_image::encode_png;
pub use rgb_image::RgbImage;
pub use soccer_field::SoccerField;
