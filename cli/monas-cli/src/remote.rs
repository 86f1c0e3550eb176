//! A run of agents in another process, reached by its control socket.

mod agent_names;
mod change;
pub(crate) mod connection;
mod link_targets;
mod live_runs;
mod request;
mod run_selector;
mod watch;

pub(crate) use agent_names::agents;
pub(crate) use change::{print_outcome, request_change};
pub(crate) use connection::failure;
pub(crate) use link_targets::LinkTargets;
pub(crate) use request::{request, unexpected_reply};
pub(crate) use run_selector::{RunSelector, hosts, runs, topics};
pub(crate) use watch::{WatchLimits, watch};
