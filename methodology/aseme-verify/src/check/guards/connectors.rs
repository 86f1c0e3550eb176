//! Guards on paths through connectors: uncovered cases (M01, M05), and paths that are never enabled
//! (M06).

use yase::expression::Expression;
use yase::{Diagnostic, NodeId, NodeKind, Severity, TransitionId};

use super::GuardCheck;
use crate::logic::{Claim, Satisfiability};

/// Limit on the segments of a path through connectors.
const MAX_PATH_LENGTH: usize = 16;

/// Limit on the nodes from which a path must continue.
const MAX_OPEN_NODES: usize = 256;

/// Limit on the paths out of one node that are compared; beyond it the check says so.
const MAX_COMPARED_PATHS: usize = 4096;

impl GuardCheck<'_> {
    /// M05 for a branch, M01 for a START: no outgoing guard covers some cases.
    ///
    /// A START with one guarded exit waits there on purpose.
    pub(crate) fn cases_left_open(&self, node: NodeId) -> Option<Diagnostic> {
        let kind = self.subject.kind(node);
        let code = match kind {
            NodeKind::Condition | NodeKind::Junction | NodeKind::Choice => "M05",
            NodeKind::Start if self.subject.outgoing(node).len() > 1 => "M01",
            _ => return None,
        };
        let example = match self.open_cases(node)? {
            Some(example) => format!(": there {example}"),
            None => String::new(),
        };
        let name = self.subject.path(node);
        let message = format!("the guards out of `{name}` leave cases uncovered{example}");
        let found = self.subject.warn(code, node, message);
        let severity = if kind == NodeKind::Choice { Severity::Error } else { found.severity };
        let found = Diagnostic { severity, ..found };
        Some(found.with_hint("remove the guard of one transition: it is then taken if no other is"))
    }

    /// An example of a case that no exit of a node covers. The inner option is `None` if no exit
    /// can be enabled at all.
    fn open_cases(&self, node: NodeId) -> Option<Option<String>> {
        let transitions = self.subject.outgoing(node);
        let guards: Vec<&Expression> = transitions.iter().filter_map(|&id| self.guard(id)).collect();
        let is_drawn = transitions.iter().any(|&id| self.subject.transition(id).weight.is_some());
        if transitions.is_empty() || guards.len() < transitions.len() || is_drawn {
            return None;
        }
        let claims: Vec<Claim<'_>> = guards.into_iter().map(Claim::IsFalse).collect();
        match self.logic.together(&claims) {
            Satisfiability::Yes(example) if example.values.is_empty() => Some(None),
            Satisfiability::Yes(example) => Some(Some(example.to_string())),
            _ => None,
        }
    }

    /// M06: a path through connectors whose guards contradict each other.
    pub(crate) fn dead_paths(&self, node: NodeId) -> Vec<Diagnostic> {
        let (mut found, mut looked) = (Vec::new(), 0);
        if self.is_static(node) {
            // a path that continues from here is analysed from its beginning
            return found;
        }
        let leads_on = |&id: &TransitionId| self.is_static(self.subject.transition(id).target);
        let segments = self.subject.outgoing(node).iter().copied();
        let mut open: Vec<Vec<TransitionId>> = segments.filter(leads_on).map(|id| vec![id]).collect();
        let mut is_cut = false;
        while let Some(transitions) = open.pop() {
            if looked == MAX_COMPARED_PATHS {
                is_cut = true;
                break;
            }
            looked += 1;
            let Some(&last) = transitions.last() else { continue };
            let target = self.subject.transition(last).target;
            if transitions.len() > 1 && self.contradict(&transitions) {
                found.push(self.dead_path(&transitions));
                continue;
            }
            if !self.is_static(target) {
                continue;
            }
            // a last segment without a guard contradicts nothing, nor does the only guard
            let is_guarded = transitions.iter().any(|&id| self.guard(id).is_some());
            let matters = |id: &TransitionId| is_guarded && self.guard(*id).is_some() || leads_on(id);
            let mut segments = self.subject.outgoing(target).iter().copied().filter(matters);
            if transitions.len() < MAX_PATH_LENGTH && looked < MAX_COMPARED_PATHS {
                let left = MAX_COMPARED_PATHS - looked;
                open.extend(segments.by_ref().take(left).map(|id| [transitions.as_slice(), &[id]].concat()));
            }
            is_cut |= segments.next().is_some();
        }
        found.extend(is_cut.then(|| self.not_compared(node)));
        found
    }

    fn not_compared(&self, node: NodeId) -> Diagnostic {
        let message = format!(
            "not all paths through connectors out of `{}` are compared: contradictions beyond {MAX_COMPARED_PATHS} paths or {MAX_PATH_LENGTH} segments are not found",
            self.subject.path(node)
        );
        let found = Diagnostic::warning("M06", self.subject.spans.node(node), message);
        let hint = "make a CHOICE of a connector on the way: paths end there";
        Diagnostic { severity: Severity::Information, ..found }.with_hint(hint)
    }

    fn is_static(&self, node: NodeId) -> bool {
        matches!(
            self.subject.kind(node),
            NodeKind::Condition | NodeKind::Junction | NodeKind::EntryPoint | NodeKind::ExitPoint
        )
    }

    /// Whether the guards of several segments are contradictory although each guard is satisfiable.
    fn contradict(&self, transitions: &[TransitionId]) -> bool {
        let guards: Vec<&Expression> = transitions.iter().filter_map(|&id| self.guard(id)).collect();
        let alone = |guard: &&Expression| self.logic.together(&[Claim::Holds(guard)]).is_no();
        let claims: Vec<Claim<'_>> = guards.iter().map(|guard| Claim::Holds(guard)).collect();
        guards.len() > 1 && !guards.iter().any(alone) && self.logic.together(&claims).is_no()
    }

    fn dead_path(&self, transitions: &[TransitionId]) -> Diagnostic {
        let first = transitions
            .first()
            .map_or_else(String::new, |&id| self.subject.path(self.subject.transition(id).source));
        let last = transitions[transitions.len() - 1];
        let targets = transitions.iter().map(|&id| self.subject.path(self.subject.transition(id).target));
        let path = std::iter::once(first).chain(targets).collect::<Vec<_>>().join("` -> `");
        let message = format!("the path `{path}` is never enabled: its guards contradict each other");
        let hint = "all guards before a CHOICE are evaluated together; make the connector a CHOICE if an action precedes it";
        Diagnostic::error("M06", self.subject.spans.guard(last), message).with_hint(hint)
    }

    /// Whether a path that reaches a node always continues from it.
    pub(crate) fn goes_on(&self, node: NodeId) -> bool {
        let mut open = vec![node];
        let mut looked = 0;
        while let Some(node) = open.pop() {
            looked += 1;
            if self.subject.kind(node) == NodeKind::Join || looked > MAX_OPEN_NODES {
                return false;
            }
            if !self.is_static(node) {
                continue;
            }
            let unguarded = self.subject.outgoing(node).iter().find(|&&id| self.guard(id).is_none());
            let Some(&sure) = unguarded else { return self.cases_are_covered(node) };
            open.push(self.subject.transition(sure).target);
        }
        true
    }

    fn cases_are_covered(&self, node: NodeId) -> bool {
        let guards = self.subject.outgoing(node).iter().filter_map(|&id| self.guard(id));
        let claims: Vec<Claim<'_>> = guards.map(Claim::DoesNotHold).collect();
        let to_states = |&id: &TransitionId| !self.is_static(self.subject.transition(id).target);
        self.logic.together(&claims).is_no() && self.subject.outgoing(node).iter().all(to_states)
    }
}
