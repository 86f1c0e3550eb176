//! The status of a host, as requested from outside.

use monas_core::records::{AgentEntry, ChartState, Configuration, ModuleEntry};

/// The publisher name of external messages.
pub(crate) const OUTSIDE: &str = "outside";

/// The present state of a host.
pub(crate) struct HostStatus {
    pub(crate) host: String,
    pub(crate) agents: Vec<AgentEntry>,
    pub(crate) configuration: Configuration,
    pub(crate) modules: Vec<ModuleEntry>,
    /// The requested chart, or why it is not available.
    pub(crate) chart: Option<Result<ChartState, String>>,
}
