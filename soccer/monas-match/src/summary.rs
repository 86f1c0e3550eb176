//! Status and results of a match.

use std::time::Duration;

use monas::{BodyStatistics, Percentiles};

/// The scoreboard.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Scoreboard {
    /// The teams, in the order of their numbers.
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
    /// Its current colour: `blue` or `red`.
    pub colour: &'static str,
    /// Its goals.
    pub goals: u32,
}

/// A notable event.
#[derive(Clone, PartialEq, Debug)]
pub struct MatchEvent {
    /// Time since the start.
    pub time: Duration,
    /// Description: `goal for Blue by Blue 2`.
    pub text: String,
}

/// The results of a match.
#[derive(Clone, Debug)]
pub struct MatchSummary {
    /// The hash of all messages, 64 hexadecimal digits: see [`monas::RunHash`]. None in real time,
    /// in which matches are not reproducible.
    pub hash: Option<String>,
    /// The number of published messages.
    pub messages: u64,
    /// The simulated time of the field.
    pub simulated: Duration,
    /// The teams, in the order of their numbers.
    pub teams: Vec<TeamSummary>,
    /// The agents, in the order in which they run.
    pub agents: Vec<AgentSummary>,
    /// The notable events.
    pub events: Vec<MatchEvent>,
    /// Time from the start of play to the first touch of the ball.
    pub time_to_first_touch: Option<Duration>,
    /// The bodies in real time; none in simulated time.
    pub bodies: Vec<BodyStatistics>,
    /// Active states and fired transitions of each chart; none in real time.
    pub coverage: Vec<monas::ChartCoverage>,
    /// Statistics of the robots' links.
    pub links: Vec<monas::LinkStatistics>,
    /// Counts of packets exchanged with a GameController, or as one.
    pub league: Option<crate::LeagueCounts>,
    /// The failure of the field that has ended a match in real time.
    pub failure: Option<String>,
    /// Names the activity that has not returned at the end, if there is one. Its thread remains.
    pub unstopped: Option<String>,
}

/// The results of a team.
#[derive(Clone, PartialEq, Debug)]
pub struct TeamSummary {
    /// Its name.
    pub name: String,
    /// Its colour in the first half.
    pub colour: &'static str,
    /// Goals, including own goals of the opponents.
    pub goals: u32,
    /// Kicks that hit the ball.
    pub kicks: u32,
    /// Kicks whose line crossed the mouth of the goal.
    pub shots: u32,
    /// Shots that the goalie touched and that were no goals.
    pub saves: u32,
    /// Unintentional falls.
    pub falls: u32,
    /// Penalties against robots of the team.
    pub penalties: u32,
    /// Fraction of the playing time in which a robot of the team was nearest to the ball and within
    /// 0.3 m.
    pub possession: f64,
    /// Intentional dives and falls of the goalie.
    pub actions: u32,
    /// Those of them to the ball's side.
    pub actions_to_ball: u32,
    /// The number of times that the goalie returned between its posts afterwards.
    pub returns: u32,
    /// Sum of the durations of these returns, s.
    pub return_seconds: f64,
}

/// The statistics of an agent.
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
    /// Percentiles of the durations of cycles, where they are measured.
    pub cycle: Option<Percentiles>,
    /// The CPU time of its activities, estimated from some of their calls, where it is measured.
    pub cpu: Option<Duration>,
    /// Micro-steps of its charts.
    pub micro_steps: u64,
    /// Calls of its activities.
    pub activity_calls: u64,
    /// Why it has stopped before the end, if it has.
    pub stopped: Option<String>,
}
