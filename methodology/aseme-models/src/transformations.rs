//! Transformations between models, in the order of the method: goals to use cases, use cases to
//! protocols and roles, these to statecharts.
//!
//! | from | to | by |
//! |---|---|---|
//! | SAG | SUC | [`sag_to_suc`] |
//! | SUC | AIP | [`suc_to_aip`] |
//! | SUC, AIP | SRM | [`suc_to_srm`] |
//! | AIP | an EAC for each protocol | [`aip_to_eac`] |
//! | SRM | an IAC for each role | [`roles_to_iac`]; for one role in a file of its own [`role_to_statechart`](aseme::role_to_statechart) |
//! | EAC into IAC | IAC | [`merge_eac`] |
//! | SRM | FT | [`functionality_table`] |
//! | EAC, IAC | statechart | [`Iac::to_statechart`](crate::Iac::to_statechart) |
//!
//! Each is a function that returns its result and a list of findings (E0830 to E0839). Operators
//! that a transformation cannot decide, such as those between the activities of a capability, are
//! written as [`OPEN_OPERATOR`] and replaced by the developer.

mod aip_to_eac;
mod from_role;
mod functionality_table;
mod merge;
mod roles_to_iac;
mod sag_to_suc;
mod suc_to_aip;
mod suc_to_srm;

pub use aip_to_eac::{aip_to_eac, conditions, protocol_formulas};
pub use functionality_table::functionality_table;
pub use merge::{ShapeMatch, merge_eac, participants, same_shape};
pub use roles_to_iac::roles_to_iac;
pub use sag_to_suc::sag_to_suc;
pub use suc_to_aip::suc_to_aip;
pub use suc_to_srm::suc_to_srm;

use crate::suc::{RoleKind, Suc, UseCase};
use aseme::liveness::Liveness;
pub use aseme::liveness::OPEN_OPERATOR;

/// Names joined by placeholders.
fn joined<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    names.join(&format!(" {OPEN_OPERATOR} "))
}

/// The formulas of a participant, which are stored without the left-hand side of the first.
pub fn participant_formula(name: &str, liveness: &str) -> String {
    format!("{}={liveness}", formula_name(name))
}

/// A valid name of a formula: other characters become underscores.
pub fn formula_name(name: &str) -> String {
    let letter = |letter: char| if aseme::text::is_name_character(letter) { letter } else { '_' };
    let name: String = name.trim().chars().map(letter).collect();
    if name.is_empty() { "_".into() } else { name }
}

/// The names in formulas that no formula refines, each once, in order.
fn activity_names(liveness: &Liveness) -> Vec<&str> {
    let refined: Vec<&str> = liveness.formulas().iter().map(|formula| formula.name.as_str()).collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in liveness.formulas().iter().flat_map(|formula| liveness.names(formula)) {
        if !refined.contains(&name) && !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The participants of a use case that belong to the system, or may belong to it.
fn system_participants<'a>(suc: &'a Suc, usecase: &'a UseCase) -> impl Iterator<Item = usize> + 'a {
    let may = |kind| matches!(kind, RoleKind::System | RoleKind::Abstract);
    usecase
        .participants
        .iter()
        .copied()
        .filter(move |&role| suc.roles.get(role).is_some_and(|role| may(role.kind)))
}
