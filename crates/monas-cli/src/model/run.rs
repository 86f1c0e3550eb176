//! `monas model run`: a scenario or a trace played on a chart.

use std::path::Path;
use std::sync::Arc;

use monas::config;
use serde_json::{Value, json};
use yase::explore::{Step, Trace, replay};
use yase::{Diagnostic, Machine, Span};

use super::scenario;
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(crate) fn execute(
    file: &Path,
    trace: &Path,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let read =
        |path: &Path| config::read_file(path).map_err(|unread| Failure::Invalid(format, vec![*unread]));
    let text = read(trace)?;
    if scenario::is_one(&text) {
        return scenario::run(file, trace, format, console);
    }
    let model = read(file)?;
    let chart = aseme::check::explorable(&model).map_err(|wrong| Failure::Invalid(format, wrong))?;
    let trace = Trace::parse(&chart, &text.text).map_err(|error| {
        let place = line(&text.text, error.line);
        let wrong = Diagnostic::error("E0290", place, error.message)
            .with_hint("this is read as a trace: a scenario begins with `model FILE`")
            .in_source(&text);
        Failure::Invalid(format, vec![wrong])
    })?;
    play(&chart, &trace, format, console)
}

/// The place of a line, from 1.
fn line(text: &str, number: usize) -> Span {
    let start = text.split_inclusive('\n').take(number.saturating_sub(1)).map(str::len).sum();
    let length = text.lines().nth(number.saturating_sub(1)).map_or(0, str::len);
    Span::new(start, start + length)
}

fn play(
    chart: &Arc<yase::Chart>,
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
    match (played, format) {
        (Ok(_), _) => Ok(Exit::Success),
        (Err(error), Format::Text) => {
            writeln!(console.out, "{error}")?;
            Ok(Exit::Diverged)
        }
        (Err(error), Format::Json) => {
            writeln!(console.out, "{}", json!({"error": error.to_string()}))?;
            Ok(Exit::Diverged)
        }
    }
}

/// What a step was for, what it did, and where it led.
fn told(
    chart: &yase::Chart,
    trace: &Trace,
    machine: &Machine,
    step: &Step,
    records: &[String],
    format: Format,
) -> String {
    let cause = trace.text_of(step);
    let active: Vec<String> =
        machine.configuration().into_iter().map(|node| chart.short_path(node)).collect();
    match format {
        Format::Text => {
            let records: String = records.iter().map(|record| format!("  {record}\n")).collect();
            format!("{cause}{records}  active: {}", active.join(", "))
        }
        Format::Json => {
            let object: Value = json!({"step": cause.trim_end(), "records": records, "active": active});
            object.to_string()
        }
    }
}
