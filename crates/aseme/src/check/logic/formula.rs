//! Conditions in a form without negation, over literals.

use yase::expression::{Comparison, Expression, ExpressionKind, Path};
use yase::statechart::{Constant, ConstantValue};

use super::linear::Linear;

/// A condition without negation.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Formula {
    All(Vec<Formula>),
    Any(Vec<Formula>),
    Is(Literal),
}

impl Formula {
    pub(super) fn constant(value: bool) -> Formula {
        if value { Formula::All(Vec::new()) } else { Formula::Any(Vec::new()) }
    }
}

/// Something that is so or not.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Literal {
    pub(super) says: Says,
    /// The messages that must have arrived for it to be known.
    pub(super) messages: Vec<String>,
    /// Whether it stands for all that it says: nothing else decides its value.
    pub(super) is_exact: bool,
}

#[derive(Clone, PartialEq, Debug)]
pub(super) enum Says {
    /// A name is true or false.
    Flag(String, bool),
    /// A name equals a text or a value of an enumeration, or does not.
    Equals(String, String, bool),
    /// The difference of two names, or one name, is at most a number, or less.
    Bound { more: Option<String>, less: Option<String>, limit: f64, strict: bool },
    /// A message has not arrived.
    Missing(String),
    /// A message has arrived.
    Present(String),
}

/// The value that a condition is to have.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Wanted {
    True,
    False,
    NotTrue,
    NotFalse,
}

impl Wanted {
    /// What is wanted of what is negated.
    fn negated(self) -> Wanted {
        match self {
            Wanted::True => Wanted::False,
            Wanted::False => Wanted::True,
            Wanted::NotTrue => Wanted::NotFalse,
            Wanted::NotFalse => Wanted::NotTrue,
        }
    }

    fn is_positive(self) -> bool {
        matches!(self, Wanted::True | Wanted::NotFalse)
    }

    /// Whether it is enough that a message is missing.
    fn may_be_unknown(self) -> bool {
        matches!(self, Wanted::NotTrue | Wanted::NotFalse)
    }
}

/// How conditions are read.
pub(super) struct Reading<'a> {
    pub(super) constants: &'a [Constant],
}

impl Reading<'_> {
    pub(super) fn formula(&self, condition: &Expression, wanted: Wanted) -> Formula {
        match &condition.kind {
            ExpressionKind::Not(inner) => self.formula(inner, wanted.negated()),
            ExpressionKind::And(parts) => self.several(parts, wanted, wanted.is_positive()),
            ExpressionKind::Or(parts) => self.several(parts, wanted, !wanted.is_positive()),
            ExpressionKind::Bool(value) => Formula::constant(*value == wanted.is_positive()),
            ExpressionKind::Compare(left, comparison, right) => {
                self.comparison(condition, left, *comparison, right, wanted)
            }
            ExpressionKind::Absent(path) => presence(path, !wanted.is_positive()),
            ExpressionKind::Present(path) => presence(path, wanted.is_positive()),
            ExpressionKind::Variable(path) => match self.constant(path) {
                Some(ConstantValue::Bool(value)) => Formula::constant(*value == wanted.is_positive()),
                _ => flag(condition, path.text(), wanted, true),
            },
            ExpressionKind::TimeoutCheck(path) => {
                flag(condition, format!("TimeoutCheck({})", path.text()), wanted, true)
            }
            // states are not independent of each other, functions may be of anything
            _ => flag(condition, condition.to_string(), wanted, false),
        }
    }

    fn several(&self, parts: &[Expression], wanted: Wanted, all: bool) -> Formula {
        let parts = parts.iter().map(|part| self.formula(part, wanted)).collect();
        if all { Formula::All(parts) } else { Formula::Any(parts) }
    }

    pub(super) fn constant(&self, path: &Path) -> Option<&ConstantValue> {
        let name = path.bare()?;
        self.constants.iter().find(|constant| constant.name == name).map(|constant| &constant.value)
    }

    fn comparison(
        &self,
        whole: &Expression,
        left: &Expression,
        comparison: Comparison,
        right: &Expression,
        wanted: Wanted,
    ) -> Formula {
        let is_equality = matches!(comparison, Comparison::Equal | Comparison::NotEqual);
        let same = (comparison == Comparison::Equal) == wanted.is_positive();
        if is_equality && (is_condition(left) || is_condition(right)) {
            return self.both_or_none(left, right, same, wanted.may_be_unknown());
        }
        if let Some((name, value)) = self.symbol(left, right).or_else(|| self.symbol(right, left)) {
            let says = match is_equality {
                true => Says::Equals(name, value, same),
                false => Says::Flag(whole.to_string(), wanted.is_positive()),
            };
            return known(whole, wanted, vec![(says, is_equality)]);
        }
        let difference = Linear::of(left, self).minus(&Linear::of(right, self));
        let comparison = if wanted.is_positive() { comparison } else { comparison.contrary() };
        // two fields that are compared for equality may be of any type
        let is_number = !(is_equality && is_field(left) && is_field(right));
        let bounds = difference.bounds(comparison).into_iter().map(|all| {
            Formula::All(
                all.into_iter().map(|(says, exact)| literal(whole, says, exact && is_number)).collect(),
            )
        });
        or_unknown(whole, wanted, Formula::Any(bounds.collect()))
    }

    /// Two conditions are compared.
    fn both_or_none(&self, left: &Expression, right: &Expression, same: bool, or_unknown: bool) -> Formula {
        let (yes, no) = match or_unknown {
            true => (Wanted::NotFalse, Wanted::NotTrue),
            false => (Wanted::True, Wanted::False),
        };
        let pair = |one, other| Formula::All(vec![self.formula(left, one), self.formula(right, other)]);
        match same {
            true => Formula::Any(vec![pair(yes, yes), pair(no, no)]),
            false => Formula::Any(vec![pair(yes, no), pair(no, yes)]),
        }
    }

    /// A field that is compared with a text, or with a value of an enumeration.
    fn symbol(&self, field: &Expression, value: &Expression) -> Option<(String, String)> {
        let ExpressionKind::Variable(path) = &field.kind else { return None };
        let value = match &value.kind {
            ExpressionKind::Text(text) => format!("\"{text}\""),
            ExpressionKind::Variable(value) => match self.constant(value) {
                None => value.bare()?.to_owned(),
                Some(ConstantValue::Text(text)) => format!("\"{text}\""),
                Some(_) => return None,
            },
            _ => return None,
        };
        (path.segments.len() > 1).then(|| (path.text(), value))
    }
}

fn is_field(expression: &Expression) -> bool {
    matches!(&expression.kind, ExpressionKind::Variable(path) if path.segments.len() > 1)
}

/// Whether an operand is a condition, whatever it reads.
fn is_condition(expression: &Expression) -> bool {
    matches!(
        expression.kind,
        ExpressionKind::Bool(_)
            | ExpressionKind::Not(_)
            | ExpressionKind::And(_)
            | ExpressionKind::Or(_)
            | ExpressionKind::Compare(..)
            | ExpressionKind::Absent(_)
            | ExpressionKind::Present(_)
            | ExpressionKind::TimeoutCheck(_)
            | ExpressionKind::In(_)
    )
}

fn presence(path: &Path, present: bool) -> Formula {
    let says = if present { Says::Present(path.text()) } else { Says::Missing(path.text()) };
    Formula::Is(Literal { says, messages: Vec::new(), is_exact: true })
}

fn flag(whole: &Expression, name: String, wanted: Wanted, is_exact: bool) -> Formula {
    known(whole, wanted, vec![(Says::Flag(name, wanted.is_positive()), is_exact)])
}

fn literal(whole: &Expression, says: Says, is_exact: bool) -> Formula {
    Formula::Is(Literal { says, messages: messages(whole), is_exact })
}

fn known(whole: &Expression, wanted: Wanted, says: Vec<(Says, bool)>) -> Formula {
    let literals = says.into_iter().map(|(says, exact)| literal(whole, says, exact)).collect();
    or_unknown(whole, wanted, Formula::All(literals))
}

/// What is known, or that a message is missing if that will do.
fn or_unknown(whole: &Expression, wanted: Wanted, known: Formula) -> Formula {
    if !wanted.may_be_unknown() {
        return known;
    }
    let missing = messages(whole).into_iter().map(|message| {
        Formula::Is(Literal { says: Says::Missing(message), messages: Vec::new(), is_exact: true })
    });
    Formula::Any(std::iter::once(known).chain(missing).collect())
}

/// The messages whose fields an expression reads: their paths without the last name.
pub(in crate::check) fn messages(expression: &Expression) -> Vec<String> {
    let (mut found, mut open): (Vec<String>, _) = (Vec::new(), vec![expression]);
    while let Some(expression) = open.pop() {
        match &expression.kind {
            ExpressionKind::Variable(path) => {
                let text = path.text();
                found.extend(text.rsplit_once('.').map(|(message, _)| message.to_owned()));
            }
            _ => open.extend(expression.parts()),
        }
    }
    found.sort();
    found.dedup();
    found
}
