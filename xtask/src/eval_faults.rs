//! `cargo xtask eval-faults`: what finds a fault of behaviour first, for each of the three
//! methodologies by which `monas eval` has a goalie and an attacker built.
//!
//! Each fault is a file in `soccer/monas-eval/faults`: what is wrong, its class, and for each
//! methodology the smallest edit of its hand-written sources that makes it, or why it cannot be
//! made. In a copy of the sources the stages of [`Bench`] run in the order in which a developer
//! runs them; the first that differs from the unchanged methodology has found the fault.

mod behaviour_patch;
mod bench;

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use behaviour_patch::{BehaviourPatch, Edit, Methodology};
use bench::{Bench, Finder};

/// The folder of the faults, relative to the workspace.
const FOLDER: &str = "soccer/monas-eval/faults";
/// The golden table, which `monas eval` prints.
const TABLE: &str = "soccer/monas-eval/faults/found.txt";

/// The folder of the change requests, in the same form; their edits include tests of the change.
const CHANGES: &str = "soccer/monas-eval/changes";
/// The golden table of the edits that the change requests need.
const CHANGE_TABLE: &str = "soccer/monas-eval/changes/edits.txt";

/// The use of the result.
pub(crate) enum Task<'a> {
    /// Write the golden table.
    Write,
    /// Compare with the golden table.
    Check,
    /// Print the result of the fault with this name.
    Print(&'a str),
}

/// The first check that finds a fault, by methodology; none where the fault cannot be made.
type Row<'a> = (&'a BehaviourPatch, BTreeMap<Methodology, Option<Finder>>);

/// Injects the faults, one at a time.
pub(crate) fn run(root: &Path, task: Task<'_>) -> Result<ExitCode, Box<dyn Error>> {
    let mut faults = behaviour_patch::read(&root.join(FOLDER))?;
    let mut changes = behaviour_patch::read(&root.join(CHANGES))?;
    if let Task::Print(name) = task {
        faults.retain(|fault| fault.name == name);
        changes.retain(|change| change.name == name);
        if faults.len() + changes.len() == 0 {
            return Err(format!("no fault and no change request `{name}`").into());
        }
    }
    let bench = Bench::build(root)?;
    for (change, methodology) in
        changes.iter().flat_map(|change| Methodology::ALL.map(|methodology| (change, methodology)))
    {
        let seconds = bench.adopt(methodology, change)?.as_secs_f64();
        println!(
            "{:<24} {:<8} runs {seconds:.1} s after the edit, and passes",
            change.name,
            methodology.name()
        );
    }
    let mut rows: Vec<Row<'_>> = Vec::new();
    for fault in &faults {
        let mut found = BTreeMap::new();
        for (&methodology, edit) in &fault.edits {
            let finder = match edit {
                Edit::Diffs(_) => {
                    let finding = bench.find(methodology, fault)?;
                    println!(
                        "{:<24} {:<8} {:<10} {}",
                        fault.name,
                        methodology.name(),
                        finding.finder.name(),
                        finding.evidence
                    );
                    Some(finding.finder)
                }
                Edit::CannotBeMade(_) => None,
            };
            found.insert(methodology, finder);
        }
        rows.push((fault, found));
    }
    let text = table(&rows);
    let edits = change_table(&changes);
    print!("\n{text}\n{edits}");
    for (file, text) in [(TABLE, text), (CHANGE_TABLE, edits)] {
        let golden = root.join(file);
        match task {
            Task::Print(_) => {}
            Task::Write => fs::write(golden, text)?,
            Task::Check if fs::read_to_string(&golden).is_ok_and(|golden| golden == text) => {}
            Task::Check => return Err(format!("this is not {file}").into()),
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The edits of each change request in the sources of each methodology, without tests.
fn change_table(changes: &[BehaviourPatch]) -> String {
    let mut text = String::new();
    line(
        &mut text,
        "lines / places / files changed",
        Methodology::ALL.map(|methodology| methodology.name().to_owned()),
    );
    for change in changes {
        let extent = |methodology| {
            let (lines, places, files) = change.extent(methodology);
            format!("{lines} / {places} / {files}")
        };
        line(&mut text, &change.class, Methodology::ALL.map(extent));
    }
    text
}

/// The table of all faults, and how many each stage has found.
fn table(rows: &[Row<'_>]) -> String {
    let mut text = String::new();
    line(&mut text, "fault", Methodology::ALL.map(|methodology| methodology.name().to_owned()));
    for (fault, found) in rows {
        let finder =
            |methodology| found.get(&methodology).copied().flatten().map_or("-", Finder::name).to_owned();
        line(&mut text, &fault.class, Methodology::ALL.map(finder));
    }
    text.push('\n');
    let count = |matches: &dyn Fn(Option<Finder>) -> bool| {
        let of = |methodology: Methodology| {
            rows.iter().filter(|(_, found)| matches(found.get(&methodology).copied().flatten())).count()
        };
        Methodology::ALL.map(|methodology| of(methodology).to_string())
    };
    line(&mut text, "faults that can be made", count(&|finder| finder.is_some()));
    for finder in Finder::ALL {
        line(&mut text, finder.sum(), count(&|found| found == Some(finder)));
    }
    text
}

fn line(text: &mut String, name: &str, columns: [String; 3]) {
    let [direct, agents, aseme] = columns;
    // A string takes every text.
    let _ = writeln!(text, "{name:<44}{direct:>11}{agents:>11}{aseme:>11}");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults() -> Vec<BehaviourPatch> {
        behaviour_patch::read(&crate::root().join(FOLDER)).unwrap()
    }

    #[test]
    fn every_fault_fits_the_sources_of_its_way() {
        let root = crate::root();
        let faults = faults();
        assert!(faults.len() >= 12, "{} faults", faults.len());
        for (fault, methodology) in
            faults.iter().flat_map(|fault| Methodology::ALL.map(|methodology| (fault, methodology)))
        {
            let Edit::Diffs(_) = &fault.edits[&methodology] else { continue };
            let read = |file: &str| Ok(fs::read_to_string(root.join(file))?);
            let changed = fault.apply(methodology, read).unwrap_or_else(|error| panic!("{error}"));
            for (file, text) in changed {
                assert!(methodology.owns(&file), "{}: {file} is not of {}", fault.name, methodology.name());
                assert_ne!(text, fs::read_to_string(root.join(&file)).unwrap(), "{}", fault.name);
            }
        }
    }

    #[test]
    fn every_change_fits_the_sources_and_its_table_is_up_to_date() {
        let root = crate::root();
        let changes = behaviour_patch::read(&root.join(CHANGES)).unwrap();
        assert!(changes.len() >= 3);
        for (change, methodology) in
            changes.iter().flat_map(|change| Methodology::ALL.map(|methodology| (change, methodology)))
        {
            let read = |file: &str| Ok(fs::read_to_string(root.join(file)).unwrap_or_default());
            let changed = change.apply(methodology, read).unwrap_or_else(|error| panic!("{error}"));
            assert!(changed.keys().any(|file| !methodology.owns(file)), "{} has no test", change.name);
        }
        assert_eq!(change_table(&changes), fs::read_to_string(root.join(CHANGE_TABLE)).unwrap());
    }

    #[test]
    fn classes_are_distinct_and_the_table_has_all_of_them() {
        let faults = faults();
        let table = fs::read_to_string(crate::root().join(TABLE)).unwrap();
        let classes: Vec<&str> = faults.iter().map(|fault| fault.class.as_str()).collect();
        let rows: Vec<&str> = table.lines().skip(1).map_while(|line| line.get(..44)).map(str::trim).collect();
        assert_eq!(rows, classes, "run `cargo xtask eval-faults`");
        let mut once = classes.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), classes.len());
    }

    #[test]
    fn the_sums_are_those_of_the_table() {
        let fault = |class: &str| BehaviourPatch { class: class.into(), ..BehaviourPatch::default() };
        let (first, second) = (fault("one"), fault("two"));
        let found =
            |finder| BTreeMap::from([(Methodology::Direct, None), (Methodology::Aseme, Some(finder))]);
        let text = table(&[(&first, found(Finder::Tests)), (&second, found(Finder::Check))]);
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(lines[1], ["one", "-", "-", "tests"]);
        assert!(lines.contains(&vec!["faults", "that", "can", "be", "made", "0", "0", "2"]), "{text}");
        assert!(lines.contains(&vec!["not", "found", "0", "0", "0"]), "{text}");
    }
}
