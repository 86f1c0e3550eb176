//! Lexical rules shared by all readers of model text: comments, positions of lines, spelling of
//! names.

use yase::Span;

/// Replaces comments (`#` to the end of the line, except within double quotes), carriage returns
/// and the byte order mark by blanks, so that all byte positions stay the same. A backslash within
/// quotes escapes the next character.
pub fn without_comments(text: &str) -> String {
    let mut blanked = String::with_capacity(text.len());
    let (mut quotes, mut comment) = (QuoteScanner::default(), false);
    for character in text.chars() {
        if character == '\n' {
            (quotes, comment) = (QuoteScanner::default(), false);
        } else {
            comment = comment || !quotes.hold(character) && character == '#';
        }
        if comment || matches!(character, '\r' | '\u{feff}') {
            blanked.extend(std::iter::repeat_n(' ', character.len_utf8()));
        } else {
            blanked.push(character);
        }
    }
    blanked
}

/// Whether a part of a line has no comment and no open quote, so that it can be written unchanged.
pub fn is_plain(text: &str) -> bool {
    let mut quotes = QuoteScanner::default();
    let is_plain = |character: char| {
        let quoted = quotes.hold(character);
        !character.is_control() && character != '\u{feff}' && (quoted || character != '#')
    };
    text.chars().all(is_plain) && !quotes.are_open() && text.trim() == text
}

/// Scans a line and tracks double quotes, in which a backslash escapes the next character.
#[derive(Default)]
pub struct QuoteScanner {
    open: bool,
    escaped: bool,
}

impl QuoteScanner {
    /// Advances by one character; returns whether it is quoted or a quote.
    pub fn hold(&mut self, letter: char) -> bool {
        let held = self.open || letter == '"';
        if std::mem::take(&mut self.escaped) {
            return held;
        }
        self.escaped = self.open && letter == '\\';
        self.open ^= letter == '"';
        held
    }

    /// Whether a quote is open.
    pub fn are_open(&self) -> bool {
        self.open
    }
}

/// A text on one line, with single blanks outside double quotes.
pub fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    let (mut quotes, mut is_apart) = (QuoteScanner::default(), false);
    for character in text.trim().chars() {
        if character == '\n' {
            // no quote is open beyond its line
            quotes = QuoteScanner::default();
        }
        if !quotes.hold(character) && character.is_whitespace() {
            is_apart = true;
            continue;
        }
        if std::mem::take(&mut is_apart) {
            line.push(' ');
        }
        line.push(character);
    }
    line
}

/// The first position of a text outside quotes.
pub fn outside_quotes(text: &str, wanted: &str) -> Option<usize> {
    let mut quotes = QuoteScanner::default();
    let mut letters = text.char_indices();
    letters.find(|&(at, letter)| !quotes.hold(letter) && text[at..].starts_with(wanted)).map(|(at, _)| at)
}

/// The comments that start within a span, in order, each with its `#`.
pub fn comments_within(text: &str, span: Span) -> Vec<&str> {
    let blanked = without_comments(text);
    lines_of(text, span).filter_map(|line| comment_of(text, &blanked, line)).collect()
}

/// All comments of a text with their positions.
pub fn comments(text: &str) -> Vec<(Span, &str)> {
    let blanked = without_comments(text);
    let lines = lines_of(text, Span::new(0, text.len()));
    let starts = lines.filter_map(|line| Some((comment_start(text, &blanked, line)?, line.end)));
    starts.map(|(start, end)| (Span::new(start, end), text[start..end].trim_end())).collect()
}

/// The comment on a line, with its `#`.
pub fn comment_of<'a>(text: &'a str, blanked: &str, line: Span) -> Option<&'a str> {
    comment_start(text, blanked, line).map(|start| text[start..line.end].trim_end())
}

fn comment_start(text: &str, blanked: &str, line: Span) -> Option<usize> {
    let (text, blanked) = (&text[line.start..line.end], &blanked[line.start..line.end]);
    let differs =
        text.char_indices().find(|&(at, character)| character == '#' && blanked[at..].starts_with(' '));
    differs.map(|(at, _)| line.start + at)
}

/// The lines within a span, without their line breaks.
pub fn lines_of(text: &str, span: Span) -> impl Iterator<Item = Span> {
    let mut start = span.start;
    text[span.start..span.end].split_inclusive('\n').map(move |line| {
        let content = Span::new(start, start + line.trim_end_matches('\n').len());
        start += line.len();
        content
    })
}

/// The span without blanks at both ends.
pub fn trimmed(text: &str, span: Span) -> Span {
    let part = &text[span.start..span.end];
    let start = span.start + (part.len() - part.trim_start().len());
    Span::new(start, start + part.trim().len())
}

/// Whether a character may occur in a name.
pub fn is_name_character(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '_'
}

/// Whether a text is a name: letters, digits and underscores.
pub fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(is_name_character)
}

/// Whether a character is a notation of "forever".
pub fn is_forever(character: char) -> bool {
    matches!(character, '~' | 'ω' | 'Ω' | '\u{2126}')
}

/// The normalised text of a term: no blanks, `~` for forever, no `^`.
pub fn canonical_name(text: &str) -> String {
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
    fn an_escaped_quote_does_not_end_a_text() {
        assert_eq!(without_comments(r#""a \" # b" # c"#), r#""a \" # b"    "#);
        assert_eq!(without_comments(r#""a \\" # b"#), r#""a \\"    "#);
    }

    #[test]
    fn one_line_keeps_the_blanks_within_quotes() {
        assert_eq!(one_line(" a  ->\tb :\r\n  [x ==  \"c  d\"]  \n"), "a -> b : [x == \"c  d\"]");
        assert_eq!(one_line("\"a  \\\"  b\"  c"), "\"a  \\\"  b\" c");
        assert_eq!(one_line("\"a\n  b  c"), "\"a b c");
        assert_eq!(one_line(" \n "), "");
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
