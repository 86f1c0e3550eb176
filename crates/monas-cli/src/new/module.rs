//! An activity as a module: a crate of its own in a project, which the workspace finds by its folder.

use std::fs;
use std::path::{Path, PathBuf};

use super::activity::{TEMPLATE, place_of, snake_case};
use super::project::{TAKEN, write};
use crate::arguments::{Format, NewArguments};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::generate::with_members;

const MANIFEST: &str = include_str!("template/module/Cargo.toml.txt");

/// The folder of modules among the members of a workspace.
const MEMBERS: &str = "\"modules/*\"";

pub(super) fn create(
    name: &str,
    arguments: &NewArguments,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let (here, project) = place_of(name, format)?;
    let package = snake_case(name);
    if TAKEN.contains(&package.as_str()) || aseme::generate::identifier(&[&package]) != package {
        let message =
            format!("`{package}` means something else to Rust or to the project: take another name");
        return Err(Failure::Usage(message));
    }
    let folder = project.join("modules").join(&package);
    if folder.exists() {
        return Err(Failure::Failed(format, format!("{} is there already", folder.display())));
    }
    let fill = |text: &str| text.replace("{{name}}", &package).replace("{{type}}", name);
    let activity = "monas::activity!({{type}});\n";
    let library = TEMPLATE.replace(activity, &format!("{activity}monas::module!();\n"));
    let mut written = Vec::new();
    for (file, text) in [("Cargo.toml", MANIFEST), ("lib.rs", &library)] {
        let path = folder.join(file);
        write(&path, &fill(text)).map_err(|error| unwritable(format, &path, &error))?;
        written.push(path);
    }
    written.extend(member(&project).map_err(|error| unwritable(format, &project, &error))?);
    let shown = |path: &PathBuf| path.strip_prefix(&here).unwrap_or(path).to_path_buf();
    super::tell(&written.iter().map(shown).collect::<Vec<_>>(), format, console)?;
    if format == Format::Text {
        writeln!(
            console.err,
            "next: `monas module build {package}`, then `monas module load` what that prints"
        )?;
    }
    Ok(Exit::Success)
}

/// Has the workspace take the folder of modules in, if it does not yet: its manifest, if that has changed.
fn member(project: &Path) -> std::io::Result<Option<PathBuf>> {
    let path = project.join("Cargo.toml");
    let there = fs::read_to_string(&path)?;
    let text = with_members(&there, MEMBERS);
    match text == there {
        true => Ok(None),
        false => fs::write(&path, text).map(|()| Some(path)),
    }
}

fn unwritable(format: Format, path: &Path, error: &std::io::Error) -> Failure {
    Failure::Failed(format, format!("cannot write {}: {error}", path.display()))
}
