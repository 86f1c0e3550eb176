//! Third-party documents; the tests are skipped if their folder is absent.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use aseme_verify::{CheckSettings, check::check};
use yase::Source;

fn files(within: &str) -> Option<Vec<PathBuf>> {
    let shared = std::env::var_os("MONAS_SHARED").map(PathBuf::from);
    let shared = shared.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"));
    let (mut files, mut open) = (Vec::new(), vec![shared.join(within)]);
    while let Some(folder) = open.pop() {
        for entry in folder.read_dir().ok()? {
            let path = entry.unwrap().path();
            if path.is_dir() { open.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    Some(files)
}

#[test]
fn no_conformant_document_has_an_error() {
    let Some(mut files) = files("suites") else {
        return println!("skipped: the folder of suites is not there");
    };
    files.retain(|file| file.extension().is_some_and(|ending| ending == "scxml"));
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut checked = 0;
    for file in &files {
        let text = std::fs::read_to_string(file).unwrap();
        let report = check(&Source::new(file.display().to_string(), text), &CheckSettings::default());
        if report.is_unreadable() {
            continue;
        }
        checked += 1;
        for finding in &report.findings {
            assert!(!finding.diagnostic.is_error(), "{finding}");
            *counts.entry(finding.diagnostic.code).or_default() += 1;
        }
    }
    println!("{checked} of {} documents, warnings: {counts:?}", files.len());
    assert!(checked * 10 > files.len() * 9, "{checked} of {}", files.len());
}

#[test]
fn every_model_is_checked_without_ado() {
    let Some(files) = files("models") else { return println!("skipped: the folder of models is not there") };
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for file in &files {
        let text = std::fs::read_to_string(file).unwrap();
        let mut settings = CheckSettings::default();
        settings.states = 200;
        let report = check(&Source::new(file.display().to_string(), text), &settings);
        for finding in &report.findings {
            *counts.entry(finding.diagnostic.code).or_default() += 1;
        }
    }
    println!("{} files, findings: {counts:?}", files.len());
    assert!(files.len() > 40);
}
