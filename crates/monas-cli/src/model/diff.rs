//! `monas model diff`: what differs between two charts.

use std::path::Path;

use aseme::diff::{self, Change, Difference, Part};
use serde_json::{Value, json};
use yase::{Statechart, export};

use super::{valid_chart, write};
use crate::arguments::{DiffArguments, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(crate) fn execute(arguments: &DiffArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let before = valid_chart(&arguments.before, format, console)?;
    let after = valid_chart(&arguments.after, format, console)?;
    let difference = diff::diff(&before, &after);
    if let Some(output) = &arguments.output {
        let drawing = drawing(output, &before, &after, &difference)?;
        write(Some(output), &drawing, format, console)?;
    }
    for change in &difference.changes {
        match format {
            Format::Text => writeln!(console.out, "{change}")?,
            Format::Json => writeln!(console.out, "{}", object(change))?,
        }
    }
    if format == Format::Text {
        writeln!(console.out, "{}", summary(&difference))?;
    }
    Ok(if difference.is_empty() { Exit::Success } else { Exit::Diverged })
}

fn drawing(
    output: &Path,
    before: &Statechart,
    after: &Statechart,
    difference: &Difference,
) -> Result<String, Failure> {
    let picture = diff::picture(before, after, difference);
    match output.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => Ok(export::to_svg_marked(&picture.chart, &picture.marks)),
        Some("dot" | "gv") => Ok(export::to_dot_marked(&picture.chart, &picture.marks).text),
        _ => Err(Failure::Usage(format!("`{}` is no drawing: let it end in .svg or .dot", output.display()))),
    }
}

fn object(change: &Change) -> Value {
    json!({
        "change": change.kind.word(),
        "part": change.part.word(),
        "name": change.name,
        "before": change.before,
        "after": change.after,
    })
}

/// `2 differences: 1 state, 1 transition`
fn summary(difference: &Difference) -> String {
    let parts = [Part::State, Part::Transition, Part::Order, Part::Constant];
    let counted = parts.into_iter().filter_map(|part| {
        let count = difference.changes.iter().filter(|change| change.part == part).count();
        (count > 0).then(|| format!("{count} of {}s", part.word()))
    });
    let counted: Vec<String> = counted.collect();
    match difference.changes.len() {
        0 => "no difference".into(),
        1 => "1 difference".into(),
        count => format!("{count} differences: {}", counted.join(", ")),
    }
}
