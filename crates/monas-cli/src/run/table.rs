//! What a match came to: tables for people, one JSON object a line for programs.

use std::io::{self, Write};
use std::time::Duration;

use comfy_table::{Cell, CellAlignment, Table};
use monas_match::{AgentSummary, Summary, TeamSummary};
use serde_json::{Value, json};

use super::{coverage, links};
use crate::arguments::Format;

/// Writes the results; `wall` is how long the match took.
pub(super) fn write(
    out: &mut dyn Write,
    format: Format,
    summary: &Summary,
    wall: Duration,
) -> io::Result<()> {
    match format {
        Format::Text => write_text(out, summary, wall),
        Format::Json => objects(summary, wall).iter().try_for_each(|object| writeln!(out, "{object}")),
    }
}

fn write_text(out: &mut dyn Write, summary: &Summary, wall: Duration) -> io::Result<()> {
    writeln!(out, "{}\n", teams(&summary.teams))?;
    writeln!(out, "{}\n", agents(&summary.agents))?;
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
    writeln!(out, "messages: {}", summary.messages)?;
    writeln!(out, "hash: {}", summary.hash)
}

/// What is shown of a team in one row.
type Figure = fn(&TeamSummary) -> String;

/// A row for each figure, a column for each team.
fn teams(teams: &[TeamSummary]) -> Table {
    let figures: [(&str, Figure); 10] = [
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
    let row =
        |(name, figure): (&str, Figure)| std::iter::once(name.to_string()).chain(teams.iter().map(figure));
    of_numbers(header, 1, figures.into_iter().map(row))
}

fn percentage(share: f64) -> String {
    format!("{:.0} %", share * 100.0)
}

/// What stands where there was nothing to measure.
fn none() -> String {
    "-".into()
}

fn share(part: u32, whole: u32) -> Option<f64> {
    (whole > 0).then(|| f64::from(part) / f64::from(whole))
}

/// How long the goalie needs on average from an action until it stands between its posts again, s.
fn return_time(team: &TeamSummary) -> Option<f64> {
    (team.returns > 0).then(|| team.return_seconds / f64::from(team.returns))
}

fn agents(agents: &[AgentSummary]) -> Table {
    let row = |agent: &AgentSummary| {
        let counts = [agent.cycles, agent.overruns, agent.micro_steps, agent.activity_calls];
        [agent.host.clone(), agent.agent.clone()].into_iter().chain(counts.map(|count| count.to_string()))
    };
    let header = ["host", "agent", "cycles", "overruns", "micro-steps", "activity calls"];
    of_numbers(header, 2, agents.iter().map(row))
}

/// A table in which numbers, which begin at column `first_number`, stand to the right.
pub(crate) fn of_numbers<Row: IntoIterator<Item = String>>(
    header: impl IntoIterator<Item: Into<Cell>>,
    first_number: usize,
    rows: impl IntoIterator<Item = Row>,
) -> Table {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::UTF8_FULL_CONDENSED).set_header(header);
    for row in rows {
        table.add_row(row);
    }
    for column in table.column_iter_mut().skip(first_number) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// Each event, each team, each agent, and the run.
fn objects(summary: &Summary, wall: Duration) -> Vec<Value> {
    let events = summary
        .events
        .iter()
        .map(|event| json!({"kind": "event", "seconds": event.time.as_secs_f64(), "text": event.text}));
    let teams = summary.teams.iter().map(team_object);
    let agents = summary.agents.iter().map(agent_object);
    let roles = coverage::by_role(&summary.coverage);
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
        .chain(roles.iter().map(coverage::object))
        .chain(links::objects(&summary.links))
        .chain(std::iter::once(run))
        .collect()
}

fn team_object(team: &TeamSummary) -> Value {
    json!({"kind": "team", "name": team.name, "colour": team.colour, "goals": team.goals, "shots": team.shots,
        "saves": team.saves, "falls": team.falls, "penalties": team.penalties, "possession": team.possession,
        "kicks": team.kicks, "actions": team.actions, "actions_to_ball": team.actions_to_ball,
        "return_seconds": return_time(team)})
}

fn agent_object(agent: &AgentSummary) -> Value {
    json!({"kind": "agent", "host": agent.host, "agent": agent.agent, "cycles": agent.cycles,
        "overruns": agent.overruns, "micro_steps": agent.micro_steps, "activity_calls": agent.activity_calls})
}

/// Simulated seconds a wall second; of a run that took no time, as of one that took a nanosecond.
fn speed(summary: &Summary, wall: Duration) -> f64 {
    summary.simulated.as_secs_f64() / wall.as_secs_f64().max(1e-9)
}
