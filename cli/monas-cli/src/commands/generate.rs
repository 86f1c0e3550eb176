//! `monas generate`: the statechart of a model as a Rust crate of the workspace, linked into its
//! program.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use monas_project::{Project, generate_crate};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument};
use serde_json::json;

use super::new::project_failure;
use crate::input::valid_chart;

/// Arguments of `monas generate`.
#[derive(Args, Debug)]
pub(crate) struct GenerateArguments {
    /// The model file.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) model: PathBuf,
    /// The folder of the crate, in `statecharts`; named after the model if not given.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) to: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &GenerateArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let GenerateArguments { model, to, .. } = arguments;
    let chart = valid_chart(model, format, console)?;
    let project = Project::around(model).map_err(project_failure(format))?;
    let made = generate_crate(model, &chart, to.as_deref(), &project).map_err(project_failure(format))?;
    if !made.is_formatted {
        writeln!(console.remarks(), "rustfmt is not installed: the sources are not formatted")?;
    }
    for path in &made.changed {
        let path = project.relative(path);
        match format {
            Format::Text => writeln!(console.out, "{path}")?,
            Format::Json => writeln!(console.out, "{}", json!({ "written": path }))?,
        }
    }
    if made.changed.is_empty() && format == Format::Text {
        writeln!(console.out, "nothing has changed")?;
    }
    Ok(Exit::Success)
}
