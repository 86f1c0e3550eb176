//! A soccer field in simulated time: robots, a ball and a referee in the plane.
//!
//! A simulator for matches of small humanoid robots: small enough to be understood and fast enough
//! for a season in a minute. It models what decides such matches: robots walk unsteadily, have
//! noisy cameras with a narrow field of view, miss the ball, push each other over and take long to
//! stand up.
//!
//! - [`SimulatedWorld`] is the whole simulation. [`SimulatedWorld::step`] advances it by [`STEP`];
//!   between steps each robot gets a [`Command`], and its sensors and cameras are read into
//!   [`Senses`].
//! - [`Setup`] configures a world: [`FieldGeometry`], [`Physics`], [`MatchRules`] and [`Radio`] are
//!   plain structs of documented numbers that a configuration file can set by name; [`TeamSetup`]
//!   and [`RobotSetup`] are the line-up.
//! - [`Referee`] keeps states, clock, score and penalties; it sends an [`Announcement`] to each
//!   robot.
//! - [`SimulationEvent`]s report what happened, [`Statistics`] counts it, [`render_svg`] and
//!   [`render_text`] show the current state, and [`animate_svg`] draws recorded states.
//! - [`SharedField`] provides a world's robots to agents as [`monas_robot::Robot`]s, and
//!   [`messages`] are the ground truth that the field publishes.
//!
//! # Design
//!
//! *Plain structs inside.* The world knows no topics, messages or agents; [`SharedField`] adapts it
//! to them, and everything else can be used and tested without them.
//!
//! *The same seed, the same bits.* Every component draws from its own stream, seeded by a hash of
//! the world's seed and the component's path; there is no clock, no thread and no hash map, and
//! trigonometric functions come from `libm`. Contacts are computed by rapier with its
//! `enhanced-determinism`.
//!
//! *Two dimensions.* A fall is a phase of a body with a duration; there is no vertical motion. A
//! robot collides as a disk with other robots and as a pair of feet, or a lying body, with the
//! ball.
//!
//! *The referee places robots.* INITIAL begins with all robots placed by hand. In READY they walk
//! to their places for the kick-off, and SET places those by hand that stand in an illegal
//! position. Outside READY and PLAYING, and while the game is stopped, the referee holds the
//! robots.
//!
//! # Frames and units
//!
//! Metres, seconds and radians. The field frame has its origin at the centre mark, x points to the
//! right (yellow) goal, y to the left when facing it. A robot's own frame has x ahead and y to its
//! left.
//!
//! # Example
//!
//! A robot that walks to the ball and kicks it:
//!
//! ```
//! use monas_sim::{Command, EventKind, GameState, Motion, Pose, Senses, Setup, Side, Sighting, SimulatedWorld, Vector};
//!
//! let mut world = SimulatedWorld::new(Setup::three_against_three(7))?;
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
mod body_phase;
mod camera;
mod command;
mod draw;
mod embodied;
mod error;
mod event;
mod field_animation;
mod field_text;
mod fouls;
mod gait;
mod geometry;
mod lineup;
pub mod messages;
mod parameters;
mod passes;
mod physics;
mod pose;
mod radio;
mod referee;
mod restart;
mod return_tracker;
mod rng;
mod rules;
mod senses;
mod setup;
mod shots;
mod snapshot;
mod state;
mod statistics;
mod world;

pub use body_phase::{BodyPhase, Direction};
pub use camera::{LineFeature, Percept, Sighting};
pub use command::{Command, Motion};
pub use draw::render_svg;
pub use embodied::{FieldBody, SharedField};
pub use error::{Error, ErrorKind};
pub use event::{EventKind, SimulationEvent};
pub use field_animation::{FieldMoment, PicturedRobot, animate_svg};
pub use field_text::render_text;
pub use fouls::Offence;
pub use geometry::FieldGeometry;
pub use lineup::check as check_lineup;
pub use lineup::{FieldSide, GoalColour, LineupError, LineupPart, RobotSetup, Side, TeamColour, TeamSetup};
pub use parameters::Parameter;
pub use physics::Physics;
pub use pose::{Pose, Vector, Velocity, normalize_angle};
pub use radio::Radio;
pub use referee::{Announcement, GameOrder, GameState, Penalty, Referee, RefereeCall};
pub use rules::MatchRules;
pub use senses::{Buttons, Senses};
pub use setup::Setup;
pub use state::{BallState, RobotState};
pub use statistics::{POSSESSION_DISTANCE, PlayCounts, Statistics};
pub use world::SimulatedWorld;

/// The time of one step, s.
pub const STEP: f64 = 0.01;
