//! Metrics as text and JSON.

use std::io::{self, Write};

use monas_terminal::{memory, millis, table};
use serde_json::{Value, json};

use super::metrics::{ActivityFigures, AgentFigures, Metrics};

/// Maximum number of listed topics.
const MAX_TOPICS: usize = 10;

pub(crate) const AGENT_HEADER: [&str; 10] =
    ["host", "agent", "state", "Hz", "of", "core", "mean", "p99", "overruns", "missed"];
pub(crate) const ACTIVITY_HEADER: [&str; 9] =
    ["activity", "state", "", "calls/s", "core", "mean", "p99", "failures", "memory"];

pub(crate) fn text(figures: &Metrics, out: &mut dyn Write) -> io::Result<()> {
    figures.alarms.iter().try_for_each(|alarm| writeln!(out, "alarm: {alarm}"))?;
    writeln!(out, "{}", table::of_numbers(AGENT_HEADER, 3, figures.agents.iter().map(agent)))?;
    for agent in figures.agents.iter().filter(|agent| !agent.activities.is_empty()) {
        writeln!(out, "\n{} on {}", agent.entry.name, agent.entry.host)?;
        writeln!(out, "{}", table::of_numbers(ACTIVITY_HEADER, 3, agent.activities.iter().map(activity)))?;
    }
    let topics = figures
        .topics
        .iter()
        .take(MAX_TOPICS)
        .map(|topic| [topic.host.clone(), topic.path.clone(), topic.publisher.clone(), number(topic.hz)]);
    writeln!(out, "\n{}", table::of_numbers(["host", "topic", "by", "Hz"], 3, topics))
}

pub(crate) fn agent(agent: &AgentFigures) -> [String; 10] {
    let AgentFigures { entry, hz, load, overruns, .. } = agent;
    let times = entry.cycle_time.as_ref();
    let new = if *overruns > 0 { format!(" (+{overruns})") } else { String::new() };
    [
        entry.host.clone(),
        entry.name.clone(),
        entry.state.clone(),
        number(*hz),
        if entry.frequency > 0.0 { entry.frequency.to_string() } else { "-".into() },
        share(*load),
        millis(times.map(|times| times.mean)),
        millis(times.map(|times| times.p99)),
        format!("{}{new}", entry.overruns),
        entry.missed.to_string(),
    ]
}

pub(crate) fn activity(activity: &ActivityFigures) -> [String; 9] {
    let ActivityFigures { entry, hz, load, remark, .. } = activity;
    let times = entry.call_time.as_ref();
    [
        entry.name.clone(),
        table::state_name(&entry.state),
        remark.map_or_else(String::new, |remark| remark.name().into()),
        number(*hz),
        share(*load),
        millis(times.map(|times| times.mean)),
        millis(times.map(|times| times.p99)),
        entry.failures.to_string(),
        memory(entry.held),
    ]
}

pub(crate) fn number(value: f64) -> String {
    format!("{value:.1}")
}

pub(crate) fn share(load: Option<f64>) -> String {
    load.map_or_else(|| "-".into(), |load| format!("{:.1} %", load * 100.0))
}

/// One object per alarm, then one per agent and one per topic.
pub(crate) fn objects(figures: &Metrics) -> impl Iterator<Item = Value> {
    let agents = figures.agents.iter().map(|agent| {
        let activities: Vec<Value> = agent
            .activities
            .iter()
            .map(|one| {
                json!({"name": one.entry.name, "state": one.entry.state, "calls_per_second": one.hz, "core": one.load,
                    "failures": one.entry.failures, "held_bytes": one.entry.held, "remark": one.remark.map(|remark| remark.name())})
            })
            .collect();
        json!({"host": agent.entry.host, "agent": agent.entry.name, "state": agent.entry.state, "hz": agent.hz,
            "frequency": agent.entry.frequency, "core": agent.load, "overruns": agent.entry.overruns,
            "new_overruns": agent.overruns, "missed": agent.entry.missed, "activities": activities})
    });
    let topics = figures.topics.iter().map(|topic| {
        json!({"host": topic.host, "topic": topic.path, "publisher": topic.publisher, "hz": topic.hz})
    });
    figures.alarms.iter().map(|alarm| json!({ "alarm": alarm })).chain(agents).chain(topics)
}
