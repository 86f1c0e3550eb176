//! Protocols become statecharts.

use yase::{Diagnostic, Span};

use super::{formula_name, participant_formula};
use crate::aip::{Aip, Participant, Protocol};
use crate::iac::{ChartKind, Iac};
use crate::{liveness, transform};

/// A chart for each protocol: its participants side by side, each doing what its formulas say. A participant without formulas is an activity.
///
/// Rules and outcomes go into the chart's description, for the person who writes them as guards and exits. Findings are those about formulas, at the
/// participant they belong to.
pub fn aip_to_eac(aip: &Aip) -> (Vec<Iac>, Vec<Diagnostic>) {
    let mut diagnostics = Vec::new();
    let eac = |protocol: &Protocol| eac(aip, protocol, &mut diagnostics);
    let charts = aip.protocols.iter().map(eac).collect();
    (charts, diagnostics)
}

fn eac(aip: &Aip, protocol: &Protocol, diagnostics: &mut Vec<Diagnostic>) -> Iac {
    let participants: Vec<&Participant> =
        protocol.participants.iter().filter_map(|&index| aip.participants.get(index)).collect();
    let names: Vec<String> = participants.iter().map(|participant| formula_name(&participant.name)).collect();
    let mut formulas = format!("{}={}\n", formula_name(&protocol.name), names.join("||"));
    // Where each part of the text belongs.
    let mut places: Vec<(usize, Span)> = vec![(formulas.len(), protocol.place.0)];
    for participant in participants.iter().filter(|participant| !participant.liveness.trim().is_empty()) {
        formulas.push_str(&participant_formula(&participant.name, &participant.liveness));
        formulas.push('\n');
        places.push((formulas.len(), participant.liveness_place.0));
    }
    let (formulas, findings) = liveness::parse(&formulas);
    let (chart, more) = transform::liveness_to_statechart(&formulas);
    let placed = |finding: Diagnostic| {
        let place = places
            .iter()
            .find(|(end, _)| finding.span.start < *end)
            .map_or(protocol.place.0, |(_, span)| *span);
        Diagnostic { span: place, ..finding }
    };
    diagnostics.extend(findings.into_iter().chain(more).map(placed));
    let mut eac = Iac::from_statechart(&chart, ChartKind::Inter);
    eac.name.clone_from(&protocol.name);
    eac.description = description(&participants);
    eac
}

/// Rules and outcomes, each once.
fn description(participants: &[&Participant]) -> String {
    let mut sentences: Vec<String> = Vec::new();
    for participant in participants {
        let said = [("engaged when", &participant.engaging_rules), ("outcomes:", &participant.outcomes)];
        for (what, text) in said.into_iter().filter(|(_, text)| !text.is_empty()) {
            let sentence = format!("{what} {text}");
            if !sentences.contains(&sentence) {
                sentences.push(sentence);
            }
        }
    }
    sentences.join("; ")
}
