//! M15: transitions that wait for the completion of a composite that never completes.

use std::collections::BTreeSet;

use yase::{Diagnostic, NodeId, NodeKind, TransitionId};

use crate::checked_model::CheckedModel;

/// Transitions whose source never completes, and their findings.
pub(crate) fn check(subject: &CheckedModel) -> Vec<(TransitionId, Diagnostic)> {
    let completes = completes(subject);
    let in_vain = |&id: &TransitionId| {
        let source = subject.transition(id).source;
        let transition = subject.transition(id);
        let goes_on = is_forever(subject, source) && transition.source == transition.target;
        waits(subject, id) && !completes[source.0 as usize] && !goes_on && !is_generated_exit(subject, id)
    };
    let waiting = subject.chart.transitions().map(|(id, _)| id).filter(in_vain);
    waiting
        .map(|id| {
            let source = subject.path(subject.transition(id).source);
            let message = format!("`{}` waits for `{source}`, which never completes", subject.arrow(id));
            let hint = "write `[false]` if it is meant to run forever; otherwise add a guard or an event";
            (id, subject.warn_of("M15", id, message).with_hint(hint))
        })
        .collect()
}

/// Whether a transition requires the completion of its source.
pub(crate) fn waits(subject: &CheckedModel, id: TransitionId) -> bool {
    let transition = subject.transition(id);
    let expression = &transition.expression;
    let is_composite = matches!(subject.kind(transition.source), NodeKind::Or | NodeKind::And);
    let for_completion = expression.guard.is_none() || transition.source == transition.target;
    is_composite && expression.trigger.is_none() && !expression.is_never() && for_completion
}

/// Whether a composite is the translation of `x~`. It repeats forever, and its exit exists only
/// because the enclosing formula continues.
pub(crate) fn is_forever(subject: &CheckedModel, node: NodeId) -> bool {
    let children = subject.chart.children(node);
    let has_end = children.iter().any(|&child| subject.kind(child) == NodeKind::End);
    subject.kind(node) == NodeKind::Or && !has_end && subject.chart.node(node).name.ends_with('~')
}

/// Whether a transition to an END is only there since the rest of a formula has one: the formulas
/// generate it, and nothing is written of it.
fn is_generated_exit(subject: &CheckedModel, id: TransitionId) -> bool {
    let transition = subject.transition(id);
    let is_of_formula = subject.liveness.is_some() || is_forever(subject, transition.source);
    transition.expression.is_empty() && subject.kind(transition.target) == NodeKind::End && is_of_formula
}

/// The generated exits of composites that never complete.
pub(crate) fn never_taken(subject: &CheckedModel) -> Vec<TransitionId> {
    let completes = completes(subject);
    let is_meant = |&id: &TransitionId| {
        let source = subject.transition(id).source;
        waits(subject, id) && !completes[source.0 as usize] && is_generated_exit(subject, id)
    };
    subject.chart.transitions().map(|(id, _)| id).filter(is_meant).collect()
}

/// Whether each node can complete, by what its transitions lead to, whatever their guards say.
fn completes(subject: &CheckedModel) -> Vec<bool> {
    completion(subject).0
}

/// The same, with the number of examined nodes.
///
/// Whether a composite completes depends on what is inside it. Nodes precede their children, so
/// that in reverse order one pass finds all; the second one confirms it.
fn completion(subject: &CheckedModel) -> (Vec<bool>, usize) {
    let mut completes: Vec<bool> =
        subject.chart.nodes().map(|(_, node)| node.kind == NodeKind::Basic).collect();
    let (mut examined, mut has_changed) = (0, true);
    while std::mem::take(&mut has_changed) {
        for index in (0..completes.len()).rev().filter(|&index| !completes[index]).collect::<Vec<_>>() {
            examined += 1;
            if can_now(subject, &completes, NodeId(index as u32)) {
                (completes[index], has_changed) = (true, true);
            }
        }
    }
    (completes, examined)
}

/// Whether a composite can complete, given the nodes known to complete.
fn can_now(subject: &CheckedModel, completes: &[bool], node: NodeId) -> bool {
    let children = subject.chart.children(node);
    match subject.kind(node) {
        NodeKind::And => {
            children.iter().all(|&child| !subject.is_state(child) || completes[child.0 as usize])
        }
        NodeKind::Or => reaches_end(subject, completes, node),
        _ => false,
    }
}

fn reaches_end(subject: &CheckedModel, completes: &[bool], composite: NodeId) -> bool {
    let starts =
        subject.chart.children(composite).iter().filter(|&&child| subject.kind(child) == NodeKind::Start);
    let mut open: Vec<NodeId> = starts.copied().collect();
    let mut seen = BTreeSet::new();
    while let Some(node) = open.pop() {
        if !seen.insert(node) {
            continue;
        }
        let inside = subject.contains(composite, node) && node != composite;
        if inside && subject.kind(node) == NodeKind::End && subject.chart.node(node).parent == Some(composite)
        {
            return true;
        }
        // states inside the target may leave it by their own transitions
        open.extend(subject.chart.children(node));
        // if an external transition enters a node, such as a HISTORY, the nodes around it may be
        // left too
        let around = subject.chart.node(node).parent.filter(|&parent| inside && parent != composite);
        open.extend(around);
        let leaving = subject.outgoing(node).iter().filter(|&&id| can_leave(subject, completes, id));
        open.extend(
            leaving
                .map(|&id| subject.transition(id).target)
                .filter(|&target| subject.contains(composite, target)),
        );
    }
    false
}

fn can_leave(subject: &CheckedModel, completes: &[bool], id: TransitionId) -> bool {
    let transition = subject.transition(id);
    let expression = &transition.expression;
    let waits = expression.trigger.is_none()
        && (expression.guard.is_none() || transition.source == transition.target);
    let is_ready = !subject.is_state(transition.source) || completes[transition.source.0 as usize];
    !expression.is_never() && (!waits || is_ready)
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;

    #[test]
    fn nested_composites_are_examined_twice_however_deep_they_are() {
        let mut role = String::from("Role: r\nLiveness:\nr = (a1)\n");
        (1..100).for_each(|level| writeln!(role, "a{level} = A{level} . a{}", level + 1).unwrap());
        role.push_str("a100 = A100\n");
        let subject = crate::checked_model::subject_of(&yase::Source::new("r.srm", &role)).unwrap();
        let (completes, examined) = completion(&subject);
        let composites =
            subject.chart.nodes().filter(|(_, node)| node.kind == NodeKind::Or).map(|(id, _)| id);
        let composites: Vec<NodeId> = composites.collect();
        assert!(composites.len() >= 99 && composites.iter().all(|&id| completes[id.0 as usize]));
        assert!(examined <= 2 * subject.chart.nodes().len(), "{examined} examined");
    }
}
