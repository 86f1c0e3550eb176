//! `monas model convert`: a model in another format of its kind.

use std::path::Path;

use aseme::convert::{Format as Written, Model};
use yase::Diagnostic;

use super::{valid_model, write};
use crate::arguments::{ConvertArguments, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(arguments: &ConvertArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let (source, model, read_as, findings) = valid_model(&arguments.input, format, console)?;
    let wanted = match &arguments.written {
        Some(word) => named(word)?,
        None => by_ending(&arguments.output, &model, read_as)?,
    };
    // What was lost in reading was shown with the other findings.
    let lost = findings.iter().filter(|finding| finding.code == "E0850").count();
    let text = text_of(&model, wanted, &source, lost, arguments.lossy, format, console)?;
    let output = Some(arguments.output.as_path()).filter(|path| *path != Path::new("-"));
    write(output, &text, format, console)
}

/// A format by its word.
pub(super) fn named(word: &str) -> Result<Written, Failure> {
    let found = Written::WORDS.iter().find(|(known, _)| *known == word).map(|(_, format)| *format);
    found.ok_or_else(|| {
        let words = Written::WORDS.map(|(word, _)| word).join(", ");
        Failure::Usage(format!("there is no format `{word}`; formats are {words}"))
    })
}

fn by_ending(output: &Path, model: &Model, read_as: Written) -> Result<Written, Failure> {
    let ending = output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if let Some(format) = Written::of_ending(ending) {
        return Ok(format);
    }
    match (ending, read_as, model) {
        ("iac" | "eac", Written::Text | Written::Scxml, Model::Chart(_)) => {
            Ok(Written::Statechart(aseme::iac::Dialect::Flat))
        }
        ("iac" | "eac" | "sag" | "suc" | "aip" | "srm" | "ft", Written::Text | Written::Role, _) => {
            Ok(Written::Xmi)
        }
        ("iac" | "eac" | "sag" | "suc" | "aip" | "srm", _, _) => Ok(Written::Text),
        _ => Err(Failure::Usage(format!(
            "`{}` does not say in which format; say it by --as",
            output.display()
        ))),
    }
}

/// The text of a model in a format, if it says all of the model or need not.
pub(super) fn text_of(
    model: &Model,
    wanted: Written,
    source: &std::sync::Arc<yase::Source>,
    lost_before: usize,
    lossy: bool,
    format: Format,
    console: &mut Console<'_>,
) -> Result<String, Failure> {
    let placed = |findings: Vec<Diagnostic>| -> Vec<Diagnostic> {
        findings.into_iter().map(|finding| finding.in_source(source)).collect()
    };
    let written =
        model.write(wanted, &source.text).map_err(|refused| Failure::Invalid(format, placed(refused)))?;
    let count = written.lost.len() + lost_before;
    report::write(console, format, &placed(written.lost))?;
    match count > 0 && !lossy {
        true => {
            let message =
                format!("{count} things would get lost in {}; --lossy writes it without them", wanted.word());
            Err(Failure::Failed(format, message))
        }
        false => Ok(written.text),
    }
}
