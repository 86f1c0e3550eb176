//! `monas model diff`: compares two charts.

use std::path::{Path, PathBuf};

use aseme_models::diff::{self, ChangedPart, ChartChange, ChartDifference};
use clap::{Args, ValueHint};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, write_text};
use serde_json::{Value, json};
use yase::Statechart;
use yase_export as export;

use crate::input::valid_chart;

/// Arguments of `monas model diff`.
#[derive(Args, Debug)]
pub(crate) struct DiffArguments {
    /// The old model file.
    #[arg(value_name = "A", value_hint = ValueHint::FilePath)]
    pub(crate) before: PathBuf,
    /// The new model file.
    #[arg(value_name = "B", value_hint = ValueHint::FilePath)]
    pub(crate) after: PathBuf,
    /// Draw both charts in one, with additions in green, removals in red and changes in orange: a
    /// file that ends in .svg or .dot.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &DiffArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let before = valid_chart(&arguments.before, format, console)?;
    let after = valid_chart(&arguments.after, format, console)?;
    let difference = diff::diff(&before, &after);
    if let Some(output) = &arguments.output {
        let drawing = drawing(output, &before, &after, &difference)?;
        write_text(Some(output), &drawing, format, console)?;
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
    difference: &ChartDifference,
) -> Result<String, CommandFailure> {
    let picture = diff::picture(before, after, difference);
    match output.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => Ok(export::to_svg_marked(&picture.chart, &picture.marks)),
        Some("dot" | "gv") => Ok(export::to_dot_marked(&picture.chart, &picture.marks).text),
        _ => Err(CommandFailure::Usage(format!(
            "`{}` is not a drawing: the file must end in .svg or .dot",
            output.display()
        ))),
    }
}

fn object(change: &ChartChange) -> Value {
    json!({
        "change": change.kind.word(),
        "part": change.part.word(),
        "name": change.name,
        "before": change.before,
        "after": change.after,
    })
}

/// `2 differences: 1 state, 1 transition`
fn summary(difference: &ChartDifference) -> String {
    let parts = [ChangedPart::State, ChangedPart::Transition, ChangedPart::Order, ChangedPart::Constant];
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
