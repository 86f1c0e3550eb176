//! Conditions, with operators from the lowest to the highest precedence: `||`, `&&`, comparison,
//! `+ -`, `* /`, `! -`.

use super::cursor::{Cursor, Parsed};
use crate::diagnostic::{Diagnostic, Span};
use crate::lexer::{Symbol, TokenKind};
use crate::syntax::{Additive, Comparison, Expression, ExpressionKind, Multiplicative};

/// Maximum nesting of parentheses, calls and signs; deeper trees would overflow a recursive walk.
const MAX_DEPTH: usize = 256;

impl Cursor<'_> {
    /// Parses a condition or an operand.
    pub(crate) fn condition(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        let mut operands = vec![self.conjunction()?];
        while self.accept_logic(Symbol::DoubleBar, Symbol::Bar, "or", "||") {
            operands.push(self.conjunction()?);
        }
        Ok(self.joined(start, operands, ExpressionKind::Or))
    }

    /// Rejects text after a complete condition.
    pub(crate) fn expect_end_of_condition(&mut self) -> Parsed<()> {
        match self.kind() {
            TokenKind::End => Ok(()),
            _ => self.refuse_operator("an operator"),
        }
    }

    fn conjunction(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        let mut operands = vec![self.comparison()?];
        while self.accept_logic(Symbol::DoubleAmpersand, Symbol::Ampersand, "and", "&&") {
            operands.push(self.comparison()?);
        }
        Ok(self.joined(start, operands, ExpressionKind::And))
    }

    fn joined(
        &self,
        start: usize,
        mut operands: Vec<Expression>,
        kind: fn(Vec<Expression>) -> ExpressionKind,
    ) -> Expression {
        match (operands.len(), operands.pop()) {
            (1, Some(only)) => only,
            (_, last) => {
                operands.extend(last);
                self.expression(start, kind(operands))
            }
        }
    }

    /// A single `&` or `|` is reported and then read as the double operator.
    fn accept_logic(&mut self, symbol: Symbol, single: Symbol, word: &str, spelling: &str) -> bool {
        if self.accept(symbol) || self.accept_word(word) {
            return true;
        }
        let slip = self.at(single);
        if slip {
            let message = format!("{} is not an operator of conditions", self.found());
            self.report(
                Diagnostic::error("E0122", self.span(), message).with_hint(format!("write `{spelling}`")),
            );
            self.advance();
        }
        slip
    }

    fn comparison(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        if self.at_null() {
            return self.null_first(start);
        }
        let left = self.sum()?;
        let Some(comparison) = self.accept_comparison() else {
            return Ok(left);
        };
        if self.at_null() {
            let null = self.advance().span;
            return self.absence(start, left, comparison, null);
        }
        let right = self.sum()?;
        self.refuse_chain()?;
        Ok(self.expression(start, ExpressionKind::Compare(Box::new(left), comparison, Box::new(right))))
    }

    fn refuse_chain(&mut self) -> Parsed<()> {
        let operator = self.span();
        if self.accept_comparison().is_none() {
            return Ok(());
        }
        let hint = "write `a < b && b < c`, or use parentheses";
        self.refuse(Diagnostic::error("E0111", operator, "comparisons cannot be chained").with_hint(hint))
    }

    pub(crate) fn at_null(&self) -> bool {
        matches!(self.word(), Some("NULL" | "null" | "nullptr"))
    }

    fn null_first(&mut self, start: usize) -> Parsed<Expression> {
        let null = self.advance().span;
        match self.accept_comparison() {
            Some(comparison) => {
                let message = self.sum()?;
                self.absence(start, message, comparison, null)
            }
            None => self.refuse_null(null),
        }
    }

    /// `message == NULL` and `message != NULL`.
    fn absence(
        &mut self,
        start: usize,
        operand: Expression,
        comparison: Comparison,
        null: Span,
    ) -> Parsed<Expression> {
        match (operand.kind, comparison) {
            (ExpressionKind::Variable(path), Comparison::Equal) => {
                Ok(self.expression(start, ExpressionKind::Absent(path)))
            }
            (ExpressionKind::Variable(path), Comparison::NotEqual) => {
                Ok(self.expression(start, ExpressionKind::Present(path)))
            }
            _ => self.refuse_null(null),
        }
    }

    pub(crate) fn refuse_null<T>(&mut self, null: Span) -> Parsed<T> {
        let hint = "write `Message == NULL` or `Message != NULL`; its negation is `!(Message == NULL)`";
        self.refuse(
            Diagnostic::error("E0114", null, "NULL can only be compared with a message").with_hint(hint),
        )
    }

    fn accept_comparison(&mut self) -> Option<Comparison> {
        let comparison = match (self.kind(), self.word()) {
            (TokenKind::Symbol(Symbol::Equal), _) | (_, Some("eq")) => Comparison::Equal,
            (TokenKind::Symbol(Symbol::NotEqual), _) | (_, Some("ne")) => Comparison::NotEqual,
            (TokenKind::Symbol(Symbol::Less), _) | (_, Some("lt")) => Comparison::Less,
            (TokenKind::Symbol(Symbol::LessOrEqual), _) | (_, Some("le")) => Comparison::LessOrEqual,
            (TokenKind::Symbol(Symbol::Greater), _) | (_, Some("gt")) => Comparison::Greater,
            (TokenKind::Symbol(Symbol::GreaterOrEqual), _) | (_, Some("ge")) => Comparison::GreaterOrEqual,
            (TokenKind::Symbol(Symbol::Assign), _) => {
                let diagnostic = Diagnostic::error("E0108", self.span(), "`=` assigns; a condition compares");
                self.report(diagnostic.with_hint("write `==`"));
                Comparison::Equal
            }
            _ => return None,
        };
        self.advance();
        Some(comparison)
    }

    fn sum(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        let first = self.product()?;
        let mut rest = Vec::new();
        while let Some(operator) = self.accept_additive() {
            rest.push((operator, self.product()?));
        }
        if rest.is_empty() {
            return Ok(first);
        }
        Ok(self.expression(start, ExpressionKind::Sum(Box::new(first), rest)))
    }

    fn accept_additive(&mut self) -> Option<Additive> {
        if self.accept(Symbol::Plus) {
            return Some(Additive::Plus);
        }
        self.accept(Symbol::Minus).then_some(Additive::Minus)
    }

    fn product(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        let first = self.signed()?;
        let mut rest = Vec::new();
        while let Some(operator) = self.accept_multiplicative() {
            rest.push((operator, self.signed()?));
        }
        if rest.is_empty() {
            return Ok(first);
        }
        Ok(self.expression(start, ExpressionKind::Product(Box::new(first), rest)))
    }

    fn accept_multiplicative(&mut self) -> Option<Multiplicative> {
        if self.accept(Symbol::Star) {
            return Some(Multiplicative::Times);
        }
        self.accept(Symbol::Slash).then_some(Multiplicative::Over)
    }

    /// Every deeper level passes through this function, so it counts the depth.
    fn signed(&mut self) -> Parsed<Expression> {
        if self.depth == MAX_DEPTH {
            let message = format!("the expression is nested deeper than {MAX_DEPTH} levels");
            return self.refuse(Diagnostic::error("E0112", self.span(), message).with_hint("split it up"));
        }
        self.depth += 1;
        let expression = self.signed_operand();
        self.depth -= 1;
        expression
    }

    fn signed_operand(&mut self) -> Parsed<Expression> {
        let start = self.span().start;
        if self.accept(Symbol::Bang) || self.accept_word("not") {
            let operand = self.signed()?;
            return Ok(self.expression(start, ExpressionKind::Not(Box::new(operand))));
        }
        if self.accept(Symbol::Minus) {
            let operand = self.signed()?;
            return Ok(self.expression(start, ExpressionKind::Negative(Box::new(operand))));
        }
        self.operand()
    }

    /// An expression from `start` to the previous token.
    pub(crate) fn expression(&self, start: usize, kind: ExpressionKind) -> Expression {
        Expression { kind, position: self.position(self.since(start)) }
    }
}
