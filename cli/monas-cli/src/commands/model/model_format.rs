//! Formats of models: their names on the command line, and writing in one.

use std::sync::Arc;

use aseme_models::convert::{Format as ModelFormat, Model};
use monas_terminal::{CommandFailure, CommandOutput, Format, counted, report};
use yase::{Diagnostic, Severity, Source};

/// The format of a name.
pub(crate) fn named(word: &str) -> Result<ModelFormat, CommandFailure> {
    let found = ModelFormat::WORDS.iter().find(|(known, _)| *known == word).map(|(_, format)| *format);
    found.ok_or_else(|| {
        let words = ModelFormat::WORDS.map(|(word, _)| word).join(", ");
        CommandFailure::Usage(format!("there is no format `{word}`; formats are {words}"))
    })
}

/// The text of a model in a format; fails on losses unless `lossy`.
pub(crate) fn text_of(
    model: &Model,
    wanted: ModelFormat,
    source: &Arc<Source>,
    lost_before: usize,
    lossy: bool,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<String, CommandFailure> {
    let placed = |findings: Vec<Diagnostic>| -> Vec<Diagnostic> {
        findings.into_iter().map(|finding| finding.in_source(source)).collect()
    };
    let written = model
        .write(wanted, &source.text)
        .map_err(|refused| CommandFailure::Invalid(format, placed(refused)))?;
    let count = written.lost.len() + lost_before;
    let mut lost = placed(written.lost);
    if lossy {
        lost.iter_mut().for_each(|lost| lost.severity = Severity::Warning);
    }
    report::write(console, format, &lost)?;
    match count > 0 && !lossy {
        true => {
            let message = format!(
                "{} would be lost in {}; --lossy writes it without them",
                counted(count as u64, "element"),
                wanted.word()
            );
            Err(CommandFailure::Failed(format, message))
        }
        false => Ok(written.text),
    }
}
