//! The share of items that are visible in a part of their crate only. Many of them are a sign of
//! one structure whose implementation is spread over several files.

use super::TidyFinding;
use super::allowances::{Check, Measure};
use super::source::code;
use super::workspace::{Crate, TextFile, Workspace};

/// Visibilities between private and `pub(crate)`.
const RESTRICTED_VISIBILITIES: [&str; 2] = ["pub(super)", "pub(in "];

/// The most per 1,000 lines of a crate's `src`, rounded down.
const MAX_PER_THOUSAND: usize = 5;

pub(super) fn measures(workspace: &Workspace) -> Vec<Measure> {
    workspace.crates.iter().filter_map(|member| measure(workspace, member)).collect()
}

fn measure(workspace: &Workspace, member: &Crate) -> Option<Measure> {
    let source = member.folder.join("src");
    let files = workspace.files.iter().filter(|file| file.is_rust() && file.path.starts_with(&source));
    let (mut restricted, mut lines) = (0, 0);
    for file in files {
        restricted += count(file);
        lines += file.text.lines().count();
    }
    let rate = (restricted * 1_000).checked_div(lines)?;
    let message = format!("`{}`: {rate} `pub(super)` or `pub(in)` per 1,000 lines", member.name);
    let finding = TidyFinding::new(member.folder.join("Cargo.toml"), 1, message);
    Some(Measure {
        owner: member.name.clone(),
        check: Check::Visibility,
        count: rate,
        limit: MAX_PER_THOUSAND,
        findings: vec![finding],
    })
}

fn count(file: &TextFile) -> usize {
    let code = code(&file.text);
    RESTRICTED_VISIBILITIES.iter().map(|restricted| code.matches(restricted).count()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn visibilities_are_counted_in_code_only() {
        let text = "pub(super) fn a() {}\npub(in crate::b) fn c() {}\n// pub(super)\npub(crate) fn d() {}\n";
        assert_eq!(count(&TextFile { path: "a.rs".into(), text: text.into() }), 2);
    }

    #[test]
    fn the_rate_is_per_thousand_lines_of_the_crate() {
        let text = "pub(super) fn a() {}\n".repeat(2) + &"\n".repeat(198);
        let workspace = Workspace::example(&[("a/src/lib.rs", &text), ("b/src/lib.rs", "\n")]);
        let counts: Vec<usize> = measures(&workspace).iter().map(|measure| measure.count).collect();
        assert_eq!(counts, [10, 0]);
    }
}
