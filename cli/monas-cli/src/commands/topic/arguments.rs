//! Arguments of `monas topic`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use clap_complete::engine::ArgValueCandidates;

use crate::remote::{RunSelector, WatchLimits, topics};

#[derive(Args, Debug)]
pub(crate) struct TopicArguments {
    /// Connect by the links of this configuration to other processes and computers, instead of to a
    /// run on this computer.
    #[arg(long, value_name = "CONFIG", global = true)]
    pub(crate) link: Option<PathBuf>,
    #[command(subcommand)]
    pub(crate) command: TopicCommand,
}

#[derive(Subcommand, Debug)]
pub(crate) enum TopicCommand {
    /// List the topics of a run with their type and last message.
    #[command(after_help = "Example: monas topic list 'soccer/*' --host blue-2")]
    List {
        /// The topics: `soccer/ball`, `soccer/*` for those directly under it, `soccer/**` for all
        /// under it. All topics if not given.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: Option<String>,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Show all details of a topic, with the fields of its messages.
    #[command(after_help = "Example: monas topic info soccer/ball")]
    Info {
        /// The topic.
        #[arg(add = ArgValueCandidates::new(topics))]
        topic: String,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Print messages as they are published.
    #[command(after_help = "Example: monas topic echo soccer/ball --host blue-2 --count 3 --format json")]
    Echo {
        /// The topics, as in `list`.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: String,
        #[command(flatten)]
        limits: WatchLimits,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Measure the rate of messages by the run's time. Prints a first result soon, and then one
    /// every second.
    #[command(after_help = "Example: monas topic hz 'body/*' --for 5s")]
    Hz {
        /// The topics, as in `list`.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: String,
        #[command(flatten)]
        limits: WatchLimits,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Measure the size of messages, and the bandwidth by the run's time.
    #[command(after_help = "Example: monas topic bw '**' --for 5s")]
    Bw {
        /// The topics, as in `list`.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: String,
        #[command(flatten)]
        limits: WatchLimits,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Measure the latency of messages: from the publishing host to the hub, and from there to the
    /// control socket, which polls every 2 ms.
    #[command(after_help = "Example: monas topic delay soccer/ball --for 5s")]
    Delay {
        /// The topics, as in `list`.
        #[arg(add = ArgValueCandidates::new(topics))]
        pattern: String,
        #[command(flatten)]
        limits: WatchLimits,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Publish a message. It is recorded like any other.
    #[command(after_help = "Example: monas topic pub soccer/calibration '{\"number\": 1}' --host blue-2")]
    Pub {
        /// The topic.
        #[arg(add = ArgValueCandidates::new(topics))]
        topic: String,
        /// The message as JSON, with the field names of its .proto file; omitted fields have their
        /// defaults.
        message: String,
        #[command(flatten)]
        run: RunSelector,
    },
}

impl TopicCommand {
    /// The run selector of the subcommand.
    pub(crate) fn run_mut(&mut self) -> &mut RunSelector {
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
