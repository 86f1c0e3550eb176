//! Texts for other tools, compared with golden files.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use yase::Statechart;
use yase_export::{Exported, to_dot, to_mermaid, to_plantuml, to_xstate};

type Export = fn(&Statechart) -> Exported;

pub(crate) fn input(name: &str) -> Statechart {
    let text = std::fs::read_to_string(golden_file(name, "chart")).unwrap();
    super::text::chart(name, &text)
}

fn golden_file(name: &str, ending: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/export/charts/{name}.{ending}"))
}

#[track_caller]
fn check(name: &str) {
    let chart = input(name);
    let mut lost = String::new();
    let tools: [(&str, Export); 4] =
        [("json", to_xstate), ("mmd", to_mermaid), ("puml", to_plantuml), ("dot", to_dot)];
    for (ending, export) in tools {
        let exported = export(&chart);
        compare(name, ending, &exported.text);
        exported.lost.iter().for_each(|finding| writeln!(lost, "{ending}: {finding}").unwrap());
    }
    compare(name, "lost", &lost);
}

#[track_caller]
fn compare(name: &str, ending: &str, actual: &str) {
    let golden = golden_file(name, ending);
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(&golden, actual).unwrap();
    }
    let expected = std::fs::read_to_string(&golden).unwrap_or_default();
    assert!(actual == expected, "{name}.{ending} is otherwise; MONAS_BLESS=1 accepts it:\n{actual}");
}

#[test]
fn a_toggle() {
    check("toggle");
}

#[test]
fn two_regions() {
    check("regions");
}

#[test]
fn activities_and_what_follows_them() {
    check("activities");
}

#[test]
fn every_kind_of_node() {
    check("kinds");
}

#[test]
fn names_that_mean_something_to_a_tool() {
    check("names");
}
