//! `monas model ontology`: derives the messages of a chart.

use std::path::PathBuf;

use aseme_models::convert::Model;
use aseme_models::ontology;
use clap::{Args, ValueHint};
use monas_terminal::{
    CommandFailure, CommandOutput, Exit, FormatArgument, check_distinct, report, write_text,
};
use yase::Diagnostic;

use crate::input::valid_model;

/// Arguments of `monas model ontology`.
#[derive(Args, Debug)]
pub(crate) struct OntologyArguments {
    /// The model file.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// The package of the messages.
    #[arg(long, value_name = "NAME", default_value = "messages")]
    pub(crate) package: String,
    /// The output file; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &OntologyArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let OntologyArguments { file, package, output, format } = arguments;
    let format = format.value;
    if !is_package(package) {
        return Err(CommandFailure::Usage(format!(
            "`{package}` is not a package name such as team or team.soccer"
        )));
    }
    if let Some(output) = output {
        check_distinct(file, output, "model")?;
    }
    let (source, model, ..) = valid_model(file, format, console)?;
    let (chart, found) = aseme_models::statechart_of(&source);
    if found.iter().any(Diagnostic::is_error) {
        return Err(CommandFailure::Invalid(format, found));
    }
    let variables = match &model {
        Model::Chart(chart) => chart.variables.as_slice(),
        _ => &[],
    };
    let (ontology, found) = ontology::of(&chart, variables);
    let found: Vec<Diagnostic> = found.into_iter().map(|diagnostic| diagnostic.in_source(&source)).collect();
    report::write(console, format, &found)?;
    if ontology.messages.is_empty() {
        let text = format!("{} refers to no messages", file.display());
        return Err(CommandFailure::Failed(format, text));
    }
    write_text(output.as_deref(), &ontology.to_proto(package), format, console)
}

fn is_package(name: &str) -> bool {
    let is_word = |word: &str| {
        word.starts_with(|letter: char| letter.is_ascii_alphabetic() || letter == '_')
            && word.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
    };
    name.split('.').all(is_word)
}
