//! `monas run`: runs a match in simulated time, or a set of agents in real time; agents with a body
//! that has its own time in the time of that body.

mod bodies;
mod control;
#[cfg(feature = "soccer")]
mod coverage;
#[cfg(feature = "soccer")]
mod field_view;
#[cfg(feature = "soccer")]
pub(crate) mod league;
mod links;
mod lockstep;
mod outputs;
mod pacer;
#[cfg(feature = "soccer")]
mod play;
#[cfg(all(unix, feature = "soccer"))]
mod processes;
mod real_time;
#[cfg(feature = "soccer")]
mod scoreboard;
#[cfg(feature = "soccer")]
mod summary;

#[cfg(unix)]
pub(super) use outputs::RECORDING;

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueHint};
use monas::duration;
use monas_project::differences;
use monas_terminal::{CommandFailure, CommandOutput, Exit, FormatArgument, parse_size, report};
use yase::Diagnostic;

use crate::input::{ConfigurationKind, DEFAULT_CONFIGURATION, LayerArguments, file_parser, kind_of, layers};

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
    /// Record every message into this MCAP file, or into a new one in this folder, named after the
    /// run. If the file exists, the next free name is taken: `match-2.mcap`.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::AnyPath, value_parser = file_parser())]
    pub(crate) record: Option<PathBuf>,
    /// The most recordings in a folder; the oldest are removed.
    #[arg(long, value_name = "COUNT", default_value_t = 20)]
    pub(crate) keep: usize,
    /// The most that all recordings in a folder take, for example 500MB; the oldest are removed.
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "4GB")]
    pub(crate) keep_size: u64,
    /// Write a log as configured by this file, in XML or TOML, see `config/logger.xml`. If the
    /// log's file exists, the next free name is taken.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) log: Option<PathBuf>,
    /// Replace the files of the recording and of the log if they exist and no run is writing them.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Run a match in real time: the field, each body and the agents of each robot on separate
    /// threads, as on robots. Agents without a match always run in real time. For simulated time
    /// that passes as fast as real time see --pace.
    #[arg(long, conflicts_with = "pace")]
    pub(crate) realtime: bool,
    /// Show the field of a match from above, as text: redrawn in place on a terminal, one picture a
    /// second elsewhere. With --pace 1 as fast as in reality.
    #[cfg(feature = "soccer")]
    #[arg(long)]
    pub(crate) field: bool,
    /// The name of the control socket, by which `monas topic` finds the run; that of the
    /// configuration if not given.
    #[arg(long, value_name = "NAME")]
    pub(crate) control: Option<String>,
    /// Do not serve a control socket.
    #[arg(long, conflicts_with = "control")]
    pub(crate) no_control: bool,
    /// View the run in the browser: serve the studio, and print its address. Simulated time then
    /// runs as fast as real time; the page and --pace change that, and results do not depend on it.
    #[cfg(unix)]
    #[arg(long, conflicts_with = "no_control")]
    pub(crate) studio: bool,
    #[cfg(unix)]
    #[command(flatten)]
    pub(crate) listen: crate::commands::studio::ListenArgument,
    /// The most simulated seconds per second of real time: 0.5 for slow motion, 10 for ten times
    /// real time. 1 with --studio, unlimited otherwise. Results do not depend on it.
    #[arg(long, value_name = "FACTOR", value_parser = pace)]
    pub(crate) pace: Option<f64>,
    /// Run the agents of this robot of a match only, in real time, for example `blue-1`. The match
    /// runs in another process, and serves the body of this robot, which has `process="1"`.
    #[cfg(all(unix, feature = "soccer"))]
    #[arg(long, value_name = "ROBOT", requires = "body", conflicts_with_all = ["pace", "seed", "studio"])]
    pub(crate) only: Option<String>,
    /// The address at which the body of the robot of --only is served.
    #[cfg(all(unix, feature = "soccer"))]
    #[arg(long, value_name = "ADDRESS", requires = "only", value_hint = ValueHint::FilePath)]
    pub(crate) body: Option<String>,
    #[cfg(feature = "soccer")]
    #[command(flatten)]
    pub(crate) league: league::LeagueArguments,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// Parses a pace.
fn pace(text: &str) -> Result<f64, String> {
    let factor: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    match factor > 0.0 {
        true => Ok(factor),
        false => Err("the pace is more than 0".into()),
    }
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
    #[cfg(unix)]
    if arguments.listen.is_given() && !arguments.studio {
        return Err(CommandFailure::Usage(
            "--listen, --allow-origin, --allow-control and --edit are for the studio: add --studio".into(),
        ));
    }
    #[cfg(feature = "soccer")]
    if kind == ConfigurationKind::Agents && arguments.league.is_given() {
        let message = "--gamecontroller and --referee are for matches; these agents have no field";
        return Err(CommandFailure::Usage(message.into()));
    }
    #[cfg(all(unix, feature = "soccer"))]
    if kind == ConfigurationKind::Agents && arguments.only.is_some() {
        let message = "--only is for matches; this configuration has the agents of one robot";
        return Err(CommandFailure::Usage(message.into()));
    }
    let unlinked = differences(&arguments.config);
    if unlinked.iter().any(Diagnostic::is_error) {
        return Err(invalid(unlinked));
    }
    report::write(console, arguments.format.value, &unlinked)?;
    let layers = layers::of(&arguments.config, &arguments.layers).map_err(invalid)?;
    match kind {
        #[cfg(feature = "soccer")]
        ConfigurationKind::Match => play::execute(arguments, &layers, console),
        ConfigurationKind::Agents => real_time::execute(arguments, &layers, console),
    }
}
