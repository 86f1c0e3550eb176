//! Finds the project around a folder, and the project's own program.

use std::path::{Path, PathBuf};

use crate::manifest::{table, value};

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
    let manifest = std::fs::read_to_string(project.join("Cargo.toml")).ok()?;
    let program = value(table(&manifest, "[workspace.metadata.monas]")?, "program")?.to_owned();
    Some((project, program))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_of_a_project_may_have_a_comment() {
        let folder = tempfile::tempdir().expect("a folder");
        let project = folder.path().join("my-team");
        crate::create_project(&project, Some("0.1.0")).expect("a project");
        let path = project.join("Cargo.toml");
        let manifest = std::fs::read_to_string(&path).expect("a manifest");
        let line = "program = \"my-team\"";
        std::fs::write(&path, manifest.replace(line, &format!("{line} # the command"))).expect("a file");
        let found = project_program(&project.join("models")).map(|(_, program)| program);
        assert_eq!(found.as_deref(), Some("my-team"));
    }
}
