//! SRM to IAC: roles to statecharts.

use std::collections::BTreeMap;

use yase::Diagnostic;
use yase::diagnostic::Suggestions;

use crate::iac::{ChartKind, Iac};
use crate::roles::{Role, RoleActivity, SystemRoles};
use aseme::{liveness, transform};

/// A chart for each role: its formulas expanded, with the functionality of each activity.
///
/// Findings about formulas are positioned at their role; unknown activities are E0249.
pub fn roles_to_iac(srm: &SystemRoles) -> (Vec<Iac>, Vec<Diagnostic>) {
    let mut diagnostics = Vec::new();
    let suggestions = Suggestions::default();
    let mut activities: BTreeMap<String, &RoleActivity> = BTreeMap::new();
    for activity in &srm.activities {
        activities.entry(activity.name.to_ascii_lowercase()).or_insert(activity);
    }
    let charts = srm
        .roles
        .iter()
        .map(|role| chart(srm, (role, &activities), &suggestions, &mut diagnostics))
        .collect();
    (charts, diagnostics)
}

fn chart(
    srm: &SystemRoles,
    (role, activities): (&Role, &BTreeMap<String, &RoleActivity>),
    suggestions: &Suggestions,
    diagnostics: &mut Vec<Diagnostic>,
) -> Iac {
    let (formulas, findings) = liveness::parse(&role.liveness);
    let (chart, more) = transform::liveness_to_statechart(&formulas);
    let span = role.liveness_position.0;
    let placed = |finding: Diagnostic| Diagnostic { span, ..finding };
    diagnostics.extend(findings.into_iter().chain(more).map(placed));
    let mut iac = Iac::from_statechart(&chart, ChartKind::Intra);
    for node in iac.nodes.iter_mut().filter(|node| node.kind == "BASIC") {
        let known = activities.get(&node.name.to_ascii_lowercase());
        let functionality = known.and_then(|activity| srm.functionalities.get(activity.functionality?));
        if let Some(functionality) = functionality {
            node.functionality.clone_from(&functionality.description);
        }
        if known.is_none() {
            let message = format!("the model has no activity `{}`", node.name);
            let names = srm.activities.iter().map(|activity| activity.name.as_str());
            let found = Diagnostic::warning("E0249", span, message);
            diagnostics.push(found.with_suggestion(suggestions, &node.name, names));
        }
    }
    iac
}
