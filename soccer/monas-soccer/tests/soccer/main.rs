//! Roles and players of the team.

mod attacker;
mod goalie;
mod players;
mod toy;
