//! The algorithms of a player: independent of messages, topics and blackboards, so that they can be
//! used and tested alone.

pub mod aim;
pub mod align;
pub mod approach;
pub mod attack;
pub mod avoidance;
pub mod ball_filter;
pub mod field;
pub mod game;
pub mod geometry;
pub mod guard;
pub mod head;
pub mod interception;
pub mod kick_off;
pub mod kicks;
pub mod landmarks;
pub mod lights;
pub mod localisation;
pub mod motion;
pub mod obstacles;
pub mod opponent_motion;
pub mod placement;
mod pose_filter;
pub mod report_budget;
pub mod support;
pub mod walk;
