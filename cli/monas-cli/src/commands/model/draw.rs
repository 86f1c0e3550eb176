//! `monas model draw`: the statechart of a model as SVG.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use yase::statechart::Layout;

use crate::input::valid_chart;
use crate::terminal::{CommandFailure, CommandOutput, Exit, FormatArgument, write_text};

/// Arguments of `monas model draw`.
#[derive(Args, Debug)]
pub(crate) struct DrawArguments {
    /// The model file.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// The output file; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Ignore the layout that the model gives for its states and transitions.
    #[arg(long)]
    pub(crate) no_layout: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &DrawArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let mut chart = valid_chart(&arguments.file, format, console)?;
    if arguments.no_layout {
        chart.layout = Layout::default();
    }
    write_text(arguments.output.as_deref(), &yase_export::to_svg(&chart), format, console)
}
