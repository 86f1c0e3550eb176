//! `monas chart show`: the state of a statechart.

use std::path::Path;

use monas::records::{ChartChoice, ChartState, Inquiry};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, write_drawing};
use serde_json::{Value, json};
use yase::StateNames;
use yase::snapshot::{ActivityPhase, EventName, OccurrenceRecord, Snapshot};

use crate::remote::{RunSelector, request, unexpected_reply};

pub(crate) fn execute(
    agent: &str,
    chart: Option<&str>,
    output: Option<&Path>,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let choice = ChartChoice { agent: agent.into(), chart: chart.unwrap_or_default().into(), values: false };
    let state = request(Inquiry { chart: Some(choice), ..Inquiry::default() }, run)?.chart;
    let state = state.ok_or_else(|| unexpected_reply(run))?;
    if output.is_some() {
        write_drawing(output, &state.drawing, run.format.value, console)?;
    }
    match run.format.value {
        Format::Json => {
            let snapshot: Value = serde_json::from_str(&state.snapshot).map_err(|_| unexpected_reply(run))?;
            let ChartState { host, agent, model, state, .. } = &state;
            let object =
                json!({"host": host, "agent": agent, "model": model, "state": state, "snapshot": snapshot});
            writeln!(console.out, "{object}")?;
        }
        Format::Text => {
            let snapshot: Snapshot =
                serde_json::from_str(&state.snapshot).map_err(|_| unexpected_reply(run))?;
            for line in lines(&state, &snapshot) {
                writeln!(console.out, "{line}")?;
            }
        }
    }
    Ok(Exit::Success)
}

/// The state of a chart as text.
fn lines(state: &ChartState, snapshot: &Snapshot) -> Vec<String> {
    let ChartState { host, agent, model, state, .. } = state;
    let remembered = snapshot.history.iter().flat_map(|one| one.nodes.iter().chain([&one.history]));
    let names = StateNames::from_some(snapshot.configuration.iter().chain(remembered).map(String::as_str));
    let seconds = |time: yase::Timestamp| time.as_nanos() as f64 / 1e9;
    let now = seconds(snapshot.now);
    let mut lines =
        vec![format!("{} ({model}) of {agent} on {host}: {state}, last step at {now:.3} s", snapshot.chart)];
    lines.extend(snapshot.configuration.iter().map(|path| {
        let activity = snapshot.activity(path).map(|activity| {
            let asked = if activity.cancelled { ", asked to return" } else { "" };
            format!(": {} {}{asked}", activity.activity, phase(activity.phase))
        });
        format!("  in {}{}", names.short(path), activity.unwrap_or_default())
    }));
    lines.extend(snapshot.timers.iter().map(|timer| {
        let deadline = seconds(timer.deadline);
        let when = match timer.expired {
            true => format!("expired at {deadline:.3} s"),
            false => format!("expires at {deadline:.3} s"),
        };
        format!("  timer {} of {} {when}", timer.timer.name, names.short(&timer.timer.region))
    }));
    lines.extend(snapshot.history.iter().map(|one| {
        let nodes: Vec<&str> = one.nodes.iter().map(|node| names.short(node)).collect();
        format!("  {} remembers {}", names.short(&one.history), nodes.join(", "))
    }));
    for (what, events) in
        [("raised", &snapshot.raised), ("arrived", &snapshot.arrived), ("deferred", &snapshot.deferred)]
    {
        lines.extend(events.iter().map(|event| format!("  event {} {what}", name(event))));
    }
    let held =
        snapshot.held.iter().map(|held| format!("  event {} waits for activities", name(&held.occurrence)));
    lines.extend(held);
    lines
}

const fn phase(phase: ActivityPhase) -> &'static str {
    match phase {
        ActivityPhase::Queued => "is to start",
        ActivityPhase::Running => "is called",
        ActivityPhase::Ongoing => "waits for its next call",
        ActivityPhase::Failed => "has failed",
        ActivityPhase::Done => "is done",
    }
}

fn name(event: &OccurrenceRecord) -> String {
    match &event.event {
        EventName::Name(name) => name.clone(),
        EventName::Message(topic) => format!("of a message on {topic}"),
    }
}
