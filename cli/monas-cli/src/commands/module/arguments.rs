//! Arguments of `monas module`.

use std::path::PathBuf;

use clap::{Subcommand, ValueHint};
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate};
use monas_terminal::{Format, FormatArgument};

use super::list;
use crate::remote::RunSelector;

#[derive(Subcommand, Debug)]
pub(crate) enum ModuleCommand {
    /// List the loaded modules of a run, with their activities and the agents that use them.
    #[command(after_help = "Example: monas module list")]
    List {
        #[command(flatten)]
        run: RunSelector,
    },
    /// Load a module into a run, so that agents can use its activities.
    #[command(after_help = "Example: monas module load target/debug/libeyes.so --agent Head")]
    Load {
        /// The module, as built by `monas module build`.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        /// Add all its activities to the list of this agent.
        #[arg(long)]
        agent: Option<String>,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Remove the activities of a module from all agents. Its code stays in memory until the run
    /// ends.
    #[command(after_help = "Example: monas module unload eyes")]
    Unload {
        /// The module.
        #[arg(add = ArgValueCandidates::new(modules))]
        name: String,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Reload a module from its file: all agents continue with new instances of its activities. If
    /// anything fails they continue with the old ones.
    #[command(after_help = "Example: monas module build eyes && monas module reload eyes")]
    Reload {
        /// The module.
        #[arg(add = ArgValueCandidates::new(modules))]
        name: String,
        /// Its file; the file it was loaded from if not given.
        #[arg(value_hint = ValueHint::FilePath)]
        file: Option<PathBuf>,
        #[command(flatten)]
        run: RunSelector,
    },
    /// Print how a module was built, and whether it is compatible with this program. Does not
    /// execute the module.
    #[command(after_help = "Example: monas module show target/debug/libeyes.so")]
    Show {
        /// The module.
        #[arg(value_hint = ValueHint::FilePath)]
        file: PathBuf,
        #[command(flatten)]
        format: FormatArgument,
    },
    /// Build a module together with this program, in one call of cargo, so that they are
    /// compatible. Prints the file of the module.
    #[command(after_help = "Example: monas module build eyes")]
    Build {
        /// The package of the module; all packages of the workspace that are modules if not given.
        package: Option<String>,
        #[command(flatten)]
        format: FormatArgument,
    },
}

/// The modules of the only run, if there is one.
fn modules() -> Vec<CompletionCandidate> {
    let run = RunSelector::of(None, None, FormatArgument { value: Format::Text });
    let mut names: Vec<String> =
        list::loaded(&run).unwrap_or_default().into_iter().map(|one| one.name).collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(CompletionCandidate::new).collect()
}
