//! The width of prose. Code blocks, tables and lines with an address are free.

use super::TidyFinding;
use super::allowances::{Check, Measure};
use super::prose::prose;
use super::workspace::{TextFile, Workspace};

/// The columns of the longest line of prose.
const MAX_COLUMNS: usize = 100;

pub(crate) fn measures(workspace: &Workspace) -> Vec<Measure> {
    Measure::by_owner(workspace, Check::Columns, 0, check_file)
}

fn check_file(file: &TextFile) -> Vec<TidyFinding> {
    let wide = prose(file).into_iter().filter(|line| line.columns > MAX_COLUMNS);
    let message = |columns| format!("{columns} columns of prose; {MAX_COLUMNS} at most");
    wide.map(|line| TidyFinding::new(&file.path, line.number, message(line.columns))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_prose_is_found_and_wide_tables_are_not() {
        let text = format!(
            "{}\n{}\n| {}\n",
            "a".repeat(MAX_COLUMNS),
            "b".repeat(MAX_COLUMNS + 1),
            "c".repeat(MAX_COLUMNS)
        );
        let found = check_file(&TextFile { path: "a.md".into(), text });
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].to_string(), "a.md:2: 101 columns of prose; 100 at most");
    }
}
