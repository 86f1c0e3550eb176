//! The section `Layout:`.

use yase::statechart::{Frame, Point};
use yase::{Diagnostic, Span};

use super::entries::{entry_spans, modifiers_start};
use super::{LayoutEntry, LayoutTarget, Reader, Section, SrmEntry};
use crate::layout::{self, BENDS_KEY, CORNERS_FORM, FRAME_KEYS, POSITION_FORM, SIZE_FORM};
use crate::text;

impl Reader {
    /// Parses entries, each of which starts with the line that has its `->` or `:`.
    pub(crate) fn layout(&mut self, blanked: &str, body: Span) {
        let begins = |line: &str| line.contains("->") || line.contains(':');
        for span in entry_spans(blanked, body, begins) {
            self.entries.push(SrmEntry { section: Section::Layout, span });
            self.layout_entry(blanked, span);
        }
    }

    fn layout_entry(&mut self, blanked: &str, span: Span) {
        let text = &blanked[span.start..span.end];
        let arrow = text.find("->");
        let Some(colon) = text[arrow.unwrap_or(0)..].find(':').map(|at| span.start + arrow.unwrap_or(0) + at)
        else {
            let hint =
                "write `path : at = 40 120, size = 160 60` or `source -> target : via = 40 80, 120 80`";
            return self.report(
                Diagnostic::error("E0243", span, "an entry has a path, `:` and settings").with_hint(hint),
            );
        };
        let head = Span::new(span.start, colon);
        let keys = if arrow.is_some() { &[BENDS_KEY][..] } else { &FRAME_KEYS };
        let of = match arrow {
            Some(arrow) => self.placed_transition(blanked, head, span.start + arrow),
            None => self.path(blanked, head).map(LayoutTarget::State),
        };
        let mut said = LayoutSettings::default();
        for (key, value) in self.settings(blanked, Span::new(colon + 1, span.end), keys) {
            self.layout_setting(blanked, key, value, keys, &mut said);
        }
        let text = text::one_line(text);
        let Some(of) = of else { return };
        self.srm.layout.push(LayoutEntry { of, frame: said.frame, bends: said.bends, text, span });
    }

    /// `[scope:] source -> target [also [number]]`.
    fn placed_transition(&mut self, blanked: &str, head: Span, arrow: usize) -> Option<LayoutTarget> {
        let scope_end = blanked[head.start..arrow].find(':').map(|colon| head.start + colon);
        let scope = scope_end.map(|colon| self.path(blanked, Span::new(head.start, colon)));
        let source = self.path(blanked, Span::new(scope_end.map_or(head.start, |colon| colon + 1), arrow));
        let words = arrow + 2 + modifiers_start(&blanked[arrow + 2..head.end]);
        let target = self.path(blanked, Span::new(arrow + 2, words));
        let beside = self.beside(blanked, Span::new(words, head.end));
        let (source, target, beside) = (source?, target?, beside?);
        Some(match scope {
            None => LayoutTarget::Transition { source, target, parallel: beside },
            Some(scope) => {
                let scope = scope?;
                LayoutTarget::Transition {
                    source: source.within(&scope),
                    target: target.within(&scope),
                    parallel: beside,
                }
            }
        })
    }

    /// Empty for the transition of the formulas; `also` or `also 2` for those added in parallel.
    fn beside(&mut self, blanked: &str, span: Span) -> Option<usize> {
        let word = text::trimmed(blanked, span);
        let words: Vec<&str> = blanked[span.start..span.end].split_whitespace().collect();
        let number = match words.as_slice() {
            [] => Some(0),
            ["also"] => Some(1),
            ["also", number] => number.parse().ok().filter(|number| *number > 0),
            _ => None,
        };
        if number.is_none() {
            let message = format!("`{}` is not a modifier of a transition", &blanked[word.start..word.end]);
            let hint =
                "in a layout a target may be followed by `also`, or `also 2` for the second added transition";
            self.report(Diagnostic::error("E0242", word, message).with_hint(hint));
        }
        number
    }

    fn layout_setting(
        &mut self,
        blanked: &str,
        key: Span,
        value: Span,
        keys: &[&str],
        said: &mut LayoutSettings,
    ) {
        let (name, text) = (&blanked[key.start..key.end], &blanked[value.start..value.end]);
        let (understood, hint) = match name {
            _ if !keys.contains(&name) => {
                let what = if keys.contains(&BENDS_KEY) { "transition" } else { "state" };
                let message = format!("the layout of a {what} has no `{name}`");
                let hint = format!("keys are {}", keys.join(", "));
                let error = Diagnostic::error("E0244", key, message).with_hint(hint);
                return self.report(error.with_nearest(name, keys.iter().copied()));
            }
            "at" => {
                said.frame.at = layout::parse_position(text);
                (said.frame.at.is_some(), POSITION_FORM)
            }
            "size" => {
                said.frame.size = layout::size(text);
                (said.frame.size.is_some(), SIZE_FORM)
            }
            _ => {
                let bends = layout::bends(text);
                let understood = bends.is_some();
                said.bends = bends.unwrap_or_default();
                (understood, CORNERS_FORM)
            }
        };
        if !understood {
            let message = format!("`{text}` is not a value for `{name}`");
            let span = if value.start < value.end { value } else { key };
            self.report(Diagnostic::error("E0245", span, message).with_hint(hint));
        }
    }
}

#[derive(Default)]
struct LayoutSettings {
    frame: Frame,
    bends: Vec<Point>,
}
