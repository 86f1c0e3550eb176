//! A participant of a protocol: inside a player's chart, and alone.

use std::collections::{BTreeMap, BTreeSet};

use yase::NodeId;

use super::{BoundaryTransitions, Conformance, guard, names};
use crate::diagnostic_names::DiagnosticNames;
use crate::logic::GuardSolver;
use aseme_models::iac::{Iac, IacTransition};
use aseme_models::transformations::{ShapeMatch, same_shape};

/// Whether a node is another or lies inside it.
pub(crate) fn is_inside(chart: &Iac, node: usize, outer: usize) -> bool {
    let mut ancestors = std::iter::successors(Some(node), |&node| chart.nodes.get(node)?.parent);
    ancestors.any(|node| node == outer)
}

/// Checks the CONDITIONs inside a part: optional activities need a guard, and at most one branch of
/// a choice may lack one.
pub(crate) fn guarded(chart: &Iac, part: usize, found: &mut Conformance) {
    let conditions = (0..chart.nodes.len())
        .filter(|&node| chart.nodes[node].kind == "CONDITION" && is_inside(chart, node, part));
    let names = names(chart);
    for condition in conditions {
        let transitions: Vec<&IacTransition> =
            chart.transitions.iter().filter(|it| it.source == condition).collect();
        let ends = |transition: &&&IacTransition| chart.nodes[transition.target].kind == "END";
        let may_be_left_out = transitions.iter().any(|transition| ends(&transition));
        let open: Vec<&&IacTransition> = transitions
            .iter()
            .filter(|transition| !ends(transition) && guard(transition).is_none())
            .collect();
        let spared = if may_be_left_out { 0 } else { 1 };
        for transition in open.iter().skip(spared) {
            let name = names.name(NodeId(transition.target as u32));
            let message = format!("`{name}` is always executed: its transition has no guard");
            let hint = "add a guard";
            found.report("E0866", transition.position.0, message, hint);
        }
    }
}

/// Checks that a player's composite equals the part of a protocol's chart: states, transitions,
/// engaging rules and exits.
pub(crate) fn contained(player: &Iac, index: usize, eac: &Iac, part: usize, found: &mut Conformance) {
    let name = &eac.nodes[part].name;
    let pairs = match same_shape(eac, part, player, index, ShapeMatch::Refined) {
        Ok(pairs) => pairs,
        Err((wanted, there)) => {
            let message = format!("`{name}` differs from the protocol: {there} instead of {wanted}");
            let hint = "copy the formula of the participant";
            return found.report("E0862", player.nodes[index].position.0, message, hint);
        }
    };
    inside(player, eac, &pairs, found);
    let (own, theirs) = (BoundaryTransitions::of(player, index), BoundaryTransitions::of(eac, part));
    for rule in theirs.into.iter().filter_map(|transition| guard(transition)) {
        own.engaged_by(player, name, &rule, found);
    }
    let outcomes: Vec<_> = theirs.out.iter().filter_map(|transition| guard(transition)).collect();
    for outcome in &outcomes {
        own.has_exit(player, name, outcome, found);
    }
    let logic = GuardSolver::new(&player.constants);
    for transition in &own.out {
        let is_exit = |guard: &yase::expression::Expression| {
            matches!(guard.kind, yase::expression::ExpressionKind::Bool(false))
                || outcomes.iter().any(|outcome| logic.implies(guard, outcome))
        };
        if let Some(guard) = guard(transition).filter(|guard| !is_exit(guard)) {
            let message = format!("`{name}` is left when `{guard}`, which is not an outcome of the protocol");
            found.report("E0865", transition.position.0, message, "make it an outcome, or remove the exit");
        }
    }
}

/// Checks that the transitions inside both parts are equal.
fn inside(player: &Iac, eac: &Iac, pairs: &BTreeMap<usize, usize>, found: &mut Conformance) {
    let own: BTreeSet<usize> = pairs.values().copied().collect();
    let is_top = |node: usize| player.nodes[node].parent.is_none_or(|parent| !own.contains(&parent));
    let mut there: Vec<&IacTransition> =
        player.transitions.iter().filter(|it| own.contains(&it.source) && own.contains(&it.target)).collect();
    let (own_names, their_names) = (names(player), names(eac));
    let words = |it: &IacTransition| yase::expression::parse_transition(&it.te).0.to_string();
    for theirs in &eac.transitions {
        let (Some(&source), Some(&target)) = (pairs.get(&theirs.source), pairs.get(&theirs.target)) else {
            continue;
        };
        let same = there.iter().position(|it| {
            (it.source, it.target) == (source, target)
                && words(it) == words(theirs)
                && it.refinement == theirs.refinement
        });
        match same {
            Some(same) => drop(there.remove(same)),
            None => {
                let message =
                    format!("the protocol has `{}`, but the player does not", written(&their_names, theirs));
                found.report(
                    "E0867",
                    player.nodes[source].position.0,
                    message,
                    "merge the protocol's chart again",
                );
            }
        }
    }
    // one from the part to itself is a way into it
    for more in there.into_iter().filter(|it| !(it.source == it.target && is_top(it.source))) {
        let message = format!("the player has `{}`, but the protocol does not", written(&own_names, more));
        found.report("E0867", more.position.0, message, "merge the protocol's chart again");
    }
}

/// A transition with the names of its nodes.
fn written(names: &DiagnosticNames, transition: &IacTransition) -> String {
    let name = |node: usize| names.name(NodeId(node as u32));
    let ends = format!("{} -> {}", name(transition.source), name(transition.target));
    match transition.te.trim() {
        "" => ends,
        expression => format!("{ends} : {expression}"),
    }
}

/// The player's part as a chart of its own. Activities of the protocol remain activities, even if
/// the player refines them into several steps.
pub(crate) fn alone(player: &Iac, index: usize, eac: &Iac, part: usize) -> Iac {
    let pairs = same_shape(eac, part, player, index, ShapeMatch::Refined).unwrap_or_default();
    let own: BTreeMap<usize, usize> = pairs.iter().map(|(&theirs, &own)| (own, theirs)).collect();
    let indices: BTreeMap<usize, usize> = own.keys().enumerate().map(|(new, &old)| (old, new)).collect();
    let nodes = own.iter().map(|(&old, &theirs)| {
        let mut node = player.nodes[old].clone();
        node.kind.clone_from(&eac.nodes[theirs].kind);
        node.parent = node.parent.and_then(|parent| indices.get(&parent).copied());
        node.variables.clear();
        node
    });
    let transitions = player.transitions.iter().filter_map(|it| {
        let (source, target) = (*indices.get(&it.source)?, *indices.get(&it.target)?);
        Some(IacTransition { source, target, ..it.clone() })
    });
    let (name, constants) = (player.nodes[index].name.clone(), player.constants.clone());
    Iac { name, constants, nodes: nodes.collect(), transitions: transitions.collect(), ..Iac::default() }
}
