//! Evaluation of conditions with the values of a model.

use yase::expression::{Additive, Comparison, Expression, ExpressionKind, Multiplicative, Path};
use yase::statechart::{Constant, ConstantValue};

use crate::logic::GuardModel;

/// Whether a condition holds; none if the values do not decide that. Without values those
/// conditions are decided that read nothing.
pub(super) fn holds(
    condition: &Expression,
    model: Option<&GuardModel>,
    constants: &[Constant],
) -> Option<bool> {
    match (Evaluation { model, constants }).truth(condition) {
        Truth::Known(value) => Some(value),
        // what is unknown does not hold
        Truth::Missing => Some(false),
        Truth::Undecided => None,
    }
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Truth {
    Known(bool),
    /// A message has not arrived.
    Missing,
    /// The values do not decide it.
    Undecided,
}

#[derive(Clone, PartialEq, Debug)]
enum Operand {
    Number(f64),
    Symbol(String),
    /// Something that is not one of the symbols that it is compared with.
    OtherThan(Vec<String>),
    Truth(bool),
    Missing,
    Undecided,
}

struct Evaluation<'a> {
    model: Option<&'a GuardModel>,
    constants: &'a [Constant],
}

impl Evaluation<'_> {
    fn truth(&self, condition: &Expression) -> Truth {
        match &condition.kind {
            ExpressionKind::Not(inner) => match self.truth(inner) {
                Truth::Known(value) => Truth::Known(!value),
                other => other,
            },
            ExpressionKind::And(parts) => self.joined(parts, false),
            ExpressionKind::Or(parts) => self.joined(parts, true),
            ExpressionKind::Absent(_) | ExpressionKind::Present(_) if self.model.is_none() => {
                Truth::Undecided
            }
            ExpressionKind::Absent(path) => Truth::Known(self.is_missing(&path.text())),
            ExpressionKind::Present(path) => Truth::Known(!self.is_missing(&path.text())),
            ExpressionKind::Compare(left, comparison, right) => self.compared(left, *comparison, right),
            _ => match self.operand(condition) {
                Operand::Truth(value) => Truth::Known(value),
                Operand::Missing => Truth::Missing,
                _ => Truth::Undecided,
            },
        }
    }

    /// Operands of which one may decide the result.
    fn joined(&self, parts: &[Expression], decisive: bool) -> Truth {
        let parts: Vec<Truth> = parts.iter().map(|part| self.truth(part)).collect();
        let has = |truth: Truth| parts.contains(&truth);
        match () {
            () if has(Truth::Known(decisive)) => Truth::Known(decisive),
            () if has(Truth::Undecided) => Truth::Undecided,
            () if has(Truth::Missing) => Truth::Missing,
            () => Truth::Known(!decisive),
        }
    }

    fn compared(&self, left: &Expression, comparison: Comparison, right: &Expression) -> Truth {
        let is_equality = matches!(comparison, Comparison::Equal | Comparison::NotEqual);
        let equal = |same: bool| Truth::Known(same == (comparison == Comparison::Equal));
        match (self.comparand(left), self.comparand(right)) {
            (Operand::Missing, _) | (_, Operand::Missing) => Truth::Missing,
            (Operand::Number(one), Operand::Number(other)) => Truth::Known(match comparison {
                Comparison::Equal => one == other,
                Comparison::NotEqual => one != other,
                Comparison::Less => one < other,
                Comparison::LessOrEqual => one <= other,
                Comparison::Greater => one > other,
                Comparison::GreaterOrEqual => one >= other,
            }),
            (Operand::Symbol(one), Operand::Symbol(other)) if is_equality => equal(one == other),
            (Operand::Truth(one), Operand::Truth(other)) if is_equality => equal(one == other),
            (Operand::OtherThan(others), Operand::Symbol(symbol))
            | (Operand::Symbol(symbol), Operand::OtherThan(others))
                if is_equality && others.contains(&symbol) =>
            {
                equal(false)
            }
            _ => Truth::Undecided,
        }
    }

    /// An operand of a comparison, which may be a condition.
    fn comparand(&self, operand: &Expression) -> Operand {
        match self.operand(operand) {
            Operand::Undecided => match self.truth_of_compound(operand) {
                Some(Truth::Known(value)) => Operand::Truth(value),
                Some(Truth::Missing) => Operand::Missing,
                _ => Operand::Undecided,
            },
            known => known,
        }
    }

    fn truth_of_compound(&self, operand: &Expression) -> Option<Truth> {
        let is_compound = matches!(
            operand.kind,
            ExpressionKind::Not(_)
                | ExpressionKind::And(_)
                | ExpressionKind::Or(_)
                | ExpressionKind::Compare(..)
                | ExpressionKind::Absent(_)
                | ExpressionKind::Present(_)
        );
        is_compound.then(|| self.truth(operand))
    }

    fn operand(&self, operand: &Expression) -> Operand {
        match &operand.kind {
            ExpressionKind::Integer(number) => Operand::Number(*number as f64),
            ExpressionKind::Decimal(number) => Operand::Number(*number),
            ExpressionKind::Bool(value) => Operand::Truth(*value),
            ExpressionKind::Text(text) => Operand::Symbol(format!("\"{text}\"")),
            ExpressionKind::Negative(inner) => self.computed(inner, |number| -number),
            ExpressionKind::Sum(first, rest) => {
                rest.iter().fold(self.operand(first), |sum, (sign, other)| {
                    combined(sum, self.operand(other), |one, other| match sign {
                        Additive::Plus => one + other,
                        Additive::Minus => one - other,
                    })
                })
            }
            ExpressionKind::Product(first, rest) => {
                rest.iter().fold(self.operand(first), |product, (operator, other)| {
                    combined(product, self.operand(other), |one, other| match operator {
                        Multiplicative::Times => one * other,
                        Multiplicative::Over => one / other,
                    })
                })
            }
            ExpressionKind::Variable(path) => self.variable(path),
            ExpressionKind::Call(name, arguments) => self.call(&name.text, arguments, operand),
            _ => self.named(&operand.to_string()),
        }
    }

    fn call(&self, name: &str, arguments: &[Expression], whole: &Expression) -> Operand {
        match (name, arguments) {
            ("abs", [one]) => self.computed(one, f64::abs),
            ("min", [one, other]) => combined(self.operand(one), self.operand(other), f64::min),
            ("max", [one, other]) => combined(self.operand(one), self.operand(other), f64::max),
            // of a function of the program only that is known which the run takes it to return
            _ => self.named(&whole.to_string()),
        }
    }

    fn computed(&self, operand: &Expression, compute: impl Fn(f64) -> f64) -> Operand {
        match self.operand(operand) {
            Operand::Number(number) => Operand::Number(compute(number)),
            Operand::Missing => Operand::Missing,
            _ => Operand::Undecided,
        }
    }

    fn variable(&self, path: &Path) -> Operand {
        let Some(name) = path.bare() else {
            let text = path.text();
            let message = text.rsplit_once('.').map_or("", |(message, _)| message);
            return if self.is_missing(message) { Operand::Missing } else { self.named(&text) };
        };
        match self.constants.iter().find(|constant| constant.name == name).map(|it| &it.value) {
            Some(ConstantValue::Bool(value)) => Operand::Truth(*value),
            Some(ConstantValue::Number(number)) => Operand::Number(*number),
            Some(ConstantValue::Text(text)) => Operand::Symbol(format!("\"{text}\"")),
            None => match self.named(name) {
                Operand::Undecided => Operand::Symbol(name.to_owned()),
                known => known,
            },
        }
    }

    fn named(&self, name: &str) -> Operand {
        let Some(model) = self.model else { return Operand::Undecided };
        let number = model.numbers.get(name).map(|&number| Operand::Number(number));
        let symbol = model.symbols.get(name).map(|symbol| Operand::Symbol(symbol.clone()));
        let others = || {
            let others = model.differs.iter().filter(|(it, _)| it == name).map(|(_, other)| other.clone());
            Some(others.collect::<Vec<_>>()).filter(|others| !others.is_empty()).map(Operand::OtherThan)
        };
        let flag = model.flags.get(name).map(|&value| Operand::Truth(value));
        number.or(symbol).or(flag).or_else(others).unwrap_or(Operand::Undecided)
    }

    /// Parts of a message arrive with it.
    fn is_missing(&self, message: &str) -> bool {
        let is_within = |inner: &str, outer: &str| {
            inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let missing = self.model.iter().flat_map(|model| &model.missing);
        missing.into_iter().any(|it| is_within(message, it) || is_within(it, message))
    }
}

fn combined(one: Operand, other: Operand, compute: impl Fn(f64, f64) -> f64) -> Operand {
    match (one, other) {
        (Operand::Missing, _) | (_, Operand::Missing) => Operand::Missing,
        (Operand::Number(one), Operand::Number(other)) => match compute(one, other) {
            number if number.is_finite() => Operand::Number(number),
            _ => Operand::Undecided,
        },
        _ => Operand::Undecided,
    }
}
