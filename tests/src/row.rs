//! The figures of one match in a season.

use std::fmt;
use std::time::Duration;

use monas_match::{MatchOptions, MatchSource, MatchSummary, TeamSummary};

use crate::{Variant, root};

/// The results of a match for both teams: blue first.
#[derive(Clone, PartialEq, Debug)]
pub struct MatchRow {
    /// The match's variant.
    pub variant: &'static str,
    /// Its seed.
    pub seed: u64,
    /// Goals.
    pub goals: [u32; 2],
    /// Kicks that hit the ball.
    pub kicks: [u32; 2],
    /// Kicks on the goal.
    pub shots: [u32; 2],
    /// Shots that a goalie stopped.
    pub saves: [u32; 2],
    /// Falls.
    pub falls: [u32; 2],
    /// Penalties.
    pub penalties: [u32; 2],
    /// Intentional dives and falls of both goalies, and how many went to the ball's side.
    pub actions: [u32; 2],
    /// How often a goalie returned between its posts afterwards, and the total time in seconds.
    pub returns: (u32, f64),
    /// Seconds of play before a robot touched the ball.
    pub first_touch: Option<f64>,
    /// The run's hash.
    pub hash: String,
}

/// Plays a match for a duration.
///
/// # Errors
/// The diagnostics of its files, or the failure.
pub fn play(variant: &Variant, seed: u64, length: Duration) -> Result<MatchRow, String> {
    let path = root().join(variant.file);
    let plan = MatchSource::load(path, &monas::Registry::linked())
        .map_err(|found| found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
    let mut running = plan.start(MatchOptions { seed, record: None }).map_err(|error| error.to_string())?;
    running.advance(length).map_err(|error| error.to_string())?;
    let summary = running.finish().map_err(|error| error.to_string())?;
    Ok(MatchRow::new(variant, seed, &summary))
}

impl MatchRow {
    fn new(variant: &Variant, seed: u64, summary: &MatchSummary) -> MatchRow {
        let both = |figure: fn(&TeamSummary) -> u32| [figure(&summary.teams[0]), figure(&summary.teams[1])];
        let sum = |figure: fn(&TeamSummary) -> u32| summary.teams.iter().map(figure).sum();
        MatchRow {
            variant: variant.name,
            seed,
            goals: both(|team| team.goals),
            kicks: both(|team| team.kicks),
            shots: both(|team| team.shots),
            saves: both(|team| team.saves),
            falls: both(|team| team.falls),
            penalties: both(|team| team.penalties),
            actions: [sum(|team| team.actions), sum(|team| team.actions_to_ball)],
            returns: (sum(|team| team.returns), summary.teams.iter().map(|team| team.return_seconds).sum()),
            first_touch: summary.time_to_first_touch.map(|time| time.as_secs_f64()),
            hash: summary.hash.clone(),
        }
    }

    /// The names of the columns.
    pub const HEADER: &'static str = "variant    seed  goals  kicks    shots    saves    falls    penalties  to ball  returns        touch  hash";
}

impl fmt::Display for MatchRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pair = |[blue, red]: [u32; 2]| format!("{blue}:{red}");
        let returns = format!("{} in {:.1} s", self.returns.0, self.returns.1);
        let touch = self.first_touch.map_or("never".into(), |seconds| format!("{seconds:.1} s"));
        let side = format!("{}/{}", self.actions[1], self.actions[0]);
        let hash = self.hash.get(..16).unwrap_or(&self.hash);
        write!(
            f,
            "{:<10} {:>4}  {:<5}  {:<7}  ",
            self.variant,
            self.seed,
            pair(self.goals),
            pair(self.kicks)
        )?;
        write!(f, "{:<7}  {:<7}  {:<7}  ", pair(self.shots), pair(self.saves), pair(self.falls))?;
        write!(f, "{:<9}  {side:<7}  {returns:<13}  {touch:<5}  {hash}", pair(self.penalties))
    }
}
