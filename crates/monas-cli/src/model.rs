//! `monas model`: models read, transformed, converted, compared, drawn and checked.

mod check;
mod compose;
mod conform;
mod convert;
mod coverage;
mod diff;
mod mutate;
mod ontology;
mod regenerate;
mod run;
mod scenario;
mod transform;

use std::fs;
use std::path::Path;
use std::sync::Arc;

use aseme::convert::Model;
use monas::config;
use yase::statechart::Layout;
use yase::{Diagnostic, Source, Statechart};

use crate::arguments::{Format, ModelCommand};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(command: &ModelCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match command {
        ModelCommand::Transform(arguments) => transform::execute(arguments, console),
        ModelCommand::Convert(arguments) => convert::execute(arguments, console),
        ModelCommand::Draw { file, output, no_layout, format } => {
            draw(file, output.as_deref(), *no_layout, format.value, console)
        }
        ModelCommand::Ontology { file, package, output, format } => {
            ontology::execute(file, package, output.as_deref(), format.value, console)
        }
        ModelCommand::Check(arguments) => check::execute(arguments, console),
        ModelCommand::Conform { files, format } => conform::execute(files, format.value, console),
        ModelCommand::Compose(arguments) => compose::execute(arguments, console),
        ModelCommand::Coverage(arguments) => coverage::execute(arguments, console),
        ModelCommand::Diff(arguments) => diff::execute(arguments, console),
        ModelCommand::Regenerate(arguments) => regenerate::execute(arguments, console),
        ModelCommand::Mutate(arguments) => mutate::execute(arguments, console),
        ModelCommand::Run { files, trace, format } => run::execute(files, trace, format.value, console),
    }
}

fn draw(
    file: &Path,
    output: Option<&Path>,
    no_layout: bool,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let mut chart = valid_chart(file, format, console)?;
    if no_layout {
        chart.layout = Layout::default();
    }
    write(output, &aseme::to_svg(&chart), format, console)
}

/// Writes a text into a file, or on standard output.
fn write(
    output: Option<&Path>,
    text: &str,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    match output {
        Some(path) => fs::write(path, text)
            .map_err(|error| Failure::Failed(format, format!("cannot write {}: {error}", path.display())))?,
        None => console.out.write_all(text.as_bytes())?,
    }
    Ok(Exit::Success)
}

/// The model in a file without errors, and its text; findings are shown.
fn valid_model(
    path: &Path,
    format: Format,
    console: &mut Console<'_>,
) -> Result<(Arc<Source>, Model, aseme::convert::Format, Vec<Diagnostic>), Failure> {
    let source = config::read_file(path).map_err(|unread| Failure::Invalid(format, vec![*unread]))?;
    match aseme::convert::read(&source) {
        (Some((model, written)), findings) if !findings.iter().any(Diagnostic::is_error) => {
            report::write(console, format, &findings)?;
            Ok((source, model, written, findings))
        }
        (_, findings) => Err(Failure::Invalid(format, findings)),
    }
}

/// The chart of a file without errors; warnings are shown.
pub(crate) fn valid_chart(
    path: &Path,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Statechart, Failure> {
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
