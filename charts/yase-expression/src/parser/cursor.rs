//! Position in the tokens of a text, with the diagnostics found so far.

use crate::diagnostic::{Diagnostic, Span};
use crate::lexer::{Symbol, Token, TokenKind, tokens};
use crate::syntax::TextPosition;

/// The parsed part, or an error whose diagnostic has been recorded.
pub(crate) type Parsed<T> = Result<T, ParseAborted>;

/// A part was rejected; its diagnostic is among those of the [`Cursor`].
#[derive(Debug)]
pub(crate) struct ParseAborted;

/// Reads tokens in sequence; the grammar is in the sibling modules.
pub(crate) struct Cursor<'t> {
    text: &'t str,
    offset: usize,
    tokens: Vec<Token>,
    next: usize,
    pub(crate) depth: usize,
    diagnostics: Vec<Diagnostic>,
}

impl<'t> Cursor<'t> {
    pub(crate) fn new(text: &'t str, offset: usize) -> Cursor<'t> {
        Cursor { text, offset, tokens: tokens(text), next: 0, depth: 0, diagnostics: Vec::new() }
    }

    pub(crate) fn into_diagnostics(self) -> Vec<Diagnostic> {
        let offset = self.offset;
        self.diagnostics.into_iter().map(|diagnostic| diagnostic.shifted(offset)).collect()
    }

    pub(crate) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub(crate) fn refuse<T>(&mut self, diagnostic: Diagnostic) -> Parsed<T> {
        self.report(diagnostic);
        Err(ParseAborted)
    }

    /// Rejects the current token: an invalid token has its own code, others get `code` and the
    /// expected text.
    pub(crate) fn refuse_here<T>(&mut self, code: &'static str, expected: &str, hint: &str) -> Parsed<T> {
        let diagnostic = self.not_a_token().unwrap_or_else(|| {
            let message = format!("{expected} is expected, not {}", self.found());
            Diagnostic::error(code, self.span(), message).with_hint(hint)
        });
        self.refuse(diagnostic)
    }

    /// Diagnostic for the current token if it is invalid in any position.
    pub(crate) fn not_a_token(&self) -> Option<Diagnostic> {
        match self.kind() {
            TokenKind::Unknown => {
                let message = format!("{} has no meaning here", self.found());
                Some(
                    Diagnostic::error("E0101", self.span(), message)
                        .with_hint("names are letters, digits and `_`"),
                )
            }
            TokenKind::Unclosed => {
                let quote = if self.here().starts_with('"') { "\"" } else { "`" };
                let span = Span::new(self.span().start, self.span().start + quote.len());
                let message = format!("{quote} is not closed");
                Some(Diagnostic::error("E0102", span, message).with_hint(format!("close it with {quote}")))
            }
            _ => None,
        }
    }

    /// The current token; at the end of the text always [`TokenKind::End`].
    pub(crate) fn token(&self) -> Token {
        let end = Token { kind: TokenKind::End, span: Span::new(self.text.len(), self.text.len()) };
        self.tokens.get(self.next).copied().unwrap_or(end)
    }

    pub(crate) fn kind(&self) -> TokenKind {
        self.token().kind
    }

    pub(crate) fn span(&self) -> Span {
        self.token().span
    }

    /// The token after the current one.
    pub(crate) fn following(&self) -> TokenKind {
        self.tokens.get(self.next + 1).map_or(TokenKind::End, |token| token.kind)
    }

    /// The text of a span.
    pub(crate) fn source(&self, span: Span) -> &'t str {
        self.text.get(span.start..span.end).unwrap_or_default()
    }

    /// The text of the current token.
    pub(crate) fn here(&self) -> &'t str {
        self.source(self.span())
    }

    /// The current token if it is a word.
    pub(crate) fn word(&self) -> Option<&'t str> {
        (self.kind() == TokenKind::Word).then(|| self.here())
    }

    /// Name of the current token in diagnostics.
    pub(crate) fn found(&self) -> String {
        match self.kind() {
            TokenKind::End => "the end".to_owned(),
            _ => format!("`{}`", self.here()),
        }
    }

    /// The position of a span in the larger text.
    pub(crate) fn position(&self, span: Span) -> TextPosition {
        TextPosition(span.shifted(self.offset))
    }

    /// The span of a position: the inverse of [`Cursor::place`].
    pub(crate) fn local(&self, position: TextPosition) -> Span {
        Span::new(position.0.start - self.offset, position.0.end - self.offset)
    }

    /// From `start` to the end of the previous token.
    pub(crate) fn since(&self, start: usize) -> Span {
        let end = self
            .next
            .checked_sub(1)
            .and_then(|last| self.tokens.get(last))
            .map_or(start, |token| token.span.end);
        Span::new(start, end.max(start))
    }

    pub(crate) fn advance(&mut self) -> Token {
        let token = self.token();
        self.next += 1;
        token
    }

    pub(crate) fn at(&self, symbol: Symbol) -> bool {
        self.kind() == TokenKind::Symbol(symbol)
    }

    pub(crate) fn accept(&mut self, symbol: Symbol) -> bool {
        let found = self.at(symbol);
        if found {
            self.advance();
        }
        found
    }

    pub(crate) fn accept_word(&mut self, word: &str) -> bool {
        let found = self.word() == Some(word);
        if found {
            self.advance();
        }
        found
    }

    /// Skips to the first token of a kind, or to the end.
    pub(crate) fn skip_until(&mut self, stop: impl Fn(TokenKind) -> bool) {
        while self.kind() != TokenKind::End && !stop(self.kind()) {
            self.advance();
        }
    }

    pub(crate) fn expect_close_parenthesis(&mut self, open: Span) -> Parsed<()> {
        if self.accept(Symbol::CloseParenthesis) {
            return Ok(());
        }
        self.refuse_closing("E0109", open, "(", ")")
    }

    /// The name that a path such as `blue-2.` probably starts with, if the current token is its
    /// dot.
    fn hyphenated_name(&self) -> Option<&'t str> {
        let before = &self.tokens[..self.next.min(self.tokens.len())];
        let [.., first, hyphen, last] = before else { return None };
        let is_name = first.kind == TokenKind::Word
            && hyphen.kind == TokenKind::Symbol(Symbol::Minus)
            && last.kind == TokenKind::Integer
            && first.span.end == hyphen.span.start
            && hyphen.span.end == last.span.start;
        (self.at(Symbol::Dot) && is_name).then(|| self.source(first.span.to(last.span)))
    }

    pub(crate) fn expect_close_bracket(&mut self, open: Span) -> Parsed<()> {
        if self.accept(Symbol::CloseBracket) {
            return Ok(());
        }
        self.refuse_closing("E0110", open, "[", "]")
    }

    /// At the end or at a closing bracket, reports the brackets; otherwise the token in the place
    /// of an operator.
    fn refuse_closing(&mut self, code: &'static str, open: Span, opening: &str, closing: &str) -> Parsed<()> {
        if opening == "[" && self.at(Symbol::CloseParenthesis) {
            let diagnostic = Diagnostic::error("E0109", self.span(), "`)` closes nothing");
            return self.refuse(diagnostic.with_hint("remove it, or add `(`"));
        }
        if matches!(
            self.kind(),
            TokenKind::End | TokenKind::Symbol(Symbol::CloseBracket | Symbol::CloseParenthesis)
        ) {
            let message = format!("`{opening}` is not closed");
            return self.refuse(Diagnostic::error(code, open, message).with_hint(format!("add `{closing}`")));
        }
        self.refuse_operator(&format!("an operator or `{closing}`"))
    }

    /// Rejects a token after a complete operand that is not an operator.
    pub(crate) fn refuse_operator(&mut self, expected: &str) -> Parsed<()> {
        if let Some(name) = self.hyphenated_name() {
            let hint = format!("a name with a hyphen is written in backquotes: `` `{name}` ``");
            return self.refuse_here("E0107", expected, &hint);
        }
        self.refuse_here(
            "E0107",
            expected,
            "names have no blanks, numbers no unit; operators are `&&`, `||`, `==`, `<` and the like",
        )
    }
}
