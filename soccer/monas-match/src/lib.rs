//! A match: teams, field, referee and Talws from one file.
//!
//! [`MatchSource::load`] reads a match file and all files it refers to, and returns a [`MatchPlan`]
//! or all diagnostics. [Starting](MatchPlan::start) a plan gives a [`RunningMatch`], which is
//! [advanced](RunningMatch::advance) in simulated time and [ends](RunningMatch::finish) with a
//! [`MatchSummary`]. The same plan and seed give the same match, down to the
//! [hash](MatchSummary::hash) of all messages.
//!
//! Only this crate combines the three below it: `monas-soccer` provides the activities, `monas-sim`
//! the field, and `monas` the runtime. Each robot is a host with its own hub; the field is another,
//! on which it publishes the ground truth.
//!
//! ```no_run
//! use std::time::Duration;
//! use monas_match::{MatchOptions, MatchSource};
//!
//! let registry = monas::Registry::linked();
//! let plan = MatchSource::load("config/match.xml", &registry)
//!     .map_err(|found| found[0].to_string())?;
//! let mut running = plan.start(MatchOptions { seed: 7, ..MatchOptions::default() })?;
//! running.advance(Duration::from_secs(60))?;
//! println!("{} : {}", running.score().teams[0].goals, running.score().teams[1].goals);
//! println!("{}", running.finish()?.hash.expect("simulated time"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod file;
mod grammar;
mod league;
mod league_player;
mod league_referee;
mod match_events;
mod match_world;
mod parameters;
mod plan;
mod recorded_field;
mod running_match;
mod settings;
mod summary;

pub use error::{Error, ErrorKind};
pub use grammar::of_matches as grammar;
pub use league::LeagueCounts;
pub use parameters::simulator_file;
pub use plan::{MatchOptions, MatchPlan, MatchSource};
pub use recorded_field::RecordedField;
pub use running_match::RunningMatch;
pub use summary::{AgentSummary, MatchEvent, MatchSummary, Scoreboard, TeamScore, TeamSummary};

// The activities register themselves at link time; the linker drops crates without a reference.
use monas_soccer as _;
