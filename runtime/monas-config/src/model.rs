//! Model files.

use std::path::Path;
use std::sync::Arc;

use yase::{Diagnostic, Source, Statechart};

use super::paths;

/// The statechart of a model file, with the file's text and its diagnostics.
pub fn load(path: &Path) -> (Option<(Statechart, Arc<Source>)>, Vec<Diagnostic>) {
    match paths::read(path) {
        Ok(source) => {
            let (chart, diagnostics) = aseme_models::statechart_of(&source);
            (Some((chart, source)), diagnostics)
        }
        Err(diagnostic) => (None, vec![*diagnostic]),
    }
}
