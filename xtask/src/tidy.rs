//! `cargo xtask tidy`: the house is as its documents say, or the place where it is not is named as `file:line`.

mod documents;
mod knowledge;
mod layers;
mod manifests;
mod source;
mod texts;
mod workspace;

use std::error::Error;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use workspace::Workspace;

/// Something that is not as it should be.
#[derive(PartialEq, Eq, PartialOrd, Ord, Debug)]
struct Finding {
    file: PathBuf,
    line: usize,
    message: String,
}

impl Finding {
    fn new(file: impl Into<PathBuf>, line: usize, message: impl Into<String>) -> Finding {
        Finding { file: file.into(), line, message: message.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, self.message)
    }
}

/// Runs every check on the workspace at `root`, prints what they find, and fails if there is anything.
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

fn check(workspace: &Workspace) -> Vec<Finding> {
    let mut findings = Vec::new();
    findings.extend(layers::check(workspace));
    findings.extend(knowledge::check(workspace));
    findings.extend(manifests::check(workspace));
    findings.extend(texts::check(workspace));
    findings.extend(documents::check(workspace));
    findings.sort();
    findings.dedup();
    findings
}
