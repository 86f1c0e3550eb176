//! Model files.

use std::path::Path;
use std::sync::Arc;

use yase::{Diagnostic, Source, Statechart};

use super::paths;

/// The statechart that a model file describes, with the file's text, and everything that is wrong with the file.
pub fn load(path: &Path) -> (Option<(Statechart, Arc<Source>)>, Vec<Diagnostic>) {
    match paths::read(path) {
        Ok(source) => {
            let (chart, diagnostics) = aseme::statechart_of(&source);
            (Some((chart, source)), diagnostics)
        }
        Err(diagnostic) => (None, vec![*diagnostic]),
    }
}

/// Whether a finding is about formulas rather than what refines them.
pub(super) fn is_about_formulas(diagnostic: &Diagnostic) -> bool {
    diagnostic.is_error() && ("E0200".."E0220").contains(&diagnostic.code)
}
