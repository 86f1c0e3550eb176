//! AIP to EAC: protocols to statecharts.

use yase::expression::{Expression, parse_transition};
use yase::{Diagnostic, Span};

use super::{formula_name, participant_formula, participants};
use crate::aip::{Aip, Participant, Protocol};
use crate::iac::{ChartKind, Iac, IacTransition};
use aseme::{liveness, transform};

/// A chart for each protocol: one region per participant with the translation of its formulas. A
/// participant without formulas is an activity.
///
/// Rules and outcomes that are conditions in brackets become guards of the entries and exits of the
/// parts. Those in prose go into the chart's description, for the developer to formalise. Findings
/// about formulas are positioned at their participant.
pub fn aip_to_eac(aip: &Aip) -> (Vec<Iac>, Vec<Diagnostic>) {
    let mut diagnostics = Vec::new();
    let eac = |protocol: &Protocol| eac(aip, protocol, &mut diagnostics);
    let charts = aip.protocols.iter().map(eac).collect();
    (charts, diagnostics)
}

fn eac(aip: &Aip, protocol: &Protocol, diagnostics: &mut Vec<Diagnostic>) -> Iac {
    let participants: Vec<&Participant> =
        protocol.participants.iter().filter_map(|&index| aip.participants.get(index)).collect();
    let (formulas, spans) = protocol_formulas(aip, protocol);
    let (formulas, findings) = liveness::parse(&formulas);
    let (chart, more) = transform::liveness_to_statechart(&formulas);
    let placed = |finding: Diagnostic| {
        let span = spans
            .iter()
            .find(|(end, _)| finding.span.start < *end)
            .map_or(protocol.position.0, |(_, span)| *span);
        Diagnostic { span, ..finding }
    };
    diagnostics.extend(findings.into_iter().chain(more).map(placed));
    let mut eac = Iac::from_statechart(&chart, ChartKind::Inter);
    eac.name.clone_from(&protocol.name);
    eac.description = description(&participants);
    set_spans(&mut eac, protocol, &participants);
    for participant in participants {
        diagnostics.extend(exits(&mut eac, participant));
    }
    eac
}

/// Gives nodes and transitions the spans of the formulas that they are made from.
fn set_spans(eac: &mut Iac, protocol: &Protocol, parts: &[&Participant]) {
    let mut positions = vec![protocol.position; eac.nodes.len()];
    let tops = participants(eac);
    for (index, node) in eac.nodes.iter().enumerate() {
        let part = if tops.contains(&index) { part_named(parts, &node.name) } else { None };
        let around = node.parent.and_then(|parent| positions.get(parent).copied());
        positions[index] = part.map(|part| part.liveness_position).or(around).unwrap_or(protocol.position);
    }
    for (node, position) in eac.nodes.iter_mut().zip(&positions) {
        node.position = *position;
    }
    for transition in &mut eac.transitions {
        transition.position = positions[transition.target];
    }
}

fn part_named<'a>(parts: &[&'a Participant], name: &str) -> Option<&'a Participant> {
    parts.iter().copied().find(|part| formula_name(&part.name) == name)
}

/// The formulas of a protocol and its participants as one text, and the participant of each section
/// with its end.
pub fn protocol_formulas(aip: &Aip, protocol: &Protocol) -> (String, Vec<(usize, Span)>) {
    let participants: Vec<&Participant> =
        protocol.participants.iter().filter_map(|&index| aip.participants.get(index)).collect();
    let names: Vec<String> = participants.iter().map(|participant| formula_name(&participant.name)).collect();
    let mut formulas = format!("{}={}\n", formula_name(&protocol.name), names.join("||"));
    let mut spans: Vec<(usize, Span)> = vec![(formulas.len(), protocol.position.0)];
    for participant in participants.iter().filter(|participant| !participant.liveness.trim().is_empty()) {
        formulas.push_str(&participant_formula(&participant.name, &participant.liveness));
        formulas.push('\n');
        spans.push((formulas.len(), participant.liveness_position.0));
    }
    (formulas, spans)
}

/// Rules and outcomes that are conditions in brackets, possibly with words between; `None` if they
/// are in prose.
pub fn conditions(text: &str) -> Option<Vec<Expression>> {
    if !text.trim_start().starts_with('[') {
        return None;
    }
    let groups = text.split('[').skip(1).map(|group| group.split(']').next().unwrap_or_default());
    Some(groups.filter_map(|group| parse_transition(&format!("[{group}]")).0.guard).collect())
}

/// Makes rules the guards of the transition into a part, and outcomes its exits (E0838 if they
/// cannot be parsed).
fn exits(eac: &mut Iac, participant: &Participant) -> Vec<Diagnostic> {
    let texts = [&participant.engaging_rules, &participant.outcomes];
    let mut found = Vec::new();
    for text in texts.into_iter().filter(|text| text.trim_start().starts_with('[')) {
        for group in text.split('[').skip(1) {
            let (inner, closed) = group.split_once(']').map_or((group, false), |(inner, _)| (inner, true));
            let findings = parse_transition(&format!("[{inner}]")).1;
            if !closed || findings.iter().any(Diagnostic::is_error) {
                let message = format!("`[{inner}` of `{}` is not a condition", participant.name);
                let hint = "write all conditions in brackets, as on a transition, or all in prose";
                found.push(Diagnostic::error("E0838", participant.position.0, message).with_hint(hint));
            }
        }
    }
    let name = formula_name(&participant.name);
    let Some(node) = participants(eac).into_iter().find(|&node| eac.nodes[node].name == name) else {
        return found;
    };
    let rules = conditions(&participant.engaging_rules).unwrap_or_default();
    if let (Some(transition), false) =
        (eac.transitions.iter_mut().find(|it| it.target == node && it.source != node), rules.is_empty())
    {
        let rules: Vec<String> = rules.iter().map(ToString::to_string).collect();
        transition.te = match rules.as_slice() {
            [one] => format!("[{one}]"),
            several => format!("[({})]", several.join(") && (")),
        };
    }
    let end = eac.transitions.iter().find(|it| it.source == node && it.target != node).map(|it| it.target);
    for outcome in conditions(&participant.outcomes).into_iter().flatten() {
        let Some(target) = end else { break };
        let name = eac.usual_name(node, target);
        eac.transitions.push(IacTransition {
            name,
            source: node,
            target,
            te: format!("[{outcome}]"),
            position: participant.position,
            ..IacTransition::default()
        });
    }
    found
}

/// Rules and outcomes without duplicates.
fn description(participants: &[&Participant]) -> String {
    let mut sentences: Vec<String> = Vec::new();
    for participant in participants {
        let said = [("engaged when", &participant.engaging_rules), ("outcomes:", &participant.outcomes)];
        let in_words = |text: &str| !text.is_empty() && conditions(text).is_none();
        for (what, text) in said.into_iter().filter(|(_, text)| in_words(text)) {
            let sentence = format!("{what} {text}");
            if !sentences.contains(&sentence) {
                sentences.push(sentence);
            }
        }
    }
    sentences.join("; ")
}
