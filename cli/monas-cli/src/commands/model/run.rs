//! `monas model run`: plays a scenario or a trace on a chart.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme_verify::composition::{PlayedStep, TeamTrace};
use clap::{Args, ValueHint};
use monas::config;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument};
use serde_json::json;
use yase::{CompiledChart, Diagnostic, Machine, MachineError, Source, Span};
use yase_explore::{ParseError, Trace, TraceStep, replay};

use super::robot_file::named;
use super::scenario;

/// Arguments of `monas model run`.
#[derive(Args, Debug)]
pub(crate) struct PlayArguments {
    /// The model file; for a trace of several robots one file each, as `NAME=CHART` if the robot is
    /// not named after its file.
    #[arg(required = true, value_name = "CHART", value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// The scenario or the trace.
    #[arg(value_name = "SCENARIO", value_hint = ValueHint::FilePath)]
    pub(crate) trace: PathBuf,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &PlayArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let PlayArguments { files, trace, format } = arguments;
    let format = format.value;
    let text = read(trace, format)?;
    if TeamTrace::is_one(&text.text) {
        return play_together(files, &text, format, console);
    }
    let [file] = files.as_slice() else {
        let trace = trace.display();
        return Err(CommandFailure::Usage(format!(
            "`{trace}` is a trace of one chart, but there are {}",
            files.len()
        )));
    };
    if scenario::is_one(&text) {
        return scenario::run(file, trace, format, console);
    }
    let chart = explorable(file, format)?;
    let hint = "this is read as a trace: a scenario begins with `model FILE`";
    let trace = Trace::parse(&chart, &text.text).map_err(|error| no_trace(error, hint, &text, format))?;
    play(&chart, &trace, format, console)
}

fn read(path: &Path, format: Format) -> Result<Arc<Source>, CommandFailure> {
    config::read_file(path).map_err(|unread| CommandFailure::Invalid(format, vec![*unread]))
}

fn explorable(path: &Path, format: Format) -> Result<Arc<CompiledChart>, CommandFailure> {
    aseme_verify::explorable(&read(path, format)?).map_err(|wrong| CommandFailure::Invalid(format, wrong))
}

fn no_trace(error: ParseError, hint: &str, text: &Arc<Source>, format: Format) -> CommandFailure {
    let span = line(&text.text, error.line);
    let wrong = Diagnostic::error("E0290", span, error.message).with_hint(hint).in_source(text);
    CommandFailure::Invalid(format, vec![wrong])
}

/// Plays a trace of several robots, each on its chart.
fn play_together(
    files: &[PathBuf],
    text: &Arc<Source>,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let mut robots = Vec::new();
    for (name, file) in named(files)? {
        robots.push((name, explorable(&file, format)?));
    }
    let charts: Vec<(&str, &Arc<CompiledChart>)> =
        robots.iter().map(|(name, chart)| (name.as_str(), chart)).collect();
    let hint = "this is read as a trace of several robots: give the chart of each, `NAME=CHART` if the robot is not named after its file";
    let joint = TeamTrace::parse(&charts, &text.text).map_err(|error| no_trace(error, hint, text, format))?;
    let (played, stopped) = joint.play();
    for PlayedStep { robot, step, records, active, .. } in &played {
        let name = charts.get(*robot).map_or("", |(name, _)| name);
        writeln!(console.out, "{}", step_text(Some(name), step, records, active, format))?;
    }
    report_error(stopped, format, console)
}

/// The span of a line, counted from 1.
fn line(text: &str, number: usize) -> Span {
    let start = text.split_inclusive('\n').take(number.saturating_sub(1)).map(str::len).sum();
    let length = text.lines().nth(number.saturating_sub(1)).map_or(0, str::len);
    Span::new(start, start + length)
}

fn play(
    chart: &Arc<CompiledChart>,
    trace: &Trace,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let mut lines = Vec::new();
    let played = replay(trace, |machine, step, records| {
        lines.push(trace_step_text(chart, trace, machine, step, records, format));
    });
    for line in lines {
        writeln!(console.out, "{line}")?;
    }
    report_error(played.err(), format, console)
}

/// Reports the error that stopped a chart, if any.
fn report_error(
    stopped: Option<MachineError>,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match (stopped, format) {
        (None, _) => return Ok(Exit::Success),
        (Some(error), Format::Text) => writeln!(console.out, "{error}")?,
        (Some(error), Format::Json) => writeln!(console.out, "{}", json!({"error": error.to_string()}))?,
    }
    Ok(Exit::Diverged)
}

/// The cause of a step, its records, and the states after it.
fn trace_step_text(
    chart: &CompiledChart,
    trace: &Trace,
    machine: &Machine,
    step: &TraceStep,
    records: &[String],
    format: Format,
) -> String {
    let cause = trace.text_of(step);
    let name = |node| match format {
        Format::Text => chart.names().name(node).to_owned(),
        Format::Json => chart.short_path(node),
    };
    let active: Vec<String> = machine.configuration().into_iter().map(name).collect();
    step_text(None, &cause, records, &active, format)
}

/// A step of a chart, prefixed by the robot's name if there are several.
fn step_text(
    robot: Option<&str>,
    step: &str,
    records: &[String],
    active: &[String],
    format: Format,
) -> String {
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
