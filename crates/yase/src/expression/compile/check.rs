//! Conditions and operands: each has one type, and operators say which they take.

use super::message::describe;
use super::scope::{Scope, Typed};
use super::{Checked, both, collect};
use crate::diagnostic::{Diagnostic, Span};
use crate::expression::program::{Literal, MAX_ARGUMENTS, Term, Test};
use crate::expression::syntax::{Comparison, Expression, ExpressionKind, Name, Path};
use crate::vocabulary::{FunctionEntry, ValueType};

impl Scope<'_> {
    /// A condition.
    pub(super) fn test(&self, expression: &Expression) -> Checked<Test> {
        match &expression.kind {
            ExpressionKind::Or(operands) => Ok(Test::Any(self.tests(operands)?.into())),
            ExpressionKind::And(operands) => Ok(Test::All(self.tests(operands)?.into())),
            ExpressionKind::Not(operand) => Ok(Test::Not(Box::new(self.test(operand)?))),
            ExpressionKind::Compare(left, comparison, right) => self.comparison(left, *comparison, right),
            ExpressionKind::Absent(message) => self.absent(message),
            ExpressionKind::Present(message) => Ok(Test::Not(Box::new(self.absent(message)?))),
            ExpressionKind::Bool(value) => Ok(Test::Literal(*value)),
            ExpressionKind::TimeoutCheck(timer) => Ok(self.timeout_check(timer)),
            ExpressionKind::In(state) => Ok(Test::Active(self.state(state)?)),
            ExpressionKind::Script(text) => Ok(Test::Script(self.script(text, expression.span())?)),
            _ => match self.term_of(expression, &ValueType::Bool)? {
                Term::Truth(test) => Ok(*test),
                term => Ok(Test::Holds(term)),
            },
        }
    }

    /// An operand that must be of a type.
    pub(super) fn term_of(&self, expression: &Expression, expected: &ValueType) -> Checked<Term> {
        let typed = self.term(expression, Some(expected))?;
        if typed.kind == *expected {
            return Ok(typed.term);
        }
        let message =
            format!("`{expression}` is {}, but {} is needed here", describe(&typed.kind), describe(expected));
        let diagnostic = Diagnostic::error("E0137", expression.span(), message);
        Err(vec![diagnostic.with_hint(needed_hint(&typed.kind, expected))])
    }

    fn tests(&self, operands: &[Expression]) -> Checked<Vec<Test>> {
        collect(operands.iter().map(|operand| self.test(operand)))
    }

    /// A timer that nothing starts is never over.
    fn timeout_check(&self, timer: &Path) -> Test {
        match self.timer(timer) {
            Some(timer) => Test::Over { timer, when_unset: false },
            None => Test::NeverStarted(timer.text().into()),
        }
    }

    fn absent(&self, path: &Path) -> Checked<Test> {
        let (source, fields) = self.message(path)?;
        let Some(field) = fields.first() else {
            return Ok(Test::Absent(source.message_source()));
        };
        let message = format!("`{}` is a field; only whole messages can be absent", field.text);
        let hint = "compare what stands before it with NULL";
        Err(vec![Diagnostic::error("E0138", field.place.0, message).with_hint(hint)])
    }

    fn comparison(&self, left: &Expression, comparison: Comparison, right: &Expression) -> Checked<Test> {
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
        Ok(Test::compare(a.term, comparison, b.term))
    }

    /// The type of an operand as far as it is plain before its neighbour is known: bare names of enumerations
    /// are not.
    fn type_hint(&self, expression: &Expression) -> Option<ValueType> {
        match &expression.kind {
            ExpressionKind::Variable(path) => self.variable(path, None).ok().map(|typed| typed.kind),
            ExpressionKind::Call(function, _) => {
                self.function(function).ok().map(|entry| entry.result.clone())
            }
            _ => None,
        }
    }

    fn term(&self, expression: &Expression, expected: Option<&ValueType>) -> Checked<Typed> {
        match &expression.kind {
            ExpressionKind::Integer(value) => Ok(number(Term::Literal(Literal::Uint(*value)))),
            ExpressionKind::Decimal(value) => Ok(number(Term::Literal(Literal::Float(*value)))),
            ExpressionKind::Text(text) => {
                Ok(Typed { term: Term::Literal(Literal::Text(text.as_str().into())), kind: ValueType::Text })
            }
            ExpressionKind::Variable(path) => self.variable(path, expected),
            ExpressionKind::Call(function, arguments) => self.call(function, arguments, expression.span()),
            ExpressionKind::Negative(operand) => Ok(number(negated(self.number(operand)?))),
            ExpressionKind::Sum(first, rest) => {
                let (first, rest) = both(self.number(first), self.chain(rest))?;
                Ok(number(Term::Sum(Box::new(first), rest)))
            }
            ExpressionKind::Product(first, rest) => {
                let (first, rest) = both(self.number(first), self.chain(rest))?;
                Ok(number(Term::Product(Box::new(first), rest)))
            }
            ExpressionKind::Bool(value) => {
                Ok(Typed { term: Term::Literal(Literal::Bool(*value)), kind: ValueType::Bool })
            }
            _ => Ok(Typed { term: Term::Truth(Box::new(self.test(expression)?)), kind: ValueType::Bool }),
        }
    }

    fn number(&self, expression: &Expression) -> Checked<Term> {
        self.term_of(expression, &ValueType::Number)
    }

    fn chain<O: Copy>(&self, rest: &[(O, Expression)]) -> Checked<Box<[(O, Term)]>> {
        let terms = rest.iter().map(|(operator, operand)| Ok((*operator, self.number(operand)?)));
        Ok(collect(terms)?.into())
    }

    fn call(&self, name: &Name, arguments: &[Expression], span: Span) -> Checked<Typed> {
        let function = self.function(name)?;
        check_count(function, arguments.len(), span)?;
        let pairs = arguments.iter().zip(&function.parameters);
        let terms = collect(pairs.map(|(argument, parameter)| self.term_of(argument, parameter)))?;
        Ok(Typed { term: Term::Call(function.id, terms.into()), kind: function.result.clone() })
    }
}

/// Whether it is a bare name, which may be a value of the enumeration beside it: nothing else depends on its neighbour.
fn is_bare(expression: &Expression) -> bool {
    matches!(&expression.kind, ExpressionKind::Variable(path) if path.bare().is_some())
}

fn check_count(function: &FunctionEntry, given: usize, span: Span) -> Checked<()> {
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

/// Numbers have an order; of everything else it can only be said whether it is the same. Messages not even
/// that.
fn refuse_order(kind: &ValueType, comparison: Comparison, span: Span) -> Checked<()> {
    let sameness = matches!(comparison, Comparison::Equal | Comparison::NotEqual);
    match kind {
        ValueType::Number => Ok(()),
        ValueType::Message(_) => {
            let diagnostic = Diagnostic::error("E0137", span, "messages cannot be compared with each other");
            Err(vec![diagnostic.with_hint("compare fields of them")])
        }
        _ if sameness => Ok(()),
        other => {
            let message = format!("`{comparison}` needs numbers, but here stands {}", describe(other));
            Err(vec![Diagnostic::error("E0137", span, message).with_hint("compare by `==` or `!=`")])
        }
    }
}

fn number(term: Term) -> Typed {
    Typed { term, kind: ValueType::Number }
}

/// A negative constant is a constant.
fn negated(term: Term) -> Term {
    match term {
        Term::Literal(Literal::Float(value)) => Term::Literal(Literal::Float(-value)),
        Term::Literal(Literal::Uint(value)) if i64::try_from(value).is_ok() => {
            Term::Literal(Literal::Int(-(value as i64)))
        }
        other => Term::Negative(Box::new(other)),
    }
}

/// What to do with an operand of one type where another is needed.
fn needed_hint(found: &ValueType, needed: &ValueType) -> String {
    match (found, needed) {
        (ValueType::Message(_), _) => "name a field of the message".to_owned(),
        (_, ValueType::Bool) => "compare it with something".to_owned(),
        (_, ValueType::Enumeration(name)) => format!("write the name of a value of `{name}`"),
        (_, ValueType::Text) => "a text stands in double quotes".to_owned(),
        (_, ValueType::Number) => "write a number, or a field that holds one".to_owned(),
        (_, ValueType::Message(name)) => format!("write `{name}`, or its topic"),
    }
}

/// What to do with two operands of different types.
fn comparison_hint(one: &ValueType, other: &ValueType) -> String {
    match (one, other) {
        (ValueType::Message(_), _) | (_, ValueType::Message(_)) => "name a field of the message".to_owned(),
        (ValueType::Bool, _) | (_, ValueType::Bool) => {
            "true and false are no numbers: write `x` or `!x`".to_owned()
        }
        (ValueType::Enumeration(name), _) | (_, ValueType::Enumeration(name)) => {
            format!("write the name of a value of `{name}`")
        }
        _ => "numbers stand without quotes, texts in quotes".to_owned(),
    }
}
