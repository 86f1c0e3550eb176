//! Reads and checks configurations.

use std::path::Path;

use monas::config::{self, Layers};
use monas::{Registry, Talws};
use monas_match::MatchSource;
use monas_project::differences;
use yase::Diagnostic;

use crate::terminal::{CommandFailure, Format};

/// The configuration that is read when none is named.
pub(crate) const DEFAULT_CONFIGURATION: &str = "config/agents.xml";

/// The kind of a configuration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ConfigurationKind {
    /// `<match>`: teams on a field.
    Match,
    /// Anything else: agents of one host.
    Agents,
}

/// The kind of a configuration, by the name of its first element.
pub(crate) fn kind_of(config: &Path) -> Result<ConfigurationKind, Box<Diagnostic>> {
    let (elements, _) = monas_match::grammar().parse(&config::read_file(config)?);
    Ok(if elements.first().is_some_and(|root| root.is("match")) {
        ConfigurationKind::Match
    } else {
        ConfigurationKind::Agents
    })
}

/// Checks a configuration without layers. Returns its warnings.
///
/// # Errors
/// The configuration has errors.
pub(crate) fn checked(config: &Path, format: Format) -> Result<Vec<Diagnostic>, CommandFailure> {
    checked_with(config, format, &|_| Ok(Layers::new()))
}

pub(crate) fn checked_with(
    config: &Path,
    format: Format,
    layers: &dyn Fn(&Path) -> Result<Layers, Vec<Diagnostic>>,
) -> Result<Vec<Diagnostic>, CommandFailure> {
    let invalid = |diagnostics| CommandFailure::Invalid(format, diagnostics);
    let registry = Registry::linked();
    let kind = kind_of(config).map_err(|unread| invalid(vec![*unread]))?;
    let layers = layers(config).map_err(invalid)?;
    let diagnostics = match kind {
        ConfigurationKind::Match => match MatchSource::load_with(config, &registry, &layers) {
            Ok(plan) => {
                let warnings = plan.warnings().to_vec();
                let found = plan.check().map_err(|error| CommandFailure::failed(format, error))?;
                [warnings, found].concat()
            }
            Err(diagnostics) => diagnostics,
        },
        ConfigurationKind::Agents => wrong_with_agents(config, registry, &layers),
    };
    let diagnostics = [differences(config), diagnostics].concat();
    match diagnostics.iter().any(Diagnostic::is_error) {
        true => Err(invalid(diagnostics)),
        false => Ok(diagnostics),
    }
}

/// Findings in a file of agents, and, if it can be read, in the agents together.
fn wrong_with_agents(config: &Path, registry: Registry, layers: &Layers) -> Vec<Diagnostic> {
    let (setup, mut diagnostics) = config::load_with(config, &registry, layers);
    if !diagnostics.iter().any(Diagnostic::is_error) {
        let talws = setup.agents.into_iter().fold(Talws::new().registry(registry), Talws::agent);
        diagnostics.extend(setup.links.into_iter().fold(talws, Talws::link).check());
    }
    diagnostics
}
