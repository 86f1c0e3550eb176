//! An activity in a project: one file, which is found when the project is built.

use std::env;
use std::path::PathBuf;

use monas::Registry;
use yase::Diagnostic;

use super::project::write;
use crate::arguments::{Format, NewArguments};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(super) const TEMPLATE: &str = include_str!("template/activity.rs.txt");

pub(super) fn create(
    name: &str,
    arguments: &NewArguments,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let (here, project) = place_of(name, format)?;
    let path = project.join("activities").join(format!("{}.rs", snake_case(name)));
    if path.exists() {
        return Err(Failure::Failed(format, format!("{} is there already", path.display())));
    }
    write(&path, &TEMPLATE.replace("{{type}}", name))
        .map_err(|error| Failure::Failed(format, format!("cannot write {}: {error}", path.display())))?;
    let shown: PathBuf = path.strip_prefix(&here).unwrap_or(&path).to_path_buf();
    super::tell(&[shown], format, console)?;
    if format == Format::Text {
        writeln!(console.err, "configurations and models name it `{}`", spelled(name))?;
    }
    Ok(Exit::Success)
}

/// Where the activity of that name is to be made: the folder in which this command is, and the project around it.
pub(super) fn place_of(name: &str, format: Format) -> Result<(PathBuf, PathBuf), Failure> {
    if !is_type(name) {
        let message = format!(
            "`{name}` cannot be the name of an activity: a large letter, then letters and digits, for example `TrackBall`"
        );
        return Err(Failure::Usage(message));
    }
    let here = env::current_dir().map_err(|error| Failure::failed(format, error))?;
    let Some(project) = super::project_around(&here) else {
        let diagnostic = Diagnostic::error("E0927", 0..0, "this folder is in no project of Monas")
            .with_hint("`monas new my-team` makes one");
        return Err(Failure::Invalid(format, vec![diagnostic]));
    };
    Ok((here, project))
}

/// How it is named: with its crate, where a crate of the program has an activity of that name already.
fn spelled(name: &str) -> String {
    match Registry::linked().activity(name) {
        Ok(_) => format!("activities::{name}"),
        Err(_) => name.to_owned(),
    }
}

fn is_type(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_alphanumeric())
        && name != "Self"
}

pub(super) fn snake_case(name: &str) -> String {
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
        assert!(
            is_type("Vision")
                && !is_type("vision")
                && !is_type("Track Ball")
                && !is_type("")
                && !is_type("Self")
        );
    }
}
