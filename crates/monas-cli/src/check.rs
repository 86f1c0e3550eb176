//! `monas config check`: everything that `run` would read, without running it.

use std::path::Path;

use monas::Registry;
use monas_match::Match;
use yase::Diagnostic;

use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;
use crate::run::{Kind, kind_of};

pub(crate) fn execute(config: &Path, format: Format, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let registry = Registry::linked();
    let diagnostics = match kind_of(config) {
        Ok(Kind::Match) => match Match::load(config, &registry) {
            Ok(plan) => plan.warnings().to_vec(),
            Err(diagnostics) => diagnostics,
        },
        Ok(Kind::Agents) => monas::config::load(config, &registry).1,
        Err(unread) => vec![*unread],
    };
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(Failure::Invalid(format, diagnostics));
    }
    report::write(console, format, &diagnostics)?;
    if format == Format::Text {
        writeln!(console.out, "{}: no errors", config.display())?;
    }
    Ok(Exit::Success)
}
