//! In a project, the project's own program knows its activities: `monas` builds that and hands over to it.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::new::project_around;

/// What needs no activities is done at once.
const OWN: [&str; 7] = ["new", "completions", "help", "--help", "-h", "--version", "-V"];

/// The command to start instead of this one, if there is one: in the folder of a project, by a program that is not the project's.
fn instead(arguments: &[OsString], here: &Path, program: &Path) -> Option<Command> {
    let first = arguments.first()?.to_string_lossy().into_owned();
    if OWN.contains(&first.as_str()) {
        return None;
    }
    let (project, own) = own_program(here)?;
    if program.file_stem().is_some_and(|stem| stem == own.as_str()) {
        return None;
    }
    let mut command = Command::new("cargo");
    command.args(["run", "--quiet", "--package", &own, "--manifest-path"]).arg(project.join("Cargo.toml"));
    command.arg("--").args(arguments);
    Some(command)
}

/// The folder of the project around a folder, and the name of its program.
pub(crate) fn own_program(here: &Path) -> Option<(PathBuf, String)> {
    let project = project_around(here)?;
    let own = program_of(&std::fs::read_to_string(project.join("Cargo.toml")).ok()?)?;
    Some((project, own))
}

/// The name of a project's program.
fn program_of(manifest: &str) -> Option<String> {
    let (_, table) = manifest.split_once("[workspace.metadata.monas]")?;
    let table = table.split("\n[").next()?;
    let line = table.lines().find_map(|line| line.trim().strip_prefix("program"))?;
    Some(line.trim_start().strip_prefix('=')?.trim().trim_matches('"').to_owned())
}

/// Starts the project's own program with the arguments of this one, and ends as it ends. Comes back if there is none.
pub(crate) fn hand_over() {
    let arguments: Vec<OsString> = env::args_os().skip(1).collect();
    let (Ok(here), Ok(program)) = (env::current_dir(), env::current_exe()) else { return };
    if let Some(command) = instead(&arguments, &here, &program) {
        become_it(command);
    }
}

/// This process becomes the other one, so that signals reach it.
#[cfg(unix)]
fn become_it(mut command: Command) {
    use std::os::unix::process::CommandExt;
    let error = command.exec();
    tracing::warn!("this project's own program is not started, its activities are unknown: cargo: {error}");
}

#[cfg(not(unix))]
fn become_it(mut command: Command) {
    match command.status() {
        Ok(status) => std::process::exit(status.code().unwrap_or(1)),
        Err(error) => {
            tracing::warn!(
                "this project's own program is not started, its activities are unknown: cargo: {error}"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(command: Command) -> Vec<String> {
        command.get_args().map(|one| one.to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn only_another_program_in_a_project_hands_over() {
        let folder = tempfile::tempdir().unwrap();
        let monas = Path::new("/usr/bin/monas");
        let run = ["run".into(), "--for".into(), "1s".into()];
        assert!(instead(&run, folder.path(), monas).is_none(), "no project");
        std::fs::create_dir(folder.path().join("activities")).unwrap();
        std::fs::write(folder.path().join("activities/lib.rs"), "").unwrap();
        let manifest =
            "[workspace]\n[workspace.metadata.monas]\nteam = \".\"\nprogram = \"my-team\"\n\n[package]\n";
        std::fs::write(folder.path().join("Cargo.toml"), manifest).unwrap();
        let below = folder.path().join("activities");
        let handed = arguments(instead(&run, &below, monas).unwrap());
        assert_eq!(handed[..4], ["run", "--quiet", "--package", "my-team"]);
        assert_eq!(handed[handed.len() - 4..], ["--", "run", "--for", "1s"]);
        assert!(instead(&run, &below, Path::new("/x/target/debug/my-team")).is_none(), "it is the project's");
        assert!(instead(&["new".into(), "activity".into()], &below, monas).is_none());
        assert!(instead(&[], &below, monas).is_none());
    }
}
