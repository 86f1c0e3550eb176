//! Recursive descent parser.
//!
//! A part that cannot be parsed gets one diagnostic, is left out of the tree and is skipped: the
//! guard up to its bracket, an action up to its separator. Each mistake is thus reported exactly
//! once.

mod action;
mod condition;
mod cursor;
mod name;
mod operand;
mod trigger;

use super::lexer::{Symbol, TokenKind};
use super::syntax::{Action, Expression, TransitionExpression};
use crate::diagnostic::Diagnostic;
use cursor::{Cursor, Parsed};
pub(crate) use name::RESERVED;

/// Parses a transition expression, `trigger [guard] / actions`. An empty text, blanks and the word
/// `null` are the empty expression.
///
/// Returns the parsed tree and diagnostics. If one of them is an error, the tree lacks the rejected
/// part and must not be executed.
pub fn parse_transition(text: &str) -> (TransitionExpression, Vec<Diagnostic>) {
    parse_transition_at(text, 0)
}

/// Parses a transition expression that begins at byte `offset` of a larger text; positions refer to
/// that text.
pub fn parse_transition_at(text: &str, offset: usize) -> (TransitionExpression, Vec<Diagnostic>) {
    let mut parser = Cursor::new(text, offset);
    let expression =
        if text.trim() == "null" { TransitionExpression::default() } else { transition(&mut parser) };
    (expression, parser.into_diagnostics())
}

/// Parses a condition without surrounding brackets.
pub fn parse_condition(text: &str) -> (Option<Expression>, Vec<Diagnostic>) {
    let mut parser = Cursor::new(text, 0);
    let condition = parser.condition().and_then(|condition| {
        parser.expect_end_of_condition()?;
        Ok(condition)
    });
    (condition.ok(), parser.into_diagnostics())
}

/// Parses actions separated by `;` or `,`. An empty text, blanks and the word `null` are no
/// actions.
pub fn parse_actions(text: &str) -> (Vec<Action>, Vec<Diagnostic>) {
    parse_actions_at(text, 0)
}

/// Parses actions that begin at byte `offset` of a larger text; positions refer to that text.
pub fn parse_actions_at(text: &str, offset: usize) -> (Vec<Action>, Vec<Diagnostic>) {
    let mut parser = Cursor::new(text, offset);
    let nothing = matches!(text.trim(), "" | "null");
    let actions = if nothing { Vec::new() } else { parser.actions() };
    (actions, parser.into_diagnostics())
}

fn transition(parser: &mut Cursor<'_>) -> TransitionExpression {
    let trigger = (!parser.at_section()).then(|| parser.trigger_or_skip()).flatten();
    let guard = parser.at(Symbol::OpenBracket).then(|| guard(parser)).flatten();
    let actions = if parser.accept(Symbol::Slash) { parser.actions() } else { Vec::new() };
    if parser.kind() != TokenKind::End {
        let found = parser.found();
        let message = format!("unexpected {found} after the expression");
        parser.report(
            Diagnostic::error("E0120", parser.span(), message)
                .with_hint("the form is `trigger [guard] / actions`"),
        );
    }
    TransitionExpression { trigger, guard, actions }
}

fn guard(parser: &mut Cursor<'_>) -> Option<Expression> {
    let guard = bracketed_condition(parser);
    if guard.is_err() {
        parser.skip_until(|kind| kind == TokenKind::Symbol(Symbol::CloseBracket));
        parser.accept(Symbol::CloseBracket);
    }
    guard.ok()
}

fn bracketed_condition(parser: &mut Cursor<'_>) -> Parsed<Expression> {
    let open = parser.advance();
    if parser.at(Symbol::CloseBracket) {
        let span = open.span.to(parser.span());
        let hint = "remove the brackets, or write `[true]`";
        return parser.refuse(Diagnostic::error("E0117", span, "the brackets are empty").with_hint(hint));
    }
    let condition = parser.condition()?;
    parser.expect_close_bracket(open.span)?;
    Ok(condition)
}
