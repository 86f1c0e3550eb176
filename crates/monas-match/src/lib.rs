//! A match: teams, field, referee and Talws from one file.
//!
//! [`Match::load`] reads a match file with everything it names and answers with a [`MatchPlan`] or with every diagnostic there
//! is. A plan [starts](MatchPlan::start) as a [`RunningMatch`], which plays in simulated time as far as it is
//! [advanced](RunningMatch::advance), and [ends](RunningMatch::finish) with a [`Summary`]. The same plan and seed give the same
//! match, down to the [hash](Summary::hash) of every message.
//!
//! The three levels below meet here and nowhere else: `monas-soccer` brings the activities, `monas-sim` the field, and
//! `monas` runs both. Each robot is a host with a hub of its own; the field is one too, on which it publishes what is true.
//!
//! ```no_run
//! use std::time::Duration;
//! use monas_match::{Match, Options};
//!
//! let registry = monas::Registry::linked();
//! let plan = Match::load("config/match.xml", &registry).map_err(|found| found[0].to_string())?;
//! let mut running = plan.start(Options { seed: 7, ..Options::default() })?;
//! running.advance(Duration::from_secs(60))?;
//! println!("{} : {}", running.score().teams[0].goals, running.score().teams[1].goals);
//! println!("{}", running.finish()?.hash);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod file;
mod grammar;
mod incidents;
mod label;
mod parameters;
mod plan;
mod running;
mod settings;
mod stage;
mod summary;

pub use error::{Error, ErrorKind};
pub use grammar::of_matches as grammar;
pub use label::{END, FOLDER, RUN, SETTINGS, ended, label_real_time};
pub use parameters::simulator_file;
pub use plan::{Match, MatchPlan, Options};
pub use running::RunningMatch;
pub use summary::{AgentSummary, MatchEvent, Scoreboard, Summary, TeamScore, TeamSummary};

// The activities register themselves at link time; a crate that nothing mentions would be left out.
use monas_soccer as _;
