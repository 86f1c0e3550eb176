//! `monas tape draw`: the field of a recorded match from above, as SVG.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueHint};
use monas::duration;
use monas_match::RecordedField;
use monas_tape::Recording;
use monas_terminal::{CommandFailure, CommandOutput, Exit, FormatArgument, failed, write_drawing};

use crate::input::{ConfigurationKind, LayerArguments, kind_of, layers, recorded_configuration};

/// The most pictures of an animation.
const MAX_PICTURES: u128 = 10_000;

/// Arguments of `monas tape draw`.
#[derive(Args, Debug)]
pub(crate) struct DrawArguments {
    /// The tape of a match.
    #[arg(value_hint = ValueHint::FilePath)]
    file: PathBuf,
    /// Draw the field at this time of the run, for example 98s.
    #[arg(long, value_name = "TIME", value_parser = duration::parse, conflicts_with = "from")]
    #[arg(required_unless_present = "from")]
    at: Option<Duration>,
    /// Draw an animation that begins at this time.
    #[arg(long, value_name = "TIME", value_parser = duration::parse, requires = "to")]
    from: Option<Duration>,
    /// Draw an animation that ends at this time.
    #[arg(long, value_name = "TIME", value_parser = duration::parse, requires = "from")]
    to: Option<Duration>,
    /// The time between two pictures of an animation.
    #[arg(long, value_name = "TIME", value_parser = duration::parse, default_value = "200ms")]
    every: Duration,
    /// The output file; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,
    #[command(flatten)]
    format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &DrawArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let times = times(arguments)?;
    let recording = Recording::open(&arguments.file).map_err(failed(format))?;
    let folder = tempfile::tempdir().map_err(failed(format))?;
    let (path, settings) = recorded_configuration(&recording, folder.path(), format)?;
    let invalid = |diagnostics| CommandFailure::Invalid(format, diagnostics);
    if kind_of(&path).map_err(|unread| invalid(vec![*unread]))? != ConfigurationKind::Match {
        let tape = arguments.file.display();
        let message = format!(
            "{tape} records agents outside of a match, so that nothing on it says where robots and ball are on \
             the field; see what the agents did with `monas studio {tape}`, and the messages with `monas tape export`"
        );
        return Err(CommandFailure::Failed(format, message));
    }
    let layers = layers::of(&path, &LayerArguments { settings, robot: None }).map_err(invalid)?;
    let field = RecordedField::load(&path, &layers).map_err(invalid)?;
    let picture = field.draw(&recording, &times).map_err(failed(format))?;
    write_drawing(arguments.output.as_deref(), &picture, format, console)
}

/// The times of the pictures.
fn times(arguments: &DrawArguments) -> Result<Vec<Duration>, CommandFailure> {
    let DrawArguments { at, from, to, every, .. } = *arguments;
    let (Some(from), Some(to)) = (from, to) else { return Ok(at.into_iter().collect()) };
    let usage = |message: &str| Err(CommandFailure::Usage(message.into()));
    if from >= to {
        return usage("--from has to be earlier than --to");
    }
    if every.is_zero() || (to - from).as_nanos() / every.as_nanos() > MAX_PICTURES {
        return usage("the animation has too many pictures: enlarge --every, or shorten the time");
    }
    let times = std::iter::successors(Some(from), |time| Some(*time + every));
    Ok(times.take_while(|time| *time <= to).collect())
}
