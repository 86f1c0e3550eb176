//! Generates random charts as Rust: those of the tests of `yase`, by number.
//! `MONAS_CHARTS=1000..2000` selects other numbers.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // modules shared with tests use them

use std::error::Error;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;

use aseme_codegen::generate::{RustBindings, generate};
use yase::StructureRules;
use yase_reference::random::Case;
use yase_reference::test_host::{TOPICS, vocabulary};

/// The default range.
const NUMBERS: Range<u64> = 0..200;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-env-changed=MONAS_CHARTS");
    println!("cargo::rerun-if-changed=build.rs");
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("cargo says where generated files go")?);
    let words = RustBindings {
        vocabulary: vocabulary(),
        messages: TOPICS
            .iter()
            .map(|name| ((*name).into(), "yase_reference::test_host::Number".into()))
            .collect(),
        ..RustBindings::default()
    };
    let mut modules = String::new();
    let mut table = String::new();
    for number in numbers()? {
        let case = Case::numbered(number);
        if case.semantics.structure == StructureRules::Uml {
            continue; // generated crates run with the structure rules of `yase`
        }
        let files = generate(&case.chart, &words).map_err(|found| format!("chart {number}: {}", found[0]))?;
        for (path, text) in &files {
            let path = folder.join(format!("chart_{number}")).join(path);
            fs::create_dir_all(path.parent().ok_or("it has one")?)?;
            fs::write(path, text)?;
        }
        let path = folder.join(format!("chart_{number}/src/lib.rs"));
        modules += &format!("#[path = {path:?}]\nmod chart_{number};\n");
        table += &format!("    ({number}, chart_{number}::chart),\n");
    }
    let all = format!("{modules}\npub(crate) const CHARTS: &[(u64, ChartConstructor)] = &[\n{table}];\n");
    fs::write(folder.join("charts.rs"), all)?;
    Ok(())
}

fn numbers() -> Result<Range<u64>, Box<dyn Error>> {
    match std::env::var("MONAS_CHARTS") {
        Ok(text) => {
            let (first, end) = text.split_once("..").ok_or("MONAS_CHARTS is like 1000..2000")?;
            Ok(first.parse()?..end.parse()?)
        }
        Err(_) => Ok(NUMBERS),
    }
}
