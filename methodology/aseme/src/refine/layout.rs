//! Refinement of layouts.

use std::collections::BTreeMap;

use yase::statechart::Frame;
use yase::{NodeId, Statechart, Transition, TransitionId};

use super::{Lookup, RefinementTarget, UnmatchedEntry, assign_entries, near_names, similar_transitions};
use crate::path::Path;
use crate::srm::{LayoutEntry, LayoutTarget};

/// Applies layout entries to a chart; entries that do not match are returned, in order. Parallel
/// transitions exist already, history connectors do not.
pub fn refine_layout(chart: &mut Statechart, entries: &[LayoutEntry]) -> Vec<UnmatchedEntry> {
    let mut unmatched = states(chart, entries);
    unmatched.extend(transitions(chart, entries));
    unmatched.sort_by_key(|unmatched| unmatched.diagnostic.span);
    unmatched
}

fn states(chart: &mut Statechart, entries: &[LayoutEntry]) -> Vec<UnmatchedEntry> {
    let plain = chart.clone();
    let lookup = Lookup::new(&plain);
    let of_states: Vec<(RefinementTarget<'_, NodeId>, Frame)> = entries
        .iter()
        .filter_map(|entry| match &entry.of {
            LayoutTarget::State(path) => Some((node_wish(&lookup, path, entry), entry.frame)),
            LayoutTarget::Transition { .. } => None,
        })
        .collect();
    let (targets, frames): (Vec<_>, Vec<_>) = of_states.into_iter().unzip();
    let (chosen, unmatched) = assign_entries(&targets, |id| lookup.node_text(*id));
    for (id, index) in chosen {
        chart.layout.frames.insert(id, frames[index]);
    }
    unmatched
}

fn node_wish<'a>(lookup: &Lookup<'_>, path: &Path, entry: &'a LayoutEntry) -> RefinementTarget<'a, NodeId> {
    let named = lookup.index.nodes(path);
    let near = match named.is_empty() && lookup.may_compare() {
        true => near_names(lookup.chart, path).collect(),
        false => Vec::new(),
    };
    RefinementTarget {
        text: &entry.text,
        span: entry.span,
        kind: "state",
        has_wildcard: path.has_wildcard(),
        named,
        near,
    }
}

fn transitions(chart: &mut Statechart, entries: &[LayoutEntry]) -> Vec<UnmatchedEntry> {
    let plain = chart.clone();
    let lookup = Lookup::new(&plain);
    let twins = indices_among_twins(&plain);
    let of_transitions: Vec<(RefinementTarget<'_, TransitionId>, &LayoutEntry)> = entries
        .iter()
        .filter_map(|entry| match &entry.of {
            LayoutTarget::Transition { source, target, parallel: beside } => {
                Some((transition_wish(&lookup, &twins, (source, target), *beside, entry), entry))
            }
            LayoutTarget::State(_) => None,
        })
        .collect();
    let (targets, entries): (Vec<_>, Vec<_>) = of_transitions.into_iter().unzip();
    let (chosen, unmatched) = assign_entries(&targets, |id| lookup.transition_text(*id));
    for (id, index) in chosen {
        chart.layout.bends.insert(id, entries[index].bends.clone());
    }
    unmatched
}

/// The transition with this index among those with the same ends.
fn transition_wish<'a>(
    lookup: &Lookup<'_>,
    twins: &[usize],
    (source, target): (&Path, &Path),
    beside: usize,
    entry: &'a LayoutEntry,
) -> RefinementTarget<'a, TransitionId> {
    let mut named = lookup.index.transitions(source, target);
    named.retain(|id| twins[id.0 as usize] == beside);
    let near = match named.is_empty() && lookup.may_compare() {
        true => similar_transitions(lookup.chart, source, target),
        false => Vec::new(),
    };
    let has_wildcard = source.has_wildcard() || target.has_wildcard();
    RefinementTarget { text: &entry.text, span: entry.span, kind: "transition", has_wildcard, named, near }
}

/// The index of a transition among those with the same ends.
pub fn index_among_twins(chart: &Statechart, id: TransitionId) -> usize {
    let Transition { source, target, .. } = *chart.transition(id);
    let before = chart.transitions().take(id.0 as usize);
    before.filter(|(_, other)| (other.source, other.target) == (source, target)).count()
}

/// The same for all transitions.
fn indices_among_twins(chart: &Statechart) -> Vec<usize> {
    let mut counts: BTreeMap<(NodeId, NodeId), usize> = BTreeMap::new();
    let index = |transition: &Transition| {
        let count = counts.entry((transition.source, transition.target)).or_default();
        *count += 1;
        *count - 1
    };
    chart.transitions().map(|(_, transition)| transition).map(index).collect()
}
