//! `monas module show`: how a module was built.

use std::path::Path;

use monas::ModuleFile;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, report};
use serde_json::{Map, Value};

pub(crate) fn execute(
    path: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let file = ModuleFile::read(path).map_err(|diagnostics| CommandFailure::Invalid(format, diagnostics))?;
    let fits = file.check();
    match format {
        Format::Text => {
            write!(console.out, "{}", file.note())?;
            if fits.is_ok() {
                writeln!(console.out, "it is compatible with this program")?;
            }
        }
        Format::Json => {
            let mut fields: Map<String, Value> =
                file.note().fields().map(|(key, value)| (key.to_owned(), value.into())).collect();
            fields.insert("digest".into(), file.digest().into());
            fields.insert("fits".into(), fits.is_ok().into());
            writeln!(console.out, "{}", Value::Object(fields))?;
        }
    }
    match fits {
        Ok(()) => Ok(Exit::Success),
        Err(diagnostics) => {
            report::write(console, format, &diagnostics)?;
            Ok(Exit::Invalid)
        }
    }
}
