//! `monas model draw`: the statechart of a model as SVG.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use monas::config;
use monas_terminal::{
    CommandFailure, CommandOutput, Exit, FormatArgument, check_distinct, report, write_drawing,
};
use yase::statechart::Layout;

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
    /// A diagram of the original editors (.kse, .iacd) for a model in XMI: nodes are placed as in
    /// the diagram.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "no_layout")]
    pub(crate) diagram: Option<PathBuf>,
    /// Leave out what is never taken (`[false]`), and boxes that only enclose another box.
    #[arg(long)]
    pub(crate) compact: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &DrawArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    if let Some(output) = &arguments.output {
        check_distinct(&arguments.file, output, "model")?;
    }
    let read = |path: &PathBuf| {
        config::read_file(path).map_err(|unread| CommandFailure::Invalid(format, vec![*unread]))
    };
    let diagram = arguments.diagram.as_ref().map(read).transpose()?;
    let (chart, findings) = aseme_models::drawable_chart_of(&read(&arguments.file)?, diagram.as_ref());
    let Some(mut chart) = chart else { return Err(CommandFailure::Invalid(format, findings)) };
    report::write(console, format, &findings)?;
    if arguments.no_layout {
        chart.layout = Layout::default();
    }
    if arguments.compact {
        chart = yase_export::compact(&chart);
    }
    write_drawing(arguments.output.as_deref(), &yase_export::to_svg(&chart), format, console)
}
