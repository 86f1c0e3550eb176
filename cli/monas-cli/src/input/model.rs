//! Reads models.

use std::path::Path;
use std::sync::Arc;

use aseme_models::convert::Model;
use monas::config;
use monas_terminal::{CommandFailure, CommandOutput, Format, report};
use yase::{Diagnostic, Source, Statechart};

/// The model in a file, its text, format and warnings. Reports the warnings; fails on errors.
pub(crate) fn valid_model(
    path: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<(Arc<Source>, Model, aseme_models::convert::Format, Vec<Diagnostic>), CommandFailure> {
    let source = config::read_file(path).map_err(|unread| CommandFailure::Invalid(format, vec![*unread]))?;
    match aseme_models::convert::read(&source) {
        (Some((model, written)), findings) if !findings.iter().any(Diagnostic::is_error) => {
            report::write(console, format, &findings)?;
            Ok((source, model, written, findings))
        }
        (_, findings) => Err(CommandFailure::Invalid(format, findings)),
    }
}

/// The statechart of a model file. Reports warnings; fails on errors.
pub(crate) fn valid_chart(
    path: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Statechart, CommandFailure> {
    match read(path) {
        (Some(chart), diagnostics) if !diagnostics.iter().any(Diagnostic::is_error) => {
            report::write(console, format, &diagnostics)?;
            Ok(chart)
        }
        (_, diagnostics) => Err(CommandFailure::Invalid(format, diagnostics)),
    }
}

/// The chart of a file as far as it could be read, and all findings in textual order.
fn read(path: &Path) -> (Option<Statechart>, Vec<Diagnostic>) {
    let (model, mut diagnostics) = config::load_model(path);
    diagnostics.sort_by_key(|diagnostic| diagnostic.span);
    (model.map(|(chart, _)| chart), diagnostics)
}
