//! Finds the project around a folder, and the project's own program.

use std::path::{Path, PathBuf};

/// The innermost project around a folder, as created by [`create_project`](crate::create_project).
pub fn project_root(folder: &Path) -> Option<PathBuf> {
    let folder = std::path::absolute(folder).ok()?;
    let is_project = |folder: &&Path| {
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
        manifest.contains("[workspace.metadata.monas]") && folder.join("activities/lib.rs").is_file()
    };
    folder.ancestors().find(is_project).map(Path::to_path_buf)
}

/// The folder of the project around a folder, and the name of its program.
pub fn project_program(here: &Path) -> Option<(PathBuf, String)> {
    let project = project_root(here)?;
    let program = program_of(&std::fs::read_to_string(project.join("Cargo.toml")).ok()?)?;
    Some((project, program))
}

/// The name of a project's program.
fn program_of(manifest: &str) -> Option<String> {
    let (_, table) = manifest.split_once("[workspace.metadata.monas]")?;
    let table = table.split("\n[").next()?;
    let line = table.lines().find_map(|line| line.trim().strip_prefix("program"))?;
    Some(line.trim_start().strip_prefix('=')?.trim().trim_matches('"').to_owned())
}
