//! `monas new`: creates a project, or an activity in one.

use std::env;
use std::path::{Path, PathBuf};

use clap::Args;
use monas_project::{NewActivity, NewModule, create_activity, create_module, create_project};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument};
use serde_json::json;

/// Arguments of `monas new`.
#[derive(Args, Debug)]
pub(crate) struct NewArguments {
    /// The folder of a new project, or `activity` and a name.
    #[arg(required = true, num_args = 1..=2, value_name = "NAME")]
    pub(crate) names: Vec<String>,
    /// Create the activity as a module: a crate in `modules` that can be loaded at run time.
    #[arg(long)]
    pub(crate) module: bool,
    /// The source of Monas for the project: a checkout, the address of a git repository, or a
    /// version; the checkout that this command was built from if not given.
    #[arg(long, value_name = "PATH|GIT|VERSION")]
    pub(crate) monas: Option<String>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// Maps an error of a project to a failure, for `map_err`.
pub(super) fn project_failure(format: Format) -> impl Fn(monas_project::Error) -> CommandFailure {
    move |error| match error.kind() {
        monas_project::ErrorKind::Argument => CommandFailure::Usage(error.to_string()),
        monas_project::ErrorKind::Invalid => CommandFailure::Invalid(format, error.diagnostics().to_vec()),
        _ => CommandFailure::failed(format, error),
    }
}

pub(crate) fn execute(
    arguments: &NewArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match arguments.names.as_slice() {
        [_] if arguments.module => Err(CommandFailure::Usage(
            "--module is for an activity: `monas new activity NAME --module`".into(),
        )),
        [kind] if kind == "activity" => {
            Err(CommandFailure::Usage("the activity has no name: `monas new activity NAME`".into()))
        }
        [name] => project(name, arguments, console),
        [kind, name] if kind == "activity" && arguments.module => module(name, arguments, console),
        [kind, name] if kind == "activity" => activity(name, arguments, console),
        [kind, name, ..] => {
            let message = format!(
                "`{kind}` cannot be created with a name: `monas new activity {name}`, or `monas new {kind}`"
            );
            Err(CommandFailure::Usage(message))
        }
        [] => Err(CommandFailure::Usage("name what to create".into())),
    }
}

fn project(
    folder: &str,
    arguments: &NewArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let folder = Path::new(folder);
    let files = create_project(folder, arguments.monas.as_deref()).map_err(project_failure(format))?;
    write_paths(&files, Path::new(""), format, console)?;
    if format == Format::Text {
        writeln!(console.remarks(), "next: cd {} && cargo test", folder.display())?;
    }
    Ok(Exit::Success)
}

fn activity(
    name: &str,
    arguments: &NewArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let here = here(format)?;
    let NewActivity { files, name } = create_activity(name, &here).map_err(project_failure(format))?;
    write_paths(&files, &here, format, console)?;
    if format == Format::Text {
        writeln!(console.remarks(), "configurations and models refer to it as `{name}`")?;
    }
    Ok(Exit::Success)
}

fn module(
    name: &str,
    arguments: &NewArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let here = here(format)?;
    let NewModule { files, package } = create_module(name, &here).map_err(project_failure(format))?;
    write_paths(&files, &here, format, console)?;
    if format == Format::Text {
        writeln!(
            console.remarks(),
            "next: `monas module build {package}`, then `monas module load` with the printed file"
        )?;
    }
    Ok(Exit::Success)
}

fn here(format: Format) -> Result<PathBuf, CommandFailure> {
    env::current_dir().map_err(|error| CommandFailure::failed(format, error))
}

/// Prints the paths of files, relative to a folder where they lie in it.
fn write_paths(
    files: &[PathBuf],
    folder: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    for file in files {
        let file = file.strip_prefix(folder).unwrap_or(file);
        match format {
            Format::Text => writeln!(console.out, "{}", file.display())?,
            Format::Json => writeln!(console.out, "{}", json!({ "written": file }))?,
        }
    }
    Ok(())
}
