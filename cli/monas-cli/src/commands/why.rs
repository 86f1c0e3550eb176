//! `monas why`: why a state was active at a moment of a tape, or a transition fired or not.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use monas::duration;
use monas_studio::{
    ChainLink, Explanation, GuardAtom, MessageChain, ReadValue, TapeRun, TransitionExplanation,
    TransitionQuestion, Verdict, WhyQuestion,
};
use monas_tape::Recording;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, failed};
use serde_json::{Value, json};

use crate::input::{check_within, recorded_charts, run_of};

#[derive(Args, Debug)]
pub(crate) struct WhyArguments {
    /// The tape.
    #[arg(value_hint = ValueHint::FilePath)]
    tape: PathBuf,
    /// The host (a robot of a match).
    host: String,
    /// The state: its name, or as much of the end of it as only one state has.
    #[arg(long, value_name = "NAME", required_unless_present = "transition", conflicts_with = "transition")]
    state: Option<String>,
    /// The transition: its number, or `A -> B` with as much of the end of both names as only one
    /// transition has.
    #[arg(long, value_name = "A -> B")]
    transition: Option<String>,
    /// The moment, in seconds of the run, for example 31.4 or 1min.
    #[arg(long, value_name = "SECONDS", value_parser = moment)]
    at: f64,
    /// The agent; not needed if only one agent of the host has such a state or transition.
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
    let WhyArguments { tape, host, state, transition, at, agent, format } = arguments;
    let format = format.value;
    let recording = Recording::open(tape).map_err(failed(format))?;
    let overview = recording.overview().map_err(failed(format))?;
    let is_whole = run_of(tape, &overview).is_ok();
    check_within("--at", *at, &overview)?;
    let charts = recorded_charts(&recording, format)?;
    let tape = TapeRun::new("", recording, &charts, None);
    let tape = tape.map_err(|error| CommandFailure::failed(format, error))?;
    let (agent, seconds) = (agent.as_deref(), *at);
    let refused = |reason: String| CommandFailure::failed(format, reason);
    let (object, lines) = match transition {
        Some(transition) => {
            let question = TransitionQuestion { host, agent, transition, seconds };
            let why = tape.explain_transition(&question).map_err(refused)?;
            (json!(why), transition_lines(&why, *at, is_whole))
        }
        None => {
            let state = state.as_deref().unwrap_or_default();
            let why = tape.explain(&WhyQuestion { host, agent, state, seconds }).map_err(refused)?;
            (json!(why), lines(&why, *at, is_whole))
        }
    };
    match format {
        Format::Json => writeln!(console.out, "{object}")?,
        Format::Text => {
            for line in lines {
                writeln!(console.out, "{line}")?;
            }
        }
    }
    Ok(Exit::Success)
}

/// An explanation as text. A tape that is not whole does not tell what never happened.
fn lines(why: &Explanation, at: f64, is_whole: bool) -> Vec<String> {
    let Explanation { host, agent, state, is_active, entered, begins, left, segments } = why;
    let cut =
        begins.map(|begins| format!("its steps are on the tape from {begins:.3} s on")).unwrap_or_default();
    let mut lines = vec![match (entered, left) {
        (None, None) if *is_active => {
            format!("{host} {agent} was in {state} at {at:.3} s, since an earlier time; {cut}")
        }
        (None, Some(left)) => format!(
            "{host} {agent} was not in {state} at {at:.3} s; it was last up to {left:.3} s, and {cut}"
        ),
        (None, None) if begins.is_some() => {
            format!("{host} {agent} was not in {state} up to {at:.3} s as far as recorded; {cut}")
        }
        (None, None) => format!("{host} {agent} was not in {state} up to {at:.3} s"),
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
        lines.extend(segment.reads.iter().map(|read| format!("    {}", read_line(read, is_whole))));
    }
    lines
}

/// The explanation of a transition as text.
fn transition_lines(why: &TransitionExplanation, at: f64, is_whole: bool) -> Vec<String> {
    let TransitionExplanation { host, agent, number, source, target, text, reason, .. } = why;
    let text = if text.is_empty() { String::new() } else { format!(" : {text}") };
    let mut lines = vec![format!("{host} {agent}, transition {number}: {source} -> {target}{text}")];
    let when = |time: Option<f64>, otherwise: &str| {
        time.map_or_else(|| otherwise.to_owned(), |time| format!("at {time:.3} s"))
    };
    let before = if is_whole { "never" } else { "before the tape, if at all" };
    lines.push(match (why.verdict, why.judged) {
        (Verdict::Waits | Verdict::NotReached, _) | (_, None) => {
            format!("did not fire at {at:.3} s: {reason}")
        }
        (_, Some(judged)) => format!("at {judged:.3} s: {reason}"),
    });
    lines.push(format!(
        "fired last {}, fires next {}",
        when(why.fired, before),
        when(why.next, "after the tape, if at all")
    ));
    for trigger in &why.triggers {
        lines.push(format!("  trigger `{}`: arrived last {}", trigger.text, when(trigger.arrived, before)));
    }
    for GuardAtom { text, value, reads } in &why.atoms {
        let value = value.map_or("unknown", |value| if value { "true" } else { "false" });
        lines.push(format!("  {value:7} {text}"));
        lines.extend(reads.iter().map(|read| format!("            {}", read_line(read, is_whole))));
    }
    for MessageChain { links } in &why.chains {
        lines.push("  the messages behind it, each followed by those that were read for it".to_owned());
        lines.extend(links.iter().map(link_line));
    }
    lines
}

fn link_line(link: &ChainLink) -> String {
    let ChainLink { depth, host, publisher, activity, topic, sequence, published, end } = link;
    let of = activity.as_ref().map(|activity| format!("{activity} of ")).unwrap_or_default();
    let end = end.as_ref().map(|end| format!("; {end}")).unwrap_or_default();
    let indent = "  ".repeat(*depth + 2);
    format!("{indent}{published:.3} s {topic} number {sequence} by {of}{publisher} on {host}{end}")
}

fn read_line(read: &ReadValue, is_whole: bool) -> String {
    let ReadValue { name, value, topic, publisher, sequence, published, .. } = read;
    let origin = match (topic, publisher, sequence, published) {
        (Some(topic), Some(publisher), Some(sequence), Some(published)) => {
            format!("number {sequence} on {topic} by {publisher}, at {published:.3} s")
        }
        (Some(topic), ..) if is_whole => format!("nothing had been delivered on {topic}"),
        (Some(topic), ..) => format!("what was delivered on {topic} is not on the tape"),
        (None, ..) if read.is_timer => match read.due {
            Some(due) => format!("timer, expires at {due:.3} s"),
            None if is_whole => "timer, never started".to_owned(),
            None => "timer, started before the tape, if at all".to_owned(),
        },
        (None, ..) => "constant".to_owned(),
    };
    match value {
        Value::Null => format!("{name}: {origin}"),
        value => format!("{name} = {value}  ({origin})"),
    }
}
