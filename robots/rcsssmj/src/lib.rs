//! The Booster T1 and K1 on the RoboCup MuJoCo soccer server as bodies.
//!
//! The server, `rcssservermj` of the package `rcsssmj` of PyPI, simulates humanoids, a ball and a
//! referee with MuJoCo. [`Booster`] implements [`monas_robot::Robot`] as one of its agents: it
//! connects to a server or starts one, and speaks its protocol, which [`frame`], [`expression`],
//! [`percept`], [`effector`] and [`monitor`] hold. A configuration names the body and the robot:
//! `<body kind="rcsssmj" robot="K1"/>`; without a name it is a T1.
//!
//! A [`Humanoid`] holds what the robots differ in, as data: joints, lengths, masses, gains, and the
//! numbers of their motions. [`T1`] and [`K1`] are the two.
//!
//! The commands in the plane, which all bodies have, become commands to motors here. A
//! [`WalkEngine`](walk::WalkEngine) turns velocities into steps: [`SineWalk`] is the project's own,
//! [`PolicyWalk`] a network for the T1 whose weights are loaded from a file. A [`Kick`] is a motion
//! from a stand. The example `motion_search` finds the numbers of walk and kick. Odometry follows
//! from the foot on the ground by the [`kinematics`] of the legs and from the gyroscope, the
//! inclination of the torso from gyroscope and accelerometer ([`InclinationFilter`]). The true pose
//! that the server sends is used only to detect that the referee has placed the robot; players see
//! nothing else of it.
//!
//! # Limits
//!
//! The robot cannot stand up: it waits until the referee puts it on its feet, or the monitor where
//! the option `pick_up` allows it. A K1 may fall over when the referee places it: version 0.2.1 of
//! the server drops it from half a metre. The robot has no radio: messages of the server have ten
//! bytes. Marks of the lines are read but not reported, since [`monas_robot::Sightings`] has none.
//!
//! ```
//! use monas_rcsssmj::T1;
//! use monas_rcsssmj::percept::{Percept, PlayMode};
//!
//! let mut percept = Percept::default();
//! percept.decode(b"(time (now 4.17))(GS (t 0.0)(pm PlayOn)(sl 0)(sr 0))", &T1)?;
//! assert_eq!((percept.time, percept.game.play_mode), (4.17, PlayMode::PlayOn));
//! # Ok::<(), monas_rcsssmj::Error>(())
//! ```

mod admission;
mod body;
mod connection;
mod control;
pub mod effector;
mod error;
pub mod expression;
pub mod frame;
mod humanoid;
mod inclination_filter;
mod k1;
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
mod t1;
pub mod walk;

use monas_robot::{BodyKind, BodySettings, BodySite, Robot};

pub use body::Booster;
pub use error::{Error, ErrorKind};
pub use humanoid::{Humanoid, JOINTS, JointValues};
pub use inclination_filter::InclinationFilter;
pub use k1::K1;
pub use kick::{Kick, KickParameters};
pub use match_rules::FieldSize;
pub use policy::PolicyWalk;
pub use server::Server;
pub use sine_parameters::SineParameters;
pub use sine_walk::SineWalk;
pub use t1::T1;

monas_robot::body_kind!(BodyKind {
    name: "rcsssmj",
    summary: "a Booster T1 or K1 on the RoboCup MuJoCo soccer server, which it starts without an `address`",
    options: options::OPTIONS,
    has_own_time,
    limits: |settings, _| limits::limits(settings),
    faults: |settings, _| options::faults(settings),
    open: |site| Ok(Box::new(open(&site)?) as Box<dyn Robot>),
    serve: None,
    probe,
});

/// Opens a robot at a server.
///
/// # Errors
/// An option has no meaning, there is no server, or it does not answer.
pub fn open(site: &BodySite) -> Result<Booster, Error> {
    Booster::open(site.address.as_deref(), &options::Options::of(&site.options)?)
}

/// In lockstep the time of the run is that of the server.
fn has_own_time(settings: &BodySettings) -> bool {
    options::Options::of(&settings.options).is_ok_and(|options| !options.realtime)
}

/// Whether a server answers at an address.
fn probe(address: Option<&str>) -> Result<String, monas_robot::Error> {
    let address = address.unwrap_or(body::DEFAULT_ADDRESS);
    connection::Connection::open(address)?;
    Ok(format!("a server answers at {address}"))
}
