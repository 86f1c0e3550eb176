//! The program that a robot gets.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::handover::own_program;

/// Builds the program of the project here, or Monas itself where no project is, and answers where it is.
///
/// # Errors
/// Cargo does not start, or the program does not compile; cargo has said why.
pub(super) fn build(here: &Path, target: Option<&str>) -> Result<PathBuf, String> {
    let project = own_program(here);
    let name = project.as_ref().map_or("monas", |(_, program)| program);
    let mut command = Command::new("cargo");
    command.args(["build", "--release", "--message-format", "json-render-diagnostics", "--bin", name]);
    if let Some((folder, program)) = &project {
        command.args(["--package", program, "--manifest-path"]).arg(folder.join("Cargo.toml"));
    }
    command.args(target.into_iter().flat_map(|target| ["--target", target])).current_dir(here);
    let output = command.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| format!("cargo does not start: {error}"))?;
    if !output.status.success() {
        let hint = target.map(|target| format!("; `rustup target add {target}` brings the libraries of that target, a linker for it is yours to install"));
        return Err(format!("the program does not compile{}", hint.unwrap_or_default()));
    }
    let told = String::from_utf8_lossy(&output.stdout);
    let made = told.lines().rev().find_map(|line| executable(line, name));
    made.ok_or_else(|| format!("cargo has not said where `{name}` is"))
}

/// The program that a line of cargo's tells of, if that is the one.
fn executable(line: &str, name: &str) -> Option<PathBuf> {
    let message: Value = serde_json::from_str(line).ok()?;
    let is_it = message["reason"] == "compiler-artifact" && message["target"]["name"] == name;
    message["executable"].as_str().filter(|_| is_it).map(PathBuf::from)
}
