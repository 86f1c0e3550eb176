//! Names and paths.

use super::cursor::{Cursor, Parsed};
use crate::diagnostic::{Diagnostic, Span};
use crate::lexer::{Symbol, TokenKind};
use crate::syntax::{Name, Path};

/// Words that are names only in backquotes.
pub(crate) const RESERVED: [&str; 16] = [
    "and", "or", "not", "lt", "le", "gt", "ge", "eq", "ne", "true", "TRUE", "false", "FALSE", "NULL", "null",
    "nullptr",
];

impl Cursor<'_> {
    /// `a`, `a.b`, `` `x.y`.c ``, and with getters `a.b()`, `a.b().c()`.
    pub(crate) fn path(&mut self) -> Parsed<Path> {
        if self.word().is_some_and(|word| RESERVED.contains(&word)) {
            return self.refuse_here("E0115", "a name", "put a name that is a keyword into backquotes");
        }
        let start = self.span().start;
        let mut segments = vec![self.name()?];
        while self.accept(Symbol::Dot) {
            segments.push(self.name()?);
            self.accept_empty_parentheses();
        }
        Ok(Path { segments, position: self.position(self.since(start)) })
    }

    /// One segment of a path: a word, a function's name with its crate (`soccer::near`), or
    /// anything in backquotes.
    pub(crate) fn name(&mut self) -> Parsed<Name> {
        let span = self.span();
        match self.kind() {
            TokenKind::Word => self.plain_name(span),
            TokenKind::Quoted => self.quoted_name(span),
            _ => self.refuse_here(
                "E0115",
                "a name",
                "a name is letters, digits and `_`; put blanks around `lt`, `gt` and the like",
            ),
        }
    }

    fn plain_name(&mut self, first: Span) -> Parsed<Name> {
        self.advance();
        while self.at(Symbol::DoubleColon) && self.following() == TokenKind::Word {
            self.advance();
            self.advance();
        }
        let span = self.since(first.start);
        let text = self.source(span).split_whitespace().collect();
        Ok(Name { text, position: self.position(span) })
    }

    fn quoted_name(&mut self, span: Span) -> Parsed<Name> {
        let text = self.here().trim_matches('`').to_owned();
        self.advance();
        if text.is_empty() {
            let hint = "a topic's path is written `` `soccer.ball` ``";
            return self.refuse(
                Diagnostic::error("E0104", span, "there is no name in the backquotes").with_hint(hint),
            );
        }
        Ok(Name { text, position: self.position(span) })
    }

    fn accept_empty_parentheses(&mut self) {
        let empty = self.following() == TokenKind::Symbol(Symbol::CloseParenthesis);
        if self.at(Symbol::OpenParenthesis) && empty {
            self.advance();
            self.advance();
        }
    }
}
