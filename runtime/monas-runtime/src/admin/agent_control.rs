//! Control of the running agents of a host, independent of the kind of time.

use crate::agent_factory::PreparedAgent;
use crate::agent_update::{AgentStatus, AgentUpdate, ChangeRef};
use monas_core::agent::AgentProfile;
use monas_core::chart_runner::ChartAspect;
use monas_core::records::AgentEntry;

/// Running agents that accept updates.
pub(crate) trait AgentControl {
    /// The status of an agent.
    fn status(&self, agent: &str) -> AgentStatus;

    /// The status of a chart of an agent, by its index.
    fn chart_status(&self, agent: &str, index: usize) -> AgentStatus;

    /// The state of a chart of an agent: the documents of `ChartRunner::inspect`.
    fn inspect_chart(&self, agent: &str, index: usize, aspect: ChartAspect) -> Result<Vec<String>, String>;

    /// Whether it has a list, which may be empty.
    fn has_list(&self, agent: &str) -> bool;

    /// Number of its cycles so far.
    fn cycles(&self, agent: &str) -> u64;

    /// Applies an update to an agent and returns notes about it.
    ///
    /// # Errors
    /// The reasons against it: nothing has changed.
    fn apply(&mut self, agent: &str, orders: AgentUpdate) -> Result<Vec<String>, Vec<String>>;

    /// Starts a new agent, requested by the given change.
    ///
    /// # Errors
    /// A thread cannot be created.
    fn launch(&mut self, member: PreparedAgent, asked: Option<&ChangeRef>) -> Result<(), String>;

    /// Removes an agent permanently.
    ///
    /// # Errors
    /// It cannot be stopped.
    fn remove(&mut self, agent: &str) -> Result<(), String>;

    /// The present entry of an agent.
    fn entry(&self, profile: &AgentProfile) -> AgentEntry;
}
