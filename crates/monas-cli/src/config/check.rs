//! `monas config check`: everything that `run` would read, without running it.

use std::path::Path;

use monas::config::Layers;
use monas::{Registry, Talws};
use monas_match::Match;
use yase::Diagnostic;

use super::layers;
use crate::arguments::{ConfigArguments, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::generate::differences;
use crate::report;
use crate::run::{Kind, kind_of};

pub(super) fn execute(arguments: &ConfigArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let (config, format) = (&arguments.config, arguments.format.value);
    let layers = |config: &Path| layers::of(config, &arguments.layers);
    let diagnostics = without_errors(config, format, &layers)?;
    report::write(console, format, &diagnostics)?;
    if format == Format::Text {
        writeln!(console.out, "{}: no errors", config.display())?;
    }
    Ok(Exit::Success)
}

/// Everything that is wrong with a configuration, if none of it is an error.
///
/// # Errors
/// The errors.
pub(crate) fn checked(config: &Path, format: Format) -> Result<Vec<Diagnostic>, Failure> {
    without_errors(config, format, &|_| Ok(Layers::new()))
}

fn without_errors(
    config: &Path,
    format: Format,
    layers: &dyn Fn(&Path) -> Result<Layers, Vec<Diagnostic>>,
) -> Result<Vec<Diagnostic>, Failure> {
    let invalid = |diagnostics| Failure::Invalid(format, diagnostics);
    let registry = Registry::linked();
    let kind = kind_of(config).map_err(|unread| invalid(vec![*unread]))?;
    let layers = layers(config).map_err(invalid)?;
    let diagnostics = match kind {
        Kind::Match => match Match::load_with(config, &registry, &layers) {
            Ok(plan) => {
                let warnings = plan.warnings().to_vec();
                let found = plan.check().map_err(|error| Failure::failed(format, error))?;
                [warnings, found].concat()
            }
            Err(diagnostics) => diagnostics,
        },
        Kind::Agents => agents(config, registry, &layers),
    };
    let diagnostics = [differences(config), diagnostics].concat();
    match diagnostics.iter().any(Diagnostic::is_error) {
        true => Err(invalid(diagnostics)),
        false => Ok(diagnostics),
    }
}

/// What is wrong with a file of agents, and, if it can be read, what is wrong with them together.
fn agents(config: &Path, registry: Registry, layers: &Layers) -> Vec<Diagnostic> {
    let (setup, mut diagnostics) = monas::config::load_with(config, &registry, layers);
    if !diagnostics.iter().any(Diagnostic::is_error) {
        let talws = setup.agents.into_iter().fold(Talws::new().registry(registry), Talws::agent);
        diagnostics.extend(setup.links.into_iter().fold(talws, Talws::link).check());
    }
    diagnostics
}
