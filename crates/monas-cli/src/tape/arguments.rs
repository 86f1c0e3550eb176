//! What may be written after `monas tape`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand, ValueEnum, ValueHint};

use crate::arguments::FormatArgument;
use crate::duration;

#[derive(Subcommand, Debug)]
pub(crate) enum TapeCommand {
    /// Say what a tape holds: where it comes from, its files, its channels.
    #[command(after_help = "Example: monas tape info match.mcap")]
    Info {
        /// The tape.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Write messages as text: a table (csv) or one JSON object a line (jsonl).
    #[command(
        after_help = "Example: monas tape export match.mcap --topic soccer/ball --format csv -o ball.csv"
    )]
    Export(ExportArguments),
    /// Mend a tape that was cut off or damaged: everything that can be read becomes a whole tape.
    #[command(after_help = "Example: monas tape recover match.mcap -o mended.mcap")]
    Recover {
        /// The tape.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Where to write the mended tape; over the old one if not given.
        #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
        output: Option<PathBuf>,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Write a part of a tape to a tape of its own: a time, some topics, some hosts.
    #[command(after_help = "Example: monas tape cut match.mcap --from 10s --to 20s -o part.mcap")]
    Cut(CutArguments),
    /// Run agents again on what was recorded, and compare what they publish with what they published then.
    #[command(after_help = "Example: monas tape replay match.mcap --agents goalie --verify")]
    Replay(ReplayArguments),
    /// Run all agents again on what was recorded, and end with 5 if anything that they publish differs: `replay --verify` of all.
    #[command(after_help = "Example: monas tape verify match.mcap")]
    Verify {
        /// The tape, with all topics of a run from its beginning, in simulated or in real time.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Write several tapes into one, ordered by time.
    #[command(after_help = "Example: monas tape merge one.mcap two.mcap -o both.mcap")]
    Merge {
        /// The tapes.
        #[arg(required = true, num_args = 2.., value_name = "FILE", value_hint = ValueHint::FilePath)]
        files: Vec<PathBuf>,
        /// Where to write the tape.
        #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
        output: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
}

/// Which messages are meant; all if nothing is said.
#[derive(Args, Debug, Default)]
pub(crate) struct Selection {
    /// Only these topics: a path, `soccer/*` for those directly under it, `soccer/**` for all under it. May be given several times.
    #[arg(long = "topic", value_name = "PATTERN")]
    pub(crate) topics: Vec<String>,
    /// Only what was published on this host. May be given several times.
    #[arg(long = "host", value_name = "NAME")]
    pub(crate) hosts: Vec<String>,
    /// Only what came from this moment of the run on, for example 10s.
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub(crate) from: Option<Duration>,
    /// Only what came before this moment of the run.
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    pub(crate) to: Option<Duration>,
}

#[derive(Args, Debug)]
pub(crate) struct ExportArguments {
    /// The tape.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// A table with a column for each field, or one JSON object a line.
    #[arg(long, value_name = "FORMAT", default_value = "jsonl")]
    pub(crate) format: ExportFormat,
    /// Where to write; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) selection: Selection,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum ExportFormat {
    /// A table.
    Csv,
    /// One JSON object a line.
    Jsonl,
}

#[derive(Args, Debug)]
pub(crate) struct CutArguments {
    /// The tape.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// Where to write the part.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) selection: Selection,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

#[derive(Args, Debug)]
pub(crate) struct ReplayArguments {
    /// The tape, with all topics of a run from its beginning, in simulated or in real time.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) file: PathBuf,
    /// The agents to run: a name, on all hosts that have it (`goalie`), on one (`blue-1/goalie`), or all of a host (`blue-1`). All agents
    /// if not given; several with commas between them.
    #[arg(long, value_name = "AGENTS", value_delimiter = ',')]
    pub(crate) agents: Vec<String>,
    /// End with 5 if anything differs.
    #[arg(long)]
    pub(crate) verify: bool,
    /// Take the agents from this configuration instead of the one in the tape.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) config: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}
