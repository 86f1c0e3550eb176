//! Arguments of `monas tape`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand, ValueEnum, ValueHint};
use monas::duration;
use monas_terminal::FormatArgument;

use crate::input::file_parser;

#[derive(Subcommand, Debug)]
pub(crate) enum TapeCommand {
    /// Show the content of a tape: its origin, files and channels.
    #[command(after_help = "Example: monas tape info match.mcap")]
    Info {
        /// The tape.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Export messages as a table (csv) or as one JSON object per line (jsonl).
    #[command(
        after_help = "Example: monas tape export match.mcap --topic soccer/ball --format csv -o ball.csv"
    )]
    Export(ExportArguments),
    /// Draw the field of a recorded match from above, as SVG: at one time, or as an animation.
    ///
    /// Circles in the colour of a team show where its robots believe the ball to be.
    #[cfg(feature = "soccer")]
    #[command(after_help = "Example: monas tape draw match.mcap --at 98s -o field.svg")]
    Draw(super::draw::DrawArguments),
    /// Play a recorded match again up to a moment, change its agents there, and compare the rest.
    ///
    /// The match is played in simulated time from the recorded configuration and seed, so that it
    /// is the recorded one up to the change. Prints the first message that differs afterwards, and
    /// the score and the events of both.
    #[cfg(all(feature = "soccer", unix))]
    #[command(
        after_help = "Example: monas tape what-if match.mcap --at 7.5s --guard 'CONDITION -> kickBall=[false]'"
    )]
    WhatIf(super::what_if::WhatIfArguments),
    /// Recover a truncated or damaged tape: writes all readable messages to a valid tape.
    #[command(after_help = "Example: monas tape recover match.mcap -o mended.mcap")]
    Recover {
        /// The tape.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// The recovered tape; replaces the old one if not given.
        #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, value_parser = file_parser())]
        output: Option<PathBuf>,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Copy a part of a tape to another tape: a time span, some topics, some hosts.
    #[command(after_help = "Example: monas tape cut match.mcap --from 10s --to 20s -o part.mcap")]
    Cut(CutArguments),
    /// Replay agents on recorded messages, and compare what they publish with the recording.
    #[command(after_help = "Example: monas tape replay match.mcap --agents goalie --verify")]
    Replay(ReplayArguments),
    /// Replay all agents, and exit with 5 if anything they publish differs: `replay --verify` with
    /// all agents.
    #[command(after_help = "Example: monas tape verify match.mcap")]
    Verify {
        /// The tape, with all topics of a run from its start, in simulated or real time.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Merge several tapes into one, ordered by time. Messages that several of them contain are
    /// written once.
    #[command(after_help = "Example: monas tape merge one.mcap two.mcap -o both.mcap")]
    Merge {
        /// The tapes.
        #[arg(required = true, num_args = 2.., value_name = "FILE", value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
        /// The output tape.
        #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, value_parser = file_parser())]
        output: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
}

/// A selection of messages; all if nothing is given.
#[derive(Args, Debug, Default)]
pub(crate) struct MessageSelection {
    /// Only these topics: a path, `soccer/*` for those directly under it, `soccer/**` for all under
    /// it. May be given several times.
    #[arg(long = "topic", value_name = "PATTERN")]
    pub(crate) topics: Vec<String>,
    /// Only messages published on this host. May be given several times.
    #[arg(long = "host", value_name = "NAME")]
    pub(crate) hosts: Vec<String>,
    /// Only messages from this time of the run on, for example 10s.
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub(crate) from: Option<Duration>,
    /// Only messages before this time of the run.
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub(crate) to: Option<Duration>,
}

#[derive(Args, Debug)]
pub(crate) struct ExportArguments {
    /// The tape.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// A table with a column for each field, or one JSON object per line.
    #[arg(long, value_name = "FORMAT", default_value = "jsonl")]
    pub(crate) format: ExportFormat,
    /// The output file; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) selection: MessageSelection,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum ExportFormat {
    /// A table.
    Csv,
    /// One JSON object per line.
    Jsonl,
}

#[derive(Args, Debug)]
pub(crate) struct CutArguments {
    /// The tape.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// The output tape.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, value_parser = file_parser())]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) selection: MessageSelection,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

#[derive(Args, Debug)]
pub(crate) struct ReplayArguments {
    /// The tape, with all topics of a run from its start, in simulated or real time.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// The agents to replay: by name on all hosts (`goalie`), on one host (`blue-1/goalie`), or all
    /// agents of a host (`blue-1`); separated by commas. All agents if not given.
    #[arg(long, value_name = "AGENTS", value_delimiter = ',')]
    pub(crate) agents: Vec<String>,
    /// Exit with 5 if anything differs.
    #[arg(long)]
    pub(crate) verify: bool,
    /// Use the agents of this configuration instead of the recorded one.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) config: Option<PathBuf>,
    /// Then view the tape in the browser, with a mark on the timeline at each difference: serve the
    /// studio until Ctrl-C, and print its address.
    #[cfg(unix)]
    #[arg(long)]
    pub(crate) studio: bool,
    #[cfg(unix)]
    #[command(flatten)]
    pub(crate) listen: crate::commands::studio::ListenArgument,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}
