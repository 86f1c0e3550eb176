//! M25: constructs that UML or SCXML interpret differently from the thesis. Each is reported once,
//! at its first occurrence.

use yase::{Diagnostic, NodeId, NodeKind, Semantics, Severity, Span};

use crate::checked_model::CheckedModel;

pub(crate) fn check(subject: &CheckedModel) -> Vec<Diagnostic> {
    if subject.semantics != Semantics::yase() {
        // an SCXML document has the semantics of its own standard
        return Vec::new();
    }
    let constructs: [(&str, Vec<Span>); 6] = [
        (
            "a composite is left by a guard, complete or not: in UML only when it has just completed, in SCXML at any time",
            left_by_guard(subject),
        ),
        (
            "a START has a guard: UML and SCXML evaluate it before the actions that lead into the composite",
            guarded_starts(subject),
        ),
        (
            "a transition without a guard precedes one with a guard but is tried after it: UML and SCXML use the order of the model",
            unguarded_first(subject),
        ),
        (
            "a transition targets a state around its source, which is exited and entered again: in UML that state completes",
            to_ancestor(subject),
        ),
        (
            "a JOIN exits its sources together: in UML each is exited when it arrives",
            of_kind(subject, NodeKind::Join),
        ),
        ("a state defers events: SCXML has no deferral", deferring(subject)),
    ];
    let constructs = constructs.into_iter().filter_map(|(says, spans)| {
        let first = *spans.first()?;
        let found = Diagnostic::warning("M25", first, says);
        let found = Diagnostic { severity: Severity::Information, ..found };
        Some(match spans.len() {
            1 => found,
            count => found.with_hint(format!("{count} occurrences")),
        })
    });
    constructs.collect()
}

fn transitions(subject: &CheckedModel, is_meant: impl Fn(yase::TransitionId) -> bool) -> Vec<Span> {
    let meant = subject.chart.transitions().map(|(id, _)| id).filter(|&id| is_meant(id));
    meant.map(|id| subject.spans.transition(id)).collect()
}

fn nodes(subject: &CheckedModel, is_meant: impl Fn(NodeId) -> bool) -> Vec<Span> {
    subject
        .chart
        .nodes()
        .map(|(id, _)| id)
        .filter(|&id| is_meant(id))
        .map(|id| subject.spans.node(id))
        .collect()
}

fn left_by_guard(subject: &CheckedModel) -> Vec<Span> {
    transitions(subject, |id| {
        let transition = subject.transition(id);
        let expression = &transition.expression;
        let is_composite = matches!(subject.kind(transition.source), NodeKind::Or | NodeKind::And);
        let is_guarded = expression.trigger.is_none() && expression.guard.is_some() && !expression.is_never();
        is_composite && is_guarded && transition.source != transition.target
    })
}

fn guarded_starts(subject: &CheckedModel) -> Vec<Span> {
    transitions(subject, |id| {
        let transition = subject.transition(id);
        subject.kind(transition.source) == NodeKind::Start && transition.expression.guard.is_some()
    })
}

fn unguarded_first(subject: &CheckedModel) -> Vec<Span> {
    transitions(subject, |id| {
        let transition = subject.transition(id);
        let is_overtaken_by = |other: yase::TransitionId| {
            let later = subject.transition(other);
            let expression = &later.expression;
            other > id
                && expression.guard.is_some()
                && !expression.is_never()
                && later.priority == transition.priority
                && expression.trigger == transition.expression.trigger
        };
        let beside = subject.outgoing(transition.source);
        transition.expression.guard.is_none() && beside.iter().any(|&other| is_overtaken_by(other))
    })
}

fn to_ancestor(subject: &CheckedModel) -> Vec<Span> {
    transitions(subject, |id| {
        let transition = subject.transition(id);
        let is_inner = transition.source != transition.target && !transition.internal;
        is_inner && subject.contains(transition.target, transition.source)
    })
}

fn of_kind(subject: &CheckedModel, kind: NodeKind) -> Vec<Span> {
    nodes(subject, |id| subject.kind(id) == kind)
}

fn deferring(subject: &CheckedModel) -> Vec<Span> {
    nodes(subject, |id| !subject.chart.node(id).defer.is_empty())
}
