//! `cargo xtask tidy`: checks that the workspace is as its documents say, and reports what is not
//! as `file:line`.

mod absences;
mod allowances;
mod body_kinds;
mod body_links;
mod circles;
mod columns;
mod documents;
mod layers;
mod manifests;
mod message_path;
mod names;
mod prose;
mod size;
mod source;
mod texts;
mod visibility;
mod words;
pub(crate) mod workspace;

use std::error::Error;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use workspace::Workspace;

pub(crate) use body_links::run as link_bodies;

/// A violation of the project's rules.
#[derive(PartialEq, Eq, PartialOrd, Ord, Debug)]
struct TidyFinding {
    file: PathBuf,
    line: usize,
    message: String,
}

impl TidyFinding {
    fn new(file: impl Into<PathBuf>, line: usize, message: impl Into<String>) -> TidyFinding {
        TidyFinding { file: file.into(), line, message: message.into() }
    }
}

impl fmt::Display for TidyFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, self.message)
    }
}

/// Runs every check on the workspace at `root`, prints the findings, and fails if there are any.
pub(crate) fn run(root: &Path) -> Result<ExitCode, Box<dyn Error>> {
    let workspace = Workspace::read(root)?;
    let findings = check(&workspace);
    for finding in &findings {
        println!("{finding}");
    }
    println!(
        "tidy: {} crates, {} files, {} findings",
        workspace.crates.len(),
        workspace.files.len(),
        findings.len()
    );
    Ok(if findings.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Prints the table of allowances that today's workspace needs.
pub(crate) fn allowances(root: &Path) -> Result<ExitCode, Box<dyn Error>> {
    for row in allowances::rows(&Workspace::read(root)?) {
        println!("{row}");
    }
    Ok(ExitCode::SUCCESS)
}

fn check(workspace: &Workspace) -> Vec<TidyFinding> {
    let mut findings = Vec::new();
    findings.extend(layers::check(workspace));
    findings.extend(absences::check(workspace));
    findings.extend(manifests::check(workspace));
    findings.extend(names::check(workspace));
    findings.extend(texts::check(workspace));
    findings.extend(documents::check(workspace));
    findings.extend(body_kinds::check(workspace));
    findings.extend(body_links::check(workspace));
    findings.extend(message_path::check(workspace));
    findings.extend(allowances::check(workspace));
    findings.sort();
    findings.dedup();
    findings
}
