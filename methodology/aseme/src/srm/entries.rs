//! The section `Transitions:`.

use yase::expression::parse_transition_at;
use yase::{Diagnostic, Span};

use super::{Reader, Section, SrmEntry, TransitionEntry};
use crate::path::Path;
use crate::text;

impl Reader {
    /// Parses entries, each of which starts with the line that has its `->`.
    pub(crate) fn transitions(&mut self, blanked: &str, body: Span) {
        let begins = |line: &str| line.contains("->");
        for span in entry_spans(blanked, body, begins) {
            self.entries.push(SrmEntry { section: Section::Transitions, span });
            self.transition(blanked, span);
        }
    }

    fn transition(&mut self, blanked: &str, span: Span) {
        let text = &blanked[span.start..span.end];
        let Some(arrow) = text.find("->") else {
            let hint = "write `source -> target : expression`";
            return self.report(
                Diagnostic::error("E0240", span, "an entry has a source, `->` and a target").with_hint(hint),
            );
        };
        let head_end = text[arrow..].find(':').map_or(text.len(), |colon| arrow + colon);
        let ends = self.ends(blanked, span, arrow, head_end);
        let expression_start = span.start + (head_end + 1).min(text.len());
        let (expression, findings) =
            parse_transition_at(&blanked[expression_start..span.end], expression_start);
        self.diagnostics.extend(findings);
        let Some((source, target, modifiers)) = ends else { return };
        let Modifiers { also, priority, weight, interrupts, internal } = modifiers;
        let text = text::one_line(text);
        self.srm.transitions.push(TransitionEntry {
            source,
            target,
            also,
            priority,
            weight,
            interrupts,
            internal,
            expression,
            text,
            span,
        });
    }

    /// Parses the text before the expression.
    fn ends(
        &mut self,
        blanked: &str,
        span: Span,
        arrow: usize,
        head_end: usize,
    ) -> Option<(Path, Path, Modifiers)> {
        let left = Span::new(span.start, span.start + arrow);
        let right = Span::new(left.end + 2, span.start + head_end);
        let scope_end = blanked[left.start..left.end].find(':');
        let source = left.start + scope_end.map_or(0, |colon| colon + 1);
        let scope = scope_end.map(|colon| self.path(blanked, Span::new(left.start, left.start + colon)));
        let modifiers_start = right.start + modifiers_start(&blanked[right.start..right.end]);
        let source = self.path(blanked, Span::new(source, left.end));
        let target = self.path(blanked, Span::new(right.start, modifiers_start));
        let modifiers = self.modifiers(blanked, Span::new(modifiers_start, right.end));
        let (source, target) = (source?, target?);
        match scope {
            None => Some((source, target, modifiers)),
            Some(scope) => scope.map(|scope| (source.within(&scope), target.within(&scope), modifiers)),
        }
    }

    /// Parses a path; errors are reported.
    pub(crate) fn path(&mut self, blanked: &str, span: Span) -> Option<Path> {
        let path = Path::parse(&blanked[span.start..span.end]);
        path.map_err(|diagnostic| self.report(diagnostic.shifted(span.start))).ok()
    }

    fn modifiers(&mut self, blanked: &str, span: Span) -> Modifiers {
        let mut modifiers = Modifiers::default();
        let spaced = blanked[span.start..span.end].replace('!', " !").replace('%', " %");
        for word in spaced.split_whitespace() {
            if modifiers.accept(word).is_none() {
                let message = format!("`{word}` is not a modifier of a transition");
                let hint =
                    "a target may be followed by `also`, `!priority`, `%weight`, `interrupts` and `internal`";
                self.report(
                    Diagnostic::error("E0242", text::trimmed(blanked, span), message).with_hint(hint),
                );
            }
        }
        modifiers
    }
}

#[derive(Default)]
struct Modifiers {
    also: bool,
    priority: i32,
    weight: Option<f64>,
    interrupts: bool,
    internal: bool,
}

impl Modifiers {
    fn accept(&mut self, word: &str) -> Option<()> {
        if word == "interrupts" {
            self.interrupts = true;
        } else if word == "internal" {
            self.internal = true;
        } else if word == "also" {
            self.also = true;
        } else if let Some(priority) = word.strip_prefix('!') {
            self.priority = priority.parse().ok()?;
        } else {
            let weight: f64 = word.strip_prefix('%')?.parse().ok()?;
            self.weight = Some(weight).filter(|weight| weight.is_finite() && *weight >= 0.0);
            self.weight?;
        }
        Some(())
    }
}

/// The end of a target's path, where its modifiers start.
pub(crate) fn modifiers_start(head: &str) -> usize {
    let sign = head.find(['!', '%']);
    let words = ["also", "interrupts", "internal"].into_iter().filter_map(|word| {
        let mut found = head.match_indices(word).map(|(at, _)| at);
        found.find(|&at| is_word(head, at, word.len()))
    });
    sign.into_iter().chain(words).min().unwrap_or(head.len())
}

/// Whether a part of a text is a separate word that is not the first.
fn is_word(text: &str, at: usize, length: usize) -> bool {
    let (before, after) = (&text[..at], &text[at + length..]);
    before.ends_with(char::is_whitespace)
        && !before.trim().is_empty()
        && !after.starts_with(text::is_name_character)
}

/// The entries of a section: each starts with a line that satisfies `begins`.
pub(crate) fn entry_spans(blanked: &str, body: Span, begins: impl Fn(&str) -> bool) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    for line in text::lines_of(blanked, body) {
        let span = text::trimmed(blanked, line);
        if span.start == span.end {
            continue;
        }
        match spans.last_mut() {
            Some(entry) if !begins(&blanked[span.start..span.end]) => entry.end = span.end,
            _ => spans.push(span),
        }
    }
    spans
}
