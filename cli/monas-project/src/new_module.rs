//! Creates an activity as a module: a crate of a project that can be loaded at run time.

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::error::{Error, ErrorKind};
use crate::manifest::with_members;
use crate::new_activity::{TEMPLATE, project_for, snake_case};
use crate::new_project::{RESERVED_NAMES, write};
use crate::packages::{is_locked, package_folder};

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
    if let Some(other) = package_folder(&project, &package).filter(|other| *other != folder) {
        let message =
            format!("`{package}` is the name of the package in {}: choose another name", other.display());
        return Err(Error::new(ErrorKind::Argument, message));
    }
    if is_locked(&project.join("Cargo.lock"), &package) {
        let message = format!("`{package}` is a crate that the project depends on: choose another name");
        return Err(Error::new(ErrorKind::Argument, message));
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create_project;

    #[test]
    fn a_module_does_not_have_the_name_of_another_package() {
        let folder = tempfile::tempdir().expect("a folder");
        let project = folder.path().join("my-team");
        create_project(&project, None).expect("a project");
        create_module("Look", &project).expect("the name is free");
        fs::create_dir_all(project.join("statecharts/walk")).expect("folders");
        fs::write(project.join("statecharts/walk/Cargo.toml"), "[package]\nname = \"walk\"\n")
            .expect("a file");
        for (name, taken) in [("MyTeam", "my_team"), ("Walk", "walk"), ("Serde", "serde")] {
            let refused = create_module(name, &project).expect_err("it is taken");
            assert_eq!(refused.kind(), ErrorKind::Argument);
            assert!(refused.to_string().starts_with(&format!("`{taken}` is ")), "{refused}");
            assert!(!project.join("modules").join(taken).exists());
        }
        assert!(
            create_module("Look", &project).expect_err("it exists").to_string().ends_with("exists already")
        );
    }
}
