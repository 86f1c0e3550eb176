//! `monas agent save`.

use std::fs;
use std::path::Path;

use monas::records::Inquiry;
use serde_json::json;

use super::{ask, odd};
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::topic::arguments::RunChoice;

pub(super) fn execute(
    file: Option<&Path>,
    run: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let format = run.format.value;
    let reply = ask(Inquiry { configuration: true, ..Inquiry::default() }, run)?;
    let configuration = reply.configuration.ok_or_else(|| odd(run))?;
    let Some(file) = file else {
        write!(console.out, "{}", configuration.text)?;
        return Ok(Exit::Success);
    };
    if file.extension().is_some_and(|ending| ending == "toml") {
        return Err(Failure::Usage("the set-up is written as XML: name a file that ends with .xml".into()));
    }
    // A new file takes the place of the old one, so that nobody ever reads half of it.
    let mut name = file.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    let new = file.with_file_name(name);
    let written = fs::write(&new, &configuration.text).and_then(|()| fs::rename(&new, file));
    written.map_err(|error| Failure::failed(format, format!("{}: {error}", file.display())))?;
    match format {
        Format::Json => writeln!(console.out, "{}", json!({"file": file, "from": configuration.file}))?,
        Format::Text => writeln!(console.out, "saved to {}", file.display())?,
    }
    Ok(Exit::Success)
}
