//! Splits text into tokens.

use std::sync::Arc;

use super::{ScriptErrorKind, Unsupported};
use yase::diagnostic::Span;

/// A token with its position.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Token {
    pub(crate) kind: TokenKind,
    pub(crate) span: Span,
    /// Whether a line ends before it: then a statement may end there.
    pub(crate) on_new_line: bool,
}

/// Kind of a token.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum TokenKind {
    Number(f64),
    Text(Arc<str>),
    /// A name or a keyword; its text is found by its span.
    Word,
    Symbol(&'static str),
    End,
}

/// Longer symbols first, so that the first match is the right one.
const SYMBOLS: [&str; 47] = [
    ">>>", "===", "!==", "...", "**=", "<<=", ">>=", "&&=", "||=", "==", "!=", "<=", ">=", "&&", "||", "++",
    "--", "+=", "-=", "*=", "/=", "%=", "=>", "**", "<<", ">>", "(", ")", "[", "]", "{", "}", ",", ";", ":",
    "?", ".", "<", ">", "+", "-", "*", "/", "%", "!", "=", "&",
];

/// Symbols of ECMAScript that are outside the subset and are not in [`SYMBOLS`].
const UNSUPPORTED_SYMBOLS: [char; 5] = ['|', '^', '~', '`', '@'];

/// Splits a text into tokens without comments. The last token is the end.
pub(crate) fn tokens(text: &str) -> Result<Vec<Token>, Unsupported> {
    let mut lexer = Lexer { text, at: 0, tokens: Vec::new(), on_new_line: false };
    lexer.skip_blanks()?;
    while lexer.at < text.len() {
        lexer.token()?;
        lexer.skip_blanks()?;
    }
    lexer.push(text.len(), TokenKind::End);
    Ok(lexer.tokens)
}

struct Lexer<'a> {
    text: &'a str,
    at: usize,
    tokens: Vec<Token>,
    on_new_line: bool,
}

impl Lexer<'_> {
    fn remaining(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.remaining().chars().next()
    }

    fn push(&mut self, start: usize, kind: TokenKind) {
        let span = Span::new(start, self.at.max(start));
        self.tokens.push(Token { kind, span, on_new_line: self.on_new_line });
        self.on_new_line = false;
    }

    fn skip_blanks(&mut self) -> Result<(), Unsupported> {
        loop {
            let rest = self.remaining();
            let blank = rest.len() - rest.trim_start().len();
            self.on_new_line |= rest[..blank].contains('\n');
            self.at += blank;
            let rest = self.remaining();
            if rest.starts_with("//") {
                self.at += rest.find('\n').unwrap_or(rest.len());
            } else if rest.starts_with("/*") {
                let Some(length) = rest.find("*/") else {
                    return Err(self.malformed(self.at, self.text.len(), "the comment is not closed"));
                };
                self.on_new_line |= rest[..length].contains('\n');
                self.at += length + 2;
            } else {
                return Ok(());
            }
        }
    }

    fn malformed(&self, start: usize, end: usize, message: impl Into<String>) -> Unsupported {
        Unsupported {
            refusal: ScriptErrorKind::Malformed,
            span: Span::new(start, end),
            message: message.into(),
        }
    }

    fn token(&mut self) -> Result<(), Unsupported> {
        let start = self.at;
        let Some(first) = self.peek() else { return Ok(()) };
        let second_is_digit = self.remaining().chars().nth(1).is_some_and(|second| second.is_ascii_digit());
        if first.is_ascii_digit() || (first == '.' && second_is_digit) {
            return self.number(start);
        }
        if is_name_start(first) {
            self.take_while(is_name_part);
            self.push(start, TokenKind::Word);
            return Ok(());
        }
        if first == '"' || first == '\'' {
            return self.string(start, first);
        }
        self.symbol(start, first)
    }

    fn symbol(&mut self, start: usize, first: char) -> Result<(), Unsupported> {
        if let Some(symbol) = SYMBOLS.iter().find(|symbol| self.remaining().starts_with(**symbol)) {
            self.at += symbol.len();
            self.push(start, TokenKind::Symbol(symbol));
            return Ok(());
        }
        let end = start + first.len_utf8();
        if UNSUPPORTED_SYMBOLS.contains(&first) {
            let message = format!("`{first}` is outside the subset of ECMAScript that is understood");
            return Err(Unsupported {
                refusal: ScriptErrorKind::Unsupported,
                span: Span::new(start, end),
                message,
            });
        }
        Err(self.malformed(start, end, format!("`{first}` has no meaning here")))
    }

    fn take_while(&mut self, accept: impl Fn(char) -> bool) {
        let rest = self.remaining();
        self.at += rest.find(|character| !accept(character)).unwrap_or(rest.len());
    }

    fn number(&mut self, start: usize) -> Result<(), Unsupported> {
        let hexadecimal = ["0x", "0X"].iter().any(|prefix| self.remaining().starts_with(prefix));
        let value = if hexadecimal { self.hexadecimal() } else { self.decimal() };
        let follows = self.peek().is_some_and(is_name_part);
        match value {
            Some(value) if !follows => {
                self.push(start, TokenKind::Number(value));
                Ok(())
            }
            _ => {
                self.take_while(is_name_part);
                Err(self.malformed(start, self.at, "the number cannot be read"))
            }
        }
    }

    fn hexadecimal(&mut self) -> Option<f64> {
        self.at += 2;
        let start = self.at;
        self.take_while(|character| character.is_ascii_hexdigit());
        u64::from_str_radix(&self.text[start..self.at], 16).ok().map(|value| value as f64)
    }

    fn decimal(&mut self) -> Option<f64> {
        let start = self.at;
        self.take_while(|character| character.is_ascii_digit());
        if self.peek() == Some('.') {
            self.at += 1;
            self.take_while(|character| character.is_ascii_digit());
        }
        if matches!(self.peek(), Some('e' | 'E')) {
            self.at += 1;
            if matches!(self.peek(), Some('+' | '-')) {
                self.at += 1;
            }
            self.take_while(|character| character.is_ascii_digit());
        }
        self.text[start..self.at].parse().ok()
    }

    fn string(&mut self, start: usize, quote: char) -> Result<(), Unsupported> {
        self.at += 1;
        let mut value = String::new();
        loop {
            let index = self.at;
            let Some(character) = self.peek() else {
                return Err(self.malformed(start, index, "the text is not closed"));
            };
            self.at += character.len_utf8();
            match character {
                '\n' | '\r' => return Err(self.malformed(start, index, "the text is not closed")),
                '\\' => self.escape(index, &mut value)?,
                end if end == quote => break,
                other => value.push(other),
            }
        }
        self.push(start, TokenKind::Text(value.into()));
        Ok(())
    }

    fn escape(&mut self, start: usize, value: &mut String) -> Result<(), Unsupported> {
        let Some(character) = self.peek() else {
            return Err(self.malformed(start, self.at, "the text is not closed"));
        };
        self.at += character.len_utf8();
        match character {
            'n' => value.push('\n'),
            't' => value.push('\t'),
            'r' => value.push('\r'),
            'b' => value.push('\u{8}'),
            'f' => value.push('\u{c}'),
            'v' => value.push('\u{b}'),
            '0' => value.push('\0'),
            '\n' => {}
            'x' => value.push(self.code(start, 2)?),
            'u' => value.push(self.code(start, 4)?),
            other => value.push(other),
        }
        Ok(())
    }

    fn code(&mut self, start: usize, digits: usize) -> Result<char, Unsupported> {
        let code = self.text.get(self.at..self.at + digits);
        let character = code.and_then(|code| u32::from_str_radix(code, 16).ok()).and_then(char::from_u32);
        match character {
            Some(character) => {
                self.at += digits;
                Ok(character)
            }
            None => Err(self.malformed(start, self.at, "the escape is not a character")),
        }
    }
}

/// Whether a name may begin with this character.
pub(crate) fn is_name_start(character: char) -> bool {
    character.is_alphabetic() || character == '_' || character == '$'
}

fn is_name_part(character: char) -> bool {
    character.is_alphanumeric() || character == '_' || character == '$'
}
