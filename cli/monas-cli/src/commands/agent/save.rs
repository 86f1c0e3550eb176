//! `monas agent save`: the current configuration of a host.

use std::path::Path;

use monas::records::Inquiry;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format};
use serde_json::json;

use crate::remote::{RunSelector, request, unexpected_reply};

pub(crate) fn execute(
    file: Option<&Path>,
    run: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = run.format.value;
    let reply = request(Inquiry { configuration: true, ..Inquiry::default() }, run)?;
    let configuration = reply.configuration.ok_or_else(|| unexpected_reply(run))?;
    let Some(file) = file else {
        write!(console.out, "{}", configuration.text)?;
        return Ok(Exit::Success);
    };
    if file.extension().is_some_and(|ending| ending == "toml") {
        return Err(CommandFailure::Usage(
            "the configuration is saved as XML: the file must end with .xml".into(),
        ));
    }
    let written = monas_files::write(file, &configuration.text);
    written.map_err(|error| CommandFailure::failed(format, format!("{}: {error}", file.display())))?;
    match format {
        Format::Json => writeln!(console.out, "{}", json!({"file": file, "from": configuration.file}))?,
        Format::Text => writeln!(console.out, "saved to {}", file.display())?,
    }
    Ok(Exit::Success)
}
