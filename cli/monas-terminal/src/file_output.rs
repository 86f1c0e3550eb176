//! The flag `-o`: writes a text or a drawing to a file or to standard output.

use std::path::Path;

use crate::{CommandFailure, CommandOutput, Exit, Format};

/// The file that was given, or none for standard output: `-`, as for other commands.
pub fn output_file(output: Option<&Path>) -> Option<&Path> {
    output.filter(|path| *path != Path::new("-"))
}

/// Refuses to write over a file that is read.
pub fn check_distinct(input: &Path, output: &Path, what: &str) -> Result<(), CommandFailure> {
    let same = |path: &Path| path.canonicalize().ok();
    match same(output).is_some_and(|output| same(input) == Some(output)) {
        true => {
            let output = output.display();
            Err(CommandFailure::Usage(format!("{output} is the {what} itself: name another file")))
        }
        false => Ok(()),
    }
}

/// Writes a text to a file, or to standard output if no file or `-` is given.
pub fn write_text(
    output: Option<&Path>,
    text: &str,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match output_file(output) {
        Some(path) => monas_files::write(path, text).map_err(|error| {
            CommandFailure::Failed(format, format!("cannot write {}: {error}", path.display()))
        })?,
        None => console.out.write_all(text.as_bytes())?,
    }
    Ok(Exit::Success)
}

/// Writes a drawing as [`write_text`] does. A name that promises another format is refused.
pub fn write_drawing(
    output: Option<&Path>,
    svg: &str,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let is_other = |path: &&Path| path.extension().is_some_and(|ending| !ending.eq_ignore_ascii_case("svg"));
    if let Some(path) = output.filter(is_other) {
        let message = format!("`{}`: drawings are SVG, the file must end in .svg", path.display());
        return Err(CommandFailure::Usage(message));
    }
    write_text(output, svg, format, console)
}
