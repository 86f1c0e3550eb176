//! Actions, the part after the slash.

use std::time::Duration;

use super::cursor::{Cursor, Parsed};
use crate::diagnostic::{Diagnostic, Span};
use crate::lexer::{Symbol, TokenKind};
use crate::syntax::{Action, ActionKind, Path, TimeoutForm};

const ACTION_FORMS: &str = "an action is `Message.field = value`, `publish.Message`, `StartTimeout(v, 100ms)`, `raise(event)`, \
                     `process_messages` or `publish_all`";

impl Cursor<'_> {
    /// Parses actions up to the end of the text, separated by `;` or `,`; invalid ones are skipped.
    pub(crate) fn actions(&mut self) -> Vec<Action> {
        let mut actions = Vec::new();
        loop {
            if self.action(&mut actions).is_err() {
                self.skip_action();
            }
            let separated = self.accept(Symbol::Semicolon) || self.accept(Symbol::Comma);
            if !separated || self.kind() == TokenKind::End {
                return actions;
            }
        }
    }

    /// Skips to the next separator outside of parentheses.
    fn skip_action(&mut self) {
        let mut open = 0_usize;
        while self.kind() != TokenKind::End {
            match self.kind() {
                TokenKind::Symbol(Symbol::OpenParenthesis) => open += 1,
                TokenKind::Symbol(Symbol::CloseParenthesis) => open = open.saturating_sub(1),
                TokenKind::Symbol(Symbol::Semicolon | Symbol::Comma) if open == 0 => return,
                _ => {}
            }
            self.advance();
        }
    }

    /// Parses one action, which may expand to two: `publish.Message.set_x(1)` assigns and
    /// publishes.
    fn action(&mut self, actions: &mut Vec<Action>) -> Parsed<()> {
        let start = self.span().start;
        match (self.word(), self.following()) {
            (Some("process_messages"), _) => self.directive(start, ActionKind::ProcessMessages, actions),
            (Some("publish_all"), _) => self.directive(start, ActionKind::PublishAll, actions),
            (Some("StartTimeout"), TokenKind::Symbol(Symbol::OpenParenthesis)) => {
                self.start_timeout(actions)?
            }
            (Some("TimeoutAction"), TokenKind::Symbol(Symbol::Dot)) => self.timeout_action(actions)?,
            (Some("raise"), TokenKind::Symbol(Symbol::OpenParenthesis)) => self.raise(actions)?,
            (Some("script"), TokenKind::Symbol(Symbol::OpenParenthesis)) => {
                let (start, text) = self.script()?;
                self.push(start, ActionKind::Script(text), actions);
            }
            (Some("publish"), TokenKind::Symbol(Symbol::Dot) | TokenKind::Word | TokenKind::Quoted) => {
                self.publish(actions)?;
            }
            _ => self.assignment(actions)?,
        }
        self.expect_end_of_action()
    }

    fn expect_end_of_action(&mut self) -> Parsed<()> {
        match self.kind() {
            TokenKind::End | TokenKind::Symbol(Symbol::Semicolon | Symbol::Comma) => Ok(()),
            _ => self.refuse_here("E0120", "`;` or the end", "actions are separated by `;` or `,`"),
        }
    }

    fn directive(&mut self, start: usize, kind: ActionKind, actions: &mut Vec<Action>) {
        self.advance();
        self.push(start, kind, actions);
    }

    fn push(&self, start: usize, kind: ActionKind, actions: &mut Vec<Action>) {
        actions.push(Action { kind, position: self.position(self.since(start)) });
    }

    /// `StartTimeout(v, 100ms)`.
    fn start_timeout(&mut self, actions: &mut Vec<Action>) -> Parsed<()> {
        let start = self.advance().span.start;
        let open = self.advance().span;
        let timer = self.path()?;
        if !self.accept(Symbol::Comma) {
            return self.refuse_here("E0119", "a delay", "write `StartTimeout(v, 100ms)`");
        }
        let first = self.span().start;
        self.skip_until(|kind| {
            matches!(kind, TokenKind::Symbol(Symbol::CloseParenthesis | Symbol::Semicolon))
        });
        let written = self.since(first);
        let Some(delay) = delay(self.source(written)) else {
            return self.refuse_delay(written);
        };
        self.expect_close_parenthesis(open)?;
        let form = TimeoutForm::StartTimeout;
        self.push(start, ActionKind::StartTimeout { timer, delay, form }, actions);
        Ok(())
    }

    fn refuse_delay(&mut self, written: Span) -> Parsed<()> {
        let text = self.source(written).trim();
        let message =
            if text.is_empty() { "a delay is missing".into() } else { format!("`{text}` is not a delay") };
        let hint = match text.starts_with(|first: char| first.is_alphabetic() || first == '_') {
            true => "write a number with its unit: `100ms`, `1.5s`; names have no value here",
            false => "write a number with its unit: `100ms`, `1.5s`",
        };
        self.refuse(Diagnostic::error("E0119", written, message).with_hint(hint))
    }

    /// `TimeoutAction.v.100`, in milliseconds.
    fn timeout_action(&mut self, actions: &mut Vec<Action>) -> Parsed<()> {
        let start = self.advance().span.start;
        let name_start = self.span().end;
        let mut segments = Vec::new();
        loop {
            if !self.accept(Symbol::Dot) {
                return self.refuse_here("E0119", "a delay", "write `TimeoutAction.v.100`");
            }
            if matches!(self.kind(), TokenKind::Integer | TokenKind::Decimal) && !segments.is_empty() {
                break;
            }
            segments.push(self.name()?);
        }
        let timer = Path { segments, position: self.position(self.since(name_start)) };
        let written = self.advance().span;
        let Some(delay) = decimal(self.source(written), 6) else {
            return self.refuse_delay(written);
        };
        let form = TimeoutForm::TimeoutAction;
        self.push(start, ActionKind::StartTimeout { timer, delay, form }, actions);
        Ok(())
    }

    fn raise(&mut self, actions: &mut Vec<Action>) -> Parsed<()> {
        let start = self.advance().span.start;
        let open = self.advance().span;
        let event = self.path()?;
        self.expect_close_parenthesis(open)?;
        self.push(start, ActionKind::Raise(event), actions);
        Ok(())
    }

    /// `publish.Message`, `publish Message`, `publish.topic.Kind.Message.set_field(value)`.
    fn publish(&mut self, actions: &mut Vec<Action>) -> Parsed<()> {
        let start = self.advance().span.start;
        self.accept(Symbol::Dot);
        let message = self.path()?;
        let message =
            if self.at(Symbol::OpenParenthesis) { self.setter(start, message, actions)? } else { message };
        self.push(start, ActionKind::Publish(message), actions);
        Ok(())
    }

    /// `Message.field = value` or `Message.set_field(value)`.
    fn assignment(&mut self, actions: &mut Vec<Action>) -> Parsed<()> {
        let start = self.span().start;
        if !matches!(self.kind(), TokenKind::Word | TokenKind::Quoted) {
            return self.refuse_here("E0118", "an action", ACTION_FORMS);
        }
        let target = self.path()?;
        match self.kind() {
            TokenKind::Symbol(Symbol::Assign) => {
                self.advance();
                let value = self.condition()?;
                self.push(start, ActionKind::Assign { target, value }, actions);
                Ok(())
            }
            TokenKind::Symbol(Symbol::OpenParenthesis) if target.segments.len() > 1 => {
                self.setter(start, target, actions).map(drop)
            }
            TokenKind::Symbol(Symbol::Equal) => {
                let diagnostic = Diagnostic::error("E0118", self.span(), "`==` compares; an action assigns");
                self.refuse(diagnostic.with_hint("write `=`"))
            }
            _ => self.refuse_action(&target),
        }
    }

    /// Value and field of a setter whose name has been read; the rest of the path is the message.
    fn setter(&mut self, start: usize, mut path: Path, actions: &mut Vec<Action>) -> Parsed<Path> {
        let message = path.clone();
        let field = path.segments.last_mut().and_then(|name| {
            name.text = name.text.strip_prefix("set_")?.to_owned();
            (!name.text.is_empty()).then_some(())
        });
        if field.is_none() || path.segments.len() < 2 {
            let hint = "write `Message.set_field(value)` or `Message.field = value`";
            let diagnostic = Diagnostic::error(
                "E0121",
                self.local(message.position),
                format!("`{}` is not a setter", message.text()),
            );
            return self.refuse(diagnostic.with_hint(hint));
        }
        let open = self.advance().span;
        let value = self.condition()?;
        self.expect_close_parenthesis(open)?;
        self.push(start, ActionKind::Assign { target: path, value }, actions);
        let mut message = message;
        message.segments.pop();
        Ok(message)
    }

    fn refuse_action(&mut self, path: &Path) -> Parsed<()> {
        let text = path.text();
        let span = self.local(path.position);
        if self.at(Symbol::OpenParenthesis) {
            let message = format!("`{text}` is called for its effect, but functions have none");
            return self.refuse(Diagnostic::error("E0118", span, message).with_hint(hint_for(&text)));
        }
        if let Some(diagnostic) = self.not_a_token() {
            return self.refuse(diagnostic);
        }
        self.refuse(
            Diagnostic::error("E0118", span, format!("`{text}` is not an action")).with_hint(hint_for(&text)),
        )
    }
}

/// Most unknown actions in old models are intended to start a timer.
fn hint_for(name: &str) -> &'static str {
    if name.to_ascii_lowercase().contains("timeout") {
        "a timer is started by `StartTimeout(v, 100ms)` or `TimeoutAction.v.100`"
    } else {
        ACTION_FORMS
    }
}

/// A number and its unit: `100ms`, `1.5 s`.
fn delay(text: &str) -> Option<Duration> {
    let text = text.trim();
    let number = text.trim_end_matches(|character: char| character.is_ascii_alphabetic());
    match &text[number.len()..] {
        "ms" => decimal(number.trim_end(), 6),
        "s" => decimal(number.trim_end(), 9),
        _ => None,
    }
}

/// A decimal number in units of 10^`decimal_places` nanoseconds; exact, or `None`.
fn decimal(number: &str, decimal_places: usize) -> Option<Duration> {
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    let only_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() || fraction.len() > decimal_places || !only_digits(whole) || !only_digits(fraction) {
        return None;
    }
    format!("{whole}{fraction:0<decimal_places$}").parse().ok().map(Duration::from_nanos)
}
