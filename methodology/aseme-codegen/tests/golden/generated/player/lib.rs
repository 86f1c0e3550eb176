//! The statechart `player`.
//!
//! Generated from `models/patrol.srm`: what is changed here is lost when that is done again.
//!
//! [`State`] lists its states; the modules `chart` and `transitions` say how they hang together, `guards` what the guards ask and
//! what is assigned, `words` what these speak of.

pub mod activities;
mod chart;
mod guards;
mod states;
mod transitions;
mod words;

pub use chart::chart;
pub use states::State;

::monas::statechart!("player" = chart, activities::instances);
