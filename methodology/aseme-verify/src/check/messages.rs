//! Checks of messages: names that the program does not have (M17, M21), regions that write and read
//! in one step (M11), guards on messages that may not have arrived (M18).
//!
//! [`ProgramSymbols`] lists the messages, functions and activities of the program, and the topics
//! that each activity publishes. For activities that declare no topics nothing is reported.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

use yase::diagnostic::Suggestions;
use yase::expression::{ActionKind, Path};
use yase::{Diagnostic, NodeId, NodeKind, Span, TransitionId};
use yase_explore::{Exploration, ExplorationProgress};

use crate::check_settings::CheckSettings;
use crate::checked_model::CheckedModel;
use crate::finding::Finding;
use crate::logic;
use crate::program_symbols::ProgramSymbols;

/// M17 and M21: names that the program does not have.
pub(crate) fn names(subject: &CheckedModel, world: &ProgramSymbols) -> Vec<Diagnostic> {
    let mut found = activities(subject, world);
    if let Err(wrong) = subject.chart.compile_with(&world.vocabulary, subject.semantics) {
        // Structural faults do not depend on the program: other checks report them.
        let is_about_names = |it: &Diagnostic| it.is_error() && it.code.starts_with("E01");
        let placed = PlacedTransitions::new(subject);
        found.extend(wrong.into_iter().filter(is_about_names).map(|diagnostic| unknown(&placed, diagnostic)));
    }
    found
}

/// An invalid expression as a finding, positioned in the file only where the file contains it
/// verbatim.
fn unknown(placed: &PlacedTransitions, diagnostic: Diagnostic) -> Diagnostic {
    let span = if placed.contain(diagnostic.span) { diagnostic.span } else { Span::default() };
    let hint = diagnostic
        .hint
        .clone()
        .or_else(|| Some("say what the program has, or link the crate that has it; `--unlinked` is for models of other programs".into()));
    Diagnostic { code: "M17", span, hint, ..diagnostic }
}

/// The spans of the transitions of a chart, by their first byte.
struct PlacedTransitions {
    /// The first byte of each span, and the last end of the spans up to it.
    ends: Vec<(usize, usize)>,
}

impl PlacedTransitions {
    fn new(subject: &CheckedModel) -> PlacedTransitions {
        let spans = subject.chart.transitions().map(|(id, _)| subject.spans.transition(id));
        let mut ends: Vec<(usize, usize)> =
            spans.filter(|span| span.end > span.start).map(|span| (span.start, span.end)).collect();
        ends.sort_unstable();
        let mut last = 0;
        for (_, end) in &mut ends {
            last = last.max(*end);
            *end = last;
        }
        PlacedTransitions { ends }
    }

    /// Whether a span lies inside that of a transition.
    fn contain(&self, span: Span) -> bool {
        let before = self.ends.partition_point(|&(start, _)| start <= span.start);
        before.checked_sub(1).is_some_and(|index| self.ends[index].1 >= span.end)
    }
}

fn activities(subject: &CheckedModel, world: &ProgramSymbols) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let suggestions = Suggestions::default();
    for (id, node) in subject.chart.nodes() {
        let Some(name) = node.activity.as_ref().filter(|name| !world.activities.contains_key(*name)) else {
            continue;
        };
        let message = format!("there is no activity `{name}`");
        let hint = match suggestions.nearest(name, world.activities.keys().map(String::as_str)) {
            Some(near) => format!("did you mean `{near}`?"),
            None => {
                "write it, or link the crate that has it; `--unlinked` is for models of other programs".into()
            }
        };
        found.push(Diagnostic::error("M21", subject.spans.node(id), message).with_hint(hint));
    }
    found
}

/// M21 without a program to ask: names in formulas that begin with a small letter, as formulas do,
/// while the other activities of the role begin with a capital.
pub(crate) fn names_like_formulas(subject: &CheckedModel) -> Vec<Diagnostic> {
    if subject.liveness.is_none() {
        return Vec::new();
    }
    let states = || subject.chart.nodes().filter(|(_, node)| node.activity.as_ref() == Some(&node.name));
    let begins =
        |name: &str, test: fn(&char) -> bool| name.chars().next().is_some_and(|letter| test(&letter));
    if !states().any(|(_, node)| begins(&node.name, char::is_ascii_uppercase)) {
        return Vec::new();
    }
    let mut seen = BTreeSet::new();
    states()
        .filter(|(_, node)| begins(&node.name, char::is_ascii_lowercase) && seen.insert(node.name.as_str()))
        .map(|(id, node)| {
            let message = format!("`{}` has no formula and is taken for an activity", node.name);
            let hint = "write its formula, or check the role with the program that has the activity";
            Diagnostic::warning("M21", subject.spans.node(id), message).with_hint(hint)
        })
        .collect()
}

/// M11: a transition of one region writes what one of another region may read in the same step, and
/// does not see yet.
pub(crate) fn same_step(subject: &CheckedModel) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    if !subject.chart.nodes().any(|(_, node)| node.kind == NodeKind::And) {
        return found;
    }
    // By message and trigger: the readers in the order of their sources in a walk through the tree.
    let mut readers: BTreeMap<(String, String), Vec<(u32, TransitionId)>> = BTreeMap::new();
    let trigger = |id| subject.trigger(id).map_or_else(String::new, ToString::to_string);
    for (id, transition) in subject.chart.transitions() {
        for message in transition.expression.guard.iter().flat_map(logic::messages) {
            let number = subject.extent(transition.source).0;
            readers.entry((message, trigger(id))).or_default().push((number, id));
        }
    }
    readers.values_mut().for_each(|readers| readers.sort_unstable());
    for (writing, transition) in subject.chart.transitions() {
        let written = transition.expression.actions.iter().filter_map(|action| match &action.kind {
            ActionKind::Assign { target, .. } => message_of(target),
            _ => None,
        });
        for message in written.collect::<BTreeSet<String>>() {
            let key = (message, trigger(writing));
            let of_message = readers.get(&key).map_or(&[][..], Vec::as_slice);
            let reader = reader_apart(subject, transition.source, of_message);
            found.extend(reader.map(|reading| written_in_same_step(subject, writing, reading, &key.0)));
        }
    }
    found
}

/// A reader in a region that is active together with a node, and apart from it: one inside an AND
/// around the node, but not inside the node's own region of it.
fn reader_apart(
    subject: &CheckedModel,
    node: NodeId,
    readers: &[(u32, TransitionId)],
) -> Option<TransitionId> {
    let within = |node: NodeId| {
        let (first, end) = subject.extent(node);
        let index = |number: u32| readers.partition_point(|&(at, _)| at < number);
        index(first)..index(end)
    };
    let mut region = node;
    subject.chart.ancestors(node).find_map(|around| {
        let own = std::mem::replace(&mut region, around);
        if subject.kind(around) != NodeKind::And {
            return None;
        }
        let (all, own) = (within(around), within(own));
        // a transition out of the AND itself is in none of its regions
        let before = readers[all.start..own.start].iter();
        let mut others = before.chain(&readers[own.end..all.end]).map(|&(_, id)| id);
        others.find(|&id| subject.chart.transition(id).source != around)
    })
}

fn message_of(field: &Path) -> Option<String> {
    field.text().rsplit_once('.').map(|(message, _)| message.to_owned())
}

fn written_in_same_step(
    subject: &CheckedModel,
    writing: TransitionId,
    reading: TransitionId,
    message: &str,
) -> Diagnostic {
    let says = format!(
        "`{}` reads `{message}`, which `{}` of another region may write in the same step: it is visible only in the next step",
        subject.arrow(reading),
        subject.arrow(writing)
    );
    let found = Diagnostic::warning("M11", subject.spans.guard(reading), says);
    found.with_hint("raise an event in one region and wait for it in the other, or use one region")
}

/// M18: a guard that waits for a message that is published only after it has held.
pub(crate) fn undelivered(
    subject: &CheckedModel,
    world: &ProgramSymbols,
    settings: &CheckSettings,
    found: &Exploration,
) -> Vec<Finding> {
    let guarded = subject
        .chart
        .transitions()
        .map(|(id, _)| id)
        .filter(|&id| subject.transition(id).expression.guard.is_some());
    let outgoing = outgoing(found);
    let mut published: BTreeMap<String, Option<BTreeSet<NodeId>>> = BTreeMap::new();
    let mut findings = Vec::new();
    for id in guarded {
        let states = found.states().len();
        if settings.observer.stops(ExplorationProgress { states, ..ExplorationProgress::default() }) {
            break;
        }
        for message in subject.transition(id).expression.guard.iter().flat_map(logic::messages) {
            let publishers =
                published.entry(message.clone()).or_insert_with(|| publishers(subject, world, &message));
            let Some(publishers) = publishers else { continue };
            if let Some(finding) = undelivered_at(subject, found, &outgoing, (id, &message), publishers) {
                findings.push(finding);
                break;
            }
        }
    }
    findings
}

fn undelivered_at(
    subject: &CheckedModel,
    found: &Exploration,
    outgoing: &BTreeMap<usize, Vec<usize>>,
    (id, message): (TransitionId, &str),
    publishers: &BTreeSet<NodeId>,
) -> Option<Finding> {
    let source = subject.transition(id).source;
    if publishers.contains(&source) || !matches!(subject.kind(source), NodeKind::Basic | NodeKind::Start) {
        return None;
    }
    let is_in_vain = |number: usize| {
        let state = &found.states()[number];
        let is_read = state.is_active(source) && !state.running.contains(&source);
        is_read && !may_return_while(found, outgoing, number, source, publishers)
    };
    let trace = path_without(found, outgoing, publishers, is_in_vain)?;
    let names: Vec<String> = publishers.iter().map(|&node| format!("`{}`", subject.path(node))).collect();
    let says = format!(
        "the guard of `{}` waits for a `{message}` that may not have arrived and cannot arrive while it waits: it is published by {}",
        subject.arrow(id),
        names.join(", ")
    );
    let diagnostic = Diagnostic::warning("M18", subject.spans.guard(id), says);
    let hint = format!("run its publisher before, or add a transition for `{message} == NULL`");
    Some(Finding { diagnostic: diagnostic.with_hint(hint), trace: Some(trace) })
}

/// M21: two states run the same activity at once, and both publish: each overwrites the other's
/// messages.
pub(crate) fn concurrent_publishers(
    subject: &CheckedModel,
    world: &ProgramSymbols,
    found: &Exploration,
) -> Vec<Finding> {
    let publishing = |node: NodeId| -> Option<(&str, &str)> {
        let name = subject.chart.node(node).activity.as_deref()?;
        let topic = world.activities.get(name)?.as_ref()?.first()?;
        Some((name, topic))
    };
    let (mut reported, mut findings) = (BTreeSet::new(), Vec::new());
    for (number, state) in found.states().iter().enumerate() {
        for (index, &node) in state.running.iter().enumerate() {
            let Some((name, topic)) = publishing(node) else { continue };
            let same = |&&other: &&NodeId| publishing(other).is_some_and(|(it, _)| it == name);
            let Some(&other) = state.running[..index].iter().find(same) else { continue };
            if !reported.insert(name) {
                continue;
            }
            let (one, other) = (subject.path(other), subject.path(node));
            let message =
                format!("`{name}` may run in `{one}` and in `{other}` at once, and both publish `{topic}`");
            let diagnostic = subject
                .warn("M21", node, message)
                .with_hint("each state has its own instance: use one state, or separate topics");
            findings.push(Finding { diagnostic, trace: Some(found.trace_to(number).to_string()) });
        }
    }
    findings
}

/// The states whose activities publish a message, or `None` if there may be other publishers.
fn publishers(subject: &CheckedModel, world: &ProgramSymbols, message: &str) -> Option<BTreeSet<NodeId>> {
    let mut topics = world.vocabulary.topics.iter().filter(|topic| topic.message == message);
    let topic = topics.next().filter(|_| topics.next().is_none())?;
    let publishes =
        |name: &str| -> Option<bool> { Some(world.activities.get(name)?.as_ref()?.contains(&topic.path)) };
    let own: BTreeSet<&str> =
        subject.chart.nodes().filter_map(|(_, node)| node.activity.as_deref()).collect();
    // activities that declare no topics and activities outside this chart may publish it
    for name in world.activities.keys() {
        let is_own = own.contains(name.as_str());
        if publishes(name)? && !is_own {
            return None;
        }
    }
    let is_publisher = |node: &yase::Node| node.activity.as_deref().and_then(publishes).unwrap_or(false);
    let states: BTreeSet<NodeId> =
        subject.chart.nodes().filter(|(_, node)| is_publisher(node)).map(|(id, _)| id).collect();
    let writes = is_written(subject, message);
    (!states.is_empty() && !writes).then_some(states)
}

/// Whether the chart itself writes a message.
fn is_written(subject: &CheckedModel, message: &str) -> bool {
    super::events::actions(subject).any(|(action, _)| match &action.kind {
        ActionKind::Assign { target, .. } => message_of(target).as_deref() == Some(message),
        ActionKind::Publish(path) => path.text() == message,
        _ => false,
    })
}

/// The edges out of each state.
fn outgoing(found: &Exploration) -> BTreeMap<usize, Vec<usize>> {
    let mut outgoing: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (index, edge) in found.edges().iter().enumerate() {
        outgoing.entry(edge.from).or_default().push(index);
    }
    outgoing
}

/// Whether one of some activities may return while a state stays active; then a guard in that state
/// only waits for it.
fn may_return_while(
    found: &Exploration,
    outgoing: &BTreeMap<usize, Vec<usize>>,
    from: usize,
    source: NodeId,
    publishers: &BTreeSet<NodeId>,
) -> bool {
    let (mut seen, mut open) = (BTreeSet::from([from]), vec![from]);
    while let Some(state) = open.pop() {
        for &edge in outgoing.get(&state).into_iter().flatten() {
            let edge = &found.edges()[edge];
            if edge.returned.is_some_and(|node| publishers.contains(&node)) {
                return true;
            }
            if found.states()[edge.to].is_active(source) && seen.insert(edge.to) {
                open.push(edge.to);
            }
        }
    }
    false
}

/// A path to a state that satisfies a predicate, on which none of some activities has returned.
fn path_without(
    found: &Exploration,
    outgoing: &BTreeMap<usize, Vec<usize>>,
    avoided: &BTreeSet<NodeId>,
    is_meant: impl Fn(usize) -> bool,
) -> Option<String> {
    let mut came: BTreeMap<usize, Option<(usize, usize)>> =
        found.initial().map(|state| (state, None)).collect();
    let mut open: VecDeque<usize> = came.keys().copied().collect();
    while let Some(state) = open.pop_front() {
        if is_meant(state) {
            let (mut at, mut edges) = (state, Vec::new());
            while let Some(Some((before, edge))) = came.get(&at) {
                edges.push(*edge);
                at = *before;
            }
            edges.reverse();
            return Some(found.trace_along(at, &edges).to_string());
        }
        for &index in outgoing.get(&state).into_iter().flatten() {
            let edge = &found.edges()[index];
            let is_avoided = edge.returned.is_some_and(|node| avoided.contains(&node));
            if let (false, Entry::Vacant(entry)) = (is_avoided, came.entry(edge.to)) {
                entry.insert(Some((state, index)));
                open.push_back(edge.to);
            }
        }
    }
    None
}
