//! Checks `Cargo.toml`: every dependency is declared once, in the workspace, and used; every crate
//! inherits the shared settings.

use std::path::Path;

use super::TidyFinding;
use super::workspace::{TextFile, Workspace};

/// Lines that every manifest must contain.
const SHARED_LINES: [&str; 6] = [
    "version.workspace = true",
    "edition.workspace = true",
    "rust-version.workspace = true",
    "license.workspace = true",
    "publish.workspace = true",
    "[lints]",
];

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    let mut findings = Vec::new();
    let members =
        workspace.crates.iter().filter_map(|member| workspace.file(&member.folder.join("Cargo.toml")));
    for manifest in members {
        findings.extend(own_versions(manifest));
        findings.extend(missing_settings(manifest));
    }
    if let Some(root) = workspace.file(Path::new("Cargo.toml")) {
        findings.extend(unused(workspace, root));
    }
    findings
}

/// Dependencies for which a member specifies its own version.
fn own_versions(manifest: &TextFile) -> Vec<TidyFinding> {
    let own = entries(&manifest.text, is_dependency_table).into_iter().filter(|(_, entry)| !is_shared(entry));
    let message = |entry: &str| format!("`{}` is not taken from [workspace.dependencies]", name(entry));
    own.map(|(line, entry)| TidyFinding::new(&manifest.path, line, message(entry))).collect()
}

fn missing_settings(manifest: &TextFile) -> Vec<TidyFinding> {
    let missing = SHARED_LINES.iter().filter(|setting| !manifest.text.lines().any(|line| line == **setting));
    missing.map(|setting| TidyFinding::new(&manifest.path, 1, format!("`{setting}` is missing"))).collect()
}

/// Dependencies of the workspace that no member uses.
fn unused(workspace: &Workspace, root: &TextFile) -> Vec<TidyFinding> {
    let is_taken = |wanted: &str| {
        workspace.crates.iter().any(|member| {
            member.name == wanted || member.dependencies.iter().any(|dependency| dependency.name == wanted)
        })
    };
    let entries = entries(&root.text, |table| table == "[workspace.dependencies]");
    let unused = entries.into_iter().filter(|(_, entry)| !is_taken(name(entry)));
    unused
        .map(|(line, entry)| TidyFinding::new(&root.path, line, format!("no crate takes `{}`", name(entry))))
        .collect()
}

/// The entries of the chosen tables, with their lines.
fn entries(manifest: &str, is_wanted: impl Fn(&str) -> bool) -> Vec<(usize, &str)> {
    let mut wanted = false;
    let mut entries = Vec::new();
    for (index, line) in manifest.lines().enumerate() {
        if line.starts_with('[') {
            wanted = is_wanted(line.trim());
        } else if wanted && line.starts_with(|c: char| c.is_ascii_alphanumeric()) {
            entries.push((index + 1, line));
        }
    }
    entries
}

fn is_dependency_table(table: &str) -> bool {
    table.trim_matches(['[', ']']).split('.').any(|part| part.ends_with("dependencies"))
}

fn is_shared(entry: &str) -> bool {
    let entry = entry.replace(' ', "");
    entry.contains(".workspace=true") || entry.contains("{workspace=true")
}

fn name(entry: &str) -> &str {
    entry.split(['.', ' ', '=']).next().unwrap_or(entry)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(text: &str) -> TextFile {
        TextFile { path: "crates/a/Cargo.toml".into(), text: text.into() }
    }

    #[test]
    fn a_version_of_its_own_is_found() {
        let text = "[dependencies]\na.workspace = true\nb = { workspace = true, features = [] }\nc = \"1\"\n\n\
                    [target.'cfg(unix)'.dependencies]\nd = { version = \"2\" }\n[package]\nversion = \"1\"\n";
        let found: Vec<String> = own_versions(&manifest(text)).iter().map(ToString::to_string).collect();
        let message = |line: usize, name: &str| {
            format!("crates/a/Cargo.toml:{line}: `{name}` is not taken from [workspace.dependencies]")
        };
        assert_eq!(found, [message(4, "c"), message(7, "d")]);
    }

    #[test]
    fn settings_are_shared() {
        let complete = SHARED_LINES.join("\n");
        assert!(missing_settings(&manifest(&complete)).is_empty());
        let without_lints = complete.replace("[lints]", "");
        assert_eq!(missing_settings(&manifest(&without_lints)).len(), 1);
    }
}
