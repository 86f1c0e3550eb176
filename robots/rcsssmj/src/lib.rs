//! The Booster T1 on the RoboCup MuJoCo soccer server as a body.
//!
//! The server, `rcssservermj` of the package `rcsssmj` of PyPI, simulates humanoids, a ball and a
//! referee with MuJoCo. [`T1`] implements [`monas_robot::Robot`] as one of its agents: it connects
//! to a server or starts one, and speaks its protocol, which [`frame`], [`expression`],
//! [`percept`], [`effector`] and [`monitor`] hold. A configuration names the body: `<body
//! kind="rcsssmj"/>`.
//!
//! The commands in the plane, which all bodies have, become commands to motors here. A
//! [`WalkEngine`](walk::WalkEngine) turns velocities into steps: [`SineWalk`] is the project's own,
//! [`PolicyWalk`] a network whose weights are loaded from a file. A [`Kick`] is a motion from a
//! stand. The example `motion_search` finds the numbers of walk and kick. Odometry follows from the
//! foot on the ground by the [`kinematics`] of the legs and from the gyroscope, the inclination of
//! the torso from gyroscope and accelerometer ([`Inertia`]). The true pose that the server sends is
//! used to notice that the referee has placed the robot, and for nothing else that players see.
//!
//! # Limits
//!
//! The robot cannot stand up: it waits until the referee puts it on its feet, or the monitor where
//! the option `pick_up` allows it. It has no radio: messages of the server have ten bytes. Marks of
//! the lines are read but not reported, since [`monas_robot::Sightings`] has none.
//!
//! ```
//! use monas_rcsssmj::percept::{Percept, PlayMode};
//!
//! let mut percept = Percept::default();
//! percept.decode(b"(time (now 4.17))(GS (t 0.0)(pm PlayOn)(sl 0)(sr 0))")?;
//! assert_eq!((percept.time, percept.game.play_mode), (4.17, PlayMode::PlayOn));
//! # Ok::<(), monas_rcsssmj::Error>(())
//! ```

mod admission;
mod anatomy;
mod body;
mod connection;
mod control;
pub mod effector;
mod error;
pub mod expression;
pub mod frame;
mod inertia;
mod kick;
pub mod kinematics;
mod limits;
mod mass;
mod match_rules;
pub mod monitor;
mod options;
mod parameters;
pub mod percept;
mod policy;
mod server;
mod sine_parameters;
mod sine_walk;
pub mod walk;

use monas_robot::{BodyKind, BodySettings, BodySite, Robot};

pub use anatomy::{JOINTS, JointValues};
pub use body::T1;
pub use error::{Error, ErrorKind};
pub use inertia::Inertia;
pub use kick::{Kick, KickParameters};
pub use mass::{centre_of_mass, mass};
pub use match_rules::FieldSize;
pub use policy::PolicyWalk;
pub use server::Server;
pub use sine_parameters::SineParameters;
pub use sine_walk::SineWalk;

monas_robot::body_kind!(BodyKind {
    name: "rcsssmj",
    summary: "a Booster T1 on the RoboCup MuJoCo soccer server, which it starts without an `address`",
    options: options::OPTIONS,
    has_own_time,
    limits: |settings, _| limits::limits(settings),
    open: |site| Ok(Box::new(open(&site)?) as Box<dyn Robot>),
    serve: None,
    probe,
});

/// Opens a T1 at a server.
///
/// # Errors
/// An option has no meaning, there is no server, or it does not answer.
pub fn open(site: &BodySite) -> Result<T1, Error> {
    T1::open(site.address.as_deref(), &options::Options::of(&site.options)?)
}

/// In lockstep the server's time is that of the run.
fn has_own_time(settings: &BodySettings) -> bool {
    options::Options::of(&settings.options).is_ok_and(|options| !options.realtime)
}

/// Whether a server answers at an address.
fn probe(address: Option<&str>) -> Result<String, monas_robot::Error> {
    let address = address.unwrap_or(body::ADDRESS);
    connection::Connection::open(address)?;
    Ok(format!("a server answers at {address}"))
}
