//! M16: events that are never raised, or never waited for.
//!
//! Events that are raised outside the chart (by an activity, another agent or a person) are listed
//! in [`CheckSettings::events`]. Arrivals of messages, timers and the events of the engine
//! (`error.*`, `done.*`) are raised implicitly.

use std::collections::BTreeMap;

use yase::diagnostic::Suggestions;
use yase::expression::{Action, ActionKind, Path, Trigger};
use yase::{Diagnostic, Span};

use crate::check_settings::CheckSettings;
use crate::checked_model::CheckedModel;

pub(crate) fn check(subject: &CheckedModel, settings: &CheckSettings) -> Vec<Diagnostic> {
    if has_scripts(subject) {
        // a script can raise any event
        return Vec::new();
    }
    let (waited, raised, timers) = (waited(subject), raised(subject), started(subject));
    let suggestions = Suggestions::default();
    let comes = |name: &str| {
        raised.contains_key(name)
            || timers.contains_key(name)
            || settings.events.contains(name)
            || comes_by_itself(name)
    };
    let never_raised = waited.iter().filter(|(name, _)| !comes(name)).map(|(name, &span)| {
        let found =
            Diagnostic::warning("M16", span, format!("no action of the chart raises the event `{name}`"));
        let candidates = raised.keys().chain(timers.keys()).map(String::as_str);
        match suggestions.nearest(name, candidates) {
            Some(near) => found.with_hint(format!("did you mean `{near}`?")),
            None => found.with_hint("declare it as external if an activity or another agent raises it"),
        }
    });
    let takes_any = subject
        .chart
        .transitions()
        .any(|(id, _)| matches!(subject.trigger(id), Some(Trigger::Any | Trigger::Not(_))));
    let is_waited_for = |name: &str| takes_any || waited.contains_key(name);
    let never_taken = raised.iter().filter(|(name, _)| !is_waited_for(name)).map(|(name, &span)| {
        let found = Diagnostic::warning("M16", span, format!("no transition waits for the event `{name}`"));
        let found = found.with_hint("let a transition wait for it, or do not raise it");
        found.with_suggestion(&suggestions, name, waited.keys().map(String::as_str))
    });
    never_raised.chain(never_taken).collect()
}

fn has_scripts(subject: &CheckedModel) -> bool {
    actions(subject).any(|(action, _)| matches!(action.kind, ActionKind::Script(_)))
}

/// All actions of the chart with their spans.
pub(crate) fn actions(subject: &CheckedModel) -> impl Iterator<Item = (&Action, Span)> {
    let of_transitions = subject.chart.transitions().flat_map(|(id, transition)| {
        let span = subject.spans.transition(id);
        transition.expression.actions.iter().map(move |action| (action, span))
    });
    let of_nodes = subject.chart.nodes().flat_map(|(id, node)| {
        let span = subject.spans.node(id);
        node.entry.iter().chain(&node.exit).map(move |action| (action, span))
    });
    of_transitions.chain(of_nodes)
}

fn raised(subject: &CheckedModel) -> BTreeMap<String, Span> {
    let mut raised = BTreeMap::new();
    for (action, span) in actions(subject) {
        if let ActionKind::Raise(event) = &action.kind {
            raised.entry(event.text()).or_insert(span);
        }
    }
    raised
}

fn started(subject: &CheckedModel) -> BTreeMap<String, Span> {
    let mut started = BTreeMap::new();
    for (action, span) in actions(subject) {
        if let ActionKind::StartTimeout { timer, .. } = &action.kind {
            started.entry(timer.text()).or_insert(span);
        }
    }
    started
}

/// The events that triggers name, each with the span of its first trigger.
pub(crate) fn waited(subject: &CheckedModel) -> BTreeMap<String, Span> {
    let mut waited = BTreeMap::new();
    for (id, transition) in subject.chart.transitions() {
        let events: &[Path] = match &transition.expression.trigger {
            Some(Trigger::OneOf(events)) => events,
            // `not e` matches every other event
            _ => &[],
        };
        for event in events {
            waited.entry(event.text()).or_insert(subject.spans.transition(id));
        }
    }
    waited
}

/// Whether a trigger names, or may name, the arrival of a message or an event of the engine.
fn comes_by_itself(name: &str) -> bool {
    let first = name.chars().next();
    let of_engine = ["error.", "done."].iter().any(|begin| name.starts_with(begin));
    of_engine || name.contains(['.', '/']) || first.is_some_and(char::is_uppercase)
}
