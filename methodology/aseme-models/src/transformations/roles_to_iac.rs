//! SRM to IAC: roles to statecharts.

use yase::Diagnostic;

use crate::iac::{ChartKind, Iac};
use crate::roles::{Role, SystemRoles};
use aseme::{liveness, transform};

/// A chart for each role: its formulas expanded, with the functionality of each activity.
///
/// Findings about formulas are positioned at their role; unknown activities are E0249.
pub fn roles_to_iac(srm: &SystemRoles) -> (Vec<Iac>, Vec<Diagnostic>) {
    let mut diagnostics = Vec::new();
    let charts = srm.roles.iter().map(|role| chart(srm, role, &mut diagnostics)).collect();
    (charts, diagnostics)
}

fn chart(srm: &SystemRoles, role: &Role, diagnostics: &mut Vec<Diagnostic>) -> Iac {
    let (formulas, findings) = liveness::parse(&role.liveness);
    let (chart, more) = transform::liveness_to_statechart(&formulas);
    let place = role.liveness_place.0;
    let placed = |finding: Diagnostic| Diagnostic { span: place, ..finding };
    diagnostics.extend(findings.into_iter().chain(more).map(placed));
    let mut iac = Iac::from_statechart(&chart, ChartKind::Intra);
    for node in iac.nodes.iter_mut().filter(|node| node.kind == "BASIC") {
        let known = srm.activities.iter().find(|activity| activity.name.eq_ignore_ascii_case(&node.name));
        let functionality = known.and_then(|activity| srm.functionalities.get(activity.functionality?));
        if let Some(functionality) = functionality {
            node.functionality.clone_from(&functionality.description);
        }
        if known.is_none() {
            let message = format!("the model has no activity `{}`", node.name);
            let names = srm.activities.iter().map(|activity| activity.name.as_str());
            diagnostics.push(Diagnostic::warning("E0249", place, message).with_nearest(&node.name, names));
        }
    }
    iac
}
