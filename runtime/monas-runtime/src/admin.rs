//! Changes of agents at runtime.
//!
//! A change is a message ([`CHANGE`](monas_core::records::CHANGE)) published on the host by a tool
//! through the control socket, by an activity, or by another process over a link with that
//! permission. It is validated against the profiles of the agents; everything it needs is prepared;
//! then it is applied between two cycles of the agent. The reply
//! ([`CHANGED`](monas_core::records::CHANGED)) is published as well, so that a tape contains both.

mod agent_control;
mod change_plan;
mod findings;
mod host_admin;
mod module_update;
mod save;
mod settings;

pub(crate) use agent_control::AgentControl;
pub(crate) use host_admin::{HOST_ITSELF, HostAdmin};
