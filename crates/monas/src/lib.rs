//! Activities, agents, statechart agents, and Talws, which runs them.

pub mod activity;
pub mod config;
mod error;
mod function;
mod parameters;
mod registry;

pub use activity::{Activity, BoxError, IntoProgress, Progress, Topics};
pub use error::{Error, ErrorKind};
pub use narukom::Blackboard;
pub use parameters::{ParameterFault, Parameters};
pub use registry::Registry;

/// What the macros of this crate expand to.
#[doc(hidden)]
pub mod linked {
    pub use crate::function::{Answer, Argument, FUNCTIONS, FunctionDeclaration};
    pub use crate::registry::{ACTIVITIES, ActivityDeclaration};
    pub use linkme;
}
