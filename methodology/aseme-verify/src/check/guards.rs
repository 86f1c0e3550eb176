//! Checks of guards by [`logic`](crate::logic): M01 for a START that may be blocked, M05 to M10.

mod alternatives;
mod connectors;

use yase::expression::Expression;
use yase::{Diagnostic, TransitionId};

use crate::check_settings::CheckedParts;
use crate::checked_model::CheckedModel;
use crate::logic::GuardSolver;

pub(crate) fn check(subject: &CheckedModel, parts: &CheckedParts<'_>) -> Vec<Diagnostic> {
    let guards = GuardCheck { subject, logic: GuardSolver::new(&subject.chart.constants) };
    let mut found = Vec::new();
    for (id, _) in subject.chart.transitions() {
        if !parts.go_on_after(1) {
            return found;
        }
        found.extend(guards.never_or_always(id));
    }
    for (id, _) in subject.chart.nodes() {
        if !parts.go_on_after(1) {
            return found;
        }
        found.extend(guards.cases_left_open(id));
        found.extend(guards.dead_paths(id));
        found.extend(guards.alternatives(id));
    }
    found.extend(guards.conflicting_regions(parts));
    found
}

/// The checks of the guards of a chart.
struct GuardCheck<'a> {
    subject: &'a CheckedModel,
    logic: GuardSolver<'a>,
}

impl<'a> GuardCheck<'a> {
    fn guard(&self, id: TransitionId) -> Option<&'a Expression> {
        self.subject.transition(id).expression.guard.as_ref()
    }

    /// M09. Literal `true` and `false` are intended and not reported.
    fn never_or_always(&self, id: TransitionId) -> Option<Diagnostic> {
        use crate::logic::Claim::{Holds, IsFalse};
        let guard = self.guard(id)?;
        if matches!(guard.kind, yase::expression::ExpressionKind::Bool(_)) {
            return None;
        }
        let (says, hint) = if self.logic.together(&[Holds(guard)]).is_no() {
            ("can never hold", "write `[false]` if the transition is never to be taken")
        } else if self.logic.together(&[IsFalse(guard)]).is_no() {
            ("always holds when its messages have arrived", "remove or correct it")
        } else {
            return None;
        };
        let message = format!("the guard of `{}` {says}", self.subject.arrow(id));
        Some(Diagnostic::warning("M09", self.subject.spans.guard(id), message).with_hint(hint))
    }
}
