//! Completion of agents' names.

use clap_complete::engine::CompletionCandidate;
use monas::records::Inquiry;
use monas_terminal::{Format, FormatArgument};

use super::request::request;
use super::run_selector::RunSelector;

/// The names of the agents of the only run, if there is one.
pub(crate) fn agents() -> Vec<CompletionCandidate> {
    let run = RunSelector::of(None, None, FormatArgument { value: Format::Text });
    let reply = request(Inquiry { agents: true, ..Inquiry::default() }, &run);
    let known = reply.ok().and_then(|reply| reply.agents).unwrap_or_default();
    let mut names: Vec<String> = known.agents.into_iter().map(|agent| agent.name).collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(CompletionCandidate::new).collect()
}
