//! Matches of each methodology, and what its programs cost.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use monas::Registry;
use monas_match::{MatchOptions, MatchPlan, MatchSource};
use monas_robot::{Actuators, Anatomy, Percepts, Robot};
use narukom::Timestamp;
use yase::Diagnostic;

use crate::direct::{DirectGoalie, DirectPlayer, DirectRobot};
use crate::sources::{self, SourceFigures};

/// The construction of a player.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Methodology {
    /// Directly on the robot interface.
    Direct,
    /// As Monas agents, one an activity.
    Agents,
    /// By ASEME, from liveness formulas.
    Aseme,
}

impl Methodology {
    /// Every methodology, in the order of the thesis.
    pub const ALL: [Methodology; 3] = [Methodology::Direct, Methodology::Agents, Methodology::Aseme];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Methodology::Direct => "direct",
            Methodology::Agents => "agents",
            Methodology::Aseme => "aseme",
        }
    }

    /// The match file in which blue is built so, from the folder of the evaluation.
    fn file(self) -> &'static str {
        match self {
            Methodology::Direct => "direct.xml",
            Methodology::Agents => "agents.xml",
            Methodology::Aseme => "../match.xml",
        }
    }
}

/// The matches of an evaluation.
#[derive(Clone, Debug)]
pub struct EvaluationSettings {
    /// The folder with the match files, `config/evaluation`.
    pub folder: PathBuf,
    /// The number of matches of each methodology, with the seeds from 1.
    pub seeds: u64,
    /// The simulated time of each match.
    pub length: Duration,
}

/// The play of blue against the team of `config/match.xml`, summed over all seeds.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct PlayFigures {
    /// Goals of blue.
    pub goals: u32,
    /// Goals of red.
    pub conceded: u32,
    /// Shots of blue.
    pub shots: u32,
    /// Shots of red.
    pub shots_faced: u32,
    /// Shots of red that the goalie stopped.
    pub saves: u32,
    /// Falls of blue.
    pub falls: u32,
}

/// The costs of one robot's programs, in a match against robots without programs. Allocations and
/// messages are those beyond a match in which no robot has a program.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct CostFigures {
    /// Processor time a cycle of the body, 20 ms of simulated time, with the robot's share of the
    /// field.
    pub cycle: Duration,
    /// Allocations a cycle; zero if the program does not count them.
    pub allocations: f64,
    /// Messages a second of simulated time.
    pub messages: f64,
}

/// The figures of all.
#[derive(Clone, Debug)]
pub struct Evaluation {
    settings: EvaluationSettings,
    /// A row for each methodology.
    pub rows: Vec<Row>,
}

/// A match that cannot be played.
#[derive(Debug)]
pub enum Error {
    /// A match file, or one it refers to, is missing or wrong.
    Files(Vec<Diagnostic>),
    /// The match ended early.
    Match(monas_match::Error),
    /// The match has not two teams.
    Teams,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Files(found) => {
                let lines: Vec<String> = found.iter().map(ToString::to_string).collect();
                f.write_str(&lines.join("\n"))
            }
            Error::Match(error) => error.fmt(f),
            Error::Teams => f.write_str("a match has two teams"),
        }
    }
}

impl std::error::Error for Error {}

/// The first check that finds each fault, by `cargo xtask eval-faults`; sums follow a blank line.
const FOUND: &str = include_str!("../faults/found.txt");
/// Cycles of a body in a second.
const CYCLES: f64 = 50.0;
/// Robots of blue.
const ROBOTS: f64 = 3.0;
/// Seeds of the matches without opponents that measure the cost; the median of each figure counts.
const COST_SEEDS: u64 = 3;

/// Plays and measures every methodology. `processor_time` is that of the calling thread, and
/// `progress` takes a line for each match.
///
/// # Errors
/// A match file is missing or wrong, or a match ends early.
pub fn evaluate(
    settings: &EvaluationSettings,
    registry: &Registry,
    processor_time: &dyn Fn() -> Duration,
    progress: &mut dyn FnMut(&str),
) -> Result<Evaluation, Error> {
    let mut rows = Vec::new();
    let mut idle = Vec::new();
    for seed in 1..=COST_SEEDS {
        let plan = alone(plan(settings, Methodology::Aseme, registry)?).without_agents(1);
        let plan = plan.replace_bodies(|_, _, body| Box::new(IdleRobot(body)));
        idle.push(measure(plan, seed, settings.length, processor_time)?);
    }
    let idle = median(&idle);
    for methodology in Methodology::ALL {
        let mut play = PlayFigures::default();
        for seed in 1..=settings.seeds {
            progress(&format!("{} {seed} of {}", methodology.name(), settings.seeds));
            play = play.plus(self::play(plan(settings, methodology, registry)?, seed, settings.length)?);
        }
        let mut costs = Vec::new();
        for seed in 1..=COST_SEEDS {
            let plan = alone(plan(settings, methodology, registry)?);
            costs.push(measure(plan, seed, settings.length, processor_time)?);
        }
        let cost = median(&costs).per_robot(&idle, settings.length);
        rows.push((methodology, play, cost, sources::of(methodology)));
    }
    Ok(Evaluation { settings: settings.clone(), rows })
}

/// The match in which blue is built by a methodology.
fn plan(
    settings: &EvaluationSettings,
    methodology: Methodology,
    registry: &Registry,
) -> Result<MatchPlan, Error> {
    let plan = load(&settings.folder.join(methodology.file()), registry)?;
    Ok(match methodology {
        Methodology::Direct => direct_players(plan),
        Methodology::Agents | Methodology::Aseme => plan,
    })
}

/// Reads a match file.
///
/// # Errors
/// The diagnostics of the file and of those it refers to.
pub fn load(path: &Path, registry: &Registry) -> Result<MatchPlan, Error> {
    MatchSource::load(path, registry).map_err(Error::Files)
}

/// Builds the first team directly on its bodies: a goalie with the number 1, and attackers.
pub fn direct_players(plan: MatchPlan) -> MatchPlan {
    plan.replace_bodies(|team, number, body| match (team, number) {
        (1, 1) => Box::new(DirectRobot::new(body, DirectGoalie::default())) as Box<dyn Robot>,
        (1, _) => Box::new(DirectRobot::new(body, DirectPlayer::default())),
        _ => body,
    })
}

/// Plays a match and counts what the first team did.
///
/// # Errors
/// The match ends early.
pub fn play(plan: MatchPlan, seed: u64, length: Duration) -> Result<PlayFigures, Error> {
    let mut running = plan.start(MatchOptions { seed, record: None }).map_err(Error::Match)?;
    running.advance(length).map_err(Error::Match)?;
    let summary = running.finish().map_err(Error::Match)?;
    let [blue, red] = summary.teams.as_slice() else {
        return Err(Error::Teams);
    };
    Ok(PlayFigures {
        goals: blue.goals,
        conceded: red.goals,
        shots: blue.shots,
        shots_faced: red.shots,
        saves: blue.saves,
        falls: blue.falls,
    })
}

/// A body without a program: nothing of what it sees and hears is used.
struct IdleRobot(Box<dyn Robot>);

impl Robot for IdleRobot {
    fn anatomy(&self) -> &Anatomy {
        self.0.anatomy()
    }

    fn sense(&mut self, now: Timestamp, percepts: &mut Percepts) -> Result<(), monas_robot::Error> {
        self.0.sense(now, percepts)?;
        (percepts.sightings, percepts.announcement) = (None, None);
        percepts.heard.clear();
        Ok(())
    }

    fn act(&mut self, now: Timestamp, actuators: &Actuators) -> Result<(), monas_robot::Error> {
        self.0.act(now, actuators)
    }
}

/// The match against robots without programs.
fn alone(plan: MatchPlan) -> MatchPlan {
    let idle = |team, _, body| if team == 2 { Box::new(IdleRobot(body)) } else { body };
    plan.without_agents(2).replace_bodies(idle)
}

/// The cost of a whole match.
#[derive(Clone, Copy, Default, Debug)]
struct MatchCost {
    processor_time: Duration,
    allocations: u64,
    messages: u64,
}

fn measure(
    plan: MatchPlan,
    seed: u64,
    length: Duration,
    processor_time: &dyn Fn() -> Duration,
) -> Result<MatchCost, Error> {
    let mut running = plan.start(MatchOptions { seed, record: None }).map_err(Error::Match)?;
    let (began, allocated) = (processor_time(), monas::memory::allocations());
    running.advance(length).map_err(Error::Match)?;
    let (ended, allocations) = (processor_time(), monas::memory::allocations() - allocated);
    let messages = running.finish().map_err(Error::Match)?.messages;
    Ok(MatchCost { processor_time: ended.saturating_sub(began), allocations, messages })
}

/// The median of each figure. The match of median processor time would not do: which one that is
/// depends on the computer, and allocations and messages do not.
fn median(costs: &[MatchCost]) -> MatchCost {
    MatchCost {
        processor_time: median_of(costs, |cost| cost.processor_time),
        allocations: median_of(costs, |cost| cost.allocations),
        messages: median_of(costs, |cost| cost.messages),
    }
}

fn median_of<T: Ord + Copy + Default>(costs: &[MatchCost], figure: impl Fn(&MatchCost) -> T) -> T {
    let mut figures: Vec<T> = costs.iter().map(figure).collect();
    figures.sort_unstable();
    figures.get(figures.len() / 2).copied().unwrap_or_default()
}

impl MatchCost {
    fn per_robot(&self, idle: &MatchCost, length: Duration) -> CostFigures {
        let robot_seconds = length.as_secs_f64() * ROBOTS;
        let beyond = |all: u64, idle: u64| all.saturating_sub(idle) as f64 / robot_seconds;
        CostFigures {
            cycle: self.processor_time.div_f64((robot_seconds * CYCLES).max(1.0)),
            allocations: beyond(self.allocations, idle.allocations) / CYCLES,
            messages: beyond(self.messages, idle.messages),
        }
    }
}

impl PlayFigures {
    /// The sums of two.
    #[must_use]
    pub fn plus(self, other: PlayFigures) -> PlayFigures {
        PlayFigures {
            goals: self.goals + other.goals,
            conceded: self.conceded + other.conceded,
            shots: self.shots + other.shots,
            shots_faced: self.shots_faced + other.shots_faced,
            saves: self.saves + other.saves,
            falls: self.falls + other.falls,
        }
    }

    /// The counts with their names in tables.
    pub fn counts(&self) -> [(&'static str, u32); 6] {
        [
            ("goals", self.goals),
            ("goals conceded", self.conceded),
            ("shots", self.shots),
            ("shots faced", self.shots_faced),
            ("saves", self.saves),
            ("falls", self.falls),
        ]
    }
}

/// The figures of one methodology.
pub type Row = (Methodology, PlayFigures, CostFigures, SourceFigures);
/// The text of a figure of a row.
type Figure<'a> = &'a dyn Fn(&Row) -> String;

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seeds, seconds) = (self.settings.seeds, self.settings.length.as_secs());
        writeln!(f, "{seeds} matches of {seconds} s each, against the team of config/match.xml\n")?;
        write!(f, "{:<44}", "")?;
        for (methodology, ..) in &self.rows {
            write!(f, "{:>11}", methodology.name())?;
        }
        writeln!(f)?;
        let lines: [(&str, Figure<'_>); 16] = [
            ("goals", &|row| row.1.goals.to_string()),
            ("goals conceded", &|row| row.1.conceded.to_string()),
            ("shots", &|row| row.1.shots.to_string()),
            ("shots faced", &|row| row.1.shots_faced.to_string()),
            ("saves", &|row| row.1.saves.to_string()),
            ("falls", &|row| row.1.falls.to_string()),
            ("processor time a cycle, with the field, us", &|row| {
                format!("{:.1}", row.2.cycle.as_secs_f64() * 1e6)
            }),
            ("allocations a cycle of a robot", &|row| format!("{:.2}", row.2.allocations)),
            ("messages a second of a robot", &|row| format!("{:.0}", row.2.messages)),
            ("lines written: goalie", &|row| row.3.goalie_lines.to_string()),
            ("lines written: both players", &|row| row.3.written_lines.to_string()),
            ("lines of activities used only by behaviours", &|row| row.3.activity_lines.to_string()),
            ("lines generated", &|row| row.3.generated_lines.to_string()),
            ("state variables kept by hand", &|row| row.3.state_variables.to_string()),
            ("coupling: names imported by a unit, mean", &|row| format!("{:.1}", row.3.coupling)),
            ("cohesion: most decisions in one unit", &|row| row.3.decisions.to_string()),
        ];
        for (name, figure) in lines {
            write!(f, "{name:<44}")?;
            for row in &self.rows {
                write!(f, "{:>11}", figure(row))?;
            }
            writeln!(f)?;
        }
        let sums = FOUND.split_once("\n\n").map_or("", |(_, sums)| sums);
        write!(f, "\n{sums}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_a_figure_does_not_depend_on_the_others() {
        let cost = |milliseconds, allocations, messages| MatchCost {
            processor_time: Duration::from_millis(milliseconds),
            allocations,
            messages,
        };
        for times in [[1, 2, 3], [2, 3, 1], [3, 1, 2]] {
            let MatchCost { processor_time, allocations, messages } =
                median(&[cost(times[0], 10, 300), cost(times[1], 20, 100), cost(times[2], 30, 200)]);
            assert_eq!((processor_time, allocations, messages), (Duration::from_millis(2), 20, 200));
        }
        assert_eq!(median(&[]).messages, 0);
    }
}
