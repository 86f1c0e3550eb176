//! Refinement of layouts.

use yase::statechart::Frame;
use yase::{NodeId, Statechart, Transition, TransitionId};

use super::{RefinementTarget, UnmatchedEntry, assign_entries, near_names, similar_transitions};
use crate::path::{self, Path};
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
    let of_states: Vec<(RefinementTarget<'_, NodeId>, Frame)> = entries
        .iter()
        .filter_map(|entry| match &entry.of {
            LayoutTarget::State(path) => Some((node_wish(chart, path, entry), entry.frame)),
            LayoutTarget::Transition { .. } => None,
        })
        .collect();
    let (wishes, frames): (Vec<_>, Vec<_>) = of_states.into_iter().unzip();
    let (chosen, unmatched) = assign_entries(&wishes, |id| path::shortest_path(chart, *id));
    for (id, index) in chosen {
        chart.layout.frames.insert(id, frames[index]);
    }
    unmatched
}

fn node_wish<'a>(chart: &Statechart, path: &Path, entry: &'a LayoutEntry) -> RefinementTarget<'a, NodeId> {
    let named: Vec<NodeId> = chart.nodes().map(|(id, _)| id).filter(|&id| path.matches(chart, id)).collect();
    let near = if named.is_empty() { near_names(chart, path).collect() } else { Vec::new() };
    RefinementTarget {
        text: &entry.text,
        span: entry.span,
        thing: "state",
        has_wildcard: path.has_wildcard(),
        named,
        near,
    }
}

fn transitions(chart: &mut Statechart, entries: &[LayoutEntry]) -> Vec<UnmatchedEntry> {
    let of_transitions: Vec<(RefinementTarget<'_, TransitionId>, &LayoutEntry)> = entries
        .iter()
        .filter_map(|entry| match &entry.of {
            LayoutTarget::Transition { source, target, beside } => {
                Some((transition_wish(chart, (source, target), *beside, entry), entry))
            }
            LayoutTarget::State(_) => None,
        })
        .collect();
    let (wishes, entries): (Vec<_>, Vec<_>) = of_transitions.into_iter().unzip();
    let (chosen, unmatched) = assign_entries(&wishes, |id| path::shortest_transition(chart, *id));
    for (id, index) in chosen {
        chart.layout.bends.insert(id, entries[index].bends.clone());
    }
    unmatched
}

/// The transition with this index among those with the same ends.
fn transition_wish<'a>(
    chart: &Statechart,
    (source, target): (&Path, &Path),
    beside: usize,
    entry: &'a LayoutEntry,
) -> RefinementTarget<'a, TransitionId> {
    let is_it = |id: &TransitionId| place_among_twins(chart, *id) == beside;
    let named: Vec<TransitionId> = path::transitions(chart, source, target).filter(is_it).collect();
    let near = if named.is_empty() { similar_transitions(chart, source, target) } else { Vec::new() };
    let has_wildcard = source.has_wildcard() || target.has_wildcard();
    RefinementTarget { text: &entry.text, span: entry.span, thing: "transition", has_wildcard, named, near }
}

/// The index of a transition among those with the same ends.
pub fn place_among_twins(chart: &Statechart, id: TransitionId) -> usize {
    let Transition { source, target, .. } = *chart.transition(id);
    let before = chart.transitions().take(id.0 as usize);
    before.filter(|(_, other)| (other.source, other.target) == (source, target)).count()
}
