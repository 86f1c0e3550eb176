//! The project's own chores, started with `cargo xtask NAME`. Each is a module; none is needed to use Monas.
//!
//! - `tidy` holds the house to what ARCHITECTURE.md and STYLE.md promise.
//! - `faults` puts classic faults into the engine, one at a time, and requires that the tests catch them.
//! - `project` makes a project with `monas new`, builds, tests and runs it, and adds to it.
//! - `season` plays a season and writes its golden table; with `--check` it compares.
//! - `picture` draws the match that README.md shows.

mod faults;
mod play;
mod project;
mod tidy;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask NAME

  tidy            check layers, absences, dependencies, texts and documents
  faults          put classic faults into a copy and see that the tests catch each
  project         make a project with `monas new`, build, test and run it, and add to it
  season          play a season and write its golden table (tests/golden)
  season --check  play a season and compare it with its golden table
  picture         draw docs/match.svg";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match arguments[..] {
        ["tidy"] => tidy::run(&root()),
        ["faults"] => faults::run(&root()),
        ["project"] => project::run(&root()),
        ["season"] => play::season(&root(), &[]),
        ["season", "--check"] => play::season(&root(), &["--check"]),
        ["picture"] => play::season(&root(), &["picture", "docs/match.svg"]),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    result.unwrap_or_else(|error| {
        eprintln!("xtask: {error}");
        ExitCode::FAILURE
    })
}

/// The folder of the workspace: the one above this package.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}
