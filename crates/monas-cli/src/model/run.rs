//! `monas model run`: a scenario or a trace played on a chart.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme::check::compose::{Joint, Played};
use monas::config;
use serde_json::json;
use yase::explore::{ParseError, Step, Trace, replay};
use yase::{Chart, Diagnostic, Machine, MachineError, Source, Span};

use super::scenario;
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(crate) fn execute(
    files: &[PathBuf],
    trace: &Path,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let text = read(trace, format)?;
    if Joint::is_one(&text.text) {
        return play_together(files, &text, format, console);
    }
    let [file] = files else {
        let trace = trace.display();
        return Err(Failure::Usage(format!("`{trace}` is about one chart, and there are {}", files.len())));
    };
    if scenario::is_one(&text) {
        return scenario::run(file, trace, format, console);
    }
    let chart = explorable(file, format)?;
    let hint = "this is read as a trace: a scenario begins with `model FILE`";
    let trace = Trace::parse(&chart, &text.text).map_err(|error| no_trace(error, hint, &text, format))?;
    play(&chart, &trace, format, console)
}

fn read(path: &Path, format: Format) -> Result<Arc<Source>, Failure> {
    config::read_file(path).map_err(|unread| Failure::Invalid(format, vec![*unread]))
}

fn explorable(path: &Path, format: Format) -> Result<Arc<Chart>, Failure> {
    aseme::check::explorable(&read(path, format)?).map_err(|wrong| Failure::Invalid(format, wrong))
}

fn no_trace(error: ParseError, hint: &str, text: &Arc<Source>, format: Format) -> Failure {
    let place = line(&text.text, error.line);
    let wrong = Diagnostic::error("E0290", place, error.message).with_hint(hint).in_source(text);
    Failure::Invalid(format, vec![wrong])
}

/// Plays a trace of several robots, each on its chart.
fn play_together(
    files: &[PathBuf],
    text: &Arc<Source>,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let mut robots = Vec::new();
    for (name, file) in super::compose::named(files)? {
        robots.push((name, explorable(&file, format)?));
    }
    let charts: Vec<(&str, &Arc<Chart>)> =
        robots.iter().map(|(name, chart)| (name.as_str(), chart)).collect();
    let hint = "this is read as a trace of several robots: give the chart of each, `NAME=CHART` if it is not called like its robot";
    let joint = Joint::parse(&charts, &text.text).map_err(|error| no_trace(error, hint, text, format))?;
    let (played, stopped) = joint.play();
    for Played { robot, step, records, active, .. } in &played {
        let name = charts.get(*robot).map_or("", |(name, _)| name);
        writeln!(console.out, "{}", shown(Some(name), step, records, active, format))?;
    }
    ended(stopped, format, console)
}

/// The place of a line, from 1.
fn line(text: &str, number: usize) -> Span {
    let start = text.split_inclusive('\n').take(number.saturating_sub(1)).map(str::len).sum();
    let length = text.lines().nth(number.saturating_sub(1)).map_or(0, str::len);
    Span::new(start, start + length)
}

fn play(
    chart: &Arc<Chart>,
    trace: &Trace,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let mut lines = Vec::new();
    let played = replay(trace, |machine, step, records| {
        lines.push(told(chart, trace, machine, step, records, format));
    });
    for line in lines {
        writeln!(console.out, "{line}")?;
    }
    ended(played.err(), format, console)
}

/// Says why a chart has stopped by itself, if one has.
fn ended(stopped: Option<MachineError>, format: Format, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match (stopped, format) {
        (None, _) => return Ok(Exit::Success),
        (Some(error), Format::Text) => writeln!(console.out, "{error}")?,
        (Some(error), Format::Json) => writeln!(console.out, "{}", json!({"error": error.to_string()}))?,
    }
    Ok(Exit::Diverged)
}

/// What a step was for, what it did, and where it led.
fn told(
    chart: &Chart,
    trace: &Trace,
    machine: &Machine,
    step: &Step,
    records: &[String],
    format: Format,
) -> String {
    let cause = trace.text_of(step);
    let active: Vec<String> =
        machine.configuration().into_iter().map(|node| chart.short_path(node)).collect();
    shown(None, &cause, records, &active, format)
}

/// A step of a chart, of the robot of a name if there are several.
fn shown(robot: Option<&str>, step: &str, records: &[String], active: &[String], format: Format) -> String {
    match format {
        Format::Text => {
            let robot = robot.map_or_else(String::new, |name| format!("{name}: "));
            let records: String = records.iter().map(|record| format!("  {record}\n")).collect();
            format!("{robot}{step}{records}  active: {}", active.join(", "))
        }
        Format::Json => {
            let mut object = json!({"step": step.trim_end(), "records": records, "active": active});
            if let (Some(name), Some(fields)) = (robot, object.as_object_mut()) {
                fields.insert("robot".into(), name.into());
            }
            object.to_string()
        }
    }
}
