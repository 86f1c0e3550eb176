//! M19: timers that are read but never started, started but never read, or restarted before they
//! can expire.
//!
//! A timer belongs to the blackboard of the region whose transition starts it.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use yase::diagnostic::Suggestions;
use yase::expression::{Expression, ExpressionKind, Trigger};
use yase::{Diagnostic, NodeId, Span, TransitionId};

use super::events;
use crate::checked_model::CheckedModel;
use crate::checked_model::timers::{self, TimerKey, blackboard, starts};

pub(crate) fn check(subject: &CheckedModel) -> Vec<Diagnostic> {
    let timers = TimerCheck::new(subject);
    let mut found = timers.never_started();
    found.extend(timers.never_read());
    found.extend(subject.chart.transitions().filter_map(|(id, _)| overtaken(subject, id)));
    found.extend(subject.chart.transitions().flat_map(|(id, _)| twice(subject, id)));
    found
}

struct TimerCheck<'a> {
    subject: &'a CheckedModel,
    started: BTreeMap<TimerKey, Span>,
    /// Names that are read: whether the form can only denote a timer, and where.
    read: BTreeMap<TimerKey, (bool, Span)>,
    suggestions: Suggestions,
    /// Names of events that are awaited or deferred: the expiry of a timer is an event.
    events: BTreeSet<String>,
}

impl<'a> TimerCheck<'a> {
    fn new(subject: &'a CheckedModel) -> TimerCheck<'a> {
        let (started, mut read) = (timers::started(subject), BTreeMap::new());
        for (id, transition) in subject.chart.transitions() {
            let board = blackboard(subject, id);
            for (name, is_sure) in transition.expression.guard.iter().flat_map(timers_read) {
                let entry = read.entry((board, name)).or_insert((false, subject.spans.guard(id)));
                entry.0 |= is_sure;
            }
        }
        let mut events: BTreeSet<String> = events::waited(subject).into_keys().collect();
        events.extend(subject.chart.transitions().filter_map(|(_, it)| match &it.expression.trigger {
            Some(Trigger::Not(event)) => Some(event.text()),
            _ => None,
        }));
        events.extend(subject.chart.nodes().flat_map(|(_, node)| node.defer.iter().cloned()));
        TimerCheck { subject, started, read, suggestions: Suggestions::default(), events }
    }

    fn never_started(&self) -> Vec<Diagnostic> {
        let unset = self.read.iter().filter(|(timer, _)| !self.started.contains_key(*timer));
        let mut boards: BTreeMap<&str, NodeId> = BTreeMap::new();
        for (board, name) in self.started.keys() {
            boards.entry(name).or_insert(*board);
        }
        unset
            .filter_map(|((board, name), &(is_sure, span))| match boards.get(name.as_str()) {
                Some(&other) => Some(self.started_elsewhere(*board, other, name, span)),
                None => self.not_started(*board, name, is_sure, span),
            })
            .collect()
    }

    fn started_elsewhere(&self, board: NodeId, other: NodeId, name: &str, span: Span) -> Diagnostic {
        let message = format!(
            "the timer `{name}` is read on the blackboard of `{}`, but started on that of `{}`",
            self.subject.path(board),
            self.subject.path(other)
        );
        let hint = "each region has its own timers: start it by a transition of the same region";
        Diagnostic::warning("M19", span, message).with_hint(hint)
    }

    /// A bare name may also be a constant or a function; such names are not reported.
    fn not_started(&self, board: NodeId, name: &str, is_sure: bool, span: Span) -> Option<Diagnostic> {
        let of_board = self.started.range((board, String::new())..).take_while(|((it, _), _)| *it == board);
        let near = self.suggestions.nearest(name, of_board.map(|((_, other), _)| other.as_str()));
        let is_constant = self.subject.chart.constants.iter().any(|constant| constant.name == name);
        let found =
            Diagnostic::warning("M19", span, format!("the timer `{name}` is read, but never started"));
        match near {
            _ if is_constant => None,
            Some(near) => Some(found.with_hint(format!("did you mean `{near}`?"))),
            None if is_sure => Some(found.with_hint(format!("start it with `StartTimeout({name}, 100ms)`"))),
            None => None,
        }
    }

    fn never_read(&self) -> Vec<Diagnostic> {
        let read = |(board, name): &TimerKey| {
            self.read.contains_key(&(*board, name.clone())) || self.events.contains(name)
        };
        let unread = self.started.iter().filter(|(timer, _)| !read(timer));
        let names: BTreeSet<&str> = self.read.keys().map(|(_, name)| name.as_str()).collect();
        unread
            .filter(|((_, name), _)| !names.contains(name.as_str()))
            .map(|((_, name), &span)| {
                let message = format!(
                    "the timer `{name}` is started, but no guard reads it and no trigger waits for it"
                );
                let hint = format!("read it with `[TimeoutCheck({name})]`, or do not start it");
                Diagnostic::warning("M19", span, message).with_hint(hint).with_suggestion(
                    &self.suggestions,
                    name,
                    names.iter().copied(),
                )
            })
            .collect()
    }
}

/// The bare names in a condition that may be timers, and whether they can be nothing else.
fn timers_read(guard: &Expression) -> Vec<(String, bool)> {
    let (mut found, mut open) = (Vec::new(), vec![guard]);
    while let Some(expression) = open.pop() {
        match &expression.kind {
            ExpressionKind::TimeoutCheck(path) => found.push((path.text(), true)),
            ExpressionKind::Variable(path) => found.extend(path.bare().map(|name| (name.to_owned(), false))),
            ExpressionKind::Or(parts) | ExpressionKind::And(parts) => open.extend(parts),
            ExpressionKind::Not(inner) => open.push(inner),
            _ => {}
        }
    }
    found
}

/// A loop that waits for one timer and restarts a longer one in each iteration.
fn overtaken(subject: &CheckedModel, id: TransitionId) -> Option<Diagnostic> {
    let transition = subject.transition(id);
    let guard = transition.expression.guard.as_ref()?;
    if transition.source != transition.target || transition.expression.trigger.is_some() {
        return None;
    }
    let needed = required(guard);
    let started: Vec<(String, Duration)> = starts(&transition.expression.actions).collect();
    let (waited, short) = started.iter().find(|(name, _)| needed.contains(name))?;
    let (other, long) = started.iter().find(|(name, delay)| !needed.contains(name) && delay > short)?;
    // another exit of the same state may leave the loop earlier
    let leaves = subject
        .outgoing(transition.source)
        .iter()
        .any(|&other| other != id && !subject.transition(other).expression.is_never());
    (!leaves).then(|| {
        let (long, short) = (long.as_millis(), short.as_millis());
        let message = format!("`{other}` is restarted before it can expire: {long} ms each time `{waited}` expires, every {short} ms");
        subject.warn_of("M19", id, message).with_hint("start the longer timer where the loop is entered")
    })
}

/// The names that must be true for a condition to hold.
fn required(guard: &Expression) -> BTreeSet<String> {
    let (mut names, mut open) = (BTreeSet::new(), vec![guard]);
    while let Some(expression) = open.pop() {
        match &expression.kind {
            ExpressionKind::And(parts) => open.extend(parts),
            ExpressionKind::TimeoutCheck(path) | ExpressionKind::Variable(path) => {
                names.insert(path.text());
            }
            _ => {}
        }
    }
    names
}

/// A timer that one transition starts twice.
fn twice(subject: &CheckedModel, id: TransitionId) -> Vec<Diagnostic> {
    let started: Vec<String> =
        starts(&subject.transition(id).expression.actions).map(|(name, _)| name).collect();
    let again = started.iter().enumerate().filter(|(index, name)| started[..*index].contains(name));
    again
        .map(|(_, name)| {
            let message = format!(
                "`{}` starts the timer `{name}` twice: only the second start counts",
                subject.arrow(id)
            );
            subject.warn_of("M19", id, message).with_hint("keep one of the two")
        })
        .collect()
}
