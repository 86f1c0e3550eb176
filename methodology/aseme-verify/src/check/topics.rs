//! M17 for topics: read but never published, or written but never read.
//!
//! Publishers and readers are known only if every activity declares its topics. For activities that
//! declare none, and for messages of other hosts, nothing is reported.

use std::collections::{BTreeMap, BTreeSet};

use yase::expression::{Effect, Origin};
use yase::vocabulary::TopicEntry;
use yase::{ActionLocation, CompiledChart, Diagnostic, Severity, Span, TopicId};

use crate::checked_model::CheckedModel;
use crate::program_symbols::ProgramSymbols;

/// Topics of the chart without a publisher or reader.
pub(crate) fn unmet(subject: &CheckedModel, world: &ProgramSymbols) -> Vec<Diagnostic> {
    let Ok(chart) = subject.chart.compile_with(&world.vocabulary, subject.semantics) else {
        return Vec::new();
    };
    let (read, written) = (read(subject, &chart), written(subject, &chart));
    let (published, taken) = (all_of(&world.activities), all_of(&world.readers));
    let own = of_chart(subject, world);
    let mut found = Vec::new();
    for topic in world.vocabulary.topics.iter().filter(|topic| !world.elsewhere.contains(&topic.path)) {
        let meets = |others: &Option<BTreeSet<&str>>| {
            others.as_ref().is_none_or(|others| others.contains(topic.path.as_str()))
        };
        match (read.get(&topic.id), written.get(&topic.id)) {
            (Some(&span), None) if !meets(&published) => found.push(never_published(topic, span)),
            (Some(&span), None) if own.as_ref().is_some_and(|own| !own.contains(topic.path.as_str())) => {
                found.extend(
                    published_elsewhere(topic, world).map(|others| from_elsewhere(topic, span, &others)),
                );
            }
            (None, Some(&span)) if !meets(&taken) => found.push(never_read(topic, span)),
            _ => {}
        }
    }
    found
}

/// All topics that activities declare, or `None` if one declares none or there are no activities.
fn all_of(activities: &BTreeMap<String, Option<BTreeSet<String>>>) -> Option<BTreeSet<&str>> {
    let mut all = BTreeSet::new();
    for topics in activities.values() {
        all.extend(topics.as_ref()?.iter().map(String::as_str));
    }
    (!activities.is_empty()).then_some(all)
}

/// The topics that the activities of the chart publish, or `None` if one of them declares none.
fn of_chart<'w>(subject: &CheckedModel, world: &'w ProgramSymbols) -> Option<BTreeSet<&'w str>> {
    let mut own = BTreeSet::new();
    for name in subject.chart.nodes().filter_map(|(_, node)| node.activity.as_deref()) {
        own.extend(world.activities.get(name)?.as_ref()?.iter().map(String::as_str));
    }
    Some(own)
}

/// The activities of the program that publish a topic, if all declare their topics.
fn published_elsewhere(topic: &TopicEntry, world: &ProgramSymbols) -> Option<String> {
    all_of(&world.activities)?;
    let publishes = |topics: &Option<BTreeSet<String>>| {
        topics.as_ref().is_some_and(|topics| topics.contains(&topic.path))
    };
    let names = world.activities.iter().filter(|(_, topics)| publishes(topics));
    Some(names.map(|(name, _)| format!("`{name}`")).collect::<Vec<_>>().join(", "))
}

/// The topics of the own host that guards and triggers read, with their spans.
fn read(subject: &CheckedModel, chart: &CompiledChart) -> BTreeMap<TopicId, Span> {
    let mut read = BTreeMap::new();
    for (transition, _, guard) in chart.guards() {
        for &topic in guard.reads() {
            read.entry(topic).or_insert(subject.spans.guard(transition));
        }
    }
    let (events, waited) = (chart.events(), super::events::waited(subject));
    for event in events.ids().filter(|&event| events.host(event).is_none()) {
        let span = waited.get(events.name(event)).copied().unwrap_or_default();
        events.topic(event).map(|topic| read.entry(topic).or_insert(span));
    }
    let is_foreign =
        |topic: &TopicId| chart.sources().any(|it| it.topic == *topic && it.origin != Origin::Own);
    read.retain(|topic, _| !is_foreign(topic));
    read
}

/// The topics that actions write or publish, with their spans.
fn written(subject: &CheckedModel, chart: &CompiledChart) -> BTreeMap<TopicId, Span> {
    let mut written = BTreeMap::new();
    for (location, _, effects) in chart.effects() {
        let span = match location {
            ActionLocation::Transition(id) => subject.spans.transition(id),
            ActionLocation::Entry(node) | ActionLocation::Exit(node) => subject.spans.node(node),
        };
        for effect in effects {
            if let Effect::Assign { topic, .. } | Effect::Publish { topic } = effect {
                written.entry(*topic).or_insert(span);
            }
        }
    }
    written
}

fn never_published(topic: &TopicEntry, span: Span) -> Diagnostic {
    let message = format!("`{}` is read here, but no activity publishes it", topic.path);
    let found = Diagnostic::warning("M17", span, message);
    found.with_hint("write an activity that publishes it, or declare the topic (`Activity::topics`)")
}

fn from_elsewhere(topic: &TopicEntry, span: Span, others: &str) -> Diagnostic {
    let message = format!("`{}` is read here, but no activity of this chart publishes it", topic.path);
    let found = Diagnostic { severity: Severity::Information, ..Diagnostic::warning("M17", span, message) };
    found.with_hint(format!("another agent of the robot has to run one of {others}"))
}

fn never_read(topic: &TopicEntry, span: Span) -> Diagnostic {
    let message = format!("`{}` is written here, but neither the chart nor an activity reads it", topic.path);
    let found = Diagnostic::warning("M17", span, message);
    found.with_hint("let an activity read it, or remove the action")
}
