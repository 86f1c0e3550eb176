//! Recursive descent parser.

mod statement;

use std::sync::Arc;

use super::lexer::{Token, TokenKind, tokens};
use super::library::{self, LibraryFunction};
use super::reserved_words::{FOREIGN_OBJECTS, FOREIGN_WORDS, is_reserved};
use super::syntax::{
    Access, Binary, Builtin, Location, Method, ScriptExpression, ScriptFunction, ScriptProgram, Statement,
    Unary,
};
use super::value::ScriptValue;
use super::{ScriptErrorKind, Unsupported};
use yase::diagnostic::Span;

/// Maximum nesting of expressions and statements.
const MAX_DEPTH: usize = 48;

type Parsed<T> = Result<T, Unsupported>;

/// Parses one expression.
pub(crate) fn parse_expression(text: &str) -> Parsed<ScriptExpression> {
    let mut parser = Parser::new(text)?;
    let expression = parser.expression()?;
    parser.expect_end()?;
    Ok(expression)
}

/// Parses a location.
pub(crate) fn parse_location(text: &str) -> Parsed<Location> {
    let mut parser = Parser::new(text)?;
    let start = parser.here().span;
    let expression = parser.expression()?;
    parser.expect_end()?;
    parser.location(expression, start)
}

/// Parses a script.
pub(crate) fn parse_program(text: &str) -> Parsed<ScriptProgram> {
    let mut parser = Parser::new(text)?;
    let mut statements = Vec::new();
    while !parser.at_end() {
        parser.statement(&mut statements)?;
    }
    Ok(ScriptProgram { statements: hoisted(statements) })
}

/// Whether a text is JSON, which is also an expression, a literal.
pub(crate) fn is_json(text: &str) -> bool {
    let Ok(tokens) = tokens(text) else { return false };
    let written_as_json = tokens.iter().all(|token| {
        let written = &text[token.span.start..token.span.end];
        match token.kind {
            TokenKind::Word => matches!(written, "true" | "false" | "null"),
            TokenKind::Text(_) => written.starts_with('"'),
            TokenKind::Number(_) => !written.contains(['x', 'X']),
            TokenKind::Symbol(symbol) => matches!(symbol, "[" | "]" | "{" | "}" | "," | ":" | "-"),
            TokenKind::End => true,
        }
    });
    written_as_json && parse_expression(text).is_ok_and(|expression| expression.is_literal())
}

impl ScriptExpression {
    fn is_literal(&self) -> bool {
        match self {
            ScriptExpression::Literal(_) => true,
            ScriptExpression::Array(items) => items.iter().all(ScriptExpression::is_literal),
            ScriptExpression::Object(members) => members.iter().all(|(_, value)| value.is_literal()),
            ScriptExpression::Unary(Unary::Minus, operand) => {
                matches!(**operand, ScriptExpression::Literal(ScriptValue::Number(_)))
            }
            _ => false,
        }
    }
}

/// Functions are declared from the beginning of the script.
fn hoisted(statements: Vec<Statement>) -> Vec<Statement> {
    let is_function = |statement: &Statement| match statement {
        Statement::Declare(names) => matches!(names.as_slice(), [(_, Some(ScriptExpression::Function(_)))]),
        _ => false,
    };
    let (mut functions, others): (Vec<_>, Vec<_>) = statements.into_iter().partition(is_function);
    functions.extend(others);
    functions
}

struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
    in_function: bool,
}

impl<'a> Parser<'a> {
    fn new(text: &'a str) -> Parsed<Parser<'a>> {
        Ok(Parser { text, tokens: tokens(text)?, at: 0, depth: 0, in_function: false })
    }

    fn here(&self) -> &Token {
        &self.tokens[self.at.min(self.tokens.len() - 1)]
    }

    fn written(&self) -> &'a str {
        let span = self.here().span;
        &self.text[span.start..span.end]
    }

    fn at_end(&self) -> bool {
        self.here().kind == TokenKind::End
    }

    fn at(&self, symbol: &str) -> bool {
        matches!(self.here().kind, TokenKind::Symbol(here) if here == symbol)
    }

    fn at_word(&self, word: &str) -> bool {
        self.here().kind == TokenKind::Word && self.written() == word
    }

    fn accept(&mut self, symbol: &str) -> bool {
        let found = self.at(symbol);
        self.at += usize::from(found);
        found
    }

    fn accept_word(&mut self, word: &str) -> bool {
        let found = self.at_word(word);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, symbol: &str) -> Parsed<()> {
        if self.accept(symbol) { Ok(()) } else { self.unexpected(&format!("`{symbol}` is missing")) }
    }

    fn expect_end(&mut self) -> Parsed<()> {
        if self.at_end() { Ok(()) } else { self.unexpected("an operator is missing") }
    }

    /// Rejects the current token; as unsupported if it is ECMAScript outside of the subset.
    fn unexpected<T>(&self, message: &str) -> Parsed<T> {
        let written = self.written();
        let foreign = match self.here().kind {
            TokenKind::Symbol(symbol) => FOREIGN_WORDS.contains(&symbol),
            TokenKind::Word => FOREIGN_WORDS.contains(&written),
            _ => false,
        };
        if foreign {
            return self.unsupported(self.here().span, written);
        }
        let message = match self.here().kind {
            TokenKind::End => format!("{message} at the end"),
            _ => format!("{message} before `{written}`"),
        };
        Err(Unsupported { refusal: ScriptErrorKind::Malformed, span: self.here().span, message })
    }

    fn unsupported<T>(&self, span: Span, what: &str) -> Parsed<T> {
        let message = format!("`{what}` is outside the subset of ECMAScript that is understood");
        Err(Unsupported { refusal: ScriptErrorKind::Unsupported, span, message })
    }

    fn nested<T>(&mut self, parse: impl FnOnce(&mut Self) -> Parsed<T>) -> Parsed<T> {
        if self.depth == MAX_DEPTH {
            let message = format!("the nesting is deeper than {MAX_DEPTH}");
            return Err(Unsupported {
                refusal: ScriptErrorKind::Unsupported,
                span: self.here().span,
                message,
            });
        }
        self.depth += 1;
        let parsed = parse(self);
        self.depth -= 1;
        parsed
    }

    fn name(&mut self) -> Parsed<Arc<str>> {
        let written = self.written();
        if self.here().kind != TokenKind::Word || is_reserved(written) {
            return self.unexpected("a name is missing");
        }
        self.at += 1;
        Ok(written.into())
    }

    fn expression(&mut self) -> Parsed<ScriptExpression> {
        self.nested(|parser| {
            let condition = parser.or()?;
            if !parser.accept("?") {
                return Ok(condition);
            }
            let yes = parser.expression()?;
            parser.expect(":")?;
            let no = parser.expression()?;
            Ok(ScriptExpression::Choose(Box::new([condition, yes, no])))
        })
    }

    fn or(&mut self) -> Parsed<ScriptExpression> {
        let mut operands = vec![self.and()?];
        while self.accept("||") {
            operands.push(self.and()?);
        }
        Ok(several(operands, ScriptExpression::Or))
    }

    fn and(&mut self) -> Parsed<ScriptExpression> {
        let mut operands = vec![self.chain(0)?];
        while self.accept("&&") {
            operands.push(self.chain(0)?);
        }
        Ok(several(operands, ScriptExpression::And))
    }

    fn chain(&mut self, level: usize) -> Parsed<ScriptExpression> {
        let Some(operators) = OPERATORS_BY_PRECEDENCE.get(level) else { return self.unary() };
        let first = self.chain(level + 1)?;
        let mut rest = Vec::new();
        while let Some(operator) = self.operator(operators) {
            rest.push((operator, self.chain(level + 1)?));
        }
        Ok(if rest.is_empty() { first } else { ScriptExpression::Chain(Box::new(first), rest) })
    }

    fn operator(&mut self, operators: &[(&str, Binary)]) -> Option<Binary> {
        let (_, operator) =
            operators.iter().find(|(written, _)| self.at(written) || self.at_word(written))?;
        self.at += 1;
        Some(*operator)
    }

    fn unary(&mut self) -> Parsed<ScriptExpression> {
        let operator = match self.here().kind {
            TokenKind::Symbol("!") => Unary::Not,
            TokenKind::Symbol("-") => Unary::Minus,
            TokenKind::Symbol("+") => Unary::Plus,
            TokenKind::Word if self.written() == "typeof" => Unary::TypeOf,
            _ => return self.accessed(),
        };
        self.at += 1;
        self.nested(|parser| Ok(ScriptExpression::Unary(operator, Box::new(parser.unary()?))))
    }

    fn accessed(&mut self) -> Parsed<ScriptExpression> {
        let base = self.operand()?;
        let mut path = Vec::new();
        loop {
            if self.accept(".") {
                path.push(self.member()?);
            } else if self.accept("[") {
                let index = self.expression()?;
                self.expect("]")?;
                path.push(Access::Index(index));
            } else if self.at("(") {
                path.push(Access::Call(self.arguments()?));
            } else {
                return Ok(if path.is_empty() {
                    base
                } else {
                    ScriptExpression::Access(Box::new(base), path)
                });
            }
        }
    }

    /// Only the methods of the language can be called: a function in a member would need `this`.
    fn member(&mut self) -> Parsed<Access> {
        let span = self.here().span;
        let written = self.written();
        if self.here().kind != TokenKind::Word {
            return self.unexpected("a name is missing");
        }
        self.at += 1;
        if !self.at("(") {
            return Ok(Access::Member(written.into()));
        }
        match Method::find(written) {
            Some(method) => Ok(Access::Method(method, self.arguments()?)),
            None => self.unsupported(span, &format!("{written}()")),
        }
    }

    fn arguments(&mut self) -> Parsed<Vec<ScriptExpression>> {
        self.expect("(")?;
        let arguments = self.list(")")?;
        Ok(arguments)
    }

    fn list(&mut self, end: &str) -> Parsed<Vec<ScriptExpression>> {
        let mut items = Vec::new();
        while !self.accept(end) {
            items.push(self.expression()?);
            if !self.at(end) {
                self.expect(",")?;
            }
        }
        Ok(items)
    }

    fn operand(&mut self) -> Parsed<ScriptExpression> {
        let token = self.here().clone();
        match token.kind {
            TokenKind::Number(value) => self.literal(ScriptValue::Number(value)),
            TokenKind::Text(text) => self.literal(ScriptValue::Text(text)),
            TokenKind::Word => self.word(token.span),
            TokenKind::Symbol("(") => {
                self.at += 1;
                let inner = self.expression()?;
                self.expect(")")?;
                Ok(inner)
            }
            TokenKind::Symbol("[") => {
                self.at += 1;
                Ok(ScriptExpression::Array(self.list("]")?))
            }
            TokenKind::Symbol("{") => self.object(),
            TokenKind::Symbol("/") => self.unsupported(token.span, "/"),
            _ => self.unexpected("a value is missing"),
        }
    }

    fn literal(&mut self, value: ScriptValue) -> Parsed<ScriptExpression> {
        self.at += 1;
        Ok(ScriptExpression::Literal(value))
    }

    fn word(&mut self, span: Span) -> Parsed<ScriptExpression> {
        let written = self.written();
        match written {
            "true" => return self.literal(ScriptValue::Bool(true)),
            "false" => return self.literal(ScriptValue::Bool(false)),
            "null" => return self.literal(ScriptValue::Null),
            "undefined" => return self.literal(ScriptValue::Undefined),
            "NaN" => return self.literal(ScriptValue::Number(f64::NAN)),
            "Infinity" => return self.literal(ScriptValue::Number(f64::INFINITY)),
            "function" => {
                self.at += 1;
                return self.function().map(|(_, function)| ScriptExpression::Function(function));
            }
            _ => {}
        }
        let name = self.name()?;
        if let Some(function) = LibraryFunction::find("", &name) {
            return Ok(ScriptExpression::Library(function, self.arguments()?));
        }
        let builtin = match &*name {
            "In" => Builtin::In,
            "String" => Builtin::String,
            "Math" | "JSON" => return self.library(&name, span),
            foreign if FOREIGN_OBJECTS.contains(&foreign) => return self.unsupported(span, foreign),
            _ => return Ok(ScriptExpression::Variable(name)),
        };
        let mut arguments = self.arguments()?;
        match (arguments.pop(), arguments.is_empty()) {
            (Some(argument), true) => Ok(ScriptExpression::Builtin(builtin, Box::new(argument))),
            _ => {
                let message = format!("`{name}` takes one argument");
                Err(Unsupported { refusal: ScriptErrorKind::Malformed, span, message })
            }
        }
    }

    /// A constant or a call of a function of the library: its objects are not values.
    fn library(&mut self, object: &str, span: Span) -> Parsed<ScriptExpression> {
        if !self.accept(".") {
            return self.unsupported(span, object);
        }
        let (member, end) = (self.written(), self.here().span);
        if let Some(number) = library::constant(object, member) {
            return self.literal(ScriptValue::Number(number));
        }
        match LibraryFunction::find(object, member) {
            Some(function) => {
                self.at += 1;
                Ok(ScriptExpression::Library(function, self.arguments()?))
            }
            None => self.unsupported(span.to(end), &format!("{object}.{member}")),
        }
    }

    fn object(&mut self) -> Parsed<ScriptExpression> {
        self.expect("{")?;
        let mut members = Vec::new();
        while !self.accept("}") {
            let key = self.key()?;
            self.expect(":")?;
            members.push((key, self.expression()?));
            if !self.at("}") {
                self.expect(",")?;
            }
        }
        Ok(ScriptExpression::Object(members))
    }

    fn key(&mut self) -> Parsed<Arc<str>> {
        let key = match &self.here().kind {
            TokenKind::Word => self.written().into(),
            TokenKind::Text(text) => text.clone(),
            TokenKind::Number(number) => super::convert::number_text(*number).into(),
            _ => return self.unexpected("a name is missing"),
        };
        self.at += 1;
        Ok(key)
    }

    /// Parses the rest after the word `function`. Functions cannot be nested, so that none outlives
    /// the variables it uses.
    fn function(&mut self) -> Parsed<(Option<Arc<str>>, Arc<ScriptFunction>)> {
        if self.in_function {
            return self.unsupported(self.tokens[self.at - 1].span, "function");
        }
        let name = if self.at("(") { None } else { Some(self.name()?) };
        self.expect("(")?;
        let mut parameters = Vec::new();
        while !self.accept(")") {
            parameters.push(self.name()?);
            if !self.at(")") {
                self.expect(",")?;
            }
        }
        self.in_function = true;
        let mut body = Vec::new();
        let block = self.block(&mut body);
        self.in_function = false;
        block?;
        Ok((name, Arc::new(ScriptFunction { parameters, body })))
    }

    fn location(&self, expression: ScriptExpression, start: Span) -> Parsed<Location> {
        let location = match expression {
            ScriptExpression::Variable(variable) => Some(Location { variable, path: Vec::new() }),
            ScriptExpression::Access(base, path) => match *base {
                ScriptExpression::Variable(variable) if path.iter().all(Access::is_assignable) => {
                    Some(Location { variable, path })
                }
                _ => None,
            },
            _ => None,
        };
        let span = Span::new(start.start, self.tokens[self.at.saturating_sub(1)].span.end.max(start.end));
        location.ok_or_else(|| Unsupported {
            refusal: ScriptErrorKind::Malformed,
            span,
            message: "nothing can be assigned to this".into(),
        })
    }
}

impl Access {
    fn is_assignable(&self) -> bool {
        matches!(self, Access::Member(_) | Access::Index(_))
    }
}

/// Operators by precedence, the lowest first.
const OPERATORS_BY_PRECEDENCE: [&[(&str, Binary)]; 4] = [
    &[("===", Binary::Same), ("!==", Binary::NotSame), ("==", Binary::Equal), ("!=", Binary::NotEqual)],
    &[
        ("<", Binary::Less),
        ("<=", Binary::LessOrEqual),
        (">", Binary::Greater),
        (">=", Binary::GreaterOrEqual),
        ("in", Binary::Within),
    ],
    &[("+", Binary::Plus), ("-", Binary::Minus)],
    &[("*", Binary::Times), ("/", Binary::Over), ("%", Binary::Modulo)],
];

fn several(
    mut operands: Vec<ScriptExpression>,
    join: impl FnOnce(Vec<ScriptExpression>) -> ScriptExpression,
) -> ScriptExpression {
    match (operands.len(), operands.pop()) {
        (1, Some(only)) => only,
        (_, last) => {
            operands.extend(last);
            join(operands)
        }
    }
}
