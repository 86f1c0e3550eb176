//! Refinement of a chart: applies the entries of a role to the transitions and states generated
//! from its formulas.
//!
//! An entry refers to its transition or state by [`Path`]s, never by label, so it stays valid when
//! the formula is edited, as long as its paths match exactly one element. An entry that does not is
//! returned as [`UnmatchedEntry`] with its text and likely candidates; none is dropped. An entry
//! with a wildcard applies to everything it matches that no entry without wildcard refers to. An
//! entry with `also` adds a transition parallel to the one it refers to, after all others, in the
//! order of the entries.

mod layout;

use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};

use yase::diagnostic::nearest;
use yase::{Diagnostic, NodeId, NodeKind, Span, Statechart, Transition, TransitionId};

use crate::path::{self, Path, PathIndex};
use crate::srm::{StateEntry, TransitionEntry};

pub use layout::{index_among_twins, refine_layout};

/// An entry that matches no element, or too many.
#[derive(Clone, PartialEq, Debug)]
pub struct UnmatchedEntry {
    /// The entry as it was written, on one line.
    pub text: String,
    /// Likely candidates, each in a form that would match.
    pub candidates: Vec<String>,
    /// The same as a diagnostic.
    pub diagnostic: Diagnostic,
}

/// Limit of candidates.
const MAX_CANDIDATES: usize = 5;

/// Applies entries to the transitions of a chart; entries that do not match are returned, in order.
pub fn refine(chart: &mut Statechart, entries: &[TransitionEntry]) -> Vec<UnmatchedEntry> {
    refine_placed(chart, entries).1
}

/// The same, with the index of the entry applied to each transition.
pub fn refine_placed(
    chart: &mut Statechart,
    entries: &[TransitionEntry],
) -> (BTreeMap<TransitionId, usize>, Vec<UnmatchedEntry>) {
    let (besides, own): (Vec<usize>, Vec<usize>) = (0..entries.len()).partition(|&index| entries[index].also);
    let plain = chart.clone();
    let lookup = Lookup::new(&plain);
    let targets: Vec<RefinementTarget<TransitionId>> =
        own.iter().map(|&index| transitions_of(&lookup, &entries[index])).collect();
    let (chosen, mut unmatched) = assign_entries(&targets, |id| lookup.transition_text(*id));
    let mut chosen: BTreeMap<TransitionId, usize> =
        chosen.into_iter().map(|(id, target)| (id, own[target])).collect();
    for (&id, &index) in &chosen {
        entries[index].apply(chart, id);
    }
    for index in besides {
        match apply_to_transitions(chart, &lookup, &entries[index]) {
            Ok(added) => chosen.extend(added.into_iter().map(|id| (id, index))),
            Err(misfit) => unmatched.push(*misfit),
        }
    }
    unmatched.sort_by_key(|unmatched| unmatched.diagnostic.span);
    (chosen, unmatched)
}

/// Adds a transition parallel to each one that an entry refers to.
fn apply_to_transitions(
    chart: &mut Statechart,
    lookup: &Lookup<'_>,
    entry: &TransitionEntry,
) -> Result<Vec<TransitionId>, Box<UnmatchedEntry>> {
    let target = transitions_of(lookup, entry);
    if target.is_ambiguous_or_unmatched() {
        return Err(Box::new(unmatched_entry(&target, |id| lookup.transition_text(*id))));
    }
    let add = |id: TransitionId| {
        let Transition { source, target, .. } = *chart.transition(id);
        let added = chart.connect(Transition::new(source, target));
        entry.apply(chart, added);
        added
    };
    Ok(target.named.into_iter().map(add).collect())
}

/// Applies entries to the states of a chart; entries that do not match are returned, in order.
pub fn refine_states(chart: &mut Statechart, entries: &[StateEntry]) -> Vec<UnmatchedEntry> {
    let plain = chart.clone();
    let lookup = Lookup::new(&plain);
    let targets: Vec<RefinementTarget<NodeId>> =
        entries.iter().map(|entry| states_of(&lookup, entry)).collect();
    let (chosen, mut unmatched) = assign_entries(&targets, |id| lookup.node_text(*id));
    for (id, index) in chosen {
        let misfit: Option<fn(&RefinementTarget<'_, NodeId>, String) -> UnmatchedEntry> =
            match chart.node(id).kind {
                NodeKind::Basic | NodeKind::End if entries[index].history.is_some() => Some(childless),
                NodeKind::Basic => None,
                _ => entries[index].is_about_activity().then_some(composite),
            };
        match misfit {
            Some(misfit) => unmatched.push(misfit(&targets[index], path::shortest_path(chart, id))),
            None => entries[index].apply(chart, id),
        }
    }
    unmatched.sort_by_key(|unmatched| unmatched.diagnostic.span);
    unmatched
}

/// The number of names that are compared for hints about unmatched entries.
const MAX_COMPARISONS: usize = 1_000_000;

/// A chart in which entries are looked up.
struct Lookup<'a> {
    chart: &'a Statechart,
    index: PathIndex<'a>,
    /// The comparisons that are left.
    left: Cell<usize>,
}

impl<'a> Lookup<'a> {
    fn new(chart: &'a Statechart) -> Lookup<'a> {
        let left = Cell::new(MAX_COMPARISONS / chart.nodes().len().max(1));
        Lookup { chart, index: PathIndex::new(chart), left }
    }

    /// Whether one more comparison with the whole chart is made.
    fn may_compare(&self) -> bool {
        let left = self.left.get();
        self.left.set(left.saturating_sub(1));
        left > 0
    }

    fn transition_text(&self, id: TransitionId) -> String {
        if self.may_compare() {
            return path::shortest_transition(self.chart, id);
        }
        let Transition { source, target, .. } = *self.chart.transition(id);
        format!("{} -> {}", self.chart.path(source), self.chart.path(target))
    }

    fn node_text(&self, id: NodeId) -> String {
        if self.may_compare() { path::shortest_path(self.chart, id) } else { self.chart.path(id) }
    }
}

/// The element that an entry names.
struct RefinementTarget<'a, Id> {
    text: &'a str,
    span: Span,
    kind: &'static str,
    has_wildcard: bool,
    named: Vec<Id>,
    /// Suggestions if it matches nothing.
    near: Vec<String>,
}

impl<Id> RefinementTarget<'_, Id> {
    /// Whether it matches nothing, or several elements without a wildcard.
    fn is_ambiguous_or_unmatched(&self) -> bool {
        self.named.is_empty() || self.named.len() > 1 && !self.has_wildcard
    }
}

fn transitions_of<'a>(lookup: &Lookup<'_>, entry: &'a TransitionEntry) -> RefinementTarget<'a, TransitionId> {
    let chart = lookup.chart;
    // of several between the same two ends the first is the formula's, the others stand beside it
    let mut ends = BTreeSet::new();
    let is_first = |id: &TransitionId| {
        let Transition { source, target, .. } = *chart.transition(*id);
        ends.insert((source, target))
    };
    let named: Vec<TransitionId> =
        lookup.index.transitions(&entry.source, &entry.target).into_iter().filter(is_first).collect();
    let near = match named.is_empty() && lookup.may_compare() {
        true => similar_transitions(chart, &entry.source, &entry.target),
        false => Vec::new(),
    };
    let has_wildcard = entry.has_wildcard();
    RefinementTarget { text: &entry.text, span: entry.span, kind: "transition", has_wildcard, named, near }
}

fn states_of<'a>(lookup: &Lookup<'_>, entry: &'a StateEntry) -> RefinementTarget<'a, NodeId> {
    let chart = lookup.chart;
    let is_state = |kind| matches!(kind, NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End);
    let mut named = lookup.index.nodes(&entry.path);
    named.retain(|&id| is_state(chart.node(id).kind));
    let near = if named.is_empty() && lookup.may_compare() {
        near_names(chart, &entry.path).collect()
    } else {
        Vec::new()
    };
    RefinementTarget {
        text: &entry.text,
        span: entry.span,
        kind: "state",
        has_wildcard: entry.path.has_wildcard(),
        named,
        near,
    }
}

/// The names nearest to those in a path that the chart does not have.
fn near_names<'a>(chart: &'a Statechart, path: &'a Path) -> impl Iterator<Item = String> + 'a {
    let names = || chart.nodes().map(|(_, node)| node.name.as_str()).filter(|name| !name.is_empty());
    path.unknown_names(chart).filter_map(move |name| nearest(name, names())).map(String::from)
}

/// Corrections of misspelt names, otherwise the transitions with the same source, then those with
/// the same target.
fn similar_transitions(chart: &Statechart, source: &Path, target: &Path) -> Vec<String> {
    let names: Vec<String> = near_names(chart, source).chain(near_names(chart, target)).collect();
    if !names.is_empty() {
        return names;
    }
    let sharing_source =
        chart.transitions().filter(|(_, transition)| source.matches(chart, transition.source));
    let sharing_target =
        chart.transitions().filter(|(_, transition)| target.matches(chart, transition.target));
    let near = sharing_source.chain(sharing_target).map(|(id, _)| path::shortest_transition(chart, id));
    near.take(MAX_CANDIDATES).collect()
}

/// Assigns entries to elements. Also returns the unmatched entries, in order.
fn assign_entries<Id: Copy + Ord>(
    targets: &[RefinementTarget<'_, Id>],
    text_of: impl Fn(&Id) -> String,
) -> (BTreeMap<Id, usize>, Vec<UnmatchedEntry>) {
    let mut chosen = BTreeMap::new();
    let mut unmatched = BTreeMap::new();
    let (wild, plain): (Vec<usize>, Vec<usize>) =
        (0..targets.len()).partition(|&index| targets[index].has_wildcard);
    for index in plain.into_iter().chain(wild) {
        let target = &targets[index];
        if target.is_ambiguous_or_unmatched() {
            unmatched.insert(index, unmatched_entry(target, &text_of));
            continue;
        }
        for id in &target.named {
            let earlier: usize = *chosen.entry(*id).or_insert(index);
            if earlier != index && targets[earlier].has_wildcard == target.has_wildcard {
                unmatched
                    .entry(index)
                    .or_insert_with(|| duplicate_entry(target, &targets[earlier], &text_of(id)));
            }
        }
    }
    (chosen, unmatched.into_values().collect())
}

/// The report for an entry that matches nothing, or several elements without a wildcard.
fn unmatched_entry<Id>(target: &RefinementTarget<'_, Id>, text_of: impl Fn(&Id) -> String) -> UnmatchedEntry {
    let (code, number, candidates) = match target.named.len() {
        0 => ("E0250", "no", target.near.clone()),
        _ => ("E0251", "more than one", target.named.iter().take(MAX_CANDIDATES).map(text_of).collect()),
    };
    let message = format!("`{}` names {number} {} of the chart", target.text, target.kind);
    let diagnostic = Diagnostic::error(code, target.span, message);
    let diagnostic = match hint(&candidates) {
        Some(hint) => diagnostic.with_hint(hint),
        None => diagnostic,
    };
    UnmatchedEntry { text: target.text.into(), candidates, diagnostic }
}

fn hint(candidates: &[String]) -> Option<String> {
    let mut quoted: Vec<String> = Vec::new();
    for candidate in candidates.iter().map(|candidate| format!("`{candidate}`")) {
        // Both ends of a loop are similar to the same name.
        if !quoted.contains(&candidate) {
            quoted.push(candidate);
        }
    }
    match quoted.as_slice() {
        [] => None,
        [one] => Some(format!("did you mean {one}?")),
        several => Some(format!("did you mean one of {}?", several.join(", "))),
    }
}

/// The report for an entry whose element already has one.
fn duplicate_entry<Id>(
    target: &RefinementTarget<'_, Id>,
    earlier: &RefinementTarget<'_, Id>,
    named: &str,
) -> UnmatchedEntry {
    let message = format!("`{}` and `{}` both refer to `{named}`", target.text, earlier.text);
    let diagnostic = Diagnostic::error("E0252", target.span, message).with_hint("keep one of the two");
    UnmatchedEntry { text: target.text.into(), candidates: vec![named.into()], diagnostic }
}

/// The report for an entry that sets an activity, or an attribute of one, on a composite.
fn composite(target: &RefinementTarget<'_, NodeId>, named: String) -> UnmatchedEntry {
    let message = format!("`{named}` consists of other states and runs no activity of its own");
    let diagnostic = Diagnostic::error("E0253", target.span, message);
    let diagnostic =
        diagnostic.with_hint("activity, priority and duration belong to states without children");
    UnmatchedEntry { text: target.text.into(), candidates: vec![named], diagnostic }
}

/// The report for an entry that sets a history on a state without children.
fn childless(target: &RefinementTarget<'_, NodeId>, named: String) -> UnmatchedEntry {
    let message = format!("`{named}` has no states inside");
    let diagnostic = Diagnostic::error("E0254", target.span, message);
    let diagnostic = diagnostic.with_hint("history belongs to composites");
    UnmatchedEntry { text: target.text.into(), candidates: vec![named], diagnostic }
}
