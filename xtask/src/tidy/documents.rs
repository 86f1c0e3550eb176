//! Checks documents: each crate opens with prose, ARCHITECTURE.md names each crate, and links and
//! paths in documents exist.

use std::path::{Component, Path, PathBuf};

use super::TidyFinding;
use super::layers::is_product;
use super::workspace::{Crate, TextFile, Workspace};

/// The documents that must exist.
const EXPECTED: [&str; 8] = [
    "README.md",
    "ARCHITECTURE.md",
    "STYLE.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "LICENSE-MIT",
    "LICENSE-APACHE",
];

/// A library opens with at least this many lines of prose, including an example.
const MIN_PROSE: usize = 12;

/// Prefixes of paths of the project in documents.
const FOLDERS: [&str; 15] = [
    "charts/",
    "methodology/",
    "messages/",
    "runtime/",
    "soccer/monas-",
    "cli/monas-",
    "statecharts/",
    "models/",
    "config/",
    "docs/",
    "examples/",
    "robots/",
    "tests/",
    "xtask/",
    ".ci/",
];

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    let mut findings = Vec::new();
    findings.extend(missing_documents(workspace));
    let crates = workspace.crates.iter().filter(|member| is_product(member));
    findings.extend(crates.filter_map(|member| opening(workspace, member)));
    findings.extend(unnamed_crates(workspace));
    let documents =
        workspace.files.iter().filter(|file| file.path.extension().is_some_and(|end| end == "md"));
    findings.extend(documents.flat_map(|document| dead_ends(workspace, document)));
    findings
}

fn missing_documents(workspace: &Workspace) -> impl Iterator<Item = TidyFinding> {
    let missing = EXPECTED.iter().filter(|name| !workspace.root.join(name).is_file());
    missing.map(|name| TidyFinding::new(name, 1, "this document is missing"))
}

/// A finding if the opening of a library is incomplete.
fn opening(workspace: &Workspace, member: &Crate) -> Option<TidyFinding> {
    let library = workspace.file(member.library.as_ref()?)?;
    let prose: Vec<&str> = library.text.lines().take_while(|line| line.starts_with("//!")).collect();
    let fault = if prose.len() < MIN_PROSE {
        format!(
            "`{}` opens with {} lines of prose; {MIN_PROSE} say what it is, why so, and how to use it",
            member.name,
            prose.len()
        )
    } else if !prose.iter().any(|line| line.contains("```")) {
        format!("`{}` opens without an example", member.name)
    } else {
        return None;
    };
    Some(TidyFinding::new(&library.path, 1, fault))
}

fn unnamed_crates(workspace: &Workspace) -> Vec<TidyFinding> {
    let Some(map) = workspace.file(Path::new("ARCHITECTURE.md")) else { return Vec::new() };
    let crates = workspace.crates.iter().filter(|member| is_product(member));
    let unnamed = crates.filter(|member| !names(&map.text, &member.name));
    unnamed
        .map(|member| TidyFinding::new(&map.path, 1, format!("`{}` is not on the map", member.name)))
        .collect()
}

/// Whether a text names a crate as a whole word (`monas` is not named by `monas-cli`).
fn names(text: &str, name: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    text.match_indices(name).any(|(index, _)| {
        !text[..index].ends_with(is_part) && !text[index + name.len()..].starts_with(is_part)
    })
}

/// Links and paths in a document that do not exist.
fn dead_ends(workspace: &Workspace, document: &TextFile) -> Vec<TidyFinding> {
    let mut findings = Vec::new();
    for (index, line) in document.text.lines().enumerate() {
        let from_here = document.path.parent().unwrap_or(Path::new(""));
        let links = links(line).map(|link| from_here.join(link));
        let paths = paths(line).map(PathBuf::from);
        let dead = links.chain(paths).filter(|path| !workspace.root.join(normal(path)).exists());
        let message = |path: PathBuf| format!("`{}` does not exist", path.display());
        findings.extend(dead.map(|path| TidyFinding::new(&document.path, index + 1, message(path))));
    }
    findings
}

/// Targets of the links in a line within the project.
fn links(line: &str) -> impl Iterator<Item = &str> {
    let targets = line.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let targets = targets.filter(|target| !target.contains("://") && !target.starts_with('#'));
    targets.filter_map(|target| target.split('#').next())
}

/// Words of a line that are paths of the project.
fn paths(line: &str) -> impl Iterator<Item = &str> {
    let words = line.split(|c: char| !(c.is_ascii_alphanumeric() || "._-/*".contains(c)));
    let words = words.map(|word| word.trim_end_matches(['.', '/']));
    words.filter(|word| FOLDERS.iter().any(|folder| word.starts_with(folder)) && !word.contains('*'))
}

/// The path with `..` resolved.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => drop(normal.pop()),
            Component::CurDir => {}
            other => normal.push(other),
        }
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_names_only() {
        assert!(names("| `monas` | runtime |", "monas"));
        assert!(!names("`monas-cli`, monas_sim", "monas"));
    }

    #[test]
    fn links_and_paths_are_found() {
        let line = "See [the map](ARCHITECTURE.md#tree), [web](https://example.org), run `config/match.xml`, `models/*.srm`.";
        assert_eq!(links(line).collect::<Vec<_>>(), ["ARCHITECTURE.md"]);
        assert_eq!(paths(line).collect::<Vec<_>>(), ["config/match.xml"]);
    }

    #[test]
    fn parents_are_worked_out() {
        assert_eq!(normal(Path::new("docs/../config/./a.xml")), Path::new("config/a.xml"));
    }
}
