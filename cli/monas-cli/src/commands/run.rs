//! `monas run`: runs a match in simulated time, or a set of agents in real time.

mod control;
#[cfg(feature = "soccer")]
mod coverage;
mod links;
#[cfg(feature = "soccer")]
mod play;
mod real_time;
#[cfg(feature = "soccer")]
mod scoreboard;
#[cfg(feature = "soccer")]
mod summary;

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, ValueHint};
use monas::logger::{LogSettings, Severity};
use monas_project::differences;
use yase::Diagnostic;

use crate::input::{ConfigurationKind, DEFAULT_CONFIGURATION, LayerArguments, kind_of, layers};
use crate::terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, duration, report};

/// Arguments of `monas run`.
#[derive(Args, Debug)]
pub(crate) struct RunArguments {
    /// A match or a file of agents, in XML or TOML.
    #[arg(default_value = DEFAULT_CONFIGURATION, value_hint = ValueHint::FilePath)]
    pub(crate) config: PathBuf,
    #[command(flatten)]
    pub(crate) layers: LayerArguments,
    /// The seed of all randomness in a match; equal seeds give equal matches. 0 if not given.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Stop after this much time, for example 600s, 10min or 500ms.
    #[arg(long = "for", value_name = "DURATION", value_parser = duration::parse)]
    pub(crate) length: Option<Duration>,
    /// Record every message into this MCAP file.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) record: Option<PathBuf>,
    /// Write a log as configured by this file, in XML or TOML, see `config/logger.xml`.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) log: Option<PathBuf>,
    /// Run simulated time no faster than real time. Without a match, agents always run in real
    /// time.
    #[arg(long)]
    pub(crate) realtime: bool,
    /// The name of the control socket, by which `monas topic` finds the run; that of the
    /// configuration if not given.
    #[arg(long, value_name = "NAME")]
    pub(crate) control: Option<String>,
    /// Do not serve a control socket.
    #[arg(long, conflicts_with = "control")]
    pub(crate) no_control: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &RunArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let invalid = |diagnostics| CommandFailure::Invalid(arguments.format.value, diagnostics);
    let kind = kind_of(&arguments.config).map_err(|unread| invalid(vec![*unread]))?;
    if kind != ConfigurationKind::Agents && arguments.layers.robot.is_some() {
        let message =
            "--robot is for the agents of one robot; a match configures each robot in its `<robot>`";
        return Err(CommandFailure::Usage(message.into()));
    }
    let unlinked = differences(&arguments.config);
    if unlinked.iter().any(Diagnostic::is_error) {
        return Err(invalid(unlinked));
    }
    report::write(console, arguments.format.value, &unlinked)?;
    let layers = layers::of(&arguments.config, &arguments.layers).map_err(invalid)?;
    let asked = match &arguments.log {
        Some(file) => write_log(file, arguments.format.value, console)?,
        None => Severity::Info,
    };
    console.log.iter().for_each(|log| log.publish(asked.max(Severity::Info)));
    match kind {
        #[cfg(feature = "soccer")]
        ConfigurationKind::Match => play::execute(arguments, &layers, console),
        ConfigurationKind::Agents => real_time::execute(arguments, &layers, console),
    }
}

/// Starts the log that a file configures. Returns its verbosity.
fn write_log(file: &Path, format: Format, console: &CommandOutput<'_>) -> Result<Severity, CommandFailure> {
    let (mut settings, diagnostics) = LogSettings::load(file);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(CommandFailure::Invalid(format, diagnostics));
    }
    let Some(log) = &console.log else {
        return Err(CommandFailure::Usage(
            "--log needs the log of the process, which belongs to the calling program".into(),
        ));
    };
    settings.colour &= console.colour_err;
    let verbosity = settings.verbosity;
    log.write(settings).map(|()| verbosity).map_err(|error| {
        CommandFailure::failed(format, format_args!("the log of {}: {error}", file.display()))
    })
}
