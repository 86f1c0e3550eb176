//! What may be written after `monas topic`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand};
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate};

use super::connect;
use crate::arguments::FormatArgument;
use crate::duration;

#[derive(Args, Debug)]
pub(crate) struct TopicArguments {
    /// Look at what the links of this configuration bring from other processes and computers, instead of a run on this one.
    #[arg(long, value_name = "CONFIG", global = true)]
    pub(crate) link: Option<PathBuf>,
    #[command(subcommand)]
    pub(crate) command: TopicCommand,
}

#[derive(Subcommand, Debug)]
pub(crate) enum TopicCommand {
    /// List the topics of a run: what each holds, and what was published on it last.
    #[command(after_help = "Example: monas topic list 'soccer/*' --host blue-2")]
    List {
        /// Which topics: `soccer/ball`, `soccer/*` for those directly under it, `soccer/**` for all. All, if it is not said.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: Option<String>,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Say everything that is known of a topic, with the fields of its messages.
    #[command(after_help = "Example: monas topic info soccer/ball")]
    Info {
        /// The topic.
        #[arg(add = ArgValueCandidates::new(topics))]
        topic: String,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Print messages as they are published.
    #[command(after_help = "Example: monas topic echo soccer/ball --host blue-2 --count 3 --format json")]
    Echo {
        /// Which topics, as in `list`.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: String,
        #[command(flatten)]
        limits: Limits,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Measure how often messages are published, by the run's own time. Says so soon, and then every second.
    #[command(after_help = "Example: monas topic hz 'body/*' --for 5s")]
    Hz {
        /// Which topics, as in `list`.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: String,
        #[command(flatten)]
        limits: Limits,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Measure how many bytes messages have, and how many that is in a second of the run's own time.
    #[command(after_help = "Example: monas topic bw '**' --for 5s")]
    Bw {
        /// Which topics, as in `list`.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: String,
        #[command(flatten)]
        limits: Limits,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Measure how long messages are on their way: to the hub, if another host published them, and from there to the control
    /// socket, which looks every 2 ms.
    #[command(after_help = "Example: monas topic delay soccer/ball --for 5s")]
    Delay {
        /// Which topics, as in `list`.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: String,
        #[command(flatten)]
        limits: Limits,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Publish a message. Whoever records the run records it.
    #[command(after_help = "Example: monas topic pub soccer/calibration '{\"number\": 1}' --host blue-2")]
    Pub {
        /// The topic.
        #[arg(add = ArgValueCandidates::new(topics))]
        topic: String,
        /// The message as JSON, with the field names of its .proto file; what is left out is as if it were not set.
        message: String,
        #[command(flatten)]
        run: RunChoice,
    },
}

/// Which run is meant, and how answers are written.
#[derive(Args, Debug)]
pub(crate) struct RunChoice {
    /// The run, by the name of its control socket; not needed if there is only one.
    #[arg(long, value_name = "NAME", add = ArgValueCandidates::new(runs))]
    pub(crate) run: Option<String>,
    /// The host (a robot of a match), if it is not all of them.
    #[arg(long, add = ArgValueCandidates::new(hosts))]
    pub(crate) host: Option<String>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
    /// The socket that stands for the other ends of links, if it is them that are looked at.
    #[arg(skip)]
    pub(crate) reached: Option<PathBuf>,
}

impl RunChoice {
    /// A run on this computer.
    pub(crate) fn of(run: Option<String>, host: Option<String>, format: FormatArgument) -> RunChoice {
        RunChoice { run, host, format, reached: None }
    }
}

impl TopicCommand {
    /// Which run is meant.
    pub(super) fn run_mut(&mut self) -> &mut RunChoice {
        match self {
            TopicCommand::List { run, .. }
            | TopicCommand::Info { run, .. }
            | TopicCommand::Echo { run, .. }
            | TopicCommand::Hz { run, .. }
            | TopicCommand::Bw { run, .. }
            | TopicCommand::Delay { run, .. }
            | TopicCommand::Pub { run, .. } => run,
        }
    }
}

/// When to stop looking.
#[derive(Args, Debug)]
pub(crate) struct Limits {
    /// Stop after so many messages.
    #[arg(long, value_name = "MESSAGES")]
    pub(crate) count: Option<u64>,
    /// Stop after this much time, for example 5s.
    #[arg(long = "for", value_name = "DURATION", value_parser = duration::parse)]
    pub(crate) length: Option<Duration>,
}

fn candidates(words: Vec<String>) -> Vec<CompletionCandidate> {
    words.into_iter().map(CompletionCandidate::new).collect()
}

/// The topics of all runs there are.
fn topics() -> Vec<CompletionCandidate> {
    candidates(connect::known_topics())
}

fn hosts() -> Vec<CompletionCandidate> {
    candidates(connect::known_hosts())
}

fn runs() -> Vec<CompletionCandidate> {
    candidates(connect::live_runs().into_iter().map(|(name, _)| name).collect())
}
