//! A soccer field in simulated time: robots, a ball and a referee in the plane.
//!
//! This is the field on which a team plays when there is no other: small enough to be understood, quick enough for
//! a season in a minute, and true to what decides a match of small humanoid robots. Robots walk unsteadily, see
//! little and badly, miss the ball, push each other over and take long to stand up.
//!
//! - [`World`] is everything together. [`World::step`] moves it on by [`STEP`]; between steps each robot gets a
//!   [`Command`] and is read into [`Senses`], what a body feels and its cameras show.
//! - [`Setup`] says who plays where: [`FieldGeometry`], [`Physics`] and [`Rules`] are plain structs of documented
//!   numbers that a configuration file can set by name, with [`TeamSetup`] and [`RobotSetup`] beside them.
//! - [`Referee`] keeps states, clock, score and penalties; [`Announcement`] is what it tells a robot.
//! - [`Event`]s tell what happened, [`Statistics`] counts it, and [`render_svg`] draws the moment.
//! - [`Pitch`] lends a world's robots to agents as [`monas_robot::Robot`]s, and [`messages`] are what the field
//!   publishes about itself.
//!
//! # Why it is so
//!
//! *Plain structs inside.* The world knows no topics, messages or agents; [`Pitch`] translates for those who do, and
//! everything else can be used, and tested, without them.
//!
//! *The same seed, the same bits.* Every component draws from a stream of its own, seeded by a hash of the world's
//! seed and the component's path; there is no clock, no thread, no hash map, and sines come from `libm`. Contacts
//! are left to rapier with its `enhanced-determinism`.
//!
//! *Two dimensions.* A fall is a phase of a body and takes its time, but nothing is lifted. A robot is a disk to
//! other robots and a pair of feet, or a lying body, to the ball; that is what decides who gets the ball.
//!
//! *The referee is the hand that carries.* Robots are placed for kick-offs by hand, as teams of 2010 often
//! chose; outside PLAYING it holds the robots, so a robot that would move in SET does not.
//!
//! # Frames and units
//!
//! Metres, seconds and radians. The field frame has its origin at the centre mark, x points to the right (yellow)
//! goal, y to the left of who faces it. A robot's own frame has x ahead and y to its left.
//!
//! # Example
//!
//! A robot that walks to the ball and kicks it:
//!
//! ```
//! use monas_sim::{Command, EventKind, GameState, Motion, Pose, Senses, Setup, Side, Sighting, Vector, World};
//!
//! let mut world = World::new(Setup::three_against_three(7))?;
//! while world.referee().state() != GameState::Playing {
//!     world.step();
//! }
//! let robot = 1; // the second robot of the first team
//! world.place_robot(robot, Pose::new(0.5, -0.05, 0.0))?;
//! world.place_ball(Vector::new(1.2, 0.0), Vector::zeros())?;
//!
//! let mut senses = Senses::default();
//! for _ in 0..1000 {
//!     world.sense(robot, &mut senses)?;
//!     let ball = senses.sightings.iter().find_map(|sighting| match sighting {
//!         Sighting::Ball(percept) => Some(percept),
//!         _ => None,
//!     });
//!     let mut command = match ball {
//!         Some(ball) if ball.distance > 0.17 => Some(Command::walk(0.2, 0.0, 0.0)),
//!         Some(_) => Some(Command::new(Motion::Kick(Side::Left))),
//!         None => None, // no new picture: go on
//!     };
//!     if let Some(command) = &mut command {
//!         command.head_pitch = 0.4; // look down
//!         world.command(robot, *command)?;
//!     }
//!     world.step();
//! }
//! assert!(world.events().iter().any(|event| matches!(event.kind, EventKind::Kick { struck: true, .. })));
//! # Ok::<(), monas_sim::Error>(())
//! ```

mod arena;
mod body;
mod camera;
mod command;
mod draw;
mod embodied;
mod error;
mod event;
mod fouls;
mod gait;
mod geometry;
mod goalie;
mod lineup;
pub mod messages;
mod parameters;
mod physics;
mod pose;
mod referee;
mod restart;
mod rng;
mod rules;
mod senses;
mod setup;
mod shots;
mod snapshot;
mod state;
mod statistics;
mod world;

pub use body::{Direction, Phase};
pub use camera::{Percept, Sighting};
pub use command::{Command, Motion};
pub use draw::render_svg;
pub use embodied::{FieldBody, Pitch};
pub use error::{Error, ErrorKind};
pub use event::{Event, EventKind};
pub use fouls::Offence;
pub use geometry::FieldGeometry;
pub use lineup::check as check_lineup;
pub use lineup::{FieldSide, GoalColour, RobotSetup, Side, TeamColour, TeamSetup};
pub use parameters::Parameter;
pub use physics::Physics;
pub use pose::{Pose, Vector, Velocity, normalize_angle};
pub use referee::{Announcement, GameState, Penalty, Referee};
pub use rules::Rules;
pub use senses::{Buttons, Senses};
pub use setup::Setup;
pub use state::{BallState, RobotState};
pub use statistics::{POSSESSION_DISTANCE, Statistics, Tally};
pub use world::World;

/// The time of one step, s.
pub const STEP: f64 = 0.01;
