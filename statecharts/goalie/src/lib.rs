//! The statechart `goalie`.
//!
//! Generated from `models/goalie.srm`: changes here are lost when it is generated again.
//!
//! [`State`] lists its states; the modules `chart` and `transitions` define its structure,
//! `guards` its guards and assigned values, `words` the names that they use.

pub mod activities;
mod chart;
mod guards;
mod states;
mod transitions;
mod words;

pub use chart::chart;
pub use states::State;

::monas::statechart!("goalie" = chart, activities::instances);
