//! `monas why`: why a state was active at a moment of a tape.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use monas_studio::{Explanation, ReadValue, TapeRun, WhyQuestion};
use monas_tape::Recording;
use serde_json::{Value, json};

use crate::input::recorded_charts;
use crate::terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, duration, failed};

#[derive(Args, Debug)]
pub(crate) struct WhyArguments {
    /// The tape.
    #[arg(value_hint = ValueHint::FilePath)]
    tape: PathBuf,
    /// The host (a robot of a match).
    host: String,
    /// The state: its name, or as much of the end of it as only one state has.
    #[arg(long, value_name = "NAME")]
    state: String,
    /// The moment, in seconds of the run, for example 31.4 or 1min.
    #[arg(long, value_name = "SECONDS", value_parser = moment)]
    at: f64,
    /// The agent; not needed if only one agent of the host has such a state.
    #[arg(long, value_name = "NAME")]
    agent: Option<String>,
    #[command(flatten)]
    format: FormatArgument,
}

/// Parses a moment: a number of seconds, or a duration with a unit.
fn moment(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds >= 0.0 && seconds.is_finite() => Ok(seconds),
        _ => duration::parse(text).map(|length| length.as_secs_f64()),
    }
}

pub(crate) fn execute(
    arguments: &WhyArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let WhyArguments { tape, host, state, at, agent, format } = arguments;
    let format = format.value;
    let recording = Recording::open(tape).map_err(failed(format))?;
    let charts = recorded_charts(&recording, format)?;
    let tape = TapeRun::new("", recording, &charts, None);
    let tape = tape.map_err(|error| CommandFailure::failed(format, error))?;
    let question = WhyQuestion { host, agent: agent.as_deref(), state, seconds: *at };
    let why = tape.explain(&question).map_err(|reason| CommandFailure::failed(format, reason))?;
    match format {
        Format::Json => writeln!(console.out, "{}", json!(why))?,
        Format::Text => {
            for line in lines(&why, *at) {
                writeln!(console.out, "{line}")?;
            }
        }
    }
    Ok(Exit::Success)
}

/// An explanation as text.
fn lines(why: &Explanation, at: f64) -> Vec<String> {
    let Explanation { host, agent, state, entered, left, segments, .. } = why;
    let mut lines = vec![match (entered, left) {
        (None, _) => format!("{host} {agent} was not in {state} up to {at:.3} s"),
        (Some(entered), None) => {
            format!("{host} {agent} was in {state} at {at:.3} s, since {entered:.3} s")
        }
        (Some(entered), Some(left)) => format!(
            "{host} {agent} was not in {state} at {at:.3} s; it was last from {entered:.3} s to {left:.3} s"
        ),
    }];
    for segment in segments {
        let text = if segment.text.is_empty() { String::new() } else { format!(" : {}", segment.text) };
        lines.push(format!("  {} -> {}{text}", segment.source, segment.target));
        lines.extend(segment.reads.iter().map(|read| format!("    {}", read_line(read))));
    }
    lines
}

fn read_line(read: &ReadValue) -> String {
    let ReadValue { name, value, topic, publisher, sequence, published } = read;
    let origin = match (topic, publisher, sequence, published) {
        (Some(topic), Some(publisher), Some(sequence), Some(published)) => {
            format!("number {sequence} on {topic} by {publisher}, at {published:.3} s")
        }
        (Some(topic), ..) => format!("nothing had been delivered on {topic}"),
        (None, ..) => "constant".to_owned(),
    };
    match value {
        Value::Null => format!("{name}: {origin}"),
        value => format!("{name} = {value}  ({origin})"),
    }
}
