//! `monas agent list`: the agents of a run with their statistics.

use monas::records::{ActivityEntry, AgentEntry, Inquiry, Times};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, memory, millis, table};
use serde_json::{Value, json};

use crate::remote::{RunSelector, request, unexpected_reply};

pub(crate) fn execute(
    agent: Option<&str>,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let reply = request(Inquiry { agents: true, ..Inquiry::default() }, run)?;
    let mut agents = reply.agents.ok_or_else(|| unexpected_reply(run))?.agents;
    if let Some(name) = agent {
        let known: Vec<String> = agents.iter().map(|agent| agent.name.clone()).collect();
        agents.retain(|agent| agent.name == name);
        if agents.is_empty() {
            return Err(CommandFailure::failed(run.format.value, no_agents(name, &known)));
        }
    }
    match (run.format.value, agent) {
        (Format::Json, _) => {
            agents.iter().try_for_each(|agent| writeln!(console.out, "{}", object(agent)))?
        }
        (Format::Text, None) => {
            let header =
                ["host", "agent", "state", "Hz", "priority", "cycles", "overruns", "mean cycle", "longest"];
            writeln!(console.out, "{}", table::of_numbers(header, 3, agents.iter().map(row)))?;
            for agent in agents.iter().filter(|agent| !agent.reason.is_empty()) {
                writeln!(console.out, "{} of {}: {}", agent.name, agent.host, agent.reason)?;
            }
        }
        (Format::Text, Some(_)) => agents.iter().try_for_each(|agent| describe(agent, console))?,
    }
    Ok(Exit::Success)
}

fn no_agents(name: &str, known: &[String]) -> String {
    let names = || known.iter().map(String::as_str);
    match yase::diagnostic::nearest(name, names()) {
        Some(near) => format!("no agent is named `{name}`; did you mean `{near}`?"),
        None => format!("no agent is named `{name}`"),
    }
}

fn row(agent: &AgentEntry) -> [String; 9] {
    let times = agent.cycle_time.as_ref();
    [
        agent.host.clone(),
        agent.name.clone(),
        agent.state.clone(),
        hertz(agent),
        agent.priority.to_string(),
        agent.cycles.to_string(),
        agent.overruns.to_string(),
        millis(times.map(|times| times.mean)),
        millis(times.map(|times| times.longest)),
    ]
}

fn hertz(agent: &AgentEntry) -> String {
    let has_list = agent.activities.iter().any(|activity| activity.state.is_empty());
    match agent.frequency > 0.0 {
        true => agent.frequency.to_string(),
        false if has_list => "free".into(),
        false => "-".into(),
    }
}

fn describe(agent: &AgentEntry, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
    let AgentEntry { host, name, state, reason, .. } = agent;
    let because = if reason.is_empty() { String::new() } else { format!(", {reason}") };
    writeln!(console.out, "{name} on {host}: {state}{because}")?;
    writeln!(
        console.out,
        "  frequency {}, priority {}, on failure {}, cycles {}, overruns {}",
        hertz(agent),
        agent.priority,
        agent.on_failure,
        agent.cycles,
        agent.overruns
    )?;
    for chart in &agent.charts {
        let active: Vec<String> = chart.active.iter().map(|path| table::state_name(path)).collect();
        let active = active.join(", ");
        let is = match chart.state.as_str() {
            "runs" => format!("in {active}"),
            "stopped" => "stopped".into(),
            state => format!("{state} in {active}"),
        };
        writeln!(console.out, "  chart {}: {is}", chart.model)?;
    }
    let header =
        ["", "activity", "parameters", "state", "calls", "failures", "mean call", "longest", "memory"];
    let rows = agent.activities.iter().zip(1..).map(activity);
    writeln!(console.out, "{}", table::of_numbers(header, 4, rows))?;
    Ok(())
}

fn activity((activity, index): (&ActivityEntry, usize)) -> [String; 9] {
    let parameters: Vec<String> =
        activity.parameters.iter().map(|one| format!("{}={}", one.key, one.value)).collect();
    let times = activity.call_time.as_ref();
    let order = if activity.state.is_empty() { index.to_string() } else { String::new() };
    [
        order,
        activity.name.clone(),
        parameters.join(" "),
        table::state_name(&activity.state),
        activity.calls.to_string(),
        activity.failures.to_string(),
        millis(times.map(|times| times.mean)),
        millis(times.map(|times| times.longest)),
        if activity.grows { format!("{}, grows", memory(activity.held)) } else { memory(activity.held) },
    ]
}

fn object(agent: &AgentEntry) -> Value {
    let times = |times: Option<&Times>| {
        times.map(|times| {
            json!({"count": times.count, "mean_seconds": times.mean, "deviation_seconds": times.deviation,
                "longest_seconds": times.longest, "cpu_mean_seconds": times.cpu_mean,
                "cpu_deviation_seconds": times.cpu_deviation, "p50_seconds": times.p50, "p90_seconds": times.p90,
                "p99_seconds": times.p99, "p999_seconds": times.p999})
        })
    };
    let activities: Vec<Value> = agent
        .activities
        .iter()
        .map(|activity| {
            let parameters: serde_json::Map<String, Value> =
                activity.parameters.iter().map(|one| (one.key.clone(), one.value.clone().into())).collect();
            json!({"name": activity.name, "state": activity.state, "parameters": parameters, "calls": activity.calls,
                "failures": activity.failures, "held_bytes": activity.held, "grows": activity.grows, "loops": activity.loops,
                "call_time": times(activity.call_time.as_ref())})
        })
        .collect();
    let charts: Vec<Value> =
        agent.charts.iter().map(|chart| json!({"model": chart.model, "name": chart.name, "state": chart.state, "active": chart.active})).collect();
    json!({"host": agent.host, "agent": agent.name, "state": agent.state, "reason": agent.reason,
        "frequency": agent.frequency, "priority": agent.priority, "on_failure": agent.on_failure,
        "cycles": agent.cycles, "overruns": agent.overruns, "missed": agent.missed, "micro_steps": agent.micro_steps,
        "cycle_time": times(agent.cycle_time.as_ref()), "activities": activities, "charts": charts})
}
