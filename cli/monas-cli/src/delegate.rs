//! Delegation to a project's own program, which has the project's activities linked in: `monas`
//! builds it and replaces itself by it.

use std::env;
use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::Command;

use monas_project::{Project, project_program};
use monas_terminal::Exit;

/// Commands that need no activities and are executed directly.
const BUILT_IN_COMMANDS: [&str; 9] =
    ["new", "completions", "explain", "man", "help", "--help", "-h", "--version", "-V"];

/// The command to run instead of this one, if the folder is in a project and this is not the
/// project's program.
fn project_command(arguments: &[OsString], here: &Path, program: &Path) -> Option<Command> {
    let first = command_word(arguments)?;
    if BUILT_IN_COMMANDS.contains(&first.as_str()) {
        return None;
    }
    let (project, own) = project_program(here)?;
    if program.file_stem().is_some_and(|stem| stem == own.as_str()) {
        return None;
    }
    let mut command = Command::new("cargo");
    command.args(["run", "--quiet", "--package", &own, "--manifest-path"]).arg(project.join("Cargo.toml"));
    command.arg("--").args(arguments);
    Some(command)
}

/// The first argument that is none of the global options in front of the command.
fn command_word(arguments: &[OsString]) -> Option<String> {
    let mut words = arguments.iter().map(|word| word.to_string_lossy().into_owned());
    while let Some(word) = words.next() {
        match word.as_str() {
            "--color" => _ = words.next(),
            "--quiet" | "--verbose" => {}
            short if short.strip_prefix('-').is_some_and(|it| it.chars().all(|c| "qv".contains(c))) => {}
            other if other.starts_with("--color=") => {}
            _ => return Some(word),
        }
    }
    None
}

/// Runs the project's own program with the arguments of this process. Returns if there is none, or
/// if it does not start: then with the exit of this process if the command needs the activities of
/// the project.
pub(crate) fn delegate() -> Option<Exit> {
    let arguments: Vec<OsString> = env::args_os().skip(1).collect();
    let (here, program) = (env::current_dir().ok()?, env::current_exe().ok()?);
    let command = project_command(&arguments, &here, &program)?;
    let generates = command_word(&arguments).is_some_and(|word| word == "generate");
    if generates {
        link_again(&here);
    }
    let error = exec_program(command);
    if generates {
        // Without the activities of the project, each of them would get a skeleton.
        tracing::error!("cannot start this project's program, nothing is generated: cargo: {error}");
        return Some(Exit::Failure);
    }
    tracing::warn!("cannot start this project's program, its activities are unknown: cargo: {error}");
    None
}

/// Removes generated crates that are deleted or incomplete from the project's manifests: with them
/// Cargo would not build the program that does this otherwise, and that generates them again.
fn link_again(here: &Path) {
    let Some((folder, _)) = project_program(here) else { return };
    let linked = Project::around(&folder.join("Cargo.toml")).and_then(|project| project.link_complete());
    if let Err(error) = linked {
        tracing::warn!("the generated crates of this project cannot be linked: {error}");
    }
}

/// Replaces this process, so that signals reach the program. Returns why that has failed.
#[cfg(unix)]
fn exec_program(mut command: Command) -> io::Error {
    use std::os::unix::process::CommandExt;
    command.exec()
}

#[cfg(not(unix))]
fn exec_program(mut command: Command) -> io::Error {
    match command.status() {
        Ok(status) => std::process::exit(status.code().unwrap_or(1)),
        Err(error) => error,
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
        assert!(project_command(&run, folder.path(), monas).is_none(), "no project");
        std::fs::create_dir(folder.path().join("activities")).unwrap();
        std::fs::write(folder.path().join("activities/lib.rs"), "").unwrap();
        let manifest =
            "[workspace]\n[workspace.metadata.monas]\nteam = \".\"\nprogram = \"my-team\"\n\n[package]\n";
        std::fs::write(folder.path().join("Cargo.toml"), manifest).unwrap();
        let below = folder.path().join("activities");
        let handed = arguments(project_command(&run, &below, monas).unwrap());
        assert_eq!(handed[..4], ["run", "--quiet", "--package", "my-team"]);
        assert_eq!(handed[handed.len() - 4..], ["--", "run", "--for", "1s"]);
        assert!(
            project_command(&run, &below, Path::new("/x/target/debug/my-team")).is_none(),
            "it is the project's"
        );
        assert!(project_command(&["new".into(), "activity".into()], &below, monas).is_none());
        let quiet = ["-q", "--color", "never", "new", "activity"].map(OsString::from);
        assert!(project_command(&quiet, &below, monas).is_none(), "options in front of the command");
        assert!(project_command(&[], &below, monas).is_none());
    }
}
