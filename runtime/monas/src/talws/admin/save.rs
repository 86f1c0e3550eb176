//! The present configuration as text.

use std::sync::Arc;

use yase::Source;

use crate::agent::AgentProfile;
use crate::registry::Registry;

/// The text of the configuration, brought up to date; a new one if it was not read from XML.
pub(crate) fn text(
    configuration: Option<&Arc<Source>>,
    profiles: &[AgentProfile],
    registry: &Registry,
) -> String {
    match configuration.filter(|source| !crate::config::is_toml(&source.name)) {
        Some(source) => crate::config::updated(source, profiles, registry.modules()),
        None => crate::config::rewritten(profiles, registry.modules()),
    }
}
