//! The tasks that play matches: they run the package of whole matches in release mode.

use std::path::Path;
use std::process::{Command, ExitCode};

/// Runs the program of the season with arguments.
pub(crate) fn season(root: &Path, arguments: &[&str]) -> Result<ExitCode, Box<dyn std::error::Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(root).args([
        "run",
        "--release",
        "--quiet",
        "--package",
        "monas-tests",
        "--bin",
        "season",
        "--",
    ]);
    let status = command.args(arguments).status()?;
    Ok(if status.success() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
