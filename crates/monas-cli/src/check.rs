//! `monas config check`: everything that `run` would read, without running it.

use std::path::Path;

use monas::{Registry, Talws};
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
            Ok(plan) => {
                let warnings = plan.warnings().to_vec();
                let found = plan.check().map_err(|error| Failure::failed(format, error))?;
                [warnings, found].concat()
            }
            Err(diagnostics) => diagnostics,
        },
        Ok(Kind::Agents) => agents(config, registry),
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

/// What is wrong with a file of agents, and, if it can be read, what is wrong with them together.
fn agents(config: &Path, registry: Registry) -> Vec<Diagnostic> {
    let (setup, mut diagnostics) = monas::config::load(config, &registry);
    if !diagnostics.iter().any(Diagnostic::is_error) {
        let talws = setup.agents.into_iter().fold(Talws::new().registry(registry), Talws::agent);
        diagnostics.extend(setup.links.into_iter().fold(talws, Talws::link).check());
    }
    diagnostics
}
