//! The kinds of bodies of the program, and whether they answer.

use monas::config::{self, Element, Layers};
use monas_robot::BodyKind;

use super::{CheckResult, DoctorArguments};
use crate::input::grammar;

const AREA: &str = "bodies";

/// Each kind of body with the answer of its interface, then each address that the configuration
/// names.
pub(crate) fn findings(arguments: &DoctorArguments) -> Vec<CheckResult> {
    let kinds = BodyKind::linked();
    if kinds.is_empty() {
        return vec![CheckResult::ok(AREA, "this program has no bodies")];
    }
    let kind = |kind: &BodyKind| {
        let BodyKind { name, summary, probe, .. } = kind;
        let answer = probe(None).unwrap_or_else(|error| error.to_string());
        CheckResult::ok(AREA, format!("{name}: {summary}; {answer}"))
    };
    let mut findings: Vec<CheckResult> = kinds.iter().map(kind).collect();
    if arguments.has_configuration() {
        let resolved = config::resolve(&arguments.config, &grammar(), &Layers::new());
        resolved.elements.iter().for_each(|element| addressed(element, &kinds, &mut findings));
    }
    findings
}

/// Adds whether the bodies with an address below an element answer.
fn addressed(element: &Element, kinds: &[BodyKind], findings: &mut Vec<CheckResult>) {
    if element.is("body")
        && let (Some(kind), Some(address)) = (element.attribute("kind"), element.attribute("address"))
        && let Some(known) = kinds.iter().find(|known| known.name == kind.value)
    {
        let name = known.name;
        findings.push(match (known.probe)(Some(&address.value)) {
            Ok(answer) => CheckResult::ok(AREA, format!("{name}: {answer}")),
            Err(error) => {
                CheckResult::warning(AREA, format!("{name}: {error}"), "start it, or correct `address`")
            }
        });
    }
    element.children().iter().for_each(|child| addressed(child, kinds, findings));
}
