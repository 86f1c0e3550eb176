//! Bodies: what is sensed, what is commanded, and one trait between.
//!
//! A robot's algorithms speak to its body through six messages and nothing else: [`Sensors`], [`Sightings`],
//! [`Announcement`] and what was [`Heard`] from the team come up, [`Actuators`] and what is [`Said`] to it go down. The runtime owns the body, a value of a type that implements [`Robot`]; it
//! publishes what the body senses on the topics of [`topics`] and hands the newest actuators back. An activity therefore
//! never learns which robot it runs on: a disk on the embedded field, a humanoid on a physics server, or a Nao.
//!
//! What a body can do differs, and [`Anatomy`] says it before anything moves: joint limits, the camera's field of view, the
//! [skills](Skill) it has by name. [`conformance::check`] is the suite that every body has to pass.
//!
//! ```
//! use std::time::Duration;
//! use monas_robot::{Actuators, Anatomy, Error, Percepts, Robot};
//! use narukom::Moment;
//!
//! /// A body that is a head on a table.
//! struct Head { yaw: f64, anatomy: Anatomy }
//!
//! impl Robot for Head {
//!     fn anatomy(&self) -> &Anatomy { &self.anatomy }
//!     fn sense(&mut self, now: Moment, percepts: &mut Percepts) -> Result<(), Error> {
//!         percepts.sensors.measured_at = now.as_nanos();
//!         percepts.sensors.head_yaw = self.yaw;
//!         Ok(())
//!     }
//!     fn act(&mut self, _now: Moment, actuators: &Actuators) -> Result<(), Error> {
//!         self.yaw = self.anatomy.head_yaw.clamp(actuators.head_yaw);
//!         Ok(())
//!     }
//! }
//!
//! let mut head = Head { yaw: 0.0, anatomy: Anatomy::new("table head", Duration::from_millis(10)) };
//! monas_robot::conformance::check(&mut head);
//! ```

mod anatomy;
pub mod conformance;
mod robot;
pub mod topics;

narukom::include_messages!("monas.robot");

pub use anatomy::{Anatomy, Camera, Limits};
pub use robot::{Error, ErrorKind, Percepts, Robot};
