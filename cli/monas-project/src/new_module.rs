//! Creates an activity as a module: a crate of a project that can be loaded at run time.

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::error::{Error, ErrorKind};
use crate::manifest::with_members;
use crate::new_activity::{TEMPLATE, project_for, snake_case};
use crate::new_project::{RESERVED_NAMES, write};

const MANIFEST: &str = include_str!("template/module/Cargo.toml.txt");

/// The folder of modules among the members of a workspace.
const MODULE_MEMBERS: &str = "\"modules/*\"";

/// A module that was created.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NewModule {
    /// The files that were written or changed.
    pub files: Vec<PathBuf>,
    /// The name of its package.
    pub package: String,
}

/// Creates an activity as a module in the project around the folder `here`.
///
/// # Errors
/// The name is not a name of a type or its package name is taken, no project is around the folder,
/// the module exists, or a file cannot be written.
pub fn create_module(name: &str, here: &Path) -> Result<NewModule, Error> {
    let project = project_for(name, here)?;
    let package = snake_case(name);
    if RESERVED_NAMES.contains(&package.as_str())
        || aseme_codegen::generate::identifier(&[&package]) != package
    {
        let message = format!("`{package}` is reserved by Rust or the project: choose another name");
        return Err(Error::new(ErrorKind::Argument, message));
    }
    let folder = project.join("modules").join(&package);
    let created = fs::create_dir_all(project.join("modules")).and_then(|()| fs::create_dir(&folder));
    created.map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => {
            Error::new(ErrorKind::File, format!("{} exists already", folder.display()))
        }
        _ => Error::file("create", &folder, &error),
    })?;
    let fill = |text: &str| text.replace("{{name}}", &package).replace("{{type}}", name);
    let activity = "monas::activity!({{type}});\n";
    let library = TEMPLATE.replace(activity, &format!("{activity}monas::module!();\n"));
    let mut files = Vec::new();
    for (file, text) in [("Cargo.toml", MANIFEST), ("lib.rs", &library)] {
        let path = folder.join(file);
        write(&path, &fill(text)).map_err(|error| Error::file("write", &path, &error))?;
        files.push(path);
    }
    files.extend(member(&project).map_err(|error| Error::file("write", &project, &error))?);
    Ok(NewModule { files, package })
}

/// Adds the folder of modules to the workspace's members. Returns the manifest if it has changed.
fn member(project: &Path) -> io::Result<Option<PathBuf>> {
    let path = project.join("Cargo.toml");
    let there = fs::read_to_string(&path)?;
    let text = with_members(&there, MODULE_MEMBERS);
    match text == there {
        true => Ok(None),
        false => monas_files::write(&path, text).map(|()| Some(path)),
    }
}
