//! `monas config check`: everything that `run` would read, without running it.

use std::path::Path;

use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, report};

use super::ConfigArguments;
use crate::input::{checked_with, layers};

pub(crate) fn execute(
    arguments: &ConfigArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let (config, format) = (&arguments.config, arguments.format.value);
    let layers = |config: &Path| layers::of(config, &arguments.layers);
    let diagnostics = checked_with(config, format, &layers)?;
    report::write(console, format, &diagnostics)?;
    if format == Format::Text {
        writeln!(console.out, "{}: no errors", monas::config::shown_name(config))?;
    }
    Ok(Exit::Success)
}
