//! The evaluation of the thesis's chapter 5, measured anew: goalie and attacker built in three
//! ways with the same skills.
//!
//! - [`Methodology::Direct`]: modules in one loop, directly on the robot interface ([`direct`]).
//! - [`Methodology::Agents`]: Monas agents, one an activity with a frequency of its own, where one
//!   activity makes all decisions ([`agents`]).
//! - [`Methodology::Aseme`]: the roles in `models/`, from liveness formulas.
//!
//! All three call the functionalities of [`monas_soccer`]: filters, paths, kicks and the arbiter of
//! motions are the same code. What differs is how a robot decides, and how its parts communicate.
//! [`evaluate`] plays matches of each methodology against the team of `config/match.xml`, measures
//! the cost of the programs of the robots, and counts their sources ([`sources`]).
//!
//! ```no_run
//! use std::time::Duration;
//!
//! let registry = monas::Registry::linked();
//! let settings = monas_eval::EvaluationSettings {
//!     folder: "config/evaluation".into(),
//!     seeds: 4,
//!     length: Duration::from_secs(600),
//! };
//! // A program that measures passes the processor time of its thread.
//! let figures = monas_eval::evaluate(&settings, &registry, &|| Duration::ZERO, &mut |_| ())?;
//! println!("{figures}");
//! # Ok::<(), monas_eval::Error>(())
//! ```

pub mod agents;
#[cfg(test)]
mod decision_cases;
#[cfg(test)]
mod decision_tests;
pub mod direct;
mod evaluation;
pub mod sources;
mod thresholds;

pub use evaluation::{
    CostFigures, Error, Evaluation, EvaluationSettings, Methodology, PlayFigures, Row, direct_players,
    evaluate, load, play,
};
