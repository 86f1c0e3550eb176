//! The statechart that a model describes.

use std::sync::Arc;

use yase::{Diagnostic, Source, Statechart};

use super::read::{KINDS, first_word};
use super::{Model, read};
use crate::roles::SystemRoles;
use crate::xmi;
use aseme::liveness;

/// The statechart of a text and all findings; `None` if the text is a refined role.
pub(crate) fn chart_of(source: &Arc<Source>) -> Option<(Statechart, Vec<Diagnostic>)> {
    if !is_other_than_role(&source.text) {
        return None;
    }
    let (found, mut diagnostics) = read(source);
    let (chart, findings) = match found {
        Some((Model::Chart(chart), _)) => chart.to_statechart(),
        Some((Model::Srm(system), _)) => of_system(&system),
        Some((model, _)) => (Statechart::new(""), vec![no_chart(&model)]),
        None => (Statechart::new(""), Vec::new()),
    };
    diagnostics.extend(findings);
    Some((chart, diagnostics))
}

fn is_other_than_role(text: &str) -> bool {
    if !xmi::is_xml(text) {
        return KINDS.contains(&first_word(text).as_str());
    }
    let document = xmi::parse(text);
    document
        .is_ok_and(|document| ["Model", "XMI", "scxml"].contains(&document.root_element().tag_name().name()))
}

fn of_system(system: &SystemRoles) -> (Statechart, Vec<Diagnostic>) {
    match system.roles.as_slice() {
        // Findings of the formulas were reported when the model was read.
        [role] => aseme::liveness_to_statechart(&liveness::parse(&role.liveness).0),
        roles => {
            let message = format!("the model has {} roles, each of which has a statechart", roles.len());
            let span = roles.get(1).map_or(yase::Span::default(), |role| role.position.0);
            let found =
                Diagnostic::error("E0248", span, message).with_hint("put each role into its own file");
            (Statechart::new(""), vec![found])
        }
    }
}

fn no_chart(model: &Model) -> Diagnostic {
    let message = format!("a model of the kind {} has no statechart", model.kind());
    let hint = "roles (SRM) and charts (IAC, EAC) have one";
    Diagnostic::error("E0230", yase::Span::default(), message).with_hint(hint)
}
