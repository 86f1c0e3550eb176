//! `cargo xtask faults`: the tests catch the classic faults of such engines.
//!
//! Each fault is a patch in `crates/yase/tests/faults` whose header says what it breaks, which rule that is, and which tests see it.
//! The sources are copied, without the fault those tests pass in the copy, and with it each of them fails. A fault that does not compile
//! is not caught, and a patch that does not fit the sources any more is an error: it is to be brought up to date.

mod copy;
mod patch;

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use copy::{Copy, Verdicts};
use patch::{Fault, Test};

/// Where the patches are, relative to the workspace.
const FOLDER: &str = "crates/yase/tests/faults";

/// Puts in one fault after the other, prints a table, and fails unless all are caught.
pub(crate) fn run(root: &Path) -> Result<ExitCode, Box<dyn Error>> {
    let faults = patch::read(&root.join(FOLDER))?;
    let copy = Copy::make(root)?;
    let all: BTreeSet<&Test> = faults.iter().flat_map(|fault| &fault.tests).collect();
    let sound = run_tests(&copy, all.iter().copied())?;
    let broken: Vec<&Test> = all.into_iter().filter(|test| sound.get(*test) != Some(&true)).collect();
    if !broken.is_empty() {
        return Err(format!("these do not pass without a fault: {broken:#?}").into());
    }
    let mut missed = 0;
    for fault in &faults {
        let verdict = judge(&copy, fault)?;
        missed += usize::from(verdict.is_err());
        println!("{:<36} {:<10} {}", fault.name, fault.rule, verdict.unwrap_or_else(|why| why));
    }
    println!("faults: {} put in, {} caught", faults.len(), faults.len() - missed);
    Ok(if missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// How a fault is caught, or why it is not. The copy is sound again afterwards.
fn judge(copy: &Copy, fault: &Fault) -> Result<Result<String, String>, Box<dyn Error>> {
    let broken = patch::apply(fault, |file| copy.read(file))?;
    let sound: Vec<_> =
        broken.keys().map(|file| Ok((file, copy.read(file)?))).collect::<Result<_, Box<dyn Error>>>()?;
    for (file, text) in &broken {
        copy.write(file, text)?;
    }
    let verdicts = run_tests(copy, &fault.tests);
    for (file, text) in sound {
        copy.write(file, &text)?;
    }
    Ok(match verdicts {
        Ok(verdicts) => weigh(fault, &verdicts),
        Err(error) => Err(format!("NOT CAUGHT: {error}")),
    })
}

fn weigh(fault: &Fault, verdicts: &Verdicts) -> Result<String, String> {
    let is_blind = |test: &&Test| verdicts.get(*test) != Some(&false);
    match fault.tests.iter().find(is_blind) {
        Some(test) => Err(format!("NOT CAUGHT by {}", test.name)),
        None => Ok(format!("caught by {}", names(&fault.tests))),
    }
}

fn names(tests: &[Test]) -> String {
    tests.iter().map(|test| test.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// Runs tests, those of one program together.
fn run_tests<'t>(copy: &Copy, tests: impl IntoIterator<Item = &'t Test>) -> Result<Verdicts, Box<dyn Error>> {
    let mut programs: BTreeMap<&str, Vec<&Test>> = BTreeMap::new();
    for test in tests {
        programs.entry(&test.program).or_default().push(test);
    }
    let mut verdicts = Verdicts::new();
    for (program, tests) in programs {
        verdicts.extend(copy.run_tests(program, &tests)?);
    }
    Ok(verdicts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_patch_fits_the_sources() {
        let root = crate::root();
        let faults = patch::read(&root.join(FOLDER)).unwrap();
        assert!(faults.len() >= 14, "{} faults", faults.len());
        for fault in &faults {
            let changed = patch::apply(fault, |file| Ok(std::fs::read_to_string(root.join(file))?));
            let changed = changed.unwrap_or_else(|error| panic!("{error}"));
            assert!(!changed.is_empty(), "{} changes nothing", fault.name);
        }
    }

    #[test]
    fn a_fault_is_caught_only_when_all_its_tests_fail() {
        let test = |name: &str| Test { program: "-p yase".into(), name: name.into() };
        let fault = Fault {
            name: "f".into(),
            rule: "R1".into(),
            tests: vec![test("a"), test("b")],
            diffs: Vec::new(),
        };
        let verdicts = |a, b| Verdicts::from([(test("a"), a), (test("b"), b)]);
        assert!(weigh(&fault, &verdicts(false, false)).is_ok());
        assert!(weigh(&fault, &verdicts(false, true)).is_err());
        assert!(weigh(&fault, &Verdicts::new()).is_err(), "a test that did not run sees nothing");
    }
}
