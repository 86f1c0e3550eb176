//! The limits that crates may still exceed. An allowance may only shrink: tidy asks to lower one
//! that is larger than what is counted, and `cargo xtask tidy --allowances` prints the table as it
//! would be today.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use super::TidyFinding;
use super::workspace::{TextFile, Workspace};
use super::{circles, columns, size, visibility, words};

/// A count that has a limit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Check {
    /// Banned words in prose.
    Words,
    /// Lines of prose that are too wide.
    Columns,
    /// `pub(crate)` and `pub(in)` per 1,000 lines, rounded down.
    Visibility,
    /// Lines under `src`.
    SourceLines,
    /// Lines under `tests`, `benches` and `examples`.
    TestLines,
    /// Modules in the largest import circle.
    Circle,
}

/// The count of one check in one crate or folder.
pub(crate) struct Measure {
    /// A crate, or the top folder of a file that belongs to none.
    pub(crate) owner: String,
    pub(crate) check: Check,
    pub(crate) count: usize,
    /// The count that needs no allowance.
    pub(crate) limit: usize,
    /// The findings to report if the count is too large.
    pub(crate) findings: Vec<TidyFinding>,
}

/// A crate that may exceed the limit of a check.
struct Allowance {
    owner: &'static str,
    check: Check,
    count: usize,
}

#[allow(dead_code, reason = "a row of the table, which is empty at present")]
const fn allow(owner: &'static str, check: Check, count: usize) -> Allowance {
    Allowance { owner, check, count }
}

/// The file of the table, relative to the root.
const TABLE: &str = "xtask/src/tidy/allowances.rs";

const ALLOWANCES: &[Allowance] = &[];

pub(crate) fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    judge(workspace, measures(workspace), ALLOWANCES)
}

/// The rows of a table that allows what is counted today.
pub(crate) fn rows(workspace: &Workspace) -> Vec<String> {
    let mut measures = measures(workspace);
    measures.retain(|measure| measure.count > measure.limit);
    measures.sort_by(|a, b| (a.check, &a.owner).cmp(&(b.check, &b.owner)));
    measures.iter().map(ToString::to_string).collect()
}

fn measures(workspace: &Workspace) -> Vec<Measure> {
    let mut measures = words::measures(workspace);
    measures.extend(columns::measures(workspace));
    measures.extend(visibility::measures(workspace));
    measures.extend(size::measures(workspace));
    measures.extend(circles::measures(workspace));
    measures
}

fn judge(workspace: &Workspace, measures: Vec<Measure>, table: &[Allowance]) -> Vec<TidyFinding> {
    let mut findings = Vec::new();
    for allowance in table {
        let is_measured = measures.iter().any(|measure| allowance.is_for(measure));
        if !is_measured {
            findings.push(allowance.finding(workspace, "remove the allowance: it is for no crate"));
        }
    }
    for measure in measures {
        let allowance = table.iter().find(|allowance| allowance.is_for(&measure));
        let allowed = allowance.map_or(measure.limit, |allowance| allowance.count);
        match allowance {
            _ if measure.count > allowed => findings.extend(measure.findings),
            Some(allowance) if measure.count <= measure.limit => {
                findings.push(allowance.finding(workspace, "remove the allowance: it is not needed"));
            }
            Some(allowance) if measure.count < allowed => {
                let message = format!("lower the allowance to {}", measure.count);
                findings.push(allowance.finding(workspace, &message));
            }
            _ => {}
        }
    }
    findings
}

impl Measure {
    /// Counts the findings in the files of each crate, and in those of each folder without a crate.
    pub(crate) fn by_owner(
        workspace: &Workspace,
        check: Check,
        limit: usize,
        find: impl Fn(&TextFile) -> Vec<TidyFinding>,
    ) -> Vec<Measure> {
        let mut owners: BTreeMap<String, Vec<TidyFinding>> = BTreeMap::new();
        for file in &workspace.files {
            owners.entry(owner(workspace, file)).or_default().extend(find(file));
        }
        let measure = |(owner, findings): (String, Vec<_>)| Measure {
            owner,
            check,
            count: findings.len(),
            limit,
            findings,
        };
        owners.into_iter().map(measure).collect()
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "    allow({:?}, Check::{:?}, {}),", self.owner, self.check, self.count)
    }
}

impl Allowance {
    fn is_for(&self, measure: &Measure) -> bool {
        self.owner == measure.owner && self.check == measure.check
    }

    fn finding(&self, workspace: &Workspace, message: &str) -> TidyFinding {
        let start = format!("allow({:?}, Check::{:?},", self.owner, self.check);
        let lines = workspace.file(Path::new(TABLE)).map(|file| file.text.lines()).into_iter().flatten();
        let row = lines.enumerate().find(|(_, line)| line.trim_start().starts_with(&start));
        let line = row.map_or(1, |(index, _)| index + 1);
        TidyFinding::new(TABLE, line, format!("`{}`, {:?}: {message}", self.owner, self.check))
    }
}

/// The crate of a file, or its top folder, or `.` for a file at the root.
fn owner(workspace: &Workspace, file: &TextFile) -> String {
    if let Some(member) = workspace.crate_of(file) {
        return member.name.clone();
    }
    let mut parts = file.path.iter();
    match (parts.next(), parts.next()) {
        (Some(folder), Some(_)) => folder.to_string_lossy().into_owned(),
        _ => ".".to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(count: usize, table: &[Allowance]) -> Vec<String> {
        let workspace = Workspace::example(&[(TABLE, "\n    allow(\"a\", Check::Words, 3),\n")]);
        let findings = (0..count).map(|line| TidyFinding::new("a.rs", line, "a word")).collect();
        let measure = Measure { owner: "a".into(), check: Check::Words, count, limit: 1, findings };
        judge(&workspace, vec![measure], table).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_count_above_the_limit_is_reported() {
        assert!(judged(1, &[]).is_empty());
        assert_eq!(judged(2, &[]), ["a.rs:0: a word", "a.rs:1: a word"]);
    }

    #[test]
    fn an_allowance_holds_until_it_can_shrink() {
        let table = [allow("a", Check::Words, 3)];
        assert!(judged(3, &table).is_empty());
        assert_eq!(judged(4, &table).len(), 4);
        let lower = format!("{TABLE}:2: `a`, Words: lower the allowance to 2");
        assert_eq!(judged(2, &table), [lower]);
        let remove = format!("{TABLE}:2: `a`, Words: remove the allowance: it is not needed");
        assert_eq!(judged(1, &table), [remove]);
    }

    #[test]
    fn an_allowance_for_no_crate_is_reported() {
        let table = [allow("b", Check::Words, 3)];
        assert_eq!(judged(0, &table).len(), 1);
    }

    #[test]
    fn files_belong_to_the_innermost_crate_or_to_their_top_folder() {
        let workspace = Workspace::example(&[
            ("a/src/lib.rs", ""),
            ("a/b/src/lib.rs", ""),
            ("docs/c.md", ""),
            ("d.md", ""),
        ]);
        let owners: Vec<String> = workspace.files.iter().map(|file| owner(&workspace, file)).collect();
        assert_eq!(owners, ["a", "a/b", "docs", "."]);
    }

    #[test]
    fn rows_allow_what_is_counted() {
        let workspace = Workspace::example(&[("a/src/lib.rs", "// nobody\n")]);
        assert_eq!(rows(&workspace), ["    allow(\"a\", Check::Words, 1),"]);
    }
}
