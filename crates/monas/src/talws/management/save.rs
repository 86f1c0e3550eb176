//! The present set-up as a text.

use std::sync::Arc;

use yase::Source;

use crate::agent::Profile;
use crate::config;
use crate::registry::Registry;

/// The text that agents were read from, brought up to date; a new one if they were not read from XML.
pub(super) fn text(configuration: Option<&Arc<Source>>, profiles: &[Profile], registry: &Registry) -> String {
    match configuration.filter(|source| !config::is_toml(&source.name)) {
        Some(source) => config::updated(source, profiles, registry.modules()),
        None => config::written_anew(profiles, registry.modules()),
    }
}
