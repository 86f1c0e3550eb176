//! The present configuration as text.

use std::sync::Arc;

use yase::Source;

use monas_core::agent::AgentProfile;
use monas_core::registry::Registry;

/// The text of the configuration, brought up to date; a new one if it was not read from XML.
pub(crate) fn text(
    configuration: Option<&Arc<Source>>,
    profiles: &[AgentProfile],
    registry: &Registry,
) -> String {
    match configuration.filter(|source| !monas_config::is_toml(&source.name)) {
        Some(source) => monas_config::updated(source, profiles, registry.modules()),
        None => monas_config::rewritten(profiles, registry.modules()),
    }
}
