//! `monas eval`: goalie and attacker built in three ways, compared.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueHint};
use monas::{Registry, duration};
use monas_eval::{Error, EvaluationSettings};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format};

/// Arguments of `monas eval`.
#[derive(Args, Debug)]
pub(crate) struct EvalArguments {
    /// The folder with the match files of the evaluation.
    #[arg(default_value = "config/evaluation", value_hint = ValueHint::DirPath)]
    folder: PathBuf,
    /// The number of matches of each way, with the seeds from 1.
    #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// The simulated time of each match, for example 600s or 2min.
    #[arg(long = "for", value_name = "DURATION", value_parser = duration::parse, default_value = "600s")]
    length: Duration,
}

pub(crate) fn execute(
    arguments: &EvalArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let EvalArguments { folder, seeds, length } = arguments;
    let settings = EvaluationSettings { folder: folder.clone(), seeds: *seeds, length: *length };
    let processor_time = || monas::cpu_time().unwrap_or_default();
    let mut remarks = console.remarks();
    let mut progress = |line: &str| drop(writeln!(remarks, "playing {line}"));
    let evaluation = monas_eval::evaluate(&settings, &Registry::linked(), &processor_time, &mut progress)
        .map_err(|error| match error {
            Error::Files(diagnostics) => CommandFailure::Invalid(Format::Text, diagnostics),
            _ => CommandFailure::failed(Format::Text, error),
        })?;
    drop(remarks);
    write!(console.out, "{evaluation}")?;
    Ok(Exit::Success)
}
