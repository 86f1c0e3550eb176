//! `monas model`: roles read, transformed, drawn and checked.

use std::fs;
use std::path::Path;

use monas::config;
use yase::{Diagnostic, Statechart};

use crate::arguments::{Format, ModelCommand};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(command: &ModelCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match command {
        ModelCommand::Transform { file, format } => transform(file, format.value, console),
        ModelCommand::Draw { file, output, format } => draw(file, output.as_deref(), format.value, console),
        ModelCommand::Check { files, format } => {
            let files: Vec<&Path> = files.iter().map(AsRef::as_ref).collect();
            check(&files, format.value, console)
        }
    }
}

fn transform(file: &Path, format: Format, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let chart = valid_chart(file, format, console)?;
    match format {
        Format::Text => write!(console.out, "{}", aseme::to_text(&chart))?,
        Format::Json => writeln!(console.out, "{}", aseme::to_json(&chart))?,
    }
    Ok(Exit::Success)
}

fn draw(
    file: &Path,
    output: Option<&Path>,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let drawing = aseme::to_svg(&valid_chart(file, format, console)?);
    match output {
        Some(path) => fs::write(path, drawing)
            .map_err(|error| Failure::Failed(format, format!("cannot write {}: {error}", path.display())))?,
        None => console.out.write_all(drawing.as_bytes())?,
    }
    Ok(Exit::Success)
}

/// All that is wrong with all files, and one line for each that is right.
fn check(paths: &[&Path], format: Format, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let mut exit = Exit::Success;
    for path in paths {
        let (chart, diagnostics) = read(path);
        report::write(console, format, &diagnostics)?;
        if diagnostics.iter().any(Diagnostic::is_error) {
            exit = Exit::Invalid;
        } else if let (Some(chart), Format::Text) = (chart, format) {
            let (states, transitions) = (chart.nodes().len(), chart.transitions().len());
            writeln!(
                console.out,
                "{}: {states} nodes, {transitions} transitions, no errors",
                path.display()
            )?;
        }
    }
    Ok(exit)
}

/// The chart of a file without errors; warnings are shown.
fn valid_chart(path: &Path, format: Format, console: &mut Console<'_>) -> Result<Statechart, Failure> {
    match read(path) {
        (Some(chart), diagnostics) if !diagnostics.iter().any(Diagnostic::is_error) => {
            report::write(console, format, &diagnostics)?;
            Ok(chart)
        }
        (_, diagnostics) => Err(Failure::Invalid(format, diagnostics)),
    }
}

/// The chart of a file, as far as it was understood, and all that is to be said of it, in the order of the text.
fn read(path: &Path) -> (Option<Statechart>, Vec<Diagnostic>) {
    let (model, mut diagnostics) = config::load_model(path);
    diagnostics.sort_by_key(|diagnostic| diagnostic.span);
    (model.map(|(chart, _)| chart), diagnostics)
}
