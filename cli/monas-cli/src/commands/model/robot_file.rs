//! Arguments `NAME=FILE`: the model of a robot, and the robot's name; `ROBOT/AGENT=FILE` for one of
//! several agents.

use std::path::{Path, PathBuf};

use monas_terminal::CommandFailure;

/// The robots' names and files: the name is the part before `=`, or the stem of the file.
///
/// # Errors
/// Two robots have one name.
pub(crate) fn named(files: &[PathBuf]) -> Result<Vec<(String, PathBuf)>, CommandFailure> {
    let mut found: Vec<(String, PathBuf)> = Vec::new();
    for file in files {
        let (name, file) = name_of(file);
        if found.iter().any(|(other, _)| *other == name) {
            return Err(CommandFailure::Usage(format!("two robots are named `{name}`: write `NAME=FILE`")));
        }
        found.push((name, file));
    }
    Ok(found)
}

/// The robot's name, or `robot/agent`, and the path of its model.
pub(crate) fn name_of(file: &Path) -> (String, PathBuf) {
    let text = file.to_string_lossy();
    let is_name = |name: &str| {
        let mut parts = name.split('/');
        parts.clone().count() <= 2 && parts.all(|part| !part.is_empty() && !part.contains(['\\', '.']))
    };
    match text.split_once('=').filter(|(name, _)| is_name(name) && !file.exists()) {
        Some((name, path)) => (name.to_owned(), PathBuf::from(path)),
        None => (file.file_stem().unwrap_or_default().to_string_lossy().into_owned(), file.to_path_buf()),
    }
}
