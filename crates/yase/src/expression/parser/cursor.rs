//! A place in the tokens of a text, and the diagnostics found so far.

use crate::diagnostic::{Diagnostic, Span};
use crate::expression::lexer::{Symbol, Token, TokenKind, tokens};
use crate::expression::syntax::Place;

/// What could be read, or nothing if a diagnostic says why not.
pub(super) type Parsed<T> = Result<T, Refused>;

/// A part was refused; its diagnostic is among those of the [`Cursor`].
#[derive(Debug)]
pub(super) struct Refused;

/// Reads tokens one after the other; the methods that know the grammar stand in the sibling modules.
pub(super) struct Cursor<'t> {
    text: &'t str,
    offset: usize,
    tokens: Vec<Token>,
    next: usize,
    pub(super) depth: usize,
    diagnostics: Vec<Diagnostic>,
}

impl<'t> Cursor<'t> {
    pub(super) fn new(text: &'t str, offset: usize) -> Cursor<'t> {
        Cursor { text, offset, tokens: tokens(text), next: 0, depth: 0, diagnostics: Vec::new() }
    }

    pub(super) fn into_diagnostics(self) -> Vec<Diagnostic> {
        let offset = self.offset;
        self.diagnostics.into_iter().map(|diagnostic| diagnostic.shifted(offset)).collect()
    }

    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub(super) fn refuse<T>(&mut self, diagnostic: Diagnostic) -> Parsed<T> {
        self.report(diagnostic);
        Err(Refused)
    }

    /// Refuses the token that stands here: what is no token at all has a code of its own, else `code` and
    /// what was expected.
    pub(super) fn refuse_here<T>(&mut self, code: &'static str, expected: &str, hint: &str) -> Parsed<T> {
        let diagnostic = self.not_a_token().unwrap_or_else(|| {
            let message = format!("{expected} is expected, not {}", self.found());
            Diagnostic::error(code, self.span(), message).with_hint(hint)
        });
        self.refuse(diagnostic)
    }

    /// What is wrong with the token that stands here, wherever it stands.
    pub(super) fn not_a_token(&self) -> Option<Diagnostic> {
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
                let message = format!("what {quote} begins is not closed");
                Some(Diagnostic::error("E0102", span, message).with_hint(format!("close it with {quote}")))
            }
            _ => None,
        }
    }

    /// The token that stands here; at the end of the text it is [`TokenKind::End`], for ever.
    pub(super) fn token(&self) -> Token {
        let end = Token { kind: TokenKind::End, span: Span::new(self.text.len(), self.text.len()) };
        self.tokens.get(self.next).copied().unwrap_or(end)
    }

    pub(super) fn kind(&self) -> TokenKind {
        self.token().kind
    }

    pub(super) fn span(&self) -> Span {
        self.token().span
    }

    /// The token after this one.
    pub(super) fn following(&self) -> TokenKind {
        self.tokens.get(self.next + 1).map_or(TokenKind::End, |token| token.kind)
    }

    /// The bytes of a span.
    pub(super) fn source(&self, span: Span) -> &'t str {
        self.text.get(span.start..span.end).unwrap_or_default()
    }

    /// The bytes of the token that stands here.
    pub(super) fn here(&self) -> &'t str {
        self.source(self.span())
    }

    /// The word that stands here, if one does.
    pub(super) fn word(&self) -> Option<&'t str> {
        (self.kind() == TokenKind::Word).then(|| self.here())
    }

    /// How a message calls the token that stands here.
    pub(super) fn found(&self) -> String {
        match self.kind() {
            TokenKind::End => "the end".to_owned(),
            _ => format!("`{}`", self.here()),
        }
    }

    /// The place of a span in the larger text.
    pub(super) fn place(&self, span: Span) -> Place {
        Place(span.shifted(self.offset))
    }

    /// The span of a place: the way back from [`Cursor::place`].
    pub(super) fn local(&self, place: Place) -> Span {
        Span::new(place.0.start - self.offset, place.0.end - self.offset)
    }

    /// From `start` to the end of the token before this one.
    pub(super) fn since(&self, start: usize) -> Span {
        let end = self
            .next
            .checked_sub(1)
            .and_then(|last| self.tokens.get(last))
            .map_or(start, |token| token.span.end);
        Span::new(start, end.max(start))
    }

    pub(super) fn advance(&mut self) -> Token {
        let token = self.token();
        self.next += 1;
        token
    }

    pub(super) fn at(&self, symbol: Symbol) -> bool {
        self.kind() == TokenKind::Symbol(symbol)
    }

    pub(super) fn accept(&mut self, symbol: Symbol) -> bool {
        let found = self.at(symbol);
        if found {
            self.advance();
        }
        found
    }

    pub(super) fn accept_word(&mut self, word: &str) -> bool {
        let found = self.word() == Some(word);
        if found {
            self.advance();
        }
        found
    }

    /// Goes on to the first token of a kind, or to the end.
    pub(super) fn skip_until(&mut self, stop: impl Fn(TokenKind) -> bool) {
        while self.kind() != TokenKind::End && !stop(self.kind()) {
            self.advance();
        }
    }

    pub(super) fn expect_close_parenthesis(&mut self, open: Span) -> Parsed<()> {
        if self.accept(Symbol::CloseParenthesis) {
            return Ok(());
        }
        self.refuse_closing("E0109", open, "(", ")")
    }

    pub(super) fn expect_close_bracket(&mut self, open: Span) -> Parsed<()> {
        if self.accept(Symbol::CloseBracket) {
            return Ok(());
        }
        self.refuse_closing("E0110", open, "[", "]")
    }

    /// At the end or at a closing bracket the brackets are at fault, else what stands where an operator
    /// should.
    fn refuse_closing(&mut self, code: &'static str, open: Span, opening: &str, closing: &str) -> Parsed<()> {
        if opening == "[" && self.at(Symbol::CloseParenthesis) {
            let diagnostic = Diagnostic::error("E0109", self.span(), "`)` closes nothing");
            return self.refuse(diagnostic.with_hint("leave it out, or add `(`"));
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

    /// Refuses what follows a complete operand and is no operator.
    pub(super) fn refuse_operator(&mut self, expected: &str) -> Parsed<()> {
        self.refuse_here(
            "E0107",
            expected,
            "names have no blanks, numbers no unit; operators are `&&`, `||`, `==`, `<` and the like",
        )
    }
}
