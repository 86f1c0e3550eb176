//! A soccer player: its messages, algorithms and activities.
//!
//! Three layers; lower ones do not depend on upper ones:
//!
//! - [`functionality`]: ordinary code on numbers, tested alone. The filters of
//!   [ball](functionality::ball_filter) and [pose](functionality::localisation), the paths [to the
//!   ball](functionality::approach) and [round it](functionality::align), the [arbiter of
//!   motions](functionality::motion).
//! - the messages of this module and their [`topics`], by which the parts of a player communicate.
//!   The guards of the roles refer to [`GameState`] and [`Ball`]; [`Pose`] and [`Robots`] complete
//!   the world model; [`MotionRequest`], [`HeadRequest`] and [`LedRequest`] are the requests of
//!   behaviours.
//! - [`activities`]: the names in the formulas. Each is a thin adapter that reads its blackboard,
//!   calls functionalities and publishes the results.
//!
//! ```text
//! body/referee, chest button --RobotController--> game_state            decides what is allowed
//! body/sensors --Sensors--> sensors --+
//! body/sightings ---------------------+--Vision--> ball, pose, robots   what is known
//! body/heard, ball, pose, motion --TeamRadio--> team, body/said         what the team knows
//! team, ball, pose, robots --AssessAttack--> attack                     how an attack of two stands
//! SearchBall, TrackBall, WalkTowardsBall, ... --> motion, head          what is wanted
//! motion, head, leds --MotionController--> body/actuators               what is done
//! ```
//!
//! **No activity chooses between behaviours.** The statechart decides which of them runs, so that
//! the model of a role defines its behaviour completely: AlignWithBall never kicks, and LeftKick
//! always does. A body has one commander, MotionController; behaviours send it requests. A request
//! to walk must be repeated, so that a robot whose behaviour has stopped stands still. A kick or a
//! dive is requested once, under a number; the activity continues until that number is done, so
//! that the next decision waits for it.
//!
//! **An attack of two** is decided by a protocol: `models/attack.aip` defines the conditions for
//! engaging in it, the parts and the outcomes. Each player evaluates the conditions from its own
//! perception and the radio reports of its team mates ([`TeamReport`]); its chart reads the result
//! ([`Attack`]) in its guards. No player has information that a real robot could not have.
//!
//! **No activity knows its player.** None reads the player's number or role: an activity does one
//! thing, whichever chart calls it. The goalkeeper's chart calls KeepGoal and ReturnToGoal, which
//! also walk it back between its posts after a dive.
//!
//! All frames are named: the robot's has x ahead and y to the left; the field's is that of the
//! player's own team, with x towards the goal to attack. Values are in SI units and radians. No
//! code reads a clock, and trigonometric functions come from `libm`, so that a match is the same on
//! every machine.
//!
//! An activity can be tested or used with just a blackboard:
//!
//! ```
//! use monas::{Activity, Progress};
//! use monas_soccer::activities::WalkTowardsBall;
//! use monas_soccer::{Ball, GameState, MotionKind, Pose, topics};
//! use narukom::{Hub, Timestamp};
//!
//! let hub = Hub::with_linked_topics("robot")?;
//! let mut blackboard = hub.blackboard("player");
//! blackboard.process_messages(Timestamp::from_secs_f64(1.0));
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
pub mod convert;
pub mod field_colours;
pub mod functionality;
pub mod image_interpreter;
pub mod perception;
pub mod topics;

narukom::include_messages!("monas.soccer");
