//! The lexer. It never fails: characters that form no token are passed to the parser, which reports
//! them.

use yase::Span;

/// The kind of a token. Its text is found by its span.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum PropertyTokenKind {
    /// Letters, digits, `_`, `/` and `.`: a keyword, a name, or a number.
    Word,
    /// A name in backquotes.
    Quoted,
    /// A text in double quotes.
    Text,
    /// A condition with its brackets.
    Condition,
    /// An unclosed quote or bracket and the text after it.
    Unclosed,
    /// `(`
    Open,
    /// `)`
    Close,
    /// `:`
    Colon,
    /// A character that starts no token.
    Unknown,
    /// The end of the text.
    End,
}

/// A token and its span.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Token {
    pub(crate) kind: PropertyTokenKind,
    pub(crate) span: Span,
}

/// The keywords.
const KEYWORDS: [&str; 16] = [
    "property",
    "always",
    "eventually",
    "until",
    "within",
    "not",
    "and",
    "or",
    "implies",
    "in",
    "entering",
    "leaving",
    "event",
    "true",
    "false",
    "s",
];

/// Whether a word is a keyword.
pub(crate) fn is_keyword(word: &str) -> bool {
    KEYWORDS.contains(&word) || word == "ms"
}

/// The keywords.
pub(crate) fn keywords() -> impl Iterator<Item = &'static str> {
    KEYWORDS.into_iter()
}

/// Whether a character may occur in a name without backquotes.
pub(crate) fn is_bare(character: char) -> bool {
    character.is_ascii_alphanumeric() || matches!(character, '_' | '/' | '.')
}

/// All tokens of a text, the last of which is [`PropertyTokenKind::End`].
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut start = 0;
    loop {
        start += blanks(&text[start..]);
        let (kind, length) = first(&text[start..]);
        tokens.push(Token { kind, span: Span::new(start, start + length) });
        if kind == PropertyTokenKind::End {
            return tokens;
        }
        start += length;
    }
}

/// The length of white space and comments.
fn blanks(text: &str) -> usize {
    let mut rest = text.trim_start();
    while rest.starts_with('#') {
        rest = rest.find('\n').map_or("", |end| &rest[end..]).trim_start();
    }
    text.len() - rest.len()
}

fn first(text: &str) -> (PropertyTokenKind, usize) {
    match text.chars().next() {
        None => (PropertyTokenKind::End, 0),
        Some('(') => (PropertyTokenKind::Open, 1),
        Some(')') => (PropertyTokenKind::Close, 1),
        Some(':') => (PropertyTokenKind::Colon, 1),
        Some('`') => quoted(text, '`', PropertyTokenKind::Quoted),
        Some('"') => quoted(text, '"', PropertyTokenKind::Text),
        Some('[') => condition(text),
        Some(first) if is_bare(first) => {
            (PropertyTokenKind::Word, text.find(|character| !is_bare(character)).unwrap_or(text.len()))
        }
        Some(first) => (PropertyTokenKind::Unknown, first.len_utf8()),
    }
}

/// A quoted text, which must end in its line.
fn quoted(text: &str, quote: char, kind: PropertyTokenKind) -> (PropertyTokenKind, usize) {
    match text[1..].find([quote, '\n']) {
        Some(end) if text[1 + end..].starts_with(quote) => (kind, end + 2),
        Some(end) => (PropertyTokenKind::Unclosed, end + 1),
        None => (PropertyTokenKind::Unclosed, text.len()),
    }
}

/// A condition ends at the bracket that is outside its texts and quoted names.
fn condition(text: &str) -> (PropertyTokenKind, usize) {
    let (mut quote, mut escaped) = (None, false);
    for (index, character) in text.char_indices().skip(1) {
        match (quote, character) {
            (Some('"'), '\\') if !escaped => {
                escaped = true;
                continue;
            }
            (Some(open), close) if open == close && !escaped => quote = None,
            (None, '"' | '`') => quote = Some(character),
            (None, ']') => return (PropertyTokenKind::Condition, index + 1),
            _ => {}
        }
        escaped = false;
    }
    (PropertyTokenKind::Unclosed, text.len())
}
