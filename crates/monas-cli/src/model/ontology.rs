//! `monas model ontology`: the messages that a chart is about.

use std::path::Path;

use aseme::convert::Model;
use aseme::ontology;
use yase::Diagnostic;

use super::{valid_model, write};
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(
    file: &Path,
    package: &str,
    output: Option<&Path>,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    if !is_package(package) {
        return Err(Failure::Usage(format!(
            "`{package}` is no name of a package: let it be like team or team.soccer"
        )));
    }
    let (source, model, ..) = valid_model(file, format, console)?;
    let (chart, found) = aseme::statechart_of(&source);
    if found.iter().any(Diagnostic::is_error) {
        return Err(Failure::Invalid(format, found));
    }
    let variables = match &model {
        Model::Chart(chart) => chart.variables.as_slice(),
        _ => &[],
    };
    let (ontology, found) = ontology::of(&chart, variables);
    let found: Vec<Diagnostic> = found.into_iter().map(|diagnostic| diagnostic.in_source(&source)).collect();
    report::write(console, format, &found)?;
    if ontology.messages.is_empty() {
        let text = format!("{} is about no messages", file.display());
        return Err(Failure::Failed(format, text));
    }
    write(output, &ontology.to_proto(package), format, console)
}

fn is_package(name: &str) -> bool {
    let is_word = |word: &str| {
        word.starts_with(|letter: char| letter.is_ascii_alphabetic() || letter == '_')
            && word.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
    };
    name.split('.').all(is_word)
}
