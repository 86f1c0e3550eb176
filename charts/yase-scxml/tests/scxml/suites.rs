//! Locations of the third-party suites, and their recorded results.

use std::path::{Path, PathBuf};

use yase_scxml::Platform;

/// The folder of a suite, if it exists. Suites are not part of this repository.
pub(crate) fn folder(suite: &str) -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shared = std::env::var_os("MONAS_SHARED").map_or_else(|| workspace.join("../shared"), PathBuf::from);
    Some(shared.join("suites").join(suite)).filter(|folder| folder.is_dir())
}

/// The recorded count of a name in `recorded.txt`.
pub(crate) fn recorded(name: &str) -> usize {
    let lines = include_str!("recorded.txt").lines();
    let counts = lines.filter_map(|line| line.rsplit_once(' '));
    let found = counts.filter(|(key, _)| *key == name).find_map(|(_, count)| count.parse().ok());
    found.unwrap_or(usize::MAX)
}

/// The folder of a document as its platform: `file:` URIs and plain names are files in it. Keeps
/// the log.
#[derive(Debug, Default)]
pub(crate) struct Neighbours {
    pub(crate) folder: PathBuf,
    pub(crate) log: Vec<String>,
}

impl Platform for Neighbours {
    fn read(&mut self, uri: &str) -> Result<String, String> {
        let name = uri.strip_prefix("file:").unwrap_or(uri);
        if name.contains(['/', '\\']) || name.starts_with('.') {
            return Err("only neighbours are read".into());
        }
        std::fs::read_to_string(self.folder.join(name)).map_err(|error| error.to_string())
    }

    fn log(&mut self, session: &str, label: &str, text: &str) {
        self.log.push(format!("{session} {label}: {text}"));
    }
}
