//! Reads and checks configurations.

use std::path::Path;

use monas::config::{self, Grammar, HostSetup, Layers};
use monas::{Registry, Talws};
#[cfg(feature = "soccer")]
use monas_match::MatchSource;
use monas_project::differences;
use monas_terminal::{CommandFailure, Format};
use yase::{Diagnostic, Source};

/// The default configuration.
pub(crate) const DEFAULT_CONFIGURATION: &str = "config/agents.xml";

/// The kind of a configuration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ConfigurationKind {
    /// `<match>`: teams on a field.
    #[cfg(feature = "soccer")]
    Match,
    /// Anything else: agents of one host.
    Agents,
}

/// The kind of a configuration, by the name of its first element.
pub(crate) fn kind_of(config: &Path) -> Result<ConfigurationKind, Box<Diagnostic>> {
    let file = config::read_file(config).map_err(|unread| match unread.hint {
        None if config == Path::new(DEFAULT_CONFIGURATION) && !config.exists() => {
            Box::new(unread.with_hint("name a configuration, or create a project: `monas new my-team`"))
        }
        _ => unread,
    })?;
    let (elements, _) = grammar().parse(&file);
    match elements.first().filter(|root| root.is("match")) {
        #[cfg(feature = "soccer")]
        Some(_) => Ok(ConfigurationKind::Match),
        #[cfg(not(feature = "soccer"))]
        Some(root) => {
            let found = root.error("E0327", root.name_span(), "this program has no field to play on");
            let hint = "give the dependency `monas-cli` the feature `soccer`, and link `monas-soccer`";
            Err(Box::new(found.with_hint(hint)))
        }
        None => Ok(ConfigurationKind::Agents),
    }
}

/// The grammar of the configurations that this program runs.
pub(crate) fn grammar() -> Grammar {
    #[cfg(feature = "soccer")]
    return monas_match::grammar();
    #[cfg(not(feature = "soccer"))]
    Grammar::agents()
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
        #[cfg(feature = "soccer")]
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

/// The setup of a file of agents, with its findings; it is an error if there is nothing to run.
pub(crate) fn load_agents(
    config: &Path,
    registry: &Registry,
    layers: &Layers,
) -> (HostSetup, Vec<Diagnostic>) {
    let (setup, mut diagnostics) = config::load_with(config, registry, layers);
    let is_empty = setup.agents.is_empty() && setup.links.is_empty() && setup.modules.is_empty();
    if is_empty && !diagnostics.iter().any(Diagnostic::is_error) {
        let name = config::shown_name(config);
        let hint = match config.extension().is_some_and(|extension| extension == "toml") {
            true => {
                "add an agent: `[[agent]]`, and below it `name = \"Greeter\"` and `statechart = [\"models/greeter.srm\"]`"
            }
            false => {
                "add an agent, as in `<agent><name>Greeter</name><statechart>models/greeter.srm</statechart></agent>`"
            }
        };
        let found = Diagnostic::error("E0326", 0..0, format!("`{name}` has no agent that is enabled"));
        diagnostics.push(found.with_hint(hint).in_source(&Source::new(name, "")));
    }
    (setup, diagnostics)
}

/// Findings in a file of agents, and, if it can be read, in the agents together.
fn wrong_with_agents(config: &Path, registry: Registry, layers: &Layers) -> Vec<Diagnostic> {
    let (setup, mut diagnostics) = load_agents(config, &registry, layers);
    if !diagnostics.iter().any(Diagnostic::is_error) {
        let talws = setup.agents.into_iter().fold(Talws::new().registry(registry), Talws::agent);
        diagnostics.extend(setup.links.into_iter().fold(talws, Talws::link).check());
    }
    diagnostics
}
