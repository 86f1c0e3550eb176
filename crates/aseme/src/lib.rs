//! AMOLA models, liveness formulas, and the arrows from a formula to a statechart.
mod json;
pub mod liveness;
pub mod names;
mod outline;
pub mod path;
pub mod refine;
pub mod srm;
mod text;
pub mod transform;

pub use json::to_json;
pub use liveness::Liveness;
pub use outline::to_text;
pub use srm::{Srm, SrmFile};
pub use transform::{liveness_to_statechart, srm_to_iac};
