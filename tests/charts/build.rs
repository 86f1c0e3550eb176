//! Generates random charts as Rust: those of the tests of `yase`, by number. `MONAS_CHARTS=1000..2000` chooses other numbers.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // what is shared with tests has theirs

#[path = "../../crates/yase/tests/kit/mod.rs"]
mod kit;
#[allow(dead_code, unreachable_pub, unused_imports)] // the rest is for other tests
#[path = "../../crates/yase/tests/reference/oracle"]
mod oracle {
    pub(crate) mod chance;
    pub(crate) mod random;
}

use std::error::Error;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;

use aseme::generate::{Words, generate};
use kit::world::TOPICS;
use oracle::random::Case;

/// These, if nothing else is asked for.
const NUMBERS: Range<u64> = 0..200;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-env-changed=MONAS_CHARTS");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../../crates/yase/tests");
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("cargo says where generated files go")?);
    let words = Words {
        vocabulary: kit::world::vocabulary(),
        messages: TOPICS.iter().map(|name| ((*name).into(), "crate::kit::world::Number".into())).collect(),
        ..Words::default()
    };
    let mut modules = String::new();
    let mut table = String::new();
    for number in numbers()? {
        let files = generate(&Case::numbered(number).chart, &words)
            .map_err(|found| format!("chart {number}: {}", found[0]))?;
        for (path, text) in &files {
            let path = folder.join(format!("chart_{number}")).join(path);
            fs::create_dir_all(path.parent().ok_or("it has one")?)?;
            fs::write(path, text)?;
        }
        let path = folder.join(format!("chart_{number}/src/lib.rs"));
        modules += &format!("#[path = {path:?}]\nmod chart_{number};\n");
        table += &format!("    ({number}, chart_{number}::chart),\n");
    }
    let all = format!("{modules}\npub(crate) const CHARTS: &[(u64, Make)] = &[\n{table}];\n");
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
