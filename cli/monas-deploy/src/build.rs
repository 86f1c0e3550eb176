//! Builds the program for a robot.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use monas_project::project_program;
use serde_json::Value;

use crate::error::{Error, ErrorKind};

/// Builds the program of the project around `here`, or `monas` itself outside of projects, for a
/// target triple. Returns the program's path.
///
/// # Errors
/// Cargo cannot be started, or the program does not compile; cargo prints the reason to standard
/// error.
pub fn build_program(here: &Path, target: Option<&str>) -> Result<PathBuf, Error> {
    let project = project_program(here);
    let name = project.as_ref().map_or("monas", |(_, program)| program);
    let mut command = Command::new("cargo");
    command.args(["build", "--release", "--message-format", "json-render-diagnostics", "--bin", name]);
    if let Some((folder, program)) = &project {
        command.args(["--package", program, "--manifest-path"]).arg(folder.join("Cargo.toml"));
    }
    command.args(target.into_iter().flat_map(|target| ["--target", target])).current_dir(here);
    let output = command.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| failed(format!("cargo does not start: {error}")))?;
    if !output.status.success() {
        let hint = target.map(|target| format!("; `rustup target add {target}` brings the libraries of that target, install a linker for it too"));
        return Err(failed(format!("the program does not compile{}", hint.unwrap_or_default())));
    }
    let messages = String::from_utf8_lossy(&output.stdout);
    let program = messages.lines().rev().find_map(|line| executable(line, name));
    program.ok_or_else(|| failed(format!("cargo has not reported the path of `{name}`")))
}

fn failed(message: String) -> Error {
    Error::new(ErrorKind::Build, message)
}

/// The path of the program in a message of cargo.
fn executable(line: &str, name: &str) -> Option<PathBuf> {
    let message: Value = serde_json::from_str(line).ok()?;
    let is_it = message["reason"] == "compiler-artifact" && message["target"]["name"] == name;
    message["executable"].as_str().filter(|_| is_it).map(PathBuf::from)
}
