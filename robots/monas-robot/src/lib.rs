//! Bodies: sensor messages, command messages, and the trait that connects them.
//!
//! A robot's algorithms communicate with its body through messages only. On the level of the plane,
//! which every body has, the inputs are [`Sensors`], [`Sightings`] or [`Images`], [`Announcement`]
//! and [`Heard`] (radio messages of the team), the outputs [`Actuators`] and [`Said`]. On the level
//! of the joints, as far as a body has them, the inputs are [`Joints`], [`Inertial`], [`Contacts`],
//! [`Sonar`] and [`Battery`], the outputs [`JointCommands`] and [`Leds`]. The runtime owns the
//! body, a value of a type that implements [`Robot`]; it publishes the sensor messages on the
//! topics of [`topics`] and passes the newest actuators to the body. An activity is therefore
//! independent of the robot it runs on: a disk on the embedded field, a humanoid on a physics
//! server, or a Nao.
//!
//! The capabilities of a body are described by its [`Anatomy`]: joints with their limits, links,
//! cameras, the named [skills](Skill). `monas_config::urdf` reads it from a file. A configuration
//! names a body by its [`BodyKind`], which [`body_kind!`] registers. [`conformance::check`] is the
//! test suite that every body has to pass.
//!
//! ```
//! use std::time::Duration;
//! use monas_robot::{Actuators, Anatomy, Error, Percepts, Robot};
//! use narukom::Timestamp;
//!
//! /// A body that is a head on a table.
//! struct Head { yaw: f64, anatomy: Anatomy }
//!
//! impl Robot for Head {
//!     fn anatomy(&self) -> &Anatomy { &self.anatomy }
//!     fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), Error> {
//!         percepts.sensors.measured_at = now.as_nanos();
//!         percepts.sensors.head_yaw = self.yaw;
//!         Ok(())
//!     }
//!     fn act(&mut self, _now: Timestamp, actuators: &Actuators) -> Result<(), Error> {
//!         self.yaw = self.anatomy.head_yaw.clamp(actuators.head_yaw);
//!         Ok(())
//!     }
//! }
//!
//! let mut head = Head { yaw: 0.0, anatomy: Anatomy::new("table head", Duration::from_millis(10)) };
//! monas_robot::conformance::check(&mut head);
//! ```

mod anatomy;
mod body_kind;
mod body_option;
pub mod conformance;
mod fall_detector;
mod joint_targets;
mod robot;
mod skill_progress;
pub mod topics;
mod wrapped_body;

narukom::include_messages!("monas.robot");

pub use anatomy::{Anatomy, Camera, Joint, Limits, Link, LinkMotion};
pub use body_kind::{
    BodyEnvironment, BodyKind, BodyLimit, BodySettings, BodySite, CameraOutput, Capability, IMAGE_WIDTHS,
    OpenBody,
};
pub use body_option::{BodyFault, BodyOption, OptionKind};
pub use fall_detector::FallDetector;
pub use joint_targets::JointTargets;
pub use robot::{Error, ErrorKind, Percepts, Robot};
pub use skill_progress::SkillProgress;
pub use wrapped_body::{Disturbances, WrappedBody};

/// The expansion of [`body_kind!`].
#[doc(hidden)]
pub mod linked {
    pub use crate::body_kind::BODY_KINDS;
    pub use narukom::linkme;
}
