//! The trigger, the part before the brackets and the slash.

use super::cursor::{Cursor, Parsed};
use crate::diagnostic::Diagnostic;
use crate::lexer::{Symbol, TokenKind};
use crate::syntax::{Path, Trigger};

impl Cursor<'_> {
    /// Whether the guard, the actions or the end follows.
    pub(crate) fn at_section(&self) -> bool {
        is_section(self.kind())
    }

    /// Parses the trigger; an invalid one is skipped.
    pub(crate) fn trigger_or_skip(&mut self) -> Option<Trigger> {
        let trigger = self.trigger();
        if trigger.is_err() {
            self.skip_until(is_section);
        }
        trigger.ok()
    }

    fn trigger(&mut self) -> Parsed<Trigger> {
        let trigger = if self.accept(Symbol::Star) {
            Trigger::Any
        } else if self.accept(Symbol::Bang) || self.accept_word("not") {
            Trigger::Not(self.negated_event()?)
        } else {
            Trigger::OneOf(self.alternatives()?)
        };
        if self.at_section() {
            return Ok(trigger);
        }
        self.refuse_trigger()
    }

    fn alternatives(&mut self) -> Parsed<Vec<Path>> {
        let mut events = vec![self.event()?];
        while self.accept(Symbol::Bar) || self.accept(Symbol::DoubleBar) || self.accept_word("or") {
            events.push(self.event()?);
        }
        Ok(events)
    }

    /// `e` or `(e)`.
    fn negated_event(&mut self) -> Parsed<Path> {
        let open = self.span();
        if !self.accept(Symbol::OpenParenthesis) {
            return self.event();
        }
        let event = self.event()?;
        self.expect_close_parenthesis(open)?;
        Ok(event)
    }

    fn event(&mut self) -> Parsed<Path> {
        match self.kind() {
            TokenKind::Word | TokenKind::Quoted => self.path(),
            _ => self.refuse_trigger(),
        }
    }

    fn refuse_trigger<T>(&mut self) -> Parsed<T> {
        let hint = match self.kind() {
            TokenKind::Symbol(Symbol::Comma | Symbol::Semicolon) => "alternative events are written `a | b`",
            _ => "an event is a name; conditions are in brackets, actions after `/`",
        };
        let message = match self.kind() {
            TokenKind::End => "an event is expected, not the end".to_owned(),
            _ => format!("{} does not belong to a trigger", self.found()),
        };
        let diagnostic = self
            .not_a_token()
            .unwrap_or_else(|| Diagnostic::error("E0116", self.span(), message).with_hint(hint));
        self.refuse(diagnostic)
    }
}

fn is_section(kind: TokenKind) -> bool {
    matches!(kind, TokenKind::End | TokenKind::Symbol(Symbol::OpenBracket | Symbol::Slash))
}
