//! Type checks of conditions and operands: each has one type, and each operator accepts certain
//! types.

use super::message::describe;
use super::name_context::{NameContext, TypedTerm};
use super::{CompileResult, both, collect};
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::{BooleanTerm, Literal, MAX_ARGUMENTS, ValueTerm};
use crate::syntax::{Comparison, Expression, ExpressionKind, Name, Path};
use crate::vocabulary::{FunctionEntry, ValueType};

impl NameContext<'_> {
    /// Compiles a condition.
    pub(crate) fn test(&self, expression: &Expression) -> CompileResult<BooleanTerm> {
        match &expression.kind {
            ExpressionKind::Or(operands) => Ok(BooleanTerm::Any(self.tests(operands)?.into())),
            ExpressionKind::And(operands) => Ok(BooleanTerm::All(self.tests(operands)?.into())),
            ExpressionKind::Not(operand) => Ok(BooleanTerm::Not(Box::new(self.test(operand)?))),
            ExpressionKind::Compare(left, comparison, right) => self.comparison(left, *comparison, right),
            ExpressionKind::Absent(message) => self.absent(message),
            ExpressionKind::Present(message) => Ok(BooleanTerm::Not(Box::new(self.absent(message)?))),
            ExpressionKind::Bool(value) => Ok(BooleanTerm::Literal(*value)),
            ExpressionKind::TimeoutCheck(timer) => Ok(self.timeout_check(timer)),
            ExpressionKind::In(state) => Ok(BooleanTerm::Active(self.state(state)?)),
            ExpressionKind::Script(text) => Ok(BooleanTerm::Script(self.script(text, expression.span())?)),
            _ => match self.term_of(expression, &ValueType::Bool)? {
                ValueTerm::Truth(test) => Ok(*test),
                term => Ok(BooleanTerm::Holds(term)),
            },
        }
    }

    /// Compiles an operand that must have the expected type.
    pub(crate) fn term_of(&self, expression: &Expression, expected: &ValueType) -> CompileResult<ValueTerm> {
        let typed = self.term(expression, Some(expected))?;
        if typed.kind == *expected {
            return Ok(typed.term);
        }
        let message =
            format!("`{expression}` is {}, but {} is needed here", describe(&typed.kind), describe(expected));
        let diagnostic = Diagnostic::error("E0137", expression.span(), message);
        Err(vec![diagnostic.with_hint(needed_hint(&typed.kind, expected))])
    }

    fn tests(&self, operands: &[Expression]) -> CompileResult<Vec<BooleanTerm>> {
        collect(operands.iter().map(|operand| self.test(operand)))
    }

    /// A timer that no action starts never expires.
    fn timeout_check(&self, timer: &Path) -> BooleanTerm {
        match self.timer(timer) {
            Some(timer) => BooleanTerm::Over { timer, when_unset: false },
            None => BooleanTerm::NeverStarted(timer.text().into()),
        }
    }

    fn absent(&self, path: &Path) -> CompileResult<BooleanTerm> {
        let (source, fields) = self.message(path)?;
        let Some(field) = fields.first() else {
            return Ok(BooleanTerm::Absent(source.message_source()));
        };
        let message = format!("`{}` is a field; only whole messages can be absent", field.text);
        let hint = "compare the message before it with NULL";
        Err(vec![Diagnostic::error("E0138", field.position.0, message).with_hint(hint)])
    }

    fn comparison(
        &self,
        left: &Expression,
        comparison: Comparison,
        right: &Expression,
    ) -> CompileResult<BooleanTerm> {
        let left_hint = is_bare(right).then(|| self.type_hint(left)).flatten();
        let right_hint = is_bare(left).then(|| self.type_hint(right)).flatten();
        let (a, b) = both(self.term(left, right_hint.as_ref()), self.term(right, left_hint.as_ref()))?;
        let span = left.span().to(right.span());
        if a.kind != b.kind {
            let (of_a, of_b) = (describe(&a.kind), describe(&b.kind));
            let message = format!("`{left}` is {of_a} and `{right}` is {of_b}: they cannot be compared");
            let diagnostic = Diagnostic::error("E0137", span, message);
            return Err(vec![diagnostic.with_hint(comparison_hint(&a.kind, &b.kind))]);
        }
        refuse_order(&a.kind, comparison, span)?;
        Ok(BooleanTerm::compare(a.term, comparison, b.term))
    }

    /// Type of an operand as far as it is known without the other operand; bare names of
    /// enumeration values have none.
    fn type_hint(&self, expression: &Expression) -> Option<ValueType> {
        match &expression.kind {
            ExpressionKind::Variable(path) => self.variable(path, None).ok().map(|typed| typed.kind),
            ExpressionKind::Call(function, _) => {
                self.function(function).ok().map(|entry| entry.result.clone())
            }
            _ => None,
        }
    }

    fn term(&self, expression: &Expression, expected: Option<&ValueType>) -> CompileResult<TypedTerm> {
        match &expression.kind {
            ExpressionKind::Integer(value) => Ok(number(ValueTerm::Literal(Literal::Uint(*value)))),
            ExpressionKind::Decimal(value) => Ok(number(ValueTerm::Literal(Literal::Float(*value)))),
            ExpressionKind::Text(text) => Ok(TypedTerm {
                term: ValueTerm::Literal(Literal::Text(text.as_str().into())),
                kind: ValueType::Text,
            }),
            ExpressionKind::Variable(path) => self.variable(path, expected),
            ExpressionKind::Call(function, arguments) => self.call(function, arguments, expression.span()),
            ExpressionKind::Negative(operand) => Ok(number(negated(self.number(operand)?))),
            ExpressionKind::Sum(first, rest) => {
                let (first, rest) = both(self.number(first), self.chain(rest))?;
                Ok(number(ValueTerm::Sum(Box::new(first), rest)))
            }
            ExpressionKind::Product(first, rest) => {
                let (first, rest) = both(self.number(first), self.chain(rest))?;
                Ok(number(ValueTerm::Product(Box::new(first), rest)))
            }
            ExpressionKind::Bool(value) => {
                Ok(TypedTerm { term: ValueTerm::Literal(Literal::Bool(*value)), kind: ValueType::Bool })
            }
            _ => Ok(TypedTerm {
                term: ValueTerm::Truth(Box::new(self.test(expression)?)),
                kind: ValueType::Bool,
            }),
        }
    }

    fn number(&self, expression: &Expression) -> CompileResult<ValueTerm> {
        self.term_of(expression, &ValueType::Number)
    }

    fn chain<O: Copy>(&self, rest: &[(O, Expression)]) -> CompileResult<Box<[(O, ValueTerm)]>> {
        let terms = rest.iter().map(|(operator, operand)| Ok((*operator, self.number(operand)?)));
        Ok(collect(terms)?.into())
    }

    fn call(&self, name: &Name, arguments: &[Expression], span: Span) -> CompileResult<TypedTerm> {
        let function = self.function(name)?;
        check_count(function, arguments.len(), span)?;
        let pairs = arguments.iter().zip(&function.parameters);
        let terms = collect(pairs.map(|(argument, parameter)| self.term_of(argument, parameter)))?;
        Ok(TypedTerm { term: ValueTerm::Call(function.id, terms.into()), kind: function.result.clone() })
    }
}

/// Whether it is a bare name, which may be a value of the other operand's enumeration. Nothing else
/// depends on the other operand.
fn is_bare(expression: &Expression) -> bool {
    matches!(&expression.kind, ExpressionKind::Variable(path) if path.bare().is_some())
}

fn check_count(function: &FunctionEntry, given: usize, span: Span) -> CompileResult<()> {
    let wanted = function.parameters.len();
    if wanted > MAX_ARGUMENTS {
        let message = format!("the function `{}` takes {wanted} arguments", function.name);
        let hint = format!("functions with more than {MAX_ARGUMENTS} cannot be called by expressions");
        return Err(vec![Diagnostic::error("E0136", span, message).with_hint(hint)]);
    }
    if given == wanted {
        return Ok(());
    }
    let types: Vec<_> = function.parameters.iter().map(describe).collect();
    let hint =
        if types.is_empty() { "it takes none".to_owned() } else { format!("it takes {}", types.join(", ")) };
    let plural = if wanted == 1 { "" } else { "s" };
    let message = format!("the function `{}` takes {wanted} argument{plural}, not {given}", function.name);
    Err(vec![Diagnostic::error("E0136", span, message).with_hint(hint)])
}

/// Only numbers are ordered. Other values can be compared for equality, messages not even that.
fn refuse_order(kind: &ValueType, comparison: Comparison, span: Span) -> CompileResult<()> {
    let sameness = matches!(comparison, Comparison::Equal | Comparison::NotEqual);
    match kind {
        ValueType::Number => Ok(()),
        ValueType::Message(_) => {
            let diagnostic = Diagnostic::error("E0137", span, "messages cannot be compared with each other");
            Err(vec![diagnostic.with_hint("compare fields of them")])
        }
        _ if sameness => Ok(()),
        other => {
            let message = format!("`{comparison}` needs numbers, found {}", describe(other));
            Err(vec![Diagnostic::error("E0137", span, message).with_hint("compare by `==` or `!=`")])
        }
    }
}

fn number(term: ValueTerm) -> TypedTerm {
    TypedTerm { term, kind: ValueType::Number }
}

/// A negated constant is a constant.
fn negated(term: ValueTerm) -> ValueTerm {
    match term {
        ValueTerm::Literal(Literal::Float(value)) => ValueTerm::Literal(Literal::Float(-value)),
        ValueTerm::Literal(Literal::Uint(value)) if i64::try_from(value).is_ok() => {
            ValueTerm::Literal(Literal::Int(-(value as i64)))
        }
        other => ValueTerm::Negative(Box::new(other)),
    }
}

/// Hint for an operand whose type differs from the required one.
fn needed_hint(found: &ValueType, needed: &ValueType) -> String {
    match (found, needed) {
        (ValueType::Message(_), _) => "name a field of the message".to_owned(),
        (_, ValueType::Bool) => "compare it with something".to_owned(),
        (_, ValueType::Enumeration(name)) => format!("write the name of a value of `{name}`"),
        (_, ValueType::Text) => "put texts into double quotes".to_owned(),
        (_, ValueType::Number) => "write a number, or a field that holds one".to_owned(),
        (_, ValueType::Message(name)) => format!("write `{name}`, or its topic"),
    }
}

/// Hint for two operands of different types.
fn comparison_hint(one: &ValueType, other: &ValueType) -> String {
    match (one, other) {
        (ValueType::Message(_), _) | (_, ValueType::Message(_)) => "name a field of the message".to_owned(),
        (ValueType::Bool, _) | (_, ValueType::Bool) => {
            "true and false are no numbers: write `x` or `!x`".to_owned()
        }
        (ValueType::Enumeration(name), _) | (_, ValueType::Enumeration(name)) => {
            format!("write the name of a value of `{name}`")
        }
        _ => "write numbers without quotes, texts with quotes".to_owned(),
    }
}
