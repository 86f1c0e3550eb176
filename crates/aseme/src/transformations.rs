//! From model to model, along the method: goals to use cases, these to protocols and roles, roles and protocols to statecharts.
//!
//! Each is a function of its own. What it cannot decide, the operators between the activities of a capability, it writes as [`OPEN_OPERATOR`], to be
//! replaced by a person.

mod from_role;

/// Stands in a formula where an operator is to be chosen.
pub const OPEN_OPERATOR: &str = "?OP?";

/// The formulas of a part in a protocol, which are kept without the left-hand side of the first.
pub(crate) fn participant_formula(name: &str, liveness: &str) -> String {
    format!("{}={liveness}", if crate::text::is_name(name) { name } else { "participant" })
}
