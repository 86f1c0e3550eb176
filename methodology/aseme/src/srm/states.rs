//! The section `States:`.

use std::time::Duration;

use yase::expression::{Action, parse_actions_at};
use yase::{Diagnostic, NodeKind, Span};

use super::entries::entry_spans;
use super::{Reader, Section, SrmEntry, StateEntry};
use crate::text;

/// The keys of settings.
pub(crate) const KEYS: [&str; 7] = ["activity", "priority", "entry", "exit", "defer", "duration", "history"];

impl Reader {
    /// Parses entries, each of which starts with the line that has its `:`.
    pub(crate) fn states(&mut self, blanked: &str, body: Span) {
        let begins = |line: &str| line.split('"').next().is_some_and(|unquoted| unquoted.contains(':'));
        for span in entry_spans(blanked, body, begins) {
            self.entries.push(SrmEntry { section: Section::States, span });
            self.state(blanked, span);
        }
    }

    fn state(&mut self, blanked: &str, span: Span) {
        let Some(colon) = blanked[span.start..span.end].find(':').map(|colon| span.start + colon) else {
            let hint = "write `path : key = value`";
            return self.report(
                Diagnostic::error("E0243", span, "an entry has a path, `:` and settings").with_hint(hint),
            );
        };
        let path = self.path(blanked, Span::new(span.start, colon));
        let text = text::one_line(&blanked[span.start..span.end]);
        let mut settings = StateSettings::default();
        for (key, value) in self.settings(blanked, Span::new(colon + 1, span.end), &KEYS) {
            self.setting(blanked, key, value, &mut settings);
        }
        let Some(path) = path else { return };
        let StateSettings { activity, priority, entry, exit, defer, duration, history } = settings;
        self.srm.states.push(StateEntry {
            path,
            activity,
            priority,
            entry,
            exit,
            defer,
            duration,
            history,
            text,
            span,
        });
    }

    /// The spans of keys and values.
    pub(crate) fn settings(&mut self, blanked: &str, span: Span, keys: &[&str]) -> Vec<(Span, Span)> {
        let mut settings: Vec<(Span, Span)> = Vec::new();
        for piece in pieces(blanked, span) {
            match (key_of(blanked, piece), settings.last_mut()) {
                (Some(key), _) => settings.push((key.0, text::trimmed(blanked, Span::new(key.1, piece.end)))),
                (None, Some((_, value))) => value.end = text::trimmed(blanked, piece).end.max(value.end),
                (None, None) => {
                    let setting = text::trimmed(blanked, span);
                    let hint = format!("keys are {}", keys.join(", "));
                    self.report(
                        Diagnostic::error("E0243", setting, "a setting is `key = value`").with_hint(hint),
                    );
                    return settings;
                }
            }
        }
        settings
    }

    fn setting(&mut self, blanked: &str, key: Span, value: Span, settings: &mut StateSettings) {
        let (name, text) = (&blanked[key.start..key.end], &blanked[value.start..value.end]);
        let understood = match name {
            // `""`: none at all
            "activity" if text == "\"\"" => set(&mut settings.activity, Some(String::new())),
            "activity" => set(&mut settings.activity, text::is_name(text).then(|| text.into())),
            "priority" => set(&mut settings.priority, text.parse().ok()),
            "defer" => set(&mut settings.defer, events(text)),
            "duration" => set(&mut settings.duration, duration(text)),
            "history" => set(&mut settings.history, history(text)),
            "entry" => set(&mut settings.entry, Some(self.actions(text, value.start))),
            "exit" => set(&mut settings.exit, Some(self.actions(text, value.start))),
            _ => {
                let error = Diagnostic::error("E0244", key, format!("states have no `{name}`"));
                let hint = format!("keys are {}", KEYS.join(", "));
                return self.report(error.with_hint(hint).with_nearest(name, KEYS));
            }
        };
        if !understood {
            let message = format!("`{text}` is not a value for `{name}`");
            let span = if value.start < value.end { value } else { key };
            self.report(Diagnostic::error("E0245", span, message).with_hint(expected(name)));
        }
    }

    fn actions(&mut self, text: &str, offset: usize) -> Vec<Action> {
        let (actions, findings) = parse_actions_at(text, offset);
        self.diagnostics.extend(findings);
        actions
    }
}

#[derive(Default)]
struct StateSettings {
    activity: Option<String>,
    priority: Option<i32>,
    entry: Option<Vec<Action>>,
    exit: Option<Vec<Action>>,
    defer: Option<Vec<String>>,
    duration: Option<Duration>,
    history: Option<NodeKind>,
}

fn set<T>(target: &mut Option<T>, value: Option<T>) -> bool {
    let understood = value.is_some();
    *target = value;
    understood
}

fn expected(key: &str) -> &'static str {
    match key {
        "activity" => "the name of an activity",
        "priority" => "a whole number; higher runs first",
        "defer" => "names of events, separated by blanks",
        "history" => "`shallow` or `deep`",
        _ => "a time such as `250ms` or `2s`",
    }
}

/// Names separated by blanks, commas or `|`.
pub fn events(text: &str) -> Option<Vec<String>> {
    let words = text.split([' ', '\t', '\n', ',', ';', '|']).filter(|word| !word.is_empty());
    let events: Vec<String> = words.map(String::from).collect();
    let is_event = |event: &String| event.split('.').all(text::is_name);
    (!events.is_empty() && events.iter().all(is_event)).then_some(events)
}

/// The kind of HISTORY: `shallow` or `deep`.
fn history(text: &str) -> Option<NodeKind> {
    match text {
        "shallow" => Some(NodeKind::ShallowHistory),
        "deep" => Some(NodeKind::DeepHistory),
        _ => None,
    }
}

/// `250ms` or `2s`.
pub fn duration(text: &str) -> Option<Duration> {
    let milliseconds = text.strip_suffix("ms").map(|number| (number, 0.001));
    let (number, unit) = milliseconds.or_else(|| text.strip_suffix('s').map(|number| (number, 1.0)))?;
    let seconds: f64 = number.trim_end().parse().ok()?;
    Duration::try_from_secs_f64(seconds * unit).ok()
}

/// The parts between commas and semicolons outside brackets and quotes.
fn pieces(blanked: &str, span: Span) -> Vec<Span> {
    let mut pieces = Vec::new();
    let (mut start, mut depth, mut quote) = (span.start, 0_usize, None);
    for (at, character) in blanked[span.start..span.end].char_indices() {
        match (quote, character) {
            (Some(open), _) => quote = Some(open).filter(|open| *open != character),
            (None, '"' | '`') => quote = Some(character),
            (None, '(' | '[') => depth += 1,
            (None, ')' | ']') => depth = depth.saturating_sub(1),
            (None, ',' | ';') if depth == 0 => {
                pieces.push(Span::new(start, span.start + at));
                start = span.start + at + 1;
            }
            _ => {}
        }
    }
    pieces.push(Span::new(start, span.end));
    pieces
}

/// The key of a setting and the position after its `=`. An assignment is not a setting: its target
/// has a dot.
fn key_of(blanked: &str, piece: Span) -> Option<(Span, usize)> {
    let text = &blanked[piece.start..piece.end];
    let equals = text.find('=').filter(|&at| !text[at + 1..].starts_with('='))?;
    let key = text::trimmed(blanked, Span::new(piece.start, piece.start + equals));
    text::is_name(&blanked[key.start..key.end]).then_some((key, piece.start + equals + 1))
}
