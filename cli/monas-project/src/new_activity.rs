//! Creates an activity in a project: one file, which the project's build finds.

use std::path::{Path, PathBuf};
use std::{fs, io};

use monas::Registry;
use monas_files::write_new;
use yase::Diagnostic;

use crate::error::{Error, ErrorKind};
use crate::project_root::project_root;

pub(crate) const TEMPLATE: &str = include_str!("template/activity.rs.txt");

/// An activity that was created.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NewActivity {
    /// The files that were written.
    pub files: Vec<PathBuf>,
    /// The name by which configurations and models refer to it: with its crate, where another
    /// activity of the program has the same name.
    pub name: String,
}

/// Creates an activity in the project around the folder `here`.
///
/// # Errors
/// The name is not a name of a type, no project is around the folder, the file exists, or it cannot
/// be written.
pub fn create_activity(name: &str, here: &Path) -> Result<NewActivity, Error> {
    let project = project_for(name, here)?;
    let path = project.join("activities").join(format!("{}.rs", snake_case(name)));
    let text = TEMPLATE.replace("{{type}}", name);
    let written = fs::create_dir_all(project.join("activities")).and_then(|()| write_new(&path, text));
    written.map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => {
            Error::new(ErrorKind::File, format!("{} exists already", path.display()))
        }
        _ => Error::file("write", &path, &error),
    })?;
    Ok(NewActivity { files: vec![path], name: qualified(name) })
}

/// The project in which an activity of that name is to be created.
pub(crate) fn project_for(name: &str, here: &Path) -> Result<PathBuf, Error> {
    if !is_type(name) {
        let message = format!(
            "`{name}` cannot be the name of an activity: use an upper-case letter, then letters and digits, for example `TrackBall`"
        );
        return Err(Error::new(ErrorKind::Argument, message));
    }
    if IMPORTED.contains(&name) || NO_MODULES.contains(&name) {
        let message = format!("`{name}` is reserved by Rust or Monas: use for example `My{name}`");
        return Err(Error::new(ErrorKind::Argument, message));
    }
    project_root(here).ok_or_else(|| {
        let diagnostic = Diagnostic::error("E0927", 0..0, "this folder is not in a Monas project")
            .with_hint("`monas new my-team` creates one");
        Error::invalid(vec![diagnostic])
    })
}

/// The name of the activity, with its crate if another crate of the program has an activity of that
/// name.
fn qualified(name: &str) -> String {
    match Registry::linked().activity(name) {
        Ok(_) => format!("activities::{name}"),
        Err(_) => name.to_owned(),
    }
}

/// Names that the file of an activity imports from Monas or Rust.
const IMPORTED: [&str; 7] = ["Activity", "Blackboard", "BoxError", "Ok", "Parameters", "Progress", "Result"];

/// Names whose files are no modules of the project's crate: those of Cargo, and those of paths.
const NO_MODULES: [&str; 7] = ["Build", "Crate", "Extern", "Lib", "Main", "Self", "Super"];

fn is_type(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_alphanumeric())
}

pub(crate) fn snake_case(name: &str) -> String {
    let mut text = String::new();
    let letters: Vec<char> = name.chars().collect();
    for (index, letter) in letters.iter().enumerate() {
        let begins = letter.is_ascii_uppercase()
            && index > 0
            && (!letters[index - 1].is_ascii_uppercase()
                || letters.get(index + 1).is_some_and(char::is_ascii_lowercase));
        if begins {
            text.push('_');
        }
        text.push(letter.to_ascii_lowercase());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_called_as_modules_are() {
        for (name, expected) in [
            ("Vision", "vision"),
            ("TrackBall", "track_ball"),
            ("LEDHandler", "led_handler"),
            ("Pass2Ball", "pass2_ball"),
        ] {
            assert_eq!(snake_case(name), expected);
        }
        assert!(is_type("Vision") && !is_type("vision") && !is_type("Track Ball") && !is_type(""));
    }

    #[test]
    fn names_that_the_file_cannot_have_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let project = folder.path().join("my-team");
        crate::create_project(&project, None).expect("a project");
        for name in ["Activity", "Blackboard", "Result", "Crate", "Main", "Self"] {
            let refused = create_activity(name, &project).expect_err("it is reserved").to_string();
            assert!(refused.contains("is reserved by Rust or Monas"), "{refused}");
        }
        assert!(!project.join("activities/main.rs").exists());
        create_activity("Match", &project).expect("modules can have raw identifiers");
    }
}
