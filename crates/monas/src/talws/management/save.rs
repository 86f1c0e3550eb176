//! The present set-up as a text.

use std::sync::Arc;

use yase::Source;

use crate::agent::Profile;
use crate::config;

/// The text that agents were read from, brought up to date; a new one if they were not read from XML.
pub(super) fn text(configuration: Option<&Arc<Source>>, profiles: &[Profile]) -> String {
    match configuration.filter(|source| !config::is_toml(&source.name)) {
        Some(source) => config::updated(source, profiles),
        None => config::written_anew(profiles),
    }
}
