//! What all readers of model text share: comments, lines with their places, and the spelling of names.

use yase::Span;

/// The text with every comment (`#` to the end of the line, unless within double quotes), carriage return and byte order mark
/// replaced by as many blanks, so that each byte keeps its place.
pub(crate) fn without_comments(text: &str) -> String {
    let mut blanked = String::with_capacity(text.len());
    let (mut quoted, mut comment) = (false, false);
    for character in text.chars() {
        match character {
            '\n' => (quoted, comment) = (false, false),
            '"' if !comment => quoted = !quoted,
            '#' if !quoted => comment = true,
            _ => {}
        }
        if comment || matches!(character, '\r' | '\u{feff}') {
            blanked.extend(std::iter::repeat_n(' ', character.len_utf8()));
        } else {
            blanked.push(character);
        }
    }
    blanked
}

/// The comments that begin within a span, in order, each with its `#`.
pub(crate) fn comments_within(text: &str, span: Span) -> Vec<&str> {
    let blanked = without_comments(text);
    let lines = lines_of(text, span);
    lines
        .filter_map(|line| comment_start(text, &blanked, line).map(|start| text[start..line.end].trim_end()))
        .collect()
}

fn comment_start(text: &str, blanked: &str, line: Span) -> Option<usize> {
    let (text, blanked) = (&text[line.start..line.end], &blanked[line.start..line.end]);
    let differs =
        text.char_indices().find(|&(at, character)| character == '#' && blanked[at..].starts_with(' '));
    differs.map(|(at, _)| line.start + at)
}

/// The lines within a span, without their line breaks.
pub(crate) fn lines_of(text: &str, span: Span) -> impl Iterator<Item = Span> {
    let mut start = span.start;
    text[span.start..span.end].split_inclusive('\n').map(move |line| {
        let content = Span::new(start, start + line.trim_end_matches('\n').len());
        start += line.len();
        content
    })
}

/// The part of a span that is left without blanks at both ends.
pub(crate) fn trimmed(text: &str, span: Span) -> Span {
    let part = &text[span.start..span.end];
    let start = span.start + (part.len() - part.trim_start().len());
    Span::new(start, start + part.trim().len())
}

/// Whether a character may stand in a name.
pub(crate) fn is_name_character(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '_'
}

/// Whether a text is a name: letters, digits and underscores.
pub(crate) fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(is_name_character)
}

/// Whether a character means "forever".
pub(crate) fn is_forever(character: char) -> bool {
    matches!(character, '~' | 'ω' | 'Ω' | '\u{2126}')
}

/// The spelling under which a chart keeps the name of a term: no blanks, `~` for forever, no `^`.
pub(crate) fn canonical_name(text: &str) -> String {
    let letters = text.chars().filter(|character| !character.is_whitespace() && *character != '^');
    letters.map(|character| if is_forever(character) { '~' } else { character }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_become_blanks_and_bytes_keep_their_place() {
        let text = "a = b # ω is forever\nc = \"#\" # d";
        let blanked = without_comments(text);
        assert_eq!(blanked.len(), text.len());
        assert_eq!(blanked, format!("a = b {}\nc = \"#\"    ", " ".repeat("# ω is forever".len())));
    }

    #[test]
    fn comments_within_a_span_are_found() {
        let text = "a = b # one\n  || c # two \n\"#\" d # three";
        assert_eq!(comments_within(text, Span::new(0, 18)), ["# one"]);
        assert_eq!(comments_within(text, Span::new(0, text.len())), ["# one", "# two", "# three"]);
    }

    #[test]
    fn lines_know_their_place() {
        let text = "x\nab\n\ncd";
        let lines: Vec<&str> =
            lines_of(text, Span::new(2, 8)).map(|line| &text[line.start..line.end]).collect();
        assert_eq!(lines, ["ab", "", "cd"]);
    }

    #[test]
    fn forever_has_one_spelling() {
        assert_eq!(canonical_name("Sensors ^ω || Vision Ω"), "Sensors~||Vision~");
    }
}
