//! The size of crates: one that is larger holds more than one person can keep in mind.

use super::TidyFinding;
use super::allowances::{Check, Measure};
use super::workspace::{Crate, Workspace};

/// The most lines under `src`, and the most under `tests`, `benches` and `examples` together.
const MAX_LINES: usize = 15_000;

pub(crate) fn measures(workspace: &Workspace) -> Vec<Measure> {
    workspace.crates.iter().flat_map(|member| measure(workspace, member)).collect()
}

fn measure(workspace: &Workspace, member: &Crate) -> [Measure; 2] {
    [(Check::SourceLines, &["src"] as &[&str]), (Check::TestLines, &["tests", "benches", "examples"])].map(
        |(check, folders)| {
            let count = lines(workspace, member, folders);
            let message = format!(
                "`{}`: {count} lines of Rust under {}; {MAX_LINES} at most",
                member.name,
                folders.join(", ")
            );
            let finding = TidyFinding::new(member.folder.join("Cargo.toml"), 1, message);
            Measure { owner: member.name.clone(), check, count, limit: MAX_LINES, findings: vec![finding] }
        },
    )
}

fn lines(workspace: &Workspace, member: &Crate, folders: &[&str]) -> usize {
    let folders: Vec<_> = folders.iter().map(|folder| member.folder.join(folder)).collect();
    let files = workspace
        .files
        .iter()
        .filter(|file| file.is_rust() && folders.iter().any(|folder| file.path.starts_with(folder)));
    files.map(|file| file.text.lines().count()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_and_tests_are_counted_apart() {
        let workspace = Workspace::example(&[
            ("a/src/lib.rs", "\n\n\n"),
            ("a/src/b/c.rs", "\n"),
            ("a/tests/d.rs", "\n\n"),
            ("a/examples/e.rs", "\n"),
            ("a/README.md", "\n"),
        ]);
        let counts: Vec<_> = measures(&workspace).iter().map(|m| (m.check, m.count)).collect();
        assert_eq!(counts, [(Check::SourceLines, 4), (Check::TestLines, 3)]);
    }
}
