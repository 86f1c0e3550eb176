//! References to states within expressions: `In(path)`.

use aseme::text;
use yase::Span;

/// The spans of a name within `In(...)` in a part of a text.
pub(crate) fn within_expressions(blanked: &str, part: Span, name: &str) -> Vec<Span> {
    let mut found = Vec::new();
    let expression = &blanked[part.start..part.end];
    for (at, _) in expression.match_indices("In(") {
        let is_word = !expression[..at].ends_with(text::is_name_character);
        let (start, mut depth) = (at + 3, 1_usize);
        let end = expression[start..].char_indices().find_map(|(at, letter)| {
            match letter {
                '(' => depth += 1,
                ')' => depth -= 1,
                _ => {}
            }
            (depth == 0).then_some(start + at)
        });
        if let (true, Some(end)) = (is_word, end) {
            found.extend(words(blanked, Span::new(part.start + start, part.start + end), name));
        }
    }
    found
}

/// The spans of a word in a part of a text.
pub(crate) fn words(blanked: &str, part: Span, name: &str) -> Vec<Span> {
    let content = &blanked[part.start..part.end];
    let is_word = |at: usize| {
        let (before, after) = (&content[..at], &content[at + name.len()..]);
        !before.ends_with(text::is_name_character) && !after.starts_with(text::is_name_character)
    };
    let starts = content.match_indices(name).map(|(at, _)| at).filter(|&at| is_word(at));
    starts.map(|at| Span::new(part.start + at, part.start + at + name.len())).collect()
}
