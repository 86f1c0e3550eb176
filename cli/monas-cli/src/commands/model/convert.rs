//! `monas model convert`: a model in another format of its kind.

use std::path::{Path, PathBuf};

use aseme_models::convert::{Format as ModelFormat, Model};
use clap::{Args, ValueHint};
use monas_terminal::{CommandFailure, CommandOutput, Exit, FormatArgument, check_distinct, write_text};

use super::model_format::{named, text_of};
use crate::input::valid_model;

/// Arguments of `monas model convert`.
#[derive(Args, Debug)]
pub(crate) struct ConvertArguments {
    /// The model file.
    #[arg(value_name = "IN", value_hint = ValueHint::FilePath)]
    pub(crate) input: PathBuf,
    /// The output file; `-` is standard output.
    #[arg(value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub(crate) output: PathBuf,
    /// The format: text, role, xmi, xmi-2010, xmi-flat, xmi-2012, xmi-2018, scxml or rust. If not
    /// given, it follows from the extension of OUT: .model, .stct, .xmi, .scxml, .rs, .txt; with
    /// .iac, .eac, .sag, .suc, .aip, .srm or .ft it is XMI for textual input, and text for XMI. Any
    /// other extension requires this option.
    #[arg(long = "as", value_name = "FORMAT")]
    pub(crate) written: Option<String>,
    /// Write the file even if the format cannot represent all of the model.
    #[arg(long)]
    pub(crate) lossy: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &ConvertArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    check_distinct(&arguments.input, &arguments.output, "model")?;
    let (source, model, read_as, findings) = valid_model(&arguments.input, format, console)?;
    let wanted = match &arguments.written {
        Some(word) => named(word)?,
        None => by_ending(&arguments.output, &model, read_as)?,
    };
    // Losses in reading were reported with the other findings.
    let lost = findings.iter().filter(|finding| finding.code == "E0850").count();
    let text = text_of(&model, wanted, &source, lost, arguments.lossy, format, console)?;
    write_text(Some(&arguments.output), &text, format, console)
}

fn by_ending(output: &Path, model: &Model, read_as: ModelFormat) -> Result<ModelFormat, CommandFailure> {
    let ending = output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if let Some(format) = ModelFormat::of_ending(ending) {
        return Ok(format);
    }
    match (ending, read_as, model) {
        ("iac" | "eac", ModelFormat::Text | ModelFormat::Scxml, Model::Chart(_))
        | ("iac" | "eac", _, Model::Role(_)) => Ok(ModelFormat::Statechart(aseme_models::iac::Dialect::Flat)),
        ("iac" | "eac" | "sag" | "suc" | "aip" | "srm" | "ft", ModelFormat::Text | ModelFormat::Role, _) => {
            Ok(ModelFormat::Xmi)
        }
        ("iac" | "eac" | "sag" | "suc" | "aip" | "srm", _, _) => Ok(ModelFormat::Text),
        _ => Err(CommandFailure::Usage(format!(
            "the extension of `{}` does not determine the format; give it with --as, as one of {}",
            output.display(),
            ModelFormat::WORDS.map(|(word, _)| word).join(", ")
        ))),
    }
}
