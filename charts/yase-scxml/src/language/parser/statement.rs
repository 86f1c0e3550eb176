//! Statements of scripts.

use super::{Parsed, Parser};
use crate::language::lexer::TokenKind;
use crate::language::syntax::{Binary, ScriptExpression, Statement};
use crate::language::value::ScriptValue;
use yase::diagnostic::Span;

impl Parser<'_> {
    pub(crate) fn block(&mut self, statements: &mut Vec<Statement>) -> Parsed<()> {
        self.expect("{")?;
        while !self.accept("}") {
            self.statement(statements)?;
        }
        Ok(())
    }

    pub(crate) fn statement(&mut self, statements: &mut Vec<Statement>) -> Parsed<()> {
        self.nested(|parser| parser.one_statement(statements))
    }

    fn one_statement(&mut self, statements: &mut Vec<Statement>) -> Parsed<()> {
        if self.accept(";") {
            return Ok(());
        }
        if self.at("{") {
            return self.block(statements);
        }
        let statement = if self.accept_word("var") {
            self.declaration()?
        } else if self.accept_word("function") {
            return self.named_function(statements);
        } else if self.accept_word("if") {
            statements.push(self.branch()?);
            return Ok(());
        } else if self.in_function && self.accept_word("return") {
            let ends = self.at(";") || self.at("}") || self.at_end() || self.here().on_new_line;
            Statement::Return(if ends { None } else { Some(self.expression()?) })
        } else {
            self.assignment()?
        };
        statements.push(statement);
        self.end_of_statement()
    }

    fn end_of_statement(&mut self) -> Parsed<()> {
        if self.accept(";") || self.at("}") || self.at_end() || self.here().on_new_line {
            return Ok(());
        }
        self.unexpected("the statement does not end")
    }

    fn declaration(&mut self) -> Parsed<Statement> {
        let mut names = Vec::new();
        loop {
            let name = self.name()?;
            let value = if self.accept("=") { Some(self.expression()?) } else { None };
            names.push((name, value));
            if !self.accept(",") {
                return Ok(Statement::Declare(names));
            }
        }
    }

    fn named_function(&mut self, statements: &mut Vec<Statement>) -> Parsed<()> {
        match self.function()? {
            (Some(name), function) => {
                statements.push(Statement::Declare(vec![(name, Some(ScriptExpression::Function(function)))]));
                Ok(())
            }
            (None, _) => self.unexpected("a function without a name does nothing"),
        }
    }

    fn branch(&mut self) -> Parsed<Statement> {
        self.expect("(")?;
        let condition = self.expression()?;
        self.expect(")")?;
        let (mut yes, mut no) = (Vec::new(), Vec::new());
        self.statement(&mut yes)?;
        if self.accept_word("else") {
            self.statement(&mut no)?;
        }
        Ok(Statement::If(condition, yes, no))
    }

    fn assignment(&mut self) -> Parsed<Statement> {
        let start = self.here().span;
        let step = if self.accept("++") {
            Some(Binary::Plus)
        } else if self.accept("--") {
            Some(Binary::Minus)
        } else {
            None
        };
        let left = self.expression()?;
        if let Some(operator) = step {
            return self.stepped(left, start, operator);
        }
        let TokenKind::Symbol(symbol) = self.here().kind else { return Ok(Statement::Evaluate(left)) };
        let operator = match symbol {
            "=" => None,
            "+=" => Some(Binary::Plus),
            "-=" => Some(Binary::Minus),
            "*=" => Some(Binary::Times),
            "/=" => Some(Binary::Over),
            "%=" => Some(Binary::Modulo),
            "++" | "--" => {
                self.at += 1;
                let operator = if symbol == "++" { Binary::Plus } else { Binary::Minus };
                return self.stepped(left, start, operator);
            }
            _ => return Ok(Statement::Evaluate(left)),
        };
        self.at += 1;
        let location = self.location(left, start)?;
        Ok(Statement::Assign(location, operator, self.expression()?))
    }

    /// `a++` as a statement. Minus converts text to a number, as `++` does.
    fn stepped(&mut self, left: ScriptExpression, start: Span, operator: Binary) -> Parsed<Statement> {
        let one = if operator == Binary::Plus { -1.0 } else { 1.0 };
        let location = self.location(left, start)?;
        Ok(Statement::Assign(
            location,
            Some(Binary::Minus),
            ScriptExpression::Literal(ScriptValue::Number(one)),
        ))
    }
}
