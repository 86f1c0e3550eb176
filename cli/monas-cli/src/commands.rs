//! The commands, one module each, with its arguments and its work.

#[cfg(unix)]
pub(crate) mod agent;
#[cfg(unix)]
pub(crate) mod chart;
pub(crate) mod config;
pub(crate) mod deploy;
pub(crate) mod doctor;
#[cfg(feature = "soccer")]
pub(crate) mod eval;
pub(crate) mod explain;
pub(crate) mod generate;
pub(crate) mod log;
pub(crate) mod model;
#[cfg(unix)]
pub(crate) mod module;
pub(crate) mod new;
#[cfg(feature = "soccer")]
pub(crate) mod referee;
pub(crate) mod run;
#[cfg(unix)]
pub(crate) mod studio;
pub(crate) mod tape;
#[cfg(unix)]
pub(crate) mod top;
#[cfg(unix)]
pub(crate) mod topic;
#[cfg(feature = "soccer")]
pub(crate) mod vision;
pub(crate) mod why;
