//! The flags that choose a run, and their completions.

use std::path::PathBuf;

use clap::Args;
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate};
use monas_terminal::FormatArgument;

use super::live_runs;

/// Selects a run, and the format of results.
#[derive(Args, Debug)]
pub(crate) struct RunSelector {
    /// The run, by the name of its control socket; not needed if there is only one.
    #[arg(long, value_name = "NAME", add = ArgValueCandidates::new(runs))]
    pub(crate) run: Option<String>,
    /// The host (a robot of a match); all hosts if not given.
    #[arg(long, add = ArgValueCandidates::new(hosts))]
    pub(crate) host: Option<String>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
    /// The control socket to use instead of that of a run, for links.
    #[arg(skip)]
    pub(crate) reached: Option<PathBuf>,
}

impl RunSelector {
    /// Selects a run on this computer.
    pub(crate) fn of(run: Option<String>, host: Option<String>, format: FormatArgument) -> RunSelector {
        RunSelector { run, host, format, reached: None }
    }
}

fn candidates(words: Vec<String>) -> Vec<CompletionCandidate> {
    words.into_iter().map(CompletionCandidate::new).collect()
}

/// The topics of all runs.
pub(crate) fn topics() -> Vec<CompletionCandidate> {
    candidates(live_runs::known_topics())
}

pub(crate) fn hosts() -> Vec<CompletionCandidate> {
    candidates(live_runs::known_hosts())
}

/// The names of all runs.
pub(crate) fn runs() -> Vec<CompletionCandidate> {
    candidates(live_runs::live_runs().into_iter().map(|(name, _)| name).collect())
}
