//! A soccer player: its messages, what it computes, and the activities of the roles.
//!
//! Three layers, of which the lower never knows the upper:
//!
//! - [`functionality`]: ordinary code on numbers, tested alone. The filters of [ball](functionality::ball_filter) and
//!   [pose](functionality::localisation), the way [to the ball](functionality::approach) and [round it](functionality::align), the
//!   [arbiter of motions](functionality::motion).
//! - the messages of this module and their [`topics`]: what the parts of a player tell each other. [`GameState`] and [`Ball`] are
//!   what the guards of the roles speak of; [`Pose`] and [`Robots`] are what else a player knows of the world; [`MotionRequest`],
//!   [`HeadRequest`] and [`LedRequest`] are what its behaviours want.
//! - [`activities`]: the names of the formulas. Each is a thin adapter that reads its blackboard, calls functionalities and publishes what
//!   comes of it.
//!
//! ```text
//! body/referee, chest button --RobotController--> game_state            decides what is allowed
//! body/sensors --Sensors--> sensors --+
//! body/sightings ---------------------+--Vision--> ball, pose, robots   what is known
//! body/heard, ball, pose, motion --TeamRadio--> team, body/said         what the team knows
//! team, ball, pose, robots --AttackWatch--> attack                      how an attack of two stands
//! SearchBall, TrackBall, WalkTowardsBall, ... --> motion, head          what is wanted
//! motion, head, leds --MotionController--> body/actuators               what is done
//! ```
//!
//! **No activity chooses between behaviours.** Which of them runs is the statechart's decision, so that the model of a role says all there
//! is to say about it: AlignWithBall never kicks, and LeftKick always does. One body has one commander, MotionController; behaviours ask it
//! for motions. A walk has to be asked for again and again, so that a robot whose behaviour has stopped stands still. A kick or a dive
//! is asked for once, under a number; the activity goes on until that number is done, so that the decision waits for it.
//!
//! **An attack of two** is decided by a protocol: `models/attack.aip` says who may engage in it, what each part does and what ends it. Each
//! player judges for itself, by what it sees and by what its team mates have told it over the radio of their bodies ([`TeamReport`]); its
//! chart reads that judgement ([`Attack`]) in its guards. Nobody knows more than a robot could.
//!
//! **The goalkeeper's way home** belongs to nobody's dive: MotionController gets every fallen robot up, and whatever runs next while no
//! shot comes, TrackBall or SearchBall, walks the one player that the rules call goalkeeper ([`GameState::goalkeeper`]) back between its
//! posts.
//!
//! All frames are named: the robot's has x ahead and y to the left; the field's is that of the player's own team, with x towards the goal to
//! attack. Numbers are SI units and radians. Nothing here reads a clock, and sines come from `libm`, so that a match is the same
//! match on every machine.
//!
//! An activity is tested, or used, with a blackboard and nothing else:
//!
//! ```
//! use monas::{Activity, Progress};
//! use monas_soccer::activities::WalkTowardsBall;
//! use monas_soccer::{Ball, GameState, MotionKind, Pose, topics};
//! use narukom::{Moment, Narukom};
//!
//! let hub = Narukom::with_linked_topics("robot")?;
//! let mut blackboard = hub.blackboard("player");
//! blackboard.process_messages(Moment::from_secs_f64(1.0));
//!
//! // The robot stands in the centre of the field and faces the goal; the ball lies two metres ahead.
//! let field = GameState { field_length: 6.0, field_width: 4.0, goal_width: 1.4, ..GameState::default() };
//! blackboard.publish(topics::GAME_STATE, field)?;
//! blackboard.publish(topics::POSE, Pose { confidence: 1.0, ..Pose::default() })?;
//! blackboard.publish(topics::BALL, Ball { found: true, x: 2.0, distance: 2.0, ..Ball::default() })?;
//!
//! let mut activity = WalkTowardsBall::default();
//! assert_eq!(activity.execute(&mut blackboard)?, Progress::Done);
//! let wanted = blackboard.read(topics::MOTION).unwrap();
//! assert_eq!(wanted.kind(), MotionKind::Walk);
//! assert!(wanted.vx > 0.0 && wanted.wz == 0.0);
//! # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
//! ```
//!
//! A program whose configuration names these activities links this crate: `use monas_soccer as _;`.

pub mod activities;
mod convert;
pub mod functionality;
pub mod topics;

narukom::include_messages!("monas.soccer");
