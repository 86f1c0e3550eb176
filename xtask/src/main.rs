//! Development tasks, started with `cargo xtask NAME`. Each is a module; none is needed to use
//! Monas.
//!
//! - `tidy` checks the rules of ARCHITECTURE.md and STYLE.md.
//! - `bodies` links each crate of a body under `robots/` into the command `monas`.
//! - `faults` injects classic faults into the engine, one at a time, and requires that the tests
//!   detect each.
//! - `eval-faults` injects the same faults of behaviour into the three ways of `monas eval` and
//!   records what finds each first: compiler, check of the model, tests or matches.
//! - `project` creates a project with `monas new`, builds, tests and runs it, and extends it.
//! - `season` plays a season and writes its golden table; with `--check` it compares.

mod eval_faults;
mod faults;
mod project;
mod season;
mod tidy;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask NAME

  tidy               check layers, absences, dependencies, texts, documents, prose, sizes and circles
  tidy --allowances  print the table of allowances for today's sources
  bodies             link each crate of a body under robots/ into the command `monas`
  faults             inject classic faults into a copy and check that the tests detect each
  eval-faults        inject faults of behaviour into the three programs of `monas eval`, write what finds each
  eval-faults --check
                     the same, and compare the result with its golden table
  eval-faults NAME   inject one of these faults, print what finds it
  project            create a project with `monas new`, build, test, run and extend it
  season             play a season and write its golden table (tests/golden)
  season --check     play a season and compare it with its golden table";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match arguments[..] {
        ["tidy"] => tidy::run(&root()),
        ["tidy", "--allowances"] => tidy::allowances(&root()),
        ["bodies"] => tidy::link_bodies(&root()),
        ["faults"] => faults::run(&root()),
        ["eval-faults"] => eval_faults::run(&root(), eval_faults::Task::Write),
        ["eval-faults", "--check"] => eval_faults::run(&root(), eval_faults::Task::Check),
        ["eval-faults", name] => eval_faults::run(&root(), eval_faults::Task::Print(name)),
        ["project"] => project::run(&root()),
        ["season"] => season::season(&root(), &[]),
        ["season", "--check"] => season::season(&root(), &["--check"]),
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

/// The folder of the workspace: the parent of this package.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}
