//! Conformance of a protocol's chart to the protocol, and of a player's chart to both.
//!
//! A protocol lists its participants, the formulas of each, the rule by which it is engaged and its
//! outcomes. Rules and outcomes that are conditions, each in brackets
//! (`[Attack.ball_is_free && Attack.part == CENTER]`), are checked; those in prose are
//! documentation.
//!
//! [`chart_conforms`] checks the chart of a protocol: every participant is present and does what
//! its formulas say, is engaged only by its rule, has an exit for each outcome and for nothing
//! else, and guards its optional activities. [`player_conforms`] checks the chart of a player: it
//! contains the parts that it takes, with their transitions, rules and exits. Both then explore
//! these charts and compare every trace with the formulas of the protocol: for a player both its
//! parts alone, and the whole player while it is engaged in them.

mod part;
mod trace_inclusion;

use yase::expression::{Expression, TextPosition, parse_transition};
use yase::{Diagnostic, Span};
use yase_explore::explore;
use yase_export::notation::depth_first;

use crate::abstraction::Abstraction;
use crate::checked_model;
use crate::conformance::{DifferenceKind, differences_of_what_is_left_early};
use crate::diagnostic_names::DiagnosticNames;
use crate::exploration_extent::ExplorationExtent;
use crate::logic::GuardSolver;
use aseme::liveness::{self, Liveness};
use aseme::srm::Srm;
use aseme_models::aip::{Aip, Participant, Protocol};
use aseme_models::iac::{ChartKind, Iac, IacTransition};
use aseme_models::transformations::{
    ShapeMatch, conditions, formula_name, participant_formula, participants, protocol_formulas, same_shape,
};

/// Limit of explored states per chart.
const MAX_STATES: usize = 100_000;

/// The result of a conformance check.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub struct Conformance {
    /// The deviations (E0860 to E0869), in the order of the chart.
    pub findings: Vec<Diagnostic>,
    /// The explored charts and the extent of each exploration.
    pub explored: Vec<(String, ExplorationExtent)>,
}

impl Conformance {
    /// Whether the chart conforms.
    pub fn is_given(&self) -> bool {
        !self.findings.iter().any(Diagnostic::is_error)
    }

    fn report(&mut self, code: &'static str, span: Span, message: String, hint: &str) {
        self.findings.push(Diagnostic::error(code, span, message).with_hint(hint));
    }
}

/// Checks whether the chart of a protocol (EAC) conforms to the protocol.
pub fn chart_conforms(eac: &Iac, aip: &Aip) -> Conformance {
    let mut found = Conformance::default();
    let Some(protocol) = protocol_of(eac, aip, &mut found) else { return found };
    let expected = aseme_models::transformations::aip_to_eac(aip).0;
    let Some(expected) = expected.iter().find(|chart| chart.name == protocol.name) else { return found };
    let parts = participants(eac);
    for index in participants(expected) {
        let name = expected.nodes[index].name.as_str();
        let part = part_named(aip, protocol, name);
        match (parts.iter().find(|&&part| eac.nodes[part].name == name), part) {
            (Some(&node), Some(part)) => chart_part(eac, node, expected, index, part, &mut found),
            _ => {
                let message = format!("`{name}` of the protocol `{}` is missing in its chart", protocol.name);
                found.report("E0861", root(eac), message, "each participant has its own region");
            }
        }
    }
    for &part in parts.iter().filter(|&&part| part_named(aip, protocol, &eac.nodes[part].name).is_none()) {
        let message = format!("`{}` takes no part in the protocol `{}`", eac.nodes[part].name, protocol.name);
        found.report(
            "E0861",
            eac.nodes[part].position.0,
            message,
            "add it to the participants, or remove it",
        );
    }
    if found.is_given() {
        let formulas = protocol_formulas(aip, protocol).0;
        traces(eac, &liveness::parse(&formulas).0, &protocol.name, root(eac), &mut found);
    }
    found
}

/// Checks whether a player's chart (IAC) contains its parts in a protocol as the protocol's chart
/// has them, and does nothing in them that the protocol does not allow.
pub fn player_conforms(player: &Iac, eac: &Iac, aip: &Aip) -> Conformance {
    let mut found = Conformance::default();
    let Some(protocol) = protocol_of(eac, aip, &mut found) else { return found };
    let mut takes_part = false;
    for part in participants(eac) {
        let name = eac.nodes[part].name.as_str();
        let span = (0..player.nodes.len())
            .filter(|&node| player.nodes[node].kind == "OR" && player.nodes[node].name == name);
        for index in span {
            takes_part = true;
            let before = found.findings.len();
            part::contained(player, index, eac, part, &mut found);
            let formulas =
                part_named(aip, protocol, name).map(|it| participant_formula(&it.name, &it.liveness));
            if let (true, Some(formulas)) = (found.findings.len() == before, formulas) {
                let alone = part::alone(player, index, eac, part);
                let liveness = liveness::parse(&formulas).0;
                traces(&alone, &liveness, name, player.nodes[index].position.0, &mut found);
                trace_inclusion::in_whole(player, index, (eac, part), &liveness, &mut found);
            }
        }
    }
    if !takes_part {
        let message = format!("`{}` takes no part in the protocol `{}`", player.name, protocol.name);
        let hint = "a part is a composite with the name of a participant: merge the protocol's chart into the player's";
        found.report("E0861", root(player), message, hint);
    }
    found
}

/// The chart of a role, with the spans of its nodes and transitions in the role's text.
///
/// # Errors
/// The findings of a role that has no chart.
pub fn role_chart(role: &Srm) -> Result<Iac, Vec<Diagnostic>> {
    let (model, found) = checked_model::of_role(role);
    if found.iter().any(Diagnostic::is_error) {
        return Err(found);
    }
    let mut chart = Iac::from_statechart(&model.chart, ChartKind::Intra);
    for (node, id) in chart.nodes.iter_mut().zip(depth_first(&model.chart)) {
        node.position = TextPosition(model.spans.node(id));
    }
    for (transition, (id, _)) in chart.transitions.iter_mut().zip(model.chart.transitions()) {
        transition.position = TextPosition(model.spans.transition(id));
    }
    Ok(chart)
}

/// The span of a whole chart.
fn root(chart: &Iac) -> Span {
    chart.nodes.first().map_or(Span::default(), |node| node.position.0)
}

/// The names of a chart's nodes in findings.
fn names(chart: &Iac) -> DiagnosticNames {
    DiagnosticNames::new(&chart.to_statechart().0)
}

/// The parts of a protocol's chart, each with whether a player takes it.
pub fn parts_taken(player: &Iac, eac: &Iac) -> Vec<(String, bool)> {
    let takes = |name: &str| player.nodes.iter().any(|node| node.kind == "OR" && node.name == name);
    let names = participants(eac).into_iter().map(|part| eac.nodes[part].name.clone());
    names.map(|name| (name.clone(), takes(&name))).collect()
}

fn protocol_of<'a>(eac: &Iac, aip: &'a Aip, found: &mut Conformance) -> Option<&'a Protocol> {
    let protocol = aip.protocols.iter().find(|protocol| protocol.name == eac.name);
    if protocol.is_none() {
        let names = aip.protocols.iter().map(|protocol| protocol.name.as_str());
        let message = format!("there is no protocol `{}`", eac.name);
        found.findings.push(Diagnostic::error("E0860", root(eac), message).with_nearest(&eac.name, names));
    }
    protocol
}

/// The participant whose part has a name in charts.
fn part_named<'a>(aip: &'a Aip, protocol: &Protocol, name: &str) -> Option<&'a Participant> {
    let mut parts = protocol.participants.iter().filter_map(|&index| aip.participants.get(index));
    parts.find(|part| formula_name(&part.name) == name)
}

/// One part of a protocol's chart.
fn chart_part(
    eac: &Iac,
    node: usize,
    expected: &Iac,
    wanted: usize,
    part: &Participant,
    found: &mut Conformance,
) {
    let name = &part.name;
    if let Err((wanted, there)) = same_shape(expected, wanted, eac, node, ShapeMatch::Same) {
        let message = format!("`{name}` differs from the protocol: {there} instead of {wanted}");
        return found.report("E0862", eac.nodes[node].position.0, message, "use the formula of the protocol");
    }
    let borders = BoundaryTransitions::of(eac, node);
    for rule in conditions(&part.engaging_rules).into_iter().flatten() {
        borders.engaged_by(eac, name, &rule, found);
    }
    let outcomes: Vec<Expression> = conditions(&part.outcomes).into_iter().flatten().collect();
    for outcome in &outcomes {
        borders.has_exit(eac, name, outcome, found);
    }
    if !outcomes.is_empty() {
        borders.no_other_exit(eac, name, &outcomes, found);
    }
    part::guarded(eac, node, found);
}

/// The transitions that lead into a composite and out of it; one from the composite to itself
/// enters it again.
struct BoundaryTransitions<'a> {
    /// The span of the composite.
    span: Span,
    into: Vec<&'a IacTransition>,
    out: Vec<&'a IacTransition>,
}

impl BoundaryTransitions<'_> {
    fn of(chart: &Iac, node: usize) -> BoundaryTransitions<'_> {
        let inside = |at: usize| part::is_inside(chart, at, node);
        let is_repetition =
            |it: &IacTransition| (it.source, it.target) == (node, node) && !it.refinement.internal;
        let crossing = |it: &&IacTransition| inside(it.source) != inside(it.target) || is_repetition(it);
        let (into, out) =
            chart.transitions.iter().filter(crossing).partition(|it: &&IacTransition| inside(it.target));
        BoundaryTransitions { span: chart.nodes[node].position.0, into, out }
    }

    fn engaged_by(&self, chart: &Iac, name: &str, rule: &Expression, found: &mut Conformance) {
        let logic = GuardSolver::new(&chart.constants);
        for transition in &self.into {
            let is_ruled = guard(transition).is_some_and(|guard| logic.implies(&guard, rule));
            if !is_ruled {
                let message = format!("`{name}` may be entered while `{rule}` does not hold");
                found.report("E0863", transition.position.0, message, "guard its entry by the engaging rule");
            }
        }
    }

    fn has_exit(&self, chart: &Iac, name: &str, outcome: &Expression, found: &mut Conformance) {
        let logic = GuardSolver::new(&chart.constants);
        let leads_out = |guard: Expression| logic.implies(outcome, &guard);
        if !self.out.iter().filter_map(|transition| guard(transition)).any(leads_out) {
            let message = format!("`{name}` has no exit for the outcome `{outcome}`");
            let span = self.out.first().map_or(self.span, |transition| transition.position.0);
            found.report("E0864", span, message, "add a transition out of it with the outcome as guard");
        }
    }

    fn no_other_exit(&self, chart: &Iac, name: &str, outcomes: &[Expression], found: &mut Conformance) {
        let logic = GuardSolver::new(&chart.constants);
        for transition in &self.out {
            let Some(guard) = guard(transition) else { continue };
            if !outcomes.iter().any(|outcome| logic.implies(&guard, outcome)) {
                let message =
                    format!("`{name}` is left when `{guard}`, which is not an outcome of the protocol");
                found.report(
                    "E0865",
                    transition.position.0,
                    message,
                    "make it an outcome, or remove the exit",
                );
            }
        }
    }
}

/// The guard of a transition; `false` never enables it.
fn guard(transition: &IacTransition) -> Option<Expression> {
    parse_transition(&transition.te).0.guard
}

/// Explores a chart and compares its traces with formulas. A trace that ends early by an exit is
/// allowed.
fn traces(chart: &Iac, liveness: &Liveness, name: &str, span: Span, found: &mut Conformance) {
    let (subject, made) = checked_model::of_chart(chart);
    let abstraction = match Abstraction::new(&subject) {
        Ok(abstraction) if !made.iter().any(Diagnostic::is_error) => abstraction,
        Ok(_) => return found.findings.extend(made),
        Err(reasons) => return found.findings.extend(reasons),
    };
    let mut surroundings = abstraction.surroundings();
    let explored = explore(&abstraction.chart, &mut surroundings, MAX_STATES);
    drop(surroundings);
    found.explored.push((name.to_owned(), ExplorationExtent::of(&explored)));
    let (differences, is_whole) = differences_of_what_is_left_early(&subject.chart, &explored, liveness);
    if !explored.is_finished() || !is_whole {
        let message = format!("`{name}` is too large: not all of its traces are known");
        return found.report("E0869", span, message, "make parts of it protocols of their own");
    }
    for difference in differences {
        let before = match difference.before.as_slice() {
            [] => String::from("at the beginning"),
            names => format!("after `{}`", names.join(" ")),
        };
        let span = match difference.kind {
            DifferenceKind::NotAllowed(node) => subject.spans.node(node),
            _ => span,
        };
        let (code, what) = match difference.kind {
            DifferenceKind::NotAllowed(node) => (
                "E0867",
                format!(
                    "`{}` is executed where the protocol does not allow it",
                    subject.chart.node(node).name
                ),
            ),
            DifferenceKind::EndsEarly => ("E0867", "it ends where the protocol continues".into()),
            DifferenceKind::NeverDone(activity) => {
                ("E0868", format!("the protocol allows `{activity}`, but the chart never executes it"))
            }
            DifferenceKind::NeverEnds => ("E0868", "the protocol may end, but the chart cannot".into()),
            DifferenceKind::Starves(_) => {
                ("E0868", "the chart can never continue as the protocol requires".into())
            }
        };
        let message = format!("in `{name}`, {before} {what}");
        found.report(code, span, message, "a guard or transition differs from the protocol");
    }
}
