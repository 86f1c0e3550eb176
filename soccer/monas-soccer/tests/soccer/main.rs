//! Roles and players of the team.
#![allow(clippy::unwrap_used)] // tests

mod attacker;
mod goalie;
mod players;
mod toy;
