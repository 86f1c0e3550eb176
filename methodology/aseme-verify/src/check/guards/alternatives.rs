//! Overlap of the guards of transitions from one node: M07, M08 and, across regions, M10.

use std::collections::{BTreeMap, BTreeSet};

use yase::expression::Trigger;
use yase::{Diagnostic, NodeId, NodeKind, TransitionId};

use super::GuardCheck;
use crate::check_settings::CheckedParts;
use crate::logic::Claim;

/// Nodes with more outgoing transitions than this have only neighbouring ones compared.
const MAX_PAIRWISE_TRANSITIONS: usize = 64;

/// The most conflicts of one transition with other regions that are reported.
const MAX_CONFLICTS: usize = 3;

impl GuardCheck<'_> {
    /// M07 and M08.
    pub(crate) fn alternatives(&self, node: NodeId) -> Vec<Diagnostic> {
        if matches!(self.subject.kind(node), NodeKind::Fork | NodeKind::Join) {
            return Vec::new();
        }
        let never = |id: &TransitionId| self.subject.transition(*id).expression.is_never();
        let possible = self.subject.outgoing(node).iter().copied().filter(|id| !never(id));
        let transitions: Vec<TransitionId> = possible.collect();
        let mut found = Vec::new();
        for (index, &later) in transitions.iter().enumerate() {
            let earlier = &transitions[index.saturating_sub(MAX_PAIRWISE_TRANSITIONS)..index];
            match self.shadowed_transition(earlier, later) {
                Some(shadowed) => found.push(shadowed),
                None => found.extend(earlier.iter().filter_map(|&first| self.overlap(first, later))),
            }
        }
        found
    }

    /// M07: a transition that is never taken, because earlier ones are enabled whenever it is.
    fn shadowed_transition(&self, earlier: &[TransitionId], later: TransitionId) -> Option<Diagnostic> {
        if self.subject.transition(later).weight.is_some() || self.is_dead(later) {
            return None;
        }
        let before: Vec<TransitionId> =
            earlier.iter().copied().filter(|&first| self.comes_before(first, later)).collect();
        let alone = before.iter().copied().find(|&first| self.is_covered(&[first], later));
        let (who, hint) = match alone {
            Some(first) if self.guard(first).is_none() => {
                let hint = "give the first a guard, or one of the two an event or a priority";
                (format!("`{}`, which has no guard,", self.subject.arrow(first)), hint)
            }
            Some(first) => {
                (format!("`{}`", self.subject.arrow(first)), "its guard holds whenever this one's does")
            }
            None if before.len() > 1 && self.is_covered(&before, later) => {
                (String::from("an earlier transition"), "their guards together hold whenever this one's does")
            }
            None => return None,
        };
        let message = format!("`{}` is never taken: {who} always precedes it", self.subject.arrow(later));
        Some(Diagnostic::warning("M07", self.subject.spans.guard(later), message).with_hint(hint))
    }

    fn is_dead(&self, id: TransitionId) -> bool {
        self.guard(id).is_some_and(|guard| self.logic.together(&[Claim::Holds(guard)]).is_no())
    }

    /// Whether a transition is tried before another whenever that one is enabled, and leads to a
    /// state.
    fn comes_before(&self, first: TransitionId, later: TransitionId) -> bool {
        let (one, other) = (self.subject.transition(first), self.subject.transition(later));
        let interrupts = one.interrupts || !other.interrupts;
        let occasion = subsumes(one.expression.trigger.as_ref(), other.expression.trigger.as_ref());
        one.weight.is_none()
            && interrupts
            && occasion
            && (one.expression.trigger.is_some()
                || self.source_requirement(first) <= self.source_requirement(later))
            && self.goes_on(one.target)
    }

    /// The requirement of a transition without a trigger on its source: 0 nothing, 1 that nothing
    /// inside can step, 2 that it has completed.
    fn source_requirement(&self, id: TransitionId) -> u8 {
        let transition = self.subject.transition(id);
        match self.subject.kind(transition.source) {
            NodeKind::Or | NodeKind::And => {
                let leaves = transition.expression.guard.is_some() && transition.source != transition.target;
                if leaves { 1 } else { 2 }
            }
            _ => 0,
        }
    }

    /// Whether one of the earlier guards holds whenever the later one does.
    fn is_covered(&self, earlier: &[TransitionId], later: TransitionId) -> bool {
        let claims =
            earlier.iter().map(|&id| self.guard(id).map(Claim::DoesNotHold)).collect::<Option<Vec<_>>>();
        // a transition without a guard is always enabled
        let Some(mut claims) = claims else { return true };
        claims.extend(self.guard(later).map(Claim::Holds));
        self.logic.together(&claims).is_no()
    }

    /// M08: both can be enabled at once, and neither has a declared priority.
    fn overlap(&self, first: TransitionId, later: TransitionId) -> Option<Diagnostic> {
        let (one, other) = (self.subject.transition(first), self.subject.transition(later));
        let is_decided = one.priority != other.priority || one.weight.is_some() || other.weight.is_some();
        let alike = self.source_requirement(first) == self.source_requirement(later);
        // both have the same effect
        let is_same = (one.target, one.interrupts, one.internal, &one.expression.actions)
            == (other.target, other.interrupts, other.internal, &other.expression.actions);
        if is_same
            || is_decided
            || !alike
            || !triggers_overlap(one.expression.trigger.as_ref(), other.expression.trigger.as_ref())
        {
            return None;
        }
        let claims = [Claim::Holds(self.guard(first)?), Claim::Holds(self.guard(later)?)];
        let crate::logic::Satisfiability::Yes(example) = self.logic.together(&claims) else {
            return None;
        };
        let (one, other) = (self.subject.arrow(first), self.subject.arrow(later));
        let message = format!("`{one}` and `{other}` may both be enabled: where {example}");
        let hint = "the first is used; give them priorities, or guards that exclude each other";
        Some(Diagnostic::warning("M08", self.subject.spans.guard(later), message).with_hint(hint))
    }

    /// M10: an event on which one region leaves the AND while another would stay.
    pub(crate) fn conflicting_regions(&self, parts: &CheckedParts<'_>) -> Vec<Diagnostic> {
        let with_trigger = |id: &TransitionId| self.subject.trigger(*id).is_some();
        let waiting: Vec<TransitionId> =
            self.subject.chart.transitions().map(|(id, _)| id).filter(with_trigger).collect();
        // those that may meet: of the same event, or of whatever comes
        let mut by_event: BTreeMap<String, Vec<TransitionId>> = BTreeMap::new();
        let mut of_any: Vec<TransitionId> = Vec::new();
        for &id in &waiting {
            match self.subject.trigger(id).and_then(names) {
                Some(names) => names.into_iter().for_each(|name| by_event.entry(name).or_default().push(id)),
                None => of_any.push(id),
            }
        }
        let mut found = Vec::new();
        for &leaving in waiting.iter().filter(|&&id| self.leaves_and(id)) {
            if !parts.go_on_after(0) {
                break;
            }
            let others: BTreeSet<TransitionId> = match self.subject.trigger(leaving).and_then(names) {
                Some(names) => names
                    .iter()
                    .filter_map(|name| by_event.get(name))
                    .flatten()
                    .chain(&of_any)
                    .copied()
                    .collect(),
                None => waiting.iter().copied().collect(),
            };
            let others = others.into_iter().filter(|&other| other != leaving);
            found.extend(
                others.filter_map(|staying| self.conflicting_pair(leaving, staying)).take(MAX_CONFLICTS),
            );
        }
        found
    }

    /// Whether a transition leaves an AND around its source.
    fn leaves_and(&self, id: TransitionId) -> bool {
        let transition = self.subject.transition(id);
        let mut around = self.subject.chart.ancestors(transition.source);
        around
            .any(|it| self.subject.kind(it) == NodeKind::And && !self.subject.contains(it, transition.target))
    }

    fn conflicting_pair(&self, leaving: TransitionId, staying: TransitionId) -> Option<Diagnostic> {
        let (one, other) = (self.subject.transition(leaving), self.subject.transition(staying));
        let (and, _, region) = self.subject.apart(one.source, other.source)?;
        let leaves = !self.subject.contains(and, one.target) && !one.internal;
        let stays = self.subject.contains(region, other.target) && !other.internal;
        let meets = triggers_overlap(one.expression.trigger.as_ref(), other.expression.trigger.as_ref());
        let guards: Vec<Claim<'_>> =
            [leaving, staying].into_iter().filter_map(|id| self.guard(id)).map(Claim::Holds).collect();
        if !(leaves && stays && meets && self.logic.together(&guards).is_yes()) {
            return None;
        }
        let winner = if one.source < other.source { leaving } else { staying };
        let message = format!(
            "on the same event `{}` leaves `{}` and `{}` stays in it: `{}` wins",
            self.subject.arrow(leaving),
            self.subject.path(and),
            self.subject.arrow(staying),
            self.subject.arrow(winner)
        );
        let hint = "the one whose source comes first in the model is taken, the other is not; use different events, or guards";
        Some(Diagnostic::warning("M10", self.subject.spans.transition(leaving), message).with_hint(hint))
    }
}

fn names(trigger: &Trigger) -> Option<BTreeSet<String>> {
    match trigger {
        Trigger::OneOf(events) => Some(events.iter().map(yase::expression::Path::text).collect()),
        _ => None,
    }
}

/// Whether a trigger matches every event that another matches.
fn subsumes(first: Option<&Trigger>, later: Option<&Trigger>) -> bool {
    match (first, later) {
        (None, None) | (Some(Trigger::Any), Some(_)) => true,
        (Some(Trigger::Not(event)), Some(Trigger::Not(other))) => event == other,
        (Some(Trigger::Not(event)), Some(later)) => {
            names(later).is_some_and(|names| !names.contains(&event.text()))
        }
        (Some(first), Some(later)) => {
            matches!((names(first), names(later)), (Some(first), Some(later)) if later.is_subset(&first))
        }
        _ => false,
    }
}

/// Whether an event exists that both triggers match.
fn triggers_overlap(one: Option<&Trigger>, other: Option<&Trigger>) -> bool {
    match (one, other) {
        (None, None) => true,
        (None, _) | (_, None) => false,
        (Some(one), Some(other)) => match (one, other) {
            (Trigger::OneOf(_), Trigger::OneOf(_)) => {
                matches!((names(one), names(other)), (Some(one), Some(other)) if !one.is_disjoint(&other))
            }
            (Trigger::Not(event), several @ Trigger::OneOf(_))
            | (several @ Trigger::OneOf(_), Trigger::Not(event)) => {
                names(several).is_some_and(|names| names.iter().any(|name| *name != event.text()))
            }
            _ => true,
        },
    }
}
