//! Splits text into tokens. Never fails: invalid input becomes tokens that the parser rejects.

use crate::diagnostic::Span;

/// Kind of a token. Its text is found by its span.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum TokenKind {
    /// Letters, digits and underscores that do not form a number: `Ball`, `100ms`.
    Word,
    /// A name in backquotes.
    Quoted,
    /// Digits without fraction or exponent.
    Integer,
    /// Digits with a fraction, an exponent or both.
    Decimal,
    /// A text in double quotes.
    Text,
    /// `"` or a backquote without its end, with the rest of the text.
    Unclosed,
    /// An operator or a bracket.
    Symbol(Symbol),
    /// A character without a meaning.
    Unknown,
    /// The end of the text.
    End,
}

/// Operators and brackets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Symbol {
    OpenParenthesis,
    CloseParenthesis,
    OpenBracket,
    CloseBracket,
    DoubleColon,
    Dot,
    Comma,
    Semicolon,
    DoubleBar,
    Bar,
    DoubleAmpersand,
    Ampersand,
    Equal,
    Assign,
    NotEqual,
    Bang,
    LessOrEqual,
    Less,
    GreaterOrEqual,
    Greater,
    Plus,
    Minus,
    Star,
    Slash,
}

/// Of two symbols with a common prefix the longer comes first.
const SYMBOLS: [(&str, Symbol); 24] = [
    ("::", Symbol::DoubleColon),
    ("||", Symbol::DoubleBar),
    ("&&", Symbol::DoubleAmpersand),
    ("==", Symbol::Equal),
    ("!=", Symbol::NotEqual),
    ("<=", Symbol::LessOrEqual),
    (">=", Symbol::GreaterOrEqual),
    ("(", Symbol::OpenParenthesis),
    (")", Symbol::CloseParenthesis),
    ("[", Symbol::OpenBracket),
    ("]", Symbol::CloseBracket),
    (".", Symbol::Dot),
    (",", Symbol::Comma),
    (";", Symbol::Semicolon),
    ("|", Symbol::Bar),
    ("&", Symbol::Ampersand),
    ("=", Symbol::Assign),
    ("!", Symbol::Bang),
    ("<", Symbol::Less),
    (">", Symbol::Greater),
    ("+", Symbol::Plus),
    ("-", Symbol::Minus),
    ("*", Symbol::Star),
    ("/", Symbol::Slash),
];

/// A token and its span.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Token {
    pub(crate) kind: TokenKind,
    pub(crate) span: Span,
}

/// All tokens of a text; the last is [`TokenKind::End`].
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut start = 0;
    loop {
        start += blanks(&text[start..]);
        let (kind, length) = first_token(&text[start..]);
        tokens.push(Token { kind, span: Span::new(start, start + length) });
        if kind == TokenKind::End {
            return tokens;
        }
        start += length;
    }
}

/// Whether a character can occur in a name without backquotes.
pub(crate) fn is_word_character(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '_'
}

fn blanks(text: &str) -> usize {
    text.len() - text.trim_start().len()
}

fn first_token(text: &str) -> (TokenKind, usize) {
    match text.chars().next() {
        None => (TokenKind::End, 0),
        Some('"') => text_literal(text),
        Some('`') => quoted_name(text),
        Some(first) if first.is_ascii_digit() => number_or_word(text),
        Some(first) if is_word_character(first) => (TokenKind::Word, word_length(text)),
        Some(first) => symbol(text).unwrap_or((TokenKind::Unknown, first.len_utf8())),
    }
}

fn symbol(text: &str) -> Option<(TokenKind, usize)> {
    let (spelling, symbol) = SYMBOLS.iter().find(|(spelling, _)| text.starts_with(spelling))?;
    Some((TokenKind::Symbol(*symbol), spelling.len()))
}

fn quoted_name(text: &str) -> (TokenKind, usize) {
    match text[1..].find('`') {
        Some(length) => (TokenKind::Quoted, length + 2),
        None => (TokenKind::Unclosed, text.len()),
    }
}

fn text_literal(text: &str) -> (TokenKind, usize) {
    let mut escaped = false;
    for (index, character) in text.char_indices().skip(1) {
        match character {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return (TokenKind::Text, index + 1),
            _ => {}
        }
    }
    (TokenKind::Unclosed, text.len())
}

fn word_length(text: &str) -> usize {
    text.find(|character| !is_word_character(character)).unwrap_or(text.len())
}

fn digits(text: &str) -> usize {
    text.find(|character: char| !character.is_ascii_digit()).unwrap_or(text.len())
}

/// A word that begins with a digit is a number if the number spans the whole word: `100`, `0.5`,
/// `1e-3`, but not `100ms`.
fn number_or_word(text: &str) -> (TokenKind, usize) {
    let whole = digits(text);
    let fraction = match text[whole..].strip_prefix('.').map(digits) {
        None | Some(0) => 0,
        Some(length) => length + 1,
    };
    let exponent = exponent_length(&text[whole + fraction..]);
    let length = whole + fraction + exponent;
    if fraction + exponent > 0 {
        return (TokenKind::Decimal, length);
    }
    match word_length(text) {
        word if word > whole => (TokenKind::Word, word),
        _ => (TokenKind::Integer, whole),
    }
}

fn exponent_length(text: &str) -> usize {
    let Some(rest) = text.strip_prefix(['e', 'E']) else {
        return 0;
    };
    let sign = usize::from(rest.starts_with(['+', '-']));
    match digits(&rest[sign..]) {
        0 => 0,
        // `1e5m` is not a number
        count if word_length(&rest[sign + count..]) > 0 => 0,
        count => 1 + sign + count,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<(TokenKind, &str)> {
        let mut kinds: Vec<_> =
            tokens(text).iter().map(|token| (token.kind, &text[token.span.start..token.span.end])).collect();
        assert_eq!(kinds.pop(), Some((TokenKind::End, "")));
        kinds
    }

    #[test]
    fn the_longest_symbol_is_taken() {
        let expected = ["||", "|", "<=", "<", "==", "=", "!=", "!", "::"];
        let found: Vec<_> = kinds("||| <=< === !=! ::").into_iter().map(|(_, text)| text).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn numbers_end_where_their_word_ends() {
        assert_eq!(kinds("100"), [(TokenKind::Integer, "100")]);
        assert_eq!(kinds("1e-3"), [(TokenKind::Decimal, "1e-3")]);
        assert_eq!(kinds("2.50E2"), [(TokenKind::Decimal, "2.50E2")]);
        assert_eq!(kinds("100ms"), [(TokenKind::Word, "100ms")]);
        assert_eq!(kinds("1e5m"), [(TokenKind::Word, "1e5m")]);
        assert_eq!(kinds("0.25m"), [(TokenKind::Decimal, "0.25"), (TokenKind::Word, "m")]);
        let dot = TokenKind::Symbol(Symbol::Dot);
        assert_eq!(kinds("a.1"), [(TokenKind::Word, "a"), (dot, "."), (TokenKind::Integer, "1")]);
        assert_eq!(kinds("1."), [(TokenKind::Integer, "1"), (dot, ".")]);
    }

    #[test]
    fn quotes_close_or_swallow_the_rest() {
        assert_eq!(kinds(r#""a\"b" c"#), [(TokenKind::Text, r#""a\"b""#), (TokenKind::Word, "c")]);
        assert_eq!(kinds("`a.b` c"), [(TokenKind::Quoted, "`a.b`"), (TokenKind::Word, "c")]);
        assert_eq!(kinds("a \"b"), [(TokenKind::Word, "a"), (TokenKind::Unclosed, "\"b")]);
        assert_eq!(kinds("`b c"), [(TokenKind::Unclosed, "`b c")]);
    }

    #[test]
    fn other_characters_are_unknown_one_at_a_time() {
        assert_eq!(kinds("ω#"), [(TokenKind::Unknown, "ω"), (TokenKind::Unknown, "#")]);
    }
}
