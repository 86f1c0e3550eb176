//! `monas new`: a project, or an activity in one.

mod activity;
mod module;
mod project;

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::arguments::{Format, NewArguments};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(crate) fn execute(arguments: &NewArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match arguments.names.as_slice() {
        [_] if arguments.module => {
            Err(Failure::Usage("--module is for an activity: `monas new activity NAME --module`".into()))
        }
        [project] => project::create(project, arguments, console),
        [kind, name] if kind == "activity" && arguments.module => module::create(name, arguments, console),
        [kind, name] if kind == "activity" => activity::create(name, arguments, console),
        [kind, name, ..] => {
            let message = format!(
                "`{kind}` is nothing that can be made with a name: `monas new activity {name}`, or `monas new {kind}`"
            );
            Err(Failure::Usage(message))
        }
        [] => Err(Failure::Usage("name what is to be made".into())),
    }
}

/// The project around a folder: the innermost one that `monas new` has made.
pub(crate) fn project_around(folder: &Path) -> Option<PathBuf> {
    let folder = std::path::absolute(folder).ok()?;
    let is_project = |folder: &&Path| {
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
        manifest.contains("[workspace.metadata.monas]") && folder.join("activities/lib.rs").is_file()
    };
    folder.ancestors().find(is_project).map(Path::to_path_buf)
}

/// Tells which files have been written.
fn tell(files: &[PathBuf], format: Format, console: &mut Console<'_>) -> Result<(), Failure> {
    for file in files {
        match format {
            Format::Text => writeln!(console.out, "{}", file.display())?,
            Format::Json => writeln!(console.out, "{}", json!({ "written": file }))?,
        }
    }
    Ok(())
}
