//! What may be written after `monas module`.

use std::path::PathBuf;

use clap::{Subcommand, ValueHint};
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate};

use super::list;
use crate::arguments::{Format, FormatArgument};
use crate::topic::arguments::RunChoice;

#[derive(Subcommand, Debug)]
pub(crate) enum ModuleCommand {
    /// List the modules that a run has loaded, with their activities and the agents that have one of these.
    #[command(after_help = "Example: monas module list")]
    List {
        #[command(flatten)]
        run: RunChoice,
    },
    /// Load a module into a run: agents can have its activities from then on.
    #[command(after_help = "Example: monas module load target/debug/libeyes.so --agent Head")]
    Load {
        /// The module: what `monas module build` has built.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Put all its activities into the list of this agent.
        #[arg(long)]
        agent: Option<String>,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Take the activities of a module out of all agents. Its code stays in memory till the run ends.
    #[command(after_help = "Example: monas module unload eyes")]
    Unload {
        /// The module.
        #[arg(add = ArgValueCandidates::new(modules))]
        name: String,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Load the file of a module again: all agents go on with new instances of its activities. If anything fails they go on with the old ones.
    #[command(after_help = "Example: monas module build eyes && monas module reload eyes")]
    Reload {
        /// The module.
        #[arg(add = ArgValueCandidates::new(modules))]
        name: String,
        /// Its file; the one that it was loaded from, if it is not said.
        #[arg(value_hint = ValueHint::FilePath)]
        file: Option<PathBuf>,
        #[command(flatten)]
        run: RunChoice,
    },
    /// Print how a module was built, and whether it fits this program. Nothing of it is run.
    #[command(after_help = "Example: monas module show target/debug/libeyes.so")]
    Show {
        /// The module.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Build a module as this program is built, so that it fits: by one call of cargo for both. Prints where it is.
    #[command(after_help = "Example: monas module build eyes")]
    Build {
        /// The package of the module; all packages of the workspace that are one, if it is not said.
        package: Option<String>,
        #[command(flatten)]
        format: FormatArgument,
    },
}

/// The modules of the only run, if there is one.
fn modules() -> Vec<CompletionCandidate> {
    let run = RunChoice::of(None, None, FormatArgument { value: Format::Text });
    let mut names: Vec<String> =
        list::loaded(&run).unwrap_or_default().into_iter().map(|one| one.name).collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(CompletionCandidate::new).collect()
}
