//! The results of a match: tables for people, one JSON object per line for programs.

use std::io::{self, Write};
use std::time::Duration;

use monas_match::{AgentSummary, LeagueCounts, MatchSummary, TeamSummary};
use monas_terminal::table::Table;
use monas_terminal::{Format, table};
use serde_json::{Value, json};

use super::{bodies, coverage, links};

/// Writes the results; `wall` is the wall-clock time of the match.
pub(crate) fn write(
    out: &mut dyn Write,
    format: Format,
    summary: &MatchSummary,
    wall: Duration,
) -> io::Result<()> {
    match format {
        Format::Text => write_text(out, summary, wall),
        Format::Json => objects(summary, wall).iter().try_for_each(|object| writeln!(out, "{object}")),
    }
}

fn write_text(out: &mut dyn Write, summary: &MatchSummary, wall: Duration) -> io::Result<()> {
    writeln!(out, "{}\n", teams(&summary.teams))?;
    writeln!(out, "{}\n", agents(summary))?;
    bodies::write(out, Format::Text, &summary.bodies)?;
    for AgentSummary { host, agent, stopped, .. } in &summary.agents {
        if let Some(reason) = stopped {
            writeln!(out, "{agent} on {host} has stopped: {reason}\n")?;
        }
    }
    links::write(out, &summary.links)?;
    coverage::by_role(&summary.coverage).iter().try_for_each(|role| coverage::write(out, role))?;
    if let Some(time) = summary.time_to_first_touch {
        writeln!(out, "from kick-off to the first touch: {:.1} s on average", time.as_secs_f64())?;
    }
    let (simulated, taken) = (summary.simulated.as_secs_f64(), wall.as_secs_f64());
    writeln!(
        out,
        "{simulated:.1} s of play in {taken:.1} s: {:.1} simulated seconds per wall second",
        speed(summary, wall)
    )?;
    if let Some(LeagueCounts { control, reports, refused }) = summary.league {
        writeln!(
            out,
            "GameController: {control} announcements, {reports} reports of robots, {refused} refused"
        )?;
    }
    writeln!(out, "messages: {}", summary.messages)?;
    summary.hash.iter().try_for_each(|hash| writeln!(out, "hash: {hash}"))
}

/// The cell of a team in one row.
type TableColumn = fn(&TeamSummary) -> String;

/// A row for each quantity, a column for each team.
fn teams(teams: &[TeamSummary]) -> Table {
    let figures: [(&str, TableColumn); 10] = [
        ("goals", |team| team.goals.to_string()),
        ("kicks", |team| team.kicks.to_string()),
        ("shots", |team| team.shots.to_string()),
        ("saves", |team| team.saves.to_string()),
        ("falls", |team| team.falls.to_string()),
        ("penalties", |team| team.penalties.to_string()),
        ("possession", |team| percentage(team.possession)),
        ("dives and falls to a side", |team| team.actions.to_string()),
        ("of these to the ball's side", |team| {
            share(team.actions_to_ball, team.actions).map_or_else(none, percentage)
        }),
        ("back between the posts after", |team| {
            return_time(team).map_or_else(none, |seconds| format!("{seconds:.1} s"))
        }),
    ];
    let header = std::iter::once(String::new()).chain(teams.iter().map(|team| team.name.clone()));
    let row = |(name, figure): (&str, TableColumn)| {
        std::iter::once(name.to_string()).chain(teams.iter().map(figure))
    };
    table::of_numbers(header, 1, figures.into_iter().map(row))
}

fn percentage(share: f64) -> String {
    format!("{:.0} %", share * 100.0)
}

/// The cell of a quantity that was not measured.
fn none() -> String {
    "-".into()
}

fn share(part: u32, whole: u32) -> Option<f64> {
    (whole > 0).then(|| f64::from(part) / f64::from(whole))
}

/// The goalie's mean time from an action until it stands between its posts again, s.
fn return_time(team: &TeamSummary) -> Option<f64> {
    (team.returns > 0).then(|| team.return_seconds / f64::from(team.returns))
}

/// The agents; in real time with their load of a core and the durations of their cycles.
fn agents(summary: &MatchSummary) -> Table {
    let is_real = summary.hash.is_none();
    let row = |agent: &AgentSummary| {
        let counts = [agent.cycles, agent.overruns, agent.micro_steps, agent.activity_calls];
        let mut cells = vec![agent.host.clone(), agent.agent.clone()];
        cells.extend(counts.map(|count| count.to_string()));
        if is_real {
            let load = load(agent, summary.simulated);
            cells.push(load.map_or_else(none, |load| format!("{:.2} %", load * 100.0)));
            cells.extend(bodies::median_and_p99(agent.cycle));
        }
        cells
    };
    let mut header = vec!["host", "agent", "cycles", "overruns", "micro-steps", "activity calls"];
    if is_real {
        header.extend(["core", "p50 ms", "p99 ms"]);
    }
    table::of_numbers(header, 2, summary.agents.iter().map(row))
}

/// The share of a core that the activities of an agent have used.
fn load(agent: &AgentSummary, length: Duration) -> Option<f64> {
    let used = agent.cpu?.as_secs_f64();
    (!length.is_zero()).then(|| used / length.as_secs_f64())
}

/// One object for each event, team, agent and link, and one for the run.
fn objects(summary: &MatchSummary, wall: Duration) -> Vec<Value> {
    let events = summary
        .events
        .iter()
        .map(|event| json!({"kind": "event", "seconds": event.time.as_secs_f64(), "text": event.text}));
    let teams = summary.teams.iter().map(team_object);
    let agents = summary.agents.iter().map(|agent| agent_object(agent, summary.simulated));
    let bodies = summary.bodies.iter().map(bodies::object);
    let roles = coverage::by_role(&summary.coverage);
    let league = summary.league.map(|league| {
        json!({"kind": "gamecontroller", "announcements": league.control, "reports": league.reports,
            "refused": league.refused})
    });
    let run = json!({
        "kind": "run",
        "simulated_seconds": summary.simulated.as_secs_f64(),
        "wall_seconds": wall.as_secs_f64(),
        "simulated_seconds_per_wall_second": speed(summary, wall),
        "seconds_to_first_touch": summary.time_to_first_touch.map(|time| time.as_secs_f64()),
        "messages": summary.messages,
        "hash": summary.hash,
    });
    events
        .chain(teams)
        .chain(agents)
        .chain(bodies)
        .chain(roles.iter().map(coverage::object))
        .chain(links::objects(&summary.links))
        .chain(league)
        .chain(std::iter::once(run))
        .collect()
}

fn team_object(team: &TeamSummary) -> Value {
    json!({"kind": "team", "name": team.name, "colour": team.colour, "goals": team.goals, "shots": team.shots,
        "saves": team.saves, "falls": team.falls, "penalties": team.penalties, "possession": team.possession,
        "kicks": team.kicks, "actions": team.actions, "actions_to_ball": team.actions_to_ball,
        "return_seconds": return_time(team)})
}

fn agent_object(agent: &AgentSummary, length: Duration) -> Value {
    json!({"kind": "agent", "host": agent.host, "agent": agent.agent, "cycles": agent.cycles,
        "overruns": agent.overruns, "micro_steps": agent.micro_steps, "activity_calls": agent.activity_calls,
        "core_share": load(agent, length),
        "cycle_p50_seconds": agent.cycle.map(|cycle| cycle.p50.as_secs_f64()),
        "cycle_p99_seconds": agent.cycle.map(|cycle| cycle.p99.as_secs_f64()),
        "stopped": agent.stopped})
}

/// Simulated seconds per wall-clock second; the wall time is at least 1 ns.
fn speed(summary: &MatchSummary, wall: Duration) -> f64 {
    summary.simulated.as_secs_f64() / wall.as_secs_f64().max(1e-9)
}
