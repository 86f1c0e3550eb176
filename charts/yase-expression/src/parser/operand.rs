//! Operands: literals, names, calls and conditions in parentheses.

use super::cursor::{Cursor, Parsed};
use super::name::RESERVED;
use crate::diagnostic::{Diagnostic, Span};
use crate::lexer::{Symbol, TokenKind};
use crate::syntax::{Expression, ExpressionKind, Name, Path};

impl Cursor<'_> {
    /// An operand without a sign.
    pub(crate) fn operand(&mut self) -> Parsed<Expression> {
        match self.kind() {
            TokenKind::Integer | TokenKind::Decimal => self.number(),
            TokenKind::Text => self.text_operand(),
            TokenKind::Word => self.word_operand(),
            TokenKind::Quoted => self.named_operand(),
            TokenKind::Symbol(Symbol::OpenParenthesis) => self.group(),
            _ => self.refuse_operand(),
        }
    }

    fn refuse_operand<T>(&mut self) -> Parsed<T> {
        self.refuse_here(
            "E0106",
            "an operand",
            "an operand is a name, a number, a \"text\", `true`, `false` or a call",
        )
    }

    fn group(&mut self) -> Parsed<Expression> {
        let open = self.advance().span;
        let inner = self.condition()?;
        self.expect_close_parenthesis(open)?;
        Ok(Expression { position: self.position(self.since(open.start)), ..inner })
    }

    fn number(&mut self) -> Parsed<Expression> {
        let token = self.advance();
        let text = self.source(token.span);
        let kind = match token.kind {
            TokenKind::Integer => text.parse().ok().map(ExpressionKind::Integer),
            _ => text.parse().ok().filter(|number: &f64| number.is_finite()).map(ExpressionKind::Decimal),
        };
        match kind {
            Some(kind) => Ok(self.expression(token.span.start, kind)),
            None => {
                let hint = "whole numbers have 64 bits, others are floating point numbers of 64 bits";
                let message = format!("the number `{text}` is too large");
                self.refuse(Diagnostic::error("E0105", token.span, message).with_hint(hint))
            }
        }
    }

    /// `script("text")`: its start and its text.
    pub(crate) fn script(&mut self) -> Parsed<(usize, String)> {
        let start = self.advance().span.start;
        let open = self.advance().span;
        if self.kind() != TokenKind::Text {
            return self.refuse_here("E0123", "a text", "write `script(\"text\")`");
        }
        let text = self.text()?;
        self.expect_close_parenthesis(open)?;
        Ok((start, text))
    }

    fn text_operand(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        let text = self.text()?;
        Ok(self.expression(start, ExpressionKind::Text(text)))
    }

    /// The current text token, without quotes and escapes.
    fn text(&mut self) -> Parsed<String> {
        let token = self.advance();
        let quoted = self.source(token.span);
        let mut text = String::new();
        let mut characters = quoted.char_indices().skip(1);
        while let Some((index, character)) = characters.next() {
            match character {
                '"' => break,
                '\\' => text.push(self.escaped(token.span.start + index, characters.next())?),
                _ => text.push(character),
            }
        }
        Ok(text)
    }

    fn escaped(&mut self, backslash: usize, escaped: Option<(usize, char)>) -> Parsed<char> {
        match escaped.map_or('\\', |(_, character)| character) {
            same @ ('"' | '\\') => Ok(same),
            'n' => Ok('\n'),
            'r' => Ok('\r'),
            't' => Ok('\t'),
            other => {
                let span = Span::new(backslash, backslash + 1 + other.len_utf8());
                let message = format!("`\\{other}` is not an escape");
                self.refuse(
                    Diagnostic::error("E0103", span, message).with_hint(r#"escapes are \" \\ \n \r \t"#),
                )
            }
        }
    }

    fn word_operand(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        let called = self.following() == TokenKind::Symbol(Symbol::OpenParenthesis);
        match self.here() {
            "true" | "TRUE" => self.literal(start, true),
            "false" | "FALSE" => self.literal(start, false),
            "TimeoutCheck" if called => self.timeout_check(),
            "In" if called => self.in_state(),
            "script" if called => {
                let (start, text) = self.script()?;
                Ok(self.expression(start, ExpressionKind::Script(text)))
            }
            _ if self.at_null() => self.refuse_null(self.span()),
            word if RESERVED.contains(&word) => self.refuse_operand(),
            _ => self.named_operand(),
        }
    }

    fn literal(&mut self, start: usize, value: bool) -> Parsed<Expression> {
        self.advance();
        Ok(self.expression(start, ExpressionKind::Bool(value)))
    }

    fn timeout_check(&mut self) -> Parsed<Expression> {
        let start = self.advance().span.start;
        let open = self.advance().span;
        let timer = self.path()?;
        self.expect_close_parenthesis(open)?;
        Ok(self.expression(start, ExpressionKind::TimeoutCheck(timer)))
    }

    /// The path of a state contains terms of a formula, `a/(b|c)*`, so it extends to the matching
    /// parenthesis.
    fn in_state(&mut self) -> Parsed<Expression> {
        let start = self.advance().span.start;
        let open = self.advance().span;
        let inside = self.skip_to_matching_parenthesis(open.end);
        self.expect_close_parenthesis(open)?;
        let text: String = self.source(inside).split_whitespace().collect::<String>().replace('ω', "~");
        if text.is_empty() {
            let hint = "write `In(state)` or `In(outer/inner)`";
            return self.refuse(
                Diagnostic::error("E0115", self.since(start), "there is no state in the parentheses")
                    .with_hint(hint),
            );
        }
        let state = Name { text, position: self.position(inside) };
        Ok(self.expression(start, ExpressionKind::In(state)))
    }

    fn skip_to_matching_parenthesis(&mut self, start: usize) -> Span {
        let mut open = 0;
        while self.kind() != TokenKind::End {
            match self.kind() {
                TokenKind::Symbol(Symbol::OpenParenthesis) => open += 1,
                TokenKind::Symbol(Symbol::CloseParenthesis) if open == 0 => break,
                TokenKind::Symbol(Symbol::CloseParenthesis) => open -= 1,
                _ => {}
            }
            self.advance();
        }
        self.since(start)
    }

    /// A variable or a call. Only a single name can be called; the empty parentheses of a member
    /// belong to its path.
    fn named_operand(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        let mut path = self.path()?;
        if !self.at(Symbol::OpenParenthesis) {
            return Ok(self.expression(start, ExpressionKind::Variable(path)));
        }
        match (path.segments.pop(), path.segments.is_empty()) {
            (Some(function), true) => {
                let arguments = self.arguments()?;
                Ok(self.expression(start, ExpressionKind::Call(function, arguments)))
            }
            (member, _) => self.refuse_arguments(path, member),
        }
    }

    fn arguments(&mut self) -> Parsed<Vec<Expression>> {
        let open = self.advance().span;
        let mut arguments = Vec::new();
        if self.accept(Symbol::CloseParenthesis) {
            return Ok(arguments);
        }
        arguments.push(self.condition()?);
        while self.accept(Symbol::Comma) {
            arguments.push(self.condition()?);
        }
        self.expect_close_parenthesis(open)?;
        Ok(arguments)
    }

    fn refuse_arguments<T>(&mut self, path: Path, member: Option<Name>) -> Parsed<T> {
        let member = member.map_or_else(String::new, |name| name.text);
        let span = self.local(path.position);
        let message = format!("the member `{member}` takes no arguments");
        let hint = format!("write `{}.{member}` or `{}.{member}()`", path.text(), path.text());
        self.refuse(Diagnostic::error("E0113", span, message).with_hint(hint))
    }
}
