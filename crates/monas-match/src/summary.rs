//! What a match shows while it lasts, and what it came to.

use std::time::Duration;

/// The board beside the field.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Scoreboard {
    /// The teams, in the order of the match file.
    pub teams: [TeamScore; 2],
    /// 1 or 2.
    pub half: u8,
    /// Whole seconds left of the half.
    pub seconds_left: u32,
    /// The referee's state: `PLAYING`.
    pub phase: &'static str,
}

/// A team on the board.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TeamScore {
    /// Its name.
    pub name: String,
    /// What it wears now: `blue` or `red`.
    pub colour: &'static str,
    /// Its goals.
    pub goals: u32,
}

/// Something of note that happened.
#[derive(Clone, PartialEq, Debug)]
pub struct MatchEvent {
    /// When, in simulated time since the beginning.
    pub time: Duration,
    /// What, in words: `goal for Blue by 2, 1 : 0`.
    pub text: String,
}

/// What a match came to.
#[derive(Clone, Debug)]
pub struct Summary {
    /// The hash of every message, 64 hexadecimal digits: see [`monas::RunHash`].
    pub hash: String,
    /// How many messages were published.
    pub messages: u64,
    /// How much time was played, simulated.
    pub simulated: Duration,
    /// The teams, in the order of the match file.
    pub teams: Vec<TeamSummary>,
    /// The agents, in the order in which they run.
    pub agents: Vec<AgentSummary>,
    /// Everything of note.
    pub events: Vec<MatchEvent>,
    /// From the beginning of play to the first touch of the ball.
    pub time_to_first_touch: Option<Duration>,
    /// Which states were active and which transitions fired, chart by chart.
    pub coverage: Vec<monas::ChartCoverage>,
    /// What the robots' links have done.
    pub links: Vec<monas::LinkStatistics>,
}

/// What a team did.
#[derive(Clone, PartialEq, Debug)]
pub struct TeamSummary {
    /// Its name.
    pub name: String,
    /// What it wore first.
    pub colour: &'static str,
    /// Goals, own goals of the others included.
    pub goals: u32,
    /// Kicks that met the ball.
    pub kicks: u32,
    /// Kicks whose line met the mouth of the goal.
    pub shots: u32,
    /// Shots on the goal that the goalie touched and that were none.
    pub saves: u32,
    /// Falls that nobody wanted.
    pub falls: u32,
    /// Times that the referee took a robot off.
    pub penalties: u32,
    /// Part of the playing time, 0 to 1, in which a robot of the team was nearest to the ball and within 0.3 m.
    pub possession: f64,
    /// Dives and falls that a goalie did on purpose, and how many of them went to the ball's side.
    pub actions: u32,
    /// See [`actions`](TeamSummary::actions).
    pub actions_to_ball: u32,
    /// How often the goalie came back between its posts after that, and the sum of the seconds that took.
    pub returns: u32,
    /// See [`returns`](TeamSummary::returns).
    pub return_seconds: f64,
}

/// What an agent did.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct AgentSummary {
    /// Its host.
    pub host: String,
    /// Its name.
    pub agent: String,
    /// Cycles of its list and run-to-completion steps of its charts.
    pub cycles: u64,
    /// Cycles that took longer than their period; none in simulated time.
    pub overruns: u64,
    /// Micro-steps of its charts.
    pub micro_steps: u64,
    /// Calls of its activities.
    pub activity_calls: u64,
}
