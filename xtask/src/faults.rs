//! `cargo xtask faults`: mutation tests of the engine with classic faults.
//!
//! Each fault is a patch in `charts/yase/tests/faults` whose header states the fault, the violated
//! rule and the tests that detect it. In a copy of the sources these tests must pass without the
//! fault, and each must fail with it. A fault that does not compile is not detected, and a patch
//! that no longer applies to the sources is an error: it must be updated.

pub(crate) mod copy;
pub(crate) mod patch;

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use copy::{TestResults, WorkspaceCopy};
use patch::{Fault, FaultTest};

/// The folder of the patches, relative to the workspace.
const FOLDER: &str = "charts/yase/tests/faults";

/// Injects one fault after the other, prints a table, and fails unless all are detected.
pub(crate) fn run(root: &Path) -> Result<ExitCode, Box<dyn Error>> {
    let faults = patch::read(&root.join(FOLDER))?;
    let copy = WorkspaceCopy::make(root, "faults")?;
    let all: BTreeSet<&FaultTest> = faults.iter().flat_map(|fault| &fault.tests).collect();
    let sound = run_tests(&copy, all.iter().copied())?;
    let broken: Vec<&FaultTest> = all.into_iter().filter(|test| sound.get(*test) != Some(&true)).collect();
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

/// The check that detects a fault, or the reason why none does. Afterwards the copy is restored.
fn judge(copy: &WorkspaceCopy, fault: &Fault) -> Result<Result<String, String>, Box<dyn Error>> {
    let broken = patch::apply(&fault.name, &fault.diffs, |file| copy.read(file))?;
    let verdicts = copy.with(&broken, || run_tests(copy, &fault.tests))?;
    Ok(match verdicts {
        Ok(verdicts) => evaluate(fault, &verdicts),
        Err(error) => Err(format!("NOT CAUGHT: {error}")),
    })
}

fn evaluate(fault: &Fault, verdicts: &TestResults) -> Result<String, String> {
    let is_blind = |test: &&FaultTest| verdicts.get(*test) != Some(&false);
    match fault.tests.iter().find(is_blind) {
        Some(test) => Err(format!("NOT CAUGHT by {}", test.name)),
        None => Ok(format!("caught by {}", names(&fault.tests))),
    }
}

fn names(tests: &[FaultTest]) -> String {
    tests.iter().map(|test| test.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// Runs tests, grouped by program.
fn run_tests<'t>(
    copy: &WorkspaceCopy,
    tests: impl IntoIterator<Item = &'t FaultTest>,
) -> Result<TestResults, Box<dyn Error>> {
    let mut programs: BTreeMap<&str, Vec<&FaultTest>> = BTreeMap::new();
    for test in tests {
        programs.entry(&test.program).or_default().push(test);
    }
    let mut verdicts = TestResults::new();
    for (program, tests) in programs {
        verdicts.extend(copy.run_tests(program, &tests)?);
    }
    Ok(verdicts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::workspace::Workspace;

    #[test]
    fn every_patch_fits_the_sources() {
        let root = crate::root();
        let faults = patch::read(&root.join(FOLDER)).unwrap();
        assert!(faults.len() >= 14, "{} faults", faults.len());
        for fault in &faults {
            let changed =
                patch::apply(&fault.name, &fault.diffs, |file| Ok(std::fs::read_to_string(root.join(file))?));
            let changed = changed.unwrap_or_else(|error| panic!("{error}"));
            assert!(!changed.is_empty(), "{} changes nothing", fault.name);
        }
    }

    #[test]
    fn every_test_that_a_patch_names_exists() {
        let workspace = Workspace::read(&crate::root()).unwrap();
        for fault in patch::read(&workspace.root.join(FOLDER)).unwrap() {
            for FaultTest { program, name } in &fault.tests {
                let function = format!("fn {}(", name.rsplit("::").next().unwrap());
                let is_of = |package: &str| program.starts_with(&format!("-p {package} "));
                let is_there = workspace.files.iter().filter(|file| file.is_rust()).any(|file| {
                    file.text.contains(&function)
                        && workspace.crate_of(file).is_some_and(|member| is_of(&member.name))
                });
                assert!(is_there, "{} names {program} {name}", fault.name);
            }
        }
    }

    #[test]
    fn a_fault_is_caught_only_when_all_its_tests_fail() {
        let test = |name: &str| FaultTest { program: "-p yase".into(), name: name.into() };
        let fault = Fault {
            name: "f".into(),
            rule: "R1".into(),
            tests: vec![test("a"), test("b")],
            diffs: Vec::new(),
        };
        let verdicts = |a, b| TestResults::from([(test("a"), a), (test("b"), b)]);
        assert!(evaluate(&fault, &verdicts(false, false)).is_ok());
        assert!(evaluate(&fault, &verdicts(false, true)).is_err());
        assert!(evaluate(&fault, &TestResults::new()).is_err(), "a test that did not run sees nothing");
    }
}
