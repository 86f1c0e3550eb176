//! Checks of the tree of states and of the transitions in it: M01 to M04, M06, M20 and M23.

use std::collections::BTreeSet;

use yase::{Diagnostic, NodeId, NodeKind, Semantics, Statechart, TransitionId};

use crate::checked_model::CheckedModel;

/// The structural findings. After a structural error no other check is run.
pub(crate) fn check(subject: &CheckedModel) -> Vec<Diagnostic> {
    let elements = subject.chart.check_elements(&subject.semantics).into_iter();
    // what may have no open way is judged by what the guards say
    let errors = elements.filter(|(diagnostic, _)| diagnostic.is_error());
    let located = |(diagnostic, about): (Diagnostic, _)| {
        let hint = diagnostic.hint.clone().or_else(|| usual_hint(diagnostic.code).map(String::from));
        Diagnostic { span: subject.spans.element(about), hint, ..diagnostic }
    };
    let mut found: Vec<Diagnostic> = errors.map(located).collect();
    if found.is_empty() {
        found.extend(subject.chart.nodes().filter_map(|(id, _)| sink(subject, id)));
        found.extend(subject.chart.nodes().filter_map(|(id, _)| history(subject, id)));
        found.extend(subject.chart.transitions().filter_map(|(id, _)| sibling_region(subject, id)));
        found.extend(subject.chart.nodes().flat_map(|(id, _)| drawn(subject, id)));
    }
    found
}

/// A hint for codes whose finding has none.
fn usual_hint(code: &str) -> Option<&'static str> {
    Some(match code {
        "M01" => "a composite has a START that leads to a state inside it",
        "M02" => "START has only outgoing transitions, END only incoming ones",
        "M03" => "lead to a state, from a state that can be active when it is not",
        "M04" => "a FORK leads into several regions of one AND, a JOIN out of them",
        "M06" => "each path through connectors leads to a state",
        "M23" => "weights are shares, and sum to 1",
        _ => return None,
    })
}

/// M02: a state without an exit, inside composites that are never left either.
fn sink(subject: &CheckedModel, id: NodeId) -> Option<Diagnostic> {
    let parent = subject.chart.node(id).parent?;
    let around = subject.chart.ancestors(id).filter(|&it| it != Statechart::ROOT);
    let stays = std::iter::once(id).chain(around).all(|it| subject.outgoing(it).is_empty());
    let is_sink = subject.is_state(id) && subject.kind(parent) == NodeKind::Or && stays;
    // a composite that holds states continues inside
    let is_leaf = subject.chart.children(id).is_empty();
    (is_sink && is_leaf).then(|| {
        let message = format!("no transition leads out of `{}`, which is not an END", subject.path(id));
        subject
            .warn("M02", id, message)
            .with_hint("add a transition to END, or an exit with an event or a guard")
    })
}

/// M03: a transition between two regions of one AND.
fn sibling_region(subject: &CheckedModel, id: TransitionId) -> Option<Diagnostic> {
    let transition = subject.transition(id);
    let is_way = |node| subject.is_state(node) || subject.kind(node) == NodeKind::End;
    if !is_way(transition.source) || !is_way(transition.target) {
        return None;
    }
    let (and, ..) = subject.apart(transition.source, transition.target)?;
    let message =
        format!("`{}` leads from one region of `{}` into another", subject.arrow(id), subject.path(and));
    let found = subject.warn_of("M03", id, message);
    let hint = "regions are active together: raise an event for the other one, or leave the AND";
    // in SCXML such a transition exits and re-enters the AND
    let severity = if is_scxml(subject) { found.severity } else { yase::Severity::Error };
    Some(Diagnostic { severity, ..found }.with_hint(hint))
}

fn is_scxml(subject: &CheckedModel) -> bool {
    subject.semantics == Semantics::scxml()
}

/// M20: a HISTORY without a default that can be reached before its composite was active.
fn history(subject: &CheckedModel, id: NodeId) -> Option<Diagnostic> {
    let owner = subject.chart.node(id).parent?;
    let is_history = matches!(subject.kind(id), NodeKind::ShallowHistory | NodeKind::DeepHistory);
    // the `history` entry of a role defines the default
    if !is_history || subject.liveness.is_some() || !subject.outgoing(id).is_empty() {
        return None;
    }
    let before = reached_without(subject, owner);
    let first = subject
        .incoming(id)
        .iter()
        .find(|&&transition| before.contains(&subject.transition(transition).source))?;
    let source = subject.path(subject.transition(*first).source);
    let message = format!(
        "`{}` has no default, and `{source}` may lead to it before `{}` has been active",
        subject.path(id),
        subject.path(owner)
    );
    let hint = "add a transition from the HISTORY to a default state; without one it uses START";
    Some(subject.warn("M20", id, message).with_hint(hint))
}

/// The nodes that can be active before a composite has been active, with guards ignored.
fn reached_without(subject: &CheckedModel, avoided: NodeId) -> BTreeSet<NodeId> {
    let mut reached = BTreeSet::from([Statechart::ROOT]);
    let mut open = vec![Statechart::ROOT];
    while let Some(node) = open.pop() {
        let inside: Vec<NodeId> = match subject.kind(node) {
            NodeKind::And => subject.chart.children(node).to_vec(),
            _ => {
                let starts = |&child: &NodeId| subject.kind(child) == NodeKind::Start;
                subject.chart.children(node).iter().copied().filter(starts).collect()
            }
        };
        let targets = subject.outgoing(node).iter().map(|&id| subject.transition(id).target);
        // entering a state also activates the states around it
        let around = |target: NodeId| {
            std::iter::once(target).chain(subject.chart.ancestors(target)).collect::<Vec<_>>()
        };
        for next in inside.into_iter().chain(targets.flat_map(around)) {
            if !subject.contains(avoided, next) && reached.insert(next) {
                open.push(next);
            }
        }
    }
    reached
}

/// M23: alternatives with weights that also have an order.
fn drawn(subject: &CheckedModel, id: NodeId) -> Vec<Diagnostic> {
    let drawn = subject
        .outgoing(id)
        .iter()
        .copied()
        .filter(|&transition| subject.transition(transition).weight.is_some());
    let drawn: Vec<TransitionId> = drawn.collect();
    let Some(&first) = drawn.first() else { return Vec::new() };
    let highest = subject.transition(first).priority;
    let lower = drawn.into_iter().filter(|&id| subject.transition(id).priority != highest);
    lower
        .map(|id| {
            let message = format!(
                "`{}` has a weight like `{}`, but has another priority",
                subject.arrow(id),
                subject.arrow(first)
            );
            let found =
                subject.warn_of("M23", id, message).with_hint("give them the same priority, or no weights");
            Diagnostic { severity: yase::Severity::Error, ..found }
        })
        .collect()
}
