//! Refinements: what a role says about the transitions and states of the chart that its formulas make.
//!
//! An entry names its transition or state by [`Path`]s, never by label, so it stays in force when the formula is edited, for
//! as long as its paths name exactly one. One that no longer does is handed back with its text and what it might have meant; nothing is
//! dropped silently. An entry with a wildcard is for all that it names and that no entry without wildcard names. An entry with `also` is no word about
//! the transition that it names: it adds another one beside it, after all others, in the order of the entries.

mod layout;

use std::collections::{BTreeMap, BTreeSet};

use yase::diagnostic::nearest;
use yase::{Diagnostic, NodeId, NodeKind, Span, Statechart, Transition, TransitionId};

use crate::path::{self, Path};
use crate::srm::{StateEntry, TransitionEntry};

pub(crate) use layout::place_among_twins;
pub use layout::refine_layout;

/// An entry that could not be applied.
#[derive(Clone, PartialEq, Debug)]
pub struct Unmatched {
    /// The entry as it was written, on one line.
    pub text: String,
    /// What it may have meant, each in a form that would fit.
    pub candidates: Vec<String>,
    /// The same, said to a person.
    pub diagnostic: Diagnostic,
}

/// How many candidates are named.
const CANDIDATES: usize = 5;

/// Gives the transitions of a chart what the entries say of them; entries that do not fit are returned, in order.
pub fn refine(chart: &mut Statechart, entries: &[TransitionEntry]) -> Vec<Unmatched> {
    refine_placed(chart, entries).1
}

/// The same, with the number of the entry that each transition was given.
pub(crate) fn refine_placed(
    chart: &mut Statechart,
    entries: &[TransitionEntry],
) -> (BTreeMap<TransitionId, usize>, Vec<Unmatched>) {
    let (besides, own): (Vec<usize>, Vec<usize>) = (0..entries.len()).partition(|&index| entries[index].also);
    let wishes: Vec<Wish<TransitionId>> =
        own.iter().map(|&index| transitions_of(chart, &entries[index])).collect();
    let (chosen, mut unmatched) = settle(&wishes, |id| path::shortest_transition(chart, *id));
    let mut chosen: BTreeMap<TransitionId, usize> =
        chosen.into_iter().map(|(id, wish)| (id, own[wish])).collect();
    for (&id, &index) in &chosen {
        entries[index].apply(chart, id);
    }
    for index in besides {
        match beside(chart, &entries[index]) {
            Ok(added) => chosen.extend(added.into_iter().map(|id| (id, index))),
            Err(misfit) => unmatched.push(*misfit),
        }
    }
    unmatched.sort_by_key(|unmatched| unmatched.diagnostic.span);
    (chosen, unmatched)
}

/// Adds what an entry says beside each transition that it names.
fn beside(chart: &mut Statechart, entry: &TransitionEntry) -> Result<Vec<TransitionId>, Box<Unmatched>> {
    let wish = transitions_of(chart, entry);
    if wish.fits_not() {
        return Err(Box::new(misfit(&wish, |id| path::shortest_transition(chart, *id))));
    }
    let add = |id: TransitionId| {
        let Transition { source, target, .. } = *chart.transition(id);
        let added = chart.connect(Transition::new(source, target));
        entry.apply(chart, added);
        added
    };
    Ok(wish.named.into_iter().map(add).collect())
}

/// Gives the states of a chart what the entries say of them; entries that do not fit are returned, in order.
pub fn refine_states(chart: &mut Statechart, entries: &[StateEntry]) -> Vec<Unmatched> {
    let wishes: Vec<Wish<NodeId>> = entries.iter().map(|entry| states_of(chart, entry)).collect();
    let (chosen, mut unmatched) = settle(&wishes, |id| path::shortest_path(chart, *id));
    for (id, index) in chosen {
        let misfit: Option<fn(&Wish<'_, NodeId>, String) -> Unmatched> = match chart.node(id).kind {
            NodeKind::Basic | NodeKind::End if entries[index].history.is_some() => Some(childless),
            NodeKind::Basic => None,
            _ => entries[index].is_about_activity().then_some(composite),
        };
        match misfit {
            Some(misfit) => unmatched.push(misfit(&wishes[index], path::shortest_path(chart, id))),
            None => entries[index].apply(chart, id),
        }
    }
    unmatched.sort_by_key(|unmatched| unmatched.diagnostic.span);
    unmatched
}

/// What one entry names.
struct Wish<'a, Id> {
    text: &'a str,
    span: Span,
    thing: &'static str,
    has_wildcard: bool,
    named: Vec<Id>,
    /// What it may have meant, should it name nothing.
    near: Vec<String>,
}

impl<Id> Wish<'_, Id> {
    /// Whether it names nothing, or several things without a wildcard.
    fn fits_not(&self) -> bool {
        self.named.is_empty() || self.named.len() > 1 && !self.has_wildcard
    }
}

fn transitions_of<'a>(chart: &Statechart, entry: &'a TransitionEntry) -> Wish<'a, TransitionId> {
    // of several between the same two ends the first is the formula's, the others stand beside it
    let mut ends = BTreeSet::new();
    let is_first = |id: &TransitionId| {
        let Transition { source, target, .. } = *chart.transition(*id);
        ends.insert((source, target))
    };
    let named: Vec<TransitionId> =
        path::transitions(chart, &entry.source, &entry.target).filter(is_first).collect();
    let near = if named.is_empty() { near_ways(chart, &entry.source, &entry.target) } else { Vec::new() };
    let has_wildcard = entry.has_wildcard();
    Wish { text: &entry.text, span: entry.span, thing: "transition", has_wildcard, named, near }
}

fn states_of<'a>(chart: &Statechart, entry: &'a StateEntry) -> Wish<'a, NodeId> {
    let is_state = |kind| matches!(kind, NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End);
    let states = chart.nodes().filter(|(_, node)| is_state(node.kind)).map(|(id, _)| id);
    let named: Vec<NodeId> = states.filter(|&id| entry.path.matches(chart, id)).collect();
    let near = if named.is_empty() { near_names(chart, &entry.path).collect() } else { Vec::new() };
    Wish {
        text: &entry.text,
        span: entry.span,
        thing: "state",
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

/// If a name is misspelt, the right one; else the transitions that share the source, then those that share the target.
fn near_ways(chart: &Statechart, source: &Path, target: &Path) -> Vec<String> {
    let names: Vec<String> = near_names(chart, source).chain(near_names(chart, target)).collect();
    if !names.is_empty() {
        return names;
    }
    let sharing_source =
        chart.transitions().filter(|(_, transition)| source.matches(chart, transition.source));
    let sharing_target =
        chart.transitions().filter(|(_, transition)| target.matches(chart, transition.target));
    let near = sharing_source.chain(sharing_target).map(|(id, _)| path::shortest_transition(chart, id));
    near.take(CANDIDATES).collect()
}

/// Which entry is for which thing, and which entries are for none, in order.
fn settle<Id: Copy + Ord>(
    wishes: &[Wish<'_, Id>],
    text_of: impl Fn(&Id) -> String,
) -> (BTreeMap<Id, usize>, Vec<Unmatched>) {
    let mut chosen = BTreeMap::new();
    let mut unmatched = BTreeMap::new();
    let (wild, plain): (Vec<usize>, Vec<usize>) =
        (0..wishes.len()).partition(|&index| wishes[index].has_wildcard);
    for index in plain.into_iter().chain(wild) {
        let wish = &wishes[index];
        if wish.fits_not() {
            unmatched.insert(index, misfit(wish, &text_of));
            continue;
        }
        for id in &wish.named {
            let earlier: usize = *chosen.entry(*id).or_insert(index);
            if earlier != index && wishes[earlier].has_wildcard == wish.has_wildcard {
                unmatched.entry(index).or_insert_with(|| again(wish, &wishes[earlier], &text_of(id)));
            }
        }
    }
    (chosen, unmatched.into_values().collect())
}

/// An entry that names nothing, or several things without a wildcard.
fn misfit<Id>(wish: &Wish<'_, Id>, text_of: impl Fn(&Id) -> String) -> Unmatched {
    let (code, number, candidates) = match wish.named.len() {
        0 => ("E0250", "no", wish.near.clone()),
        _ => ("E0251", "more than one", wish.named.iter().take(CANDIDATES).map(text_of).collect()),
    };
    let message = format!("`{}` names {number} {} of the chart", wish.text, wish.thing);
    let diagnostic = Diagnostic::error(code, wish.span, message);
    let diagnostic = match hint(&candidates) {
        Some(hint) => diagnostic.with_hint(hint),
        None => diagnostic,
    };
    Unmatched { text: wish.text.into(), candidates, diagnostic }
}

fn hint(candidates: &[String]) -> Option<String> {
    let mut quoted: Vec<String> = Vec::new();
    for candidate in candidates.iter().map(|candidate| format!("`{candidate}`")) {
        // A loop's two ends are near the same name.
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

/// An entry for something that another one is for already.
fn again<Id>(wish: &Wish<'_, Id>, earlier: &Wish<'_, Id>, named: &str) -> Unmatched {
    let message = format!("`{}` is for `{named}`, as `{}` is", wish.text, earlier.text);
    let diagnostic = Diagnostic::error("E0252", wish.span, message).with_hint("keep one of the two");
    Unmatched { text: wish.text.into(), candidates: vec![named.into()], diagnostic }
}

/// An entry that gives an activity, or what belongs to one, to a state that is made of others.
fn composite(wish: &Wish<'_, NodeId>, named: String) -> Unmatched {
    let message = format!("`{named}` consists of other states and runs no activity of its own");
    let diagnostic = Diagnostic::error("E0253", wish.span, message);
    let diagnostic =
        diagnostic.with_hint("activity, priority and duration belong to states without children");
    Unmatched { text: wish.text.into(), candidates: vec![named], diagnostic }
}

/// An entry that has a state remember what was active inside, where there is nothing inside.
fn childless(wish: &Wish<'_, NodeId>, named: String) -> Unmatched {
    let message = format!("`{named}` has no states inside that it could remember");
    let diagnostic = Diagnostic::error("E0254", wish.span, message);
    let diagnostic = diagnostic.with_hint("history belongs to composites");
    Unmatched { text: wish.text.into(), candidates: vec![named], diagnostic }
}
