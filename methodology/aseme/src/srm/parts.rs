//! The parts of an entry, for tools that edit a role's text.

use yase::Span;

use super::entries::modifiers_start;
use super::states::KEYS;
use super::{Reader, SrmFile, TransitionEntry};
use crate::text;

/// The parts of a transition's entry.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TransitionParts {
    /// Scope, source and target.
    pub ends: Span,
    /// The modifiers after the target, without surrounding blanks; empty at the end of
    /// [`ends`](TransitionParts::ends) if there are none.
    pub modifiers: Span,
    /// The position of the colon before the expression.
    pub colon: Option<usize>,
    /// The expression without surrounding blanks; empty at the end of the entry if there is none.
    pub expression: Span,
}

impl SrmFile {
    /// The parts of a transition's entry of this file.
    pub fn transition_parts(&self, entry: &TransitionEntry) -> TransitionParts {
        let blanked = text::without_comments(&self.text);
        let Span { start, end } = entry.span;
        let part = &blanked[start..end];
        let arrow = part.find("->").unwrap_or(part.len());
        let colon = part[arrow..].find(':').map(|colon| start + arrow + colon);
        let head_end = colon.unwrap_or(end);
        let target = (start + arrow + 2).min(head_end);
        let modifiers = target + modifiers_start(&blanked[target..head_end]);
        let ends = text::trimmed(&blanked, Span::new(start, modifiers));
        let modifiers = text::trimmed(&blanked, Span::new(modifiers, head_end));
        let modifiers =
            if modifiers.start < modifiers.end { modifiers } else { Span::new(ends.end, ends.end) };
        let expression = text::trimmed(&blanked, Span::new(colon.map_or(end, |colon| colon + 1), end));
        TransitionParts { ends, modifiers, colon, expression }
    }

    /// The keys and values of a state's entry of this file, in order.
    pub fn state_settings(&self, entry: Span) -> Vec<(Span, Span)> {
        let blanked = text::without_comments(&self.text);
        let colon = blanked[entry.start..entry.end].find(':');
        let start = colon.map_or(entry.end, |colon| entry.start + colon + 1);
        Reader::default().settings(&blanked, Span::new(start, entry.end), &KEYS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_an_entry_are_where_they_stand() {
        let text =
            "Liveness:\na = b ω . c\nTransitions:\n# ω\na: b -> c also !2 : [x\n  # why\n  && y]\nb -> b\n";
        let (file, _) = SrmFile::parse(text);
        let of = |index: usize| {
            let TransitionParts { ends, modifiers, colon, expression } =
                file.transition_parts(&file.srm().transitions[index]);
            let part = |span: Span| &text[span.start..span.end];
            (part(ends), part(modifiers), colon.is_some(), part(expression))
        };
        assert_eq!(of(0), ("a: b -> c", "also !2", true, "[x\n  # why\n  && y]"));
        assert_eq!(of(1), ("b -> b", "", false, ""));
    }
}
