//! M29: guards that judge a situation that is gone.
//!
//! An activity that waits ends on a message. Its return and the guards that follow it are evaluated
//! in the same step. A guard that reads another topic, which some activity elsewhere derives from
//! that message, reads what was derived from an older one: the derivation has not run yet. The
//! derivation has to stand between the activity and the guard, in the same region.
//!
//! The check follows the completions of states through connectors. At each place it knows the
//! topics on whose messages the last waiting activity ended, and those published in the region
//! since. Activities say what they end on (`Activity::topics`); for those that do not, nothing is
//! reported.
//!
//! A finding needs one path on which a topic is not published. So of all paths from a state to a
//! place, the topics that are published on each of them suffice: their number does not grow with
//! the number of paths.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

use yase::{Diagnostic, NodeId, NodeKind, TransitionId};

use crate::checked_model::CheckedModel;
use crate::program_symbols::ProgramSymbols;

/// A way in which a node is reached: from the last state that waited.
#[derive(Clone, Debug)]
struct NodeArrival<'a> {
    /// The state whose activity ended, the last that waits.
    state: NodeId,
    /// The topics on whose messages it may have ended.
    ended_on: &'a BTreeSet<String>,
    /// The topics that it and its successors have published since, on every path.
    published: BTreeSet<&'a str>,
}

/// The ways in which a node is reached, by the state whose activity ended.
type NodeArrivals<'a> = BTreeMap<NodeId, NodeArrival<'a>>;

/// Guards that are evaluated before the messages that they read are derived.
pub(crate) fn stale(subject: &CheckedModel, world: &ProgramSymbols) -> Vec<Diagnostic> {
    let Ok(chart) = subject.chart.compile_with(&world.vocabulary, subject.semantics) else {
        return Vec::new();
    };
    let topic = |id: yase::TopicId| world.vocabulary.topics.iter().find(|topic| topic.id == id);
    let reads: BTreeMap<TransitionId, BTreeSet<&str>> = chart
        .guards()
        .map(|(id, _, guard)| {
            let read = guard.reads().iter().filter_map(|&read| topic(read));
            (id, read.map(|topic| topic.path.as_str()).collect())
        })
        .collect();
    let activities = chart.activities().map(|entry| (entry.node, entry.name.to_owned())).collect();
    let arrivals = ArrivalSearch { subject, world, activities }.run();
    let mut found = Vec::new();
    for (&id, read) in &reads {
        let source = subject.chart.transition(id).source;
        let transitions = &subject.outgoing[source.0 as usize];
        let target = |id: TransitionId| subject.chart.transition(id).target;
        if transitions.iter().all(|&transition| target(transition) == target(id)) {
            // No guard is decided here.
            continue;
        }
        for (arrival, path) in
            arrivals[source.0 as usize].values().flat_map(|it| read.iter().map(move |path| (it, *path)))
        {
            if arrival.published.contains(path) || arrival.ended_on.contains(path) {
                continue;
            }
            let origin = origins(world, path);
            let Some(cause) = arrival.ended_on.iter().find(|topic| origin.contains(topic.as_str())) else {
                continue;
            };
            found.push(report(subject, world, id, arrival.state, path, cause));
        }
    }
    found.sort_by(|a, b| (a.span, &a.message).cmp(&(b.span, &b.message)));
    found.dedup();
    found
}

fn report(
    subject: &CheckedModel,
    world: &ProgramSymbols,
    guard: TransitionId,
    state: NodeId,
    path: &str,
    cause: &str,
) -> Diagnostic {
    let state = subject.path(state);
    let message = format!(
        "the guard reads `{path}` when `{state}` ends on `{cause}`, from which `{path}` is derived elsewhere: \
         it may be that of an older `{cause}`"
    );
    let publishes = |(_, topics): &(&String, &Option<BTreeSet<String>>)| {
        topics.as_ref().is_some_and(|topics| topics.contains(path))
    };
    let found = Diagnostic::warning("M29", subject.spans.guard(guard), message);
    match world.activities.iter().find(publishes) {
        Some((activity, _)) => {
            found.with_hint(format!("let `{activity}` stand between the two: `{state} . {activity}`"))
        }
        None => found,
    }
}

/// The topics from which a topic is derived, directly or through others.
fn origins<'a>(world: &'a ProgramSymbols, path: &'a str) -> BTreeSet<&'a str> {
    let (mut origins, mut open) = (BTreeSet::new(), vec![path]);
    while let Some(path) = open.pop() {
        let publishers = world
            .activities
            .iter()
            .filter(|(_, topics)| topics.as_ref().is_some_and(|topics| topics.contains(path)));
        let read = publishers.filter_map(|(activity, _)| world.readers.get(activity)?.as_ref()).flatten();
        for origin in read {
            if origins.insert(origin.as_str()) {
                open.push(origin);
            }
        }
    }
    origins
}

/// Adds an arrival to those of a node; returns what is known now, if that is new.
fn joined<'m, 'a>(known: &'m mut NodeArrivals<'a>, arrival: NodeArrival<'a>) -> Option<&'m NodeArrival<'a>> {
    match known.entry(arrival.state) {
        Entry::Vacant(new) => Some(new.insert(arrival)),
        Entry::Occupied(known) => {
            let known = known.into_mut();
            let before = known.published.len();
            known.published.retain(|topic| arrival.published.contains(topic));
            (known.published.len() < before).then_some(known)
        }
    }
}

/// Follows the completions of states.
struct ArrivalSearch<'a> {
    subject: &'a CheckedModel,
    world: &'a ProgramSymbols,
    activities: BTreeMap<NodeId, String>,
}

impl<'a> ArrivalSearch<'a> {
    /// The arrivals with which each node completes, or is passed through.
    fn run(&self) -> Vec<NodeArrivals<'a>> {
        let mut arrivals = vec![NodeArrivals::new(); self.subject.chart.nodes().len()];
        let basic = self.subject.chart.nodes().filter(|(_, node)| node.kind == NodeKind::Basic);
        let mut open: Vec<(NodeId, Option<NodeArrival<'a>>)> = basic.map(|(id, _)| (id, None)).collect();
        while let Some((node, before)) = open.pop() {
            let Some(arrival) = self.after(node, before) else { continue };
            if let Some(changed) = joined(&mut arrivals[node.0 as usize], arrival) {
                open.extend(self.next(node).into_iter().map(|next| (next, Some(changed.clone()))));
            }
        }
        arrivals
    }

    /// The arrival after a node reached by another arrival; none before the first state that waits.
    fn after(&self, node: NodeId, before: Option<NodeArrival<'a>>) -> Option<NodeArrival<'a>> {
        let Some(activity) = self.activities.get(&node) else { return before };
        let topics = self.world.activities.get(activity).and_then(Option::as_ref);
        let published = topics.into_iter().flatten().map(String::as_str);
        match self.world.ended_by.get(activity).filter(|topics| !topics.is_empty()) {
            Some(ended_on) => Some(NodeArrival { state: node, ended_on, published: published.collect() }),
            None => before.map(|mut arrival| {
                arrival.published.extend(published);
                arrival
            }),
        }
    }

    /// The nodes reached by a completion of a node: the targets of its transitions, the beginning
    /// of a composite, the composite whose END it is.
    fn next(&self, node: NodeId) -> Vec<NodeId> {
        let chart = &self.subject.chart;
        let here = chart.node(node);
        if here.kind == NodeKind::End {
            let parent = here.parent.filter(|parent| chart.node(*parent).kind == NodeKind::Or);
            return parent.into_iter().collect();
        }
        let transition = self.subject.outgoing[node.0 as usize].iter();
        let untriggered = transition.filter(|&&id| self.subject.trigger(id).is_none());
        untriggered.flat_map(|&id| self.entered(chart.transition(id).target)).collect()
    }

    /// The nodes that are reached by entering a node.
    fn entered(&self, node: NodeId) -> Vec<NodeId> {
        let chart = &self.subject.chart;
        match chart.node(node).kind {
            NodeKind::Or | NodeKind::And => {
                let inside = chart.children(node).iter().map(|&id| (id, chart.node(id)));
                let begins = inside.filter(|(_, it)| matches!(it.kind, NodeKind::Start | NodeKind::Or));
                begins
                    .flat_map(|(id, it)| match (it.kind, chart.node(node).kind) {
                        (NodeKind::Start, _) => vec![id],
                        (_, NodeKind::And) => self.entered(id),
                        _ => Vec::new(),
                    })
                    .collect()
            }
            _ => vec![node],
        }
    }
}
