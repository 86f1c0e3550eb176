//! EAC into IAC: merges a protocol's chart into the charts of its participants.

use std::collections::BTreeMap;

use aseme::names::encode;
use yase::expression::{Action, Expression, ExpressionKind, parse_transition};
use yase::{Diagnostic, Span};

use crate::iac::{Iac, IacNode, IacTransition};

/// Merges a protocol's chart into the chart of a role: each composite with the name of a
/// participant gets the variables and refinements of the participant's states and transitions.
///
/// The rule of the protocol becomes a guard on each way into the part, beside the guard that the
/// role has there, and each outcome an exit. A part that the role repeats directly (`part~`), or
/// that follows another composite, is enclosed in a composite `(part)`, as if the formula were
/// `(part)~`: its START waits for the rule and its END is where the outcomes lead, so that neither
/// what comes before is left nor the part entered again without them. Charts of several protocols
/// are merged one after the other, in any order.
///
/// Returns the paths, by label, of the composites that were found. One that is not built as the
/// participant is stays as it is, and that is an error (E0835): the role would not do what the
/// protocol asks for. If the role differs from the protocol inside the part, the protocol holds,
/// and that is reported (E0836). A protocol of which nothing is found is reported (E0837), and a
/// part whose rule or outcomes have no place (E0839).
pub fn merge_eac(iac: &mut Iac, eac: &Iac) -> (Vec<String>, Vec<Diagnostic>) {
    let mut merging = ChartMerge {
        variables: shared_variables(iac, eac),
        iac,
        eac,
        refused: Vec::new(),
        diagnostics: Vec::new(),
    };
    merging.constants();
    let participants = participants(eac);
    for &participant in &participants {
        // merging one of them may move the others
        for number in 0.. {
            let Some(position) = merging.composites_of(participant).nth(number) else { break };
            merging.composite(participant, position);
        }
    }
    let merged: Vec<String> = participants
        .iter()
        .flat_map(|&participant| merging.composites_of(participant))
        .map(|composite| merging.iac.nodes[composite].label.clone())
        .collect();
    let merged: Vec<String> = merged.into_iter().filter(|label| !merging.refused.contains(label)).collect();
    let mut diagnostics = merging.diagnostics;
    if merged.is_empty() && diagnostics.is_empty() {
        let names = participants
            .iter()
            .map(|&index| format!("`{}`", eac.nodes[index].name))
            .collect::<Vec<_>>()
            .join(", ");
        let message = format!("`{}` has none of the parts of `{}`: {names}", iac.name, eac.name);
        let hint = "a part is found by its name, which the role's formulas must refine";
        diagnostics.push(Diagnostic::warning("E0837", Span::default(), message).with_hint(hint));
    }
    (merged, diagnostics)
}

/// The composites in the regions of the protocol's AND; of a protocol with a single participant,
/// the one beside START and END.
pub fn participants(eac: &Iac) -> Vec<usize> {
    let children = eac.children();
    let of_kind = |nodes: &[usize], kind: &str| -> Vec<usize> {
        nodes.iter().copied().filter(|&node| eac.nodes[node].kind == kind).collect()
    };
    let top = children.first().map(Vec::as_slice).unwrap_or_default();
    let regions = of_kind(top, "AND").into_iter().flat_map(|and| children[and].clone());
    let inside: Vec<usize> = regions.flat_map(|region| of_kind(&children[region], "OR")).collect();
    if inside.is_empty() { of_kind(top, "OR") } else { inside }
}

/// The variable of the role for each variable of the protocol, added if it is missing.
fn shared_variables(iac: &mut Iac, eac: &Iac) -> Vec<usize> {
    eac.variables.iter().map(|variable| iac.variable(variable)).collect()
}

struct ChartMerge<'a> {
    iac: &'a mut Iac,
    eac: &'a Iac,
    variables: Vec<usize>,
    /// The labels of composites that are not built as the participant is.
    refused: Vec<String>,
    diagnostics: Vec<Diagnostic>,
}

impl ChartMerge<'_> {
    /// The composites of the role that are called as a participant is.
    fn composites_of(&self, participant: usize) -> impl Iterator<Item = usize> {
        let name = &self.eac.nodes[participant].name;
        let nodes = self.iac.nodes.iter().enumerate();
        nodes.filter(move |(_, node)| node.kind == "OR" && node.name == *name).map(|(index, _)| index)
    }

    fn constants(&mut self) {
        for constant in &self.eac.constants {
            match self.iac.constants.iter().find(|own| own.name == constant.name) {
                None => self.iac.constants.push(constant.clone()),
                Some(own) if own.value == constant.value => {}
                Some(_) => {
                    let message =
                        format!("the constant `{}` has another value in the protocol", constant.name);
                    self.diagnostics.push(
                        Diagnostic::error("E0836", Span::default(), message)
                            .with_hint("give one of the two another name"),
                    );
                }
            }
        }
    }

    fn composite(&mut self, participant: usize, position: usize) {
        let pairs = match same_shape(self.eac, participant, self.iac, position, ShapeMatch::Refined) {
            Ok(pairs) => pairs,
            Err((wanted, found)) => {
                self.refused.push(self.iac.nodes[position].label.clone());
                return self.mismatch(participant, position, &wanted, &found);
            }
        };
        for (&theirs, &own) in pairs.iter().skip(1) {
            let theirs = &self.eac.nodes[theirs];
            let variables = theirs.variables.iter().filter_map(|&index| self.variables.get(index).copied());
            let node = &mut self.iac.nodes[own];
            for variable in variables {
                if !node.variables.contains(&variable) {
                    node.variables.push(variable);
                }
            }
            if theirs.refinement != crate::iac::StateRefinement::default() {
                node.refinement = theirs.refinement.clone();
            }
        }
        self.transitions(&pairs);
        let boundary = BoundaryTransitions::of(self.eac, participant);
        let composite = match boundary.need_enclosure(self.iac, position) {
            true => enclose(self.iac, position),
            false => position,
        };
        self.guard_entries(&boundary, composite);
        self.connect_exits(&boundary, composite);
    }

    fn mismatch(&mut self, participant: usize, index: usize, wanted: &str, found: &str) {
        let name = &self.eac.nodes[participant].name;
        let message = format!(
            "`{name}` of `{}` differs from `{}`: {found} instead of {wanted}",
            self.iac.name, self.eac.name
        );
        let hint = "copy the formula of the participant";
        let span = self.iac.nodes[index].position.0;
        self.diagnostics.push(Diagnostic::error("E0835", span, message).with_hint(hint));
    }

    /// Adds the protocol's rule for engaging in a part to each transition of the role that leads
    /// there.
    fn guard_entries(&mut self, boundary: &BoundaryTransitions<'_>, index: usize) {
        let Some(rule) = boundary.rule else { return };
        let mut is_guarded = false;
        for own in self.iac.transitions.iter_mut().filter(|it| it.target == index && it.source != index) {
            is_guarded = true;
            match with_guard(&own.te, &rule.te) {
                Some(te) => own.te = te,
                None => {
                    // how the role chooses among its ways stays its own
                    let refinement = std::mem::take(&mut own.refinement);
                    self.diagnostics.extend(copy_refinement(rule, own));
                    own.refinement = refinement;
                }
            }
        }
        if !is_guarded {
            self.report_unmerged(index, "rule", "nothing leads into it");
        }
    }

    /// The exits of a part lead where the role goes on after it.
    fn connect_exits(&mut self, boundary: &BoundaryTransitions<'_>, index: usize) {
        let leads_out = |it: &IacTransition| it.source == index && it.target != index;
        let Some(target) = self.iac.transitions.iter().find(|it| leads_out(it)).map(|it| it.target) else {
            if boundary.exits.iter().any(|exit| has_content(exit)) {
                self.report_unmerged(index, "outcomes", "nothing leads out of it");
            }
            return;
        };
        let may_complete = boundary.exits.iter().any(|exit| !has_content(exit));
        for exit in boundary.exits.iter().filter(|exit| has_content(exit)) {
            let name = self.iac.usual_name(index, target);
            let is_same = |own: &IacTransition| (&own.te, &own.refinement) == (&exit.te, &exit.refinement);
            if self.iac.transitions.iter().any(|own| leads_out(own) && is_same(own)) {
                continue;
            }
            let mut own = self.iac.transitions.iter_mut().filter(|it| leads_out(it));
            match own.find(|own| !may_complete && !has_content(own)) {
                Some(own) => (own.te, own.refinement) = (exit.te.clone(), exit.refinement.clone()),
                None => {
                    let added = IacTransition { source: index, target, name, ..(*exit).clone() };
                    self.iac.transitions.push(added);
                }
            }
        }
    }

    fn report_unmerged(&mut self, index: usize, what: &str, why: &str) {
        let (part, role) = (self.iac.nodes[index].written(), &self.iac.name);
        let message = format!("the {what} of the part `{part}` have no place in `{role}`: {why}");
        let hint = format!("the role does the part as one of its states, as in `role = {part}`");
        let span = self.iac.nodes[index].position.0;
        self.diagnostics.push(Diagnostic::error("E0839", span, message).with_hint(hint));
    }

    /// Those with both ends inside; several between the same two ends are matched in order.
    fn transitions(&mut self, pairs: &BTreeMap<usize, usize>) {
        let mut seen: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for theirs in &self.eac.transitions {
            let ends = (pairs.get(&theirs.source), pairs.get(&theirs.target));
            let (Some(&source), Some(&target)) = ends else { continue };
            let number = seen.entry((source, target)).or_default();
            let mut alike =
                self.iac.transitions.iter_mut().filter(|own| (own.source, own.target) == (source, target));
            match alike.nth(*number) {
                Some(own) => self.diagnostics.extend(copy_refinement(theirs, own)),
                None => {
                    let name = self.iac.usual_name(source, target);
                    self.iac.transitions.push(IacTransition { source, target, name, ..theirs.clone() });
                }
            }
            *number += 1;
        }
    }
}

/// The transitions of a protocol into and out of a part.
struct BoundaryTransitions<'a> {
    rule: Option<&'a IacTransition>,
    exits: Vec<&'a IacTransition>,
}

impl<'a> BoundaryTransitions<'a> {
    fn of(eac: &'a Iac, participant: usize) -> BoundaryTransitions<'a> {
        let (source, target) =
            (|it: &IacTransition| it.source == participant, |it: &IacTransition| it.target == participant);
        let rule = eac.transitions.iter().find(|it| target(it) && !source(it) && !it.te.is_empty());
        let exits = eac.transitions.iter().filter(|it| source(it) && !target(it)).collect();
        BoundaryTransitions { rule, exits }
    }

    /// Whether the part has to be enclosed: the role repeats it without anything between, or comes
    /// to it from a composite, which a guarded transition would leave before it has completed.
    fn need_enclosure(&self, role: &Iac, index: usize) -> bool {
        let mut into = role.transitions.iter().filter(|it| it.target == index && !it.refinement.internal);
        let is_composite = |node: usize| matches!(role.nodes[node].kind.as_str(), "OR" | "AND");
        let has_outcomes = self.exits.iter().any(|exit| has_content(exit));
        into.any(|transition| match transition.source == index {
            true => self.rule.is_some() || has_outcomes,
            false => {
                self.rule.is_some()
                    && is_composite(transition.source)
                    && !is_inside(role, transition.source, index)
            }
        })
    }
}

/// Whether a node lies in another.
fn is_inside(chart: &Iac, node: usize, outer: usize) -> bool {
    std::iter::successors(chart.nodes[node].parent, |&node| chart.nodes[node].parent)
        .any(|node| node == outer)
}

/// Encloses a composite in one of its own, with START and END, which takes its place: the chart of
/// `(part)`. Returns where the part is then.
fn enclose(chart: &mut Iac, part: usize) -> usize {
    let first = chart.nodes.len();
    let [around, start, end] = [first, first + 1, first + 2];
    let mut children = chart.children();
    if let Some(siblings) = chart.nodes[part].parent.and_then(|parent| children.get_mut(parent)) {
        siblings.iter_mut().filter(|child| **child == part).for_each(|child| *child = around);
    }
    children.extend([vec![start, part, end], Vec::new(), Vec::new()]);
    let name = encode(&format!("({})", chart.nodes[part].written()));
    let node = |name: &str, kind: &str, parent| IacNode {
        name: name.into(),
        kind: kind.into(),
        parent,
        ..IacNode::default()
    };
    let (parent, frame) = (chart.nodes[part].parent, std::mem::take(&mut chart.nodes[part].frame));
    chart.nodes.push(IacNode { frame, ..node(&name, "OR", parent) });
    chart.nodes.extend(["START", "END"].map(|kind| node("", kind, Some(around))));
    chart.nodes[part].parent = Some(around);
    for index in 0..chart.transitions.len() {
        let IacTransition { source, target, .. } = chart.transitions[index];
        let is_at_border = !chart.transitions[index].refinement.internal;
        let (leaves, enters) = (source == part, target == part);
        if (leaves || enters) && chart.transitions[index].name == chart.usual_name(source, target) {
            chart.transitions[index].name.clear(); // to be named again by its new ends
        }
        if leaves && is_at_border && !is_inside(chart, target, part) {
            chart.transitions[index].source = around;
        }
        if enters && is_at_border && !is_inside(chart, source, part) {
            chart.transitions[index].target = around;
        }
    }
    for (source, target) in [(start, part), (part, end)] {
        chart.transitions.push(IacTransition { source, target, ..IacTransition::default() });
    }
    let indices = chart.arrange(&children);
    chart.relabel(indices[around]);
    indices[part]
}

/// An expression with another guard beside its own, and with the other's trigger and actions where
/// it has none; none if one of the two cannot be read.
fn with_guard(own: &str, other: &str) -> Option<String> {
    let read = |text: &str| {
        let (expression, findings) = parse_transition(text);
        (!findings.iter().any(Diagnostic::is_error)).then_some(expression)
    };
    let (mut expression, other) = (read(own)?, read(other)?);
    expression.guard = match (expression.guard, other.guard) {
        (Some(own), Some(other)) => {
            let missing: Vec<String> =
                conjuncts(&other).into_iter().filter(|part| !conjuncts(&own).contains(part)).collect();
            let missing = missing.iter().map(|part| format!(" && ({part})"));
            read(&format!("[({own}){}]", missing.collect::<String>()))?.guard
        }
        (own, other) => own.or(other),
    };
    expression.trigger = expression.trigger.or(other.trigger);
    let added = other.actions.into_iter().filter(|action| !expression.actions.contains(action));
    let added: Vec<Action> = added.collect();
    expression.actions.extend(added);
    Some(expression.to_string())
}

/// The conditions that all have to hold.
fn conjuncts(guard: &Expression) -> Vec<String> {
    match &guard.kind {
        ExpressionKind::And(parts) => parts.iter().flat_map(conjuncts).collect(),
        _ => vec![guard.to_string()],
    }
}

/// Whether a transition has more than its ends.
fn has_content(transition: &IacTransition) -> bool {
    !transition.te.is_empty() || transition.refinement != crate::iac::TransitionRefinement::default()
}

/// The protocol holds wherever it says something.
fn copy_refinement(theirs: &IacTransition, own: &mut IacTransition) -> Option<Diagnostic> {
    if !has_content(theirs) {
        return None;
    }
    let differs = has_content(own) && (&own.te, &own.refinement) != (&theirs.te, &theirs.refinement);
    let found = differs.then(|| {
        let message =
            format!("`{}` was on `{}` of the role; the protocol has `{}`", own.te, own.name, theirs.te);
        Diagnostic::warning("E0836", own.position.0, message)
    });
    (own.te, own.refinement) = (theirs.te.clone(), theirs.refinement.clone());
    found
}

/// The minimum similarity of two composites.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShapeMatch {
    /// The same.
    Same,
    /// The second may refine activities of the first into several steps.
    Refined,
}

/// The corresponding node for each node of a composite, starting with the composites themselves, or
/// the first two nodes that differ.
pub fn same_shape(
    eac: &Iac,
    participant: usize,
    iac: &Iac,
    position: usize,
    wanted: ShapeMatch,
) -> Result<BTreeMap<usize, usize>, (String, String)> {
    let (theirs, own) = (eac.children(), iac.children());
    let mut pairs = BTreeMap::new();
    let mut open = vec![(participant, position)];
    while let Some((a, b)) = open.pop() {
        pairs.insert(a, b);
        let longest = theirs[a].len().max(own[b].len());
        for index in 0..longest {
            match (theirs[a].get(index), own[b].get(index)) {
                (Some(&a), Some(&b)) if node_content(eac, a) == node_content(iac, b) => open.push((a, b)),
                (Some(&a), Some(&b)) if wanted == ShapeMatch::Refined && is_refined(eac, a, iac, b) => {
                    pairs.insert(a, b);
                }
                (a, b) => {
                    let shown = |chart: &Iac, node: Option<&usize>| {
                        node.map_or("nothing".into(), |&node| node_content(chart, node))
                    };
                    return Err((shown(eac, a), shown(iac, b)));
                }
            }
        }
    }
    Ok(pairs)
}

/// Whether an activity of one chart is a composite of that name in another.
fn is_refined(eac: &Iac, a: usize, iac: &Iac, b: usize) -> bool {
    let (theirs, own) = (&eac.nodes[a], &iac.nodes[b]);
    theirs.name == own.name && theirs.kind == "BASIC" && matches!(own.kind.as_str(), "OR" | "AND")
}

/// The content of a node except its label.
fn node_content(chart: &Iac, node: usize) -> String {
    let node = &chart.nodes[node];
    if node.name == node.label { node.kind.clone() } else { format!("{} {}", node.written(), node.kind) }
}
