//! The flag `-o`: writes a text to a file or to standard output.

use std::path::Path;

use crate::{CommandFailure, CommandOutput, Exit, Format};

/// Writes a text to a file, or to standard output if no file is given.
pub fn write_text(
    output: Option<&Path>,
    text: &str,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match output {
        Some(path) => monas_files::write(path, text).map_err(|error| {
            CommandFailure::Failed(format, format!("cannot write {}: {error}", path.display()))
        })?,
        None => console.out.write_all(text.as_bytes())?,
    }
    Ok(Exit::Success)
}
