//! Activities, agents, statechart agents, and Talws, which runs them.

mod activity;
mod agent;
mod binder;
mod call;
mod chart;
pub mod config;
mod coverage;
mod error;
mod frequency;
mod function;
mod list;
mod listener;
mod parameters;
pub mod records;
mod registry;
mod run_hash;
mod statistics;
mod talws;
mod vocabulary;

pub use activity::{Activity, BoxError, IntoProgress, Progress, Topics};
pub use agent::{Agent, Policy};
pub use coverage::{ChartCoverage, StateCoverage, TransitionCoverage};
pub use error::{Error, ErrorKind};
pub use frequency::{Frequency, Hz};
pub use listener::{ChartListener, MicroStep};
pub use narukom::{Blackboard, Moment};
pub use parameters::{ParameterFault, Parameters};
pub use registry::Registry;
pub use run_hash::RunHash;
pub use statistics::{ActivityStatistics, AgentStatistics, Average, Statistics};
pub use talws::{HostConfig, Running, Simulation, Stopper, Talws, World};

/// What the macros of this crate expand to.
#[doc(hidden)]
pub mod linked {
    pub use crate::function::{Answer, Argument, FUNCTIONS, FunctionDeclaration};
    pub use crate::registry::{ACTIVITIES, ActivityDeclaration};
    pub use linkme;
}
