//! A loaded module.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::module_abi::ModuleActivity;
use super::note::BuildFingerprint;

/// A loaded module: its activities, for a [`Registry`](crate::Registry) [with
/// it](crate::Registry::with_module).
#[derive(Clone)]
pub struct Module {
    file: PathBuf,
    digest: String,
    note: BuildFingerprint,
    activities: Arc<[ModuleActivity]>,
}

impl Module {
    /// A module of a file with this digest.
    pub fn new(
        file: &Path,
        digest: String,
        note: BuildFingerprint,
        activities: Vec<ModuleActivity>,
    ) -> Module {
        Module { file: file.to_owned(), digest, note, activities: activities.into() }
    }

    /// Its name: by default that of its crate.
    pub fn name(&self) -> &str {
        self.note.module()
    }

    /// The file that was loaded.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The BLAKE3 hash of that file when it was loaded, hexadecimal.
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// Its build fingerprint.
    pub fn note(&self) -> &BuildFingerprint {
        &self.note
    }

    /// The names of its activities, in alphabetical order.
    pub fn activity_names(&self) -> impl Iterator<Item = &str> {
        self.activities.iter().map(|activity| activity.name)
    }

    /// Its activities.
    pub fn activities(&self) -> impl Iterator<Item = &ModuleActivity> {
        self.activities.iter()
    }

    /// A module as if it had been loaded, for tests.
    #[cfg(test)]
    pub(crate) fn for_test(name: &str, crates: &[&str]) -> Module {
        let note =
            BuildFingerprint::parse(&format!("{}module {name}\n", super::note::BUILD)).expect("it is one");
        let activities = super::module_abi::contents(crates).activities;
        Module {
            file: format!("{name}.so").into(),
            digest: String::new(),
            note,
            activities: activities.into(),
        }
    }
}

impl std::fmt::Debug for Module {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Module")
            .field("name", &self.name())
            .field("file", &self.file)
            .field("activities", &self.activity_names().collect::<Vec<_>>())
            .finish_non_exhaustive()
    }
}
