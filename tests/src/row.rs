//! The figures of one match in a season.

use std::fmt;
use std::time::Duration;

use monas_match::{MatchOptions, MatchSource, MatchSummary, TeamSummary};

use crate::{TeamPlay, TeamPlayObserver, Variant, root};

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
    /// The number of times that a goalie returned between its posts afterwards, and the total
    /// time, s.
    pub returns: (u32, f64),
    /// Seconds of play before a robot touched the ball.
    pub first_touch: Option<f64>,
    /// Passes, kick-offs and crowding.
    pub team_play: TeamPlay,
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
    let observer = TeamPlayObserver::default();
    let plan = observer.listen(plan);
    let mut running = plan.start(MatchOptions { seed, record: None }).map_err(|error| error.to_string())?;
    running.advance(length).map_err(|error| error.to_string())?;
    let team_play = observer.team_play(&running);
    let summary = running.finish().map_err(|error| error.to_string())?;
    Ok(MatchRow::new(variant, seed, &summary, team_play))
}

impl MatchRow {
    fn new(variant: &Variant, seed: u64, summary: &MatchSummary, team_play: TeamPlay) -> MatchRow {
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
            team_play,
            hash: summary.hash.clone().unwrap_or_default(),
        }
    }

    /// The names of the columns. Passes are attempts, those completed, and shots after them;
    /// `kept` are kick-offs after which the team that took it was the first to kick the ball;
    /// `rolls` and `crowd` are percentages of the playing time.
    pub const HEADER: &'static str = "variant            seed  goals  kicks    shots    saves    falls    penalties  to ball  returns        touch  passes           kept   rolls  crowd  hash";
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
            "{:<18} {:>4}  {:<5}  {:<7}  ",
            self.variant,
            self.seed,
            pair(self.goals),
            pair(self.kicks)
        )?;
        write!(f, "{:<7}  {:<7}  {:<7}  ", pair(self.shots), pair(self.saves), pair(self.falls))?;
        write!(f, "{:<9}  {side:<7}  {returns:<13}  {touch:<5}  ", pair(self.penalties))?;
        let TeamPlay { passes, kick_offs, kick_offs_kept, rolling, crowded, .. } = &self.team_play;
        let [blue, red] = passes.map(|it| format!("{}/{}/{}", it.attempts, it.completed, it.shots));
        let (passes, kept) = (format!("{blue}:{red}"), format!("{kick_offs_kept}/{kick_offs}"));
        let percent = |part: &f64| format!("{:.0} %", part * 100.0);
        write!(f, "{passes:<15}  {kept:<5}  {:<5}  {:<5}  {hash}", percent(rolling), percent(crowded))
    }
}
