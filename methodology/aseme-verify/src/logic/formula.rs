//! Conditions in negation normal form.

use yase::expression::{Comparison, Expression, ExpressionKind, Path};
use yase::statechart::{Constant, ConstantValue};

use super::linear::LinearForm;

/// A condition without negation.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum NegationNormalForm {
    All(Vec<NegationNormalForm>),
    Any(Vec<NegationNormalForm>),
    Is(GuardLiteral),
}

impl NegationNormalForm {
    pub(crate) fn constant(value: bool) -> NegationNormalForm {
        if value { NegationNormalForm::All(Vec::new()) } else { NegationNormalForm::Any(Vec::new()) }
    }
}

/// A literal: an atom or its negation.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct GuardLiteral {
    pub(crate) atom: Atom,
    /// The messages that must have arrived for it to be known.
    pub(crate) messages: Vec<String>,
    /// Whether the atom expresses the condition completely, so that nothing else decides its value.
    pub(crate) is_exact: bool,
}

#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Atom {
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

/// The value that a condition must have.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Polarity {
    True,
    False,
    NotTrue,
    NotFalse,
}

impl Polarity {
    /// The polarity of the operand of a negation.
    fn negated(self) -> Polarity {
        match self {
            Polarity::True => Polarity::False,
            Polarity::False => Polarity::True,
            Polarity::NotTrue => Polarity::NotFalse,
            Polarity::NotFalse => Polarity::NotTrue,
        }
    }

    fn is_positive(self) -> bool {
        matches!(self, Polarity::True | Polarity::NotFalse)
    }

    /// Whether a missing message satisfies the polarity.
    fn may_be_unknown(self) -> bool {
        matches!(self, Polarity::NotTrue | Polarity::NotFalse)
    }
}

/// Converts conditions to negation normal form.
pub(crate) struct ConditionReader<'a> {
    pub(crate) constants: &'a [Constant],
}

impl ConditionReader<'_> {
    pub(crate) fn formula(&self, condition: &Expression, wanted: Polarity) -> NegationNormalForm {
        match &condition.kind {
            ExpressionKind::Not(inner) => self.formula(inner, wanted.negated()),
            ExpressionKind::And(parts) => self.several(parts, wanted, wanted.is_positive()),
            ExpressionKind::Or(parts) => self.several(parts, wanted, !wanted.is_positive()),
            ExpressionKind::Bool(value) => NegationNormalForm::constant(*value == wanted.is_positive()),
            ExpressionKind::Compare(left, comparison, right) => {
                self.comparison(condition, left, *comparison, right, wanted)
            }
            ExpressionKind::Absent(path) => presence(path, !wanted.is_positive()),
            ExpressionKind::Present(path) => presence(path, wanted.is_positive()),
            ExpressionKind::Variable(path) => match self.constant(path) {
                Some(ConstantValue::Bool(value)) => {
                    NegationNormalForm::constant(*value == wanted.is_positive())
                }
                _ => flag(condition, path.text(), wanted, true),
            },
            ExpressionKind::TimeoutCheck(path) => {
                flag(condition, format!("TimeoutCheck({})", path.text()), wanted, true)
            }
            // states depend on each other and functions are unknown, so both are opaque
            _ => flag(condition, condition.to_string(), wanted, false),
        }
    }

    fn several(&self, parts: &[Expression], wanted: Polarity, all: bool) -> NegationNormalForm {
        let parts = parts.iter().map(|part| self.formula(part, wanted)).collect();
        if all { NegationNormalForm::All(parts) } else { NegationNormalForm::Any(parts) }
    }

    pub(crate) fn constant(&self, path: &Path) -> Option<&ConstantValue> {
        let name = path.bare()?;
        self.constants.iter().find(|constant| constant.name == name).map(|constant| &constant.value)
    }

    fn comparison(
        &self,
        whole: &Expression,
        left: &Expression,
        comparison: Comparison,
        right: &Expression,
        wanted: Polarity,
    ) -> NegationNormalForm {
        let is_equality = matches!(comparison, Comparison::Equal | Comparison::NotEqual);
        let same = (comparison == Comparison::Equal) == wanted.is_positive();
        if is_equality && (is_condition(left) || is_condition(right)) {
            return self.both_or_none(left, right, same, wanted.may_be_unknown());
        }
        if let Some((name, value)) = self.symbol(left, right).or_else(|| self.symbol(right, left)) {
            let says = match is_equality {
                true => Atom::Equals(name, value, same),
                false => Atom::Flag(whole.to_string(), wanted.is_positive()),
            };
            return known(whole, wanted, vec![(says, is_equality)]);
        }
        if let Some(cases) = self.cases(left, comparison, right, wanted.is_positive()) {
            return or_unknown(whole, wanted, cases);
        }
        let difference = LinearForm::of(left, self).minus(&LinearForm::of(right, self));
        let comparison = if wanted.is_positive() { comparison } else { comparison.negated() };
        // two fields compared for equality may have any type
        let is_number = !(is_equality && is_field(left) && is_field(right));
        let bounds = difference.bounds(comparison).into_iter().map(|all| {
            NegationNormalForm::All(
                all.into_iter().map(|(says, exact)| literal(whole, says, exact && is_number)).collect(),
            )
        });
        or_unknown(whole, wanted, NegationNormalForm::Any(bounds.collect()))
    }

    /// A comparison with `abs`, `min` or `max` in it, by the cases in which they are one or the
    /// other of two operands.
    fn cases(
        &self,
        left: &Expression,
        comparison: Comparison,
        right: &Expression,
        holds: bool,
    ) -> Option<NegationNormalForm> {
        let piecewise = [left, right].into_iter().find_map(|side| side.find_map(&mut PiecewiseCall::of))?;
        let wanted = if holds { Polarity::True } else { Polarity::False };
        let case = |is_first: bool, value: &Expression| {
            let replaced = |side: &Expression| {
                side.replaced(&mut |part| (*part == *piecewise.whole).then(|| value.clone()))
            };
            let condition = if is_first { Polarity::True } else { Polarity::False };
            let kind =
                ExpressionKind::Compare(Box::new(replaced(left)), comparison, Box::new(replaced(right)));
            let rest = Expression { kind, position: left.position };
            NegationNormalForm::All(vec![
                self.formula(&piecewise.is_first, condition),
                self.formula(&rest, wanted),
            ])
        };
        Some(NegationNormalForm::Any(vec![case(true, &piecewise.first), case(false, &piecewise.second)]))
    }

    /// Two conditions are compared.
    fn both_or_none(
        &self,
        left: &Expression,
        right: &Expression,
        same: bool,
        or_unknown: bool,
    ) -> NegationNormalForm {
        let (yes, no) = match or_unknown {
            true => (Polarity::NotFalse, Polarity::NotTrue),
            false => (Polarity::True, Polarity::False),
        };
        let pair =
            |one, other| NegationNormalForm::All(vec![self.formula(left, one), self.formula(right, other)]);
        match same {
            true => NegationNormalForm::Any(vec![pair(yes, yes), pair(no, no)]),
            false => NegationNormalForm::Any(vec![pair(yes, no), pair(no, yes)]),
        }
    }

    /// The comparison of a field with a text or an enumeration value.
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

/// A call of `abs`, `min` or `max`: one of two operands.
struct PiecewiseCall<'e> {
    whole: &'e Expression,
    /// Whether it is the first one.
    is_first: Expression,
    first: Expression,
    second: Expression,
}

impl<'e> PiecewiseCall<'e> {
    fn of(part: &'e Expression) -> Option<PiecewiseCall<'e>> {
        let ExpressionKind::Call(name, arguments) = &part.kind else { return None };
        let made = |kind| Expression { kind, position: part.position };
        let (first, comparison, second) = match (name.text.as_str(), arguments.as_slice()) {
            ("abs", [operand]) => {
                let negative = made(ExpressionKind::Negative(Box::new(operand.clone())));
                (operand.clone(), Comparison::GreaterOrEqual, negative)
            }
            ("min", [one, other]) => (one.clone(), Comparison::LessOrEqual, other.clone()),
            ("max", [one, other]) => (one.clone(), Comparison::GreaterOrEqual, other.clone()),
            _ => return None,
        };
        let to = match name.text.as_str() {
            "abs" => made(ExpressionKind::Integer(0)),
            _ => second.clone(),
        };
        let is_first = made(ExpressionKind::Compare(Box::new(first.clone()), comparison, Box::new(to)));
        Some(PiecewiseCall { whole: part, is_first, first, second })
    }
}

fn is_field(expression: &Expression) -> bool {
    matches!(&expression.kind, ExpressionKind::Variable(path) if path.segments.len() > 1)
}

/// Whether an operand is a condition rather than a value.
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

fn presence(path: &Path, present: bool) -> NegationNormalForm {
    let says = if present { Atom::Present(path.text()) } else { Atom::Missing(path.text()) };
    NegationNormalForm::Is(GuardLiteral { atom: says, messages: Vec::new(), is_exact: true })
}

fn flag(whole: &Expression, name: String, wanted: Polarity, is_exact: bool) -> NegationNormalForm {
    known(whole, wanted, vec![(Atom::Flag(name, wanted.is_positive()), is_exact)])
}

fn literal(whole: &Expression, says: Atom, is_exact: bool) -> NegationNormalForm {
    NegationNormalForm::Is(GuardLiteral { atom: says, messages: messages(whole), is_exact })
}

fn known(whole: &Expression, wanted: Polarity, says: Vec<(Atom, bool)>) -> NegationNormalForm {
    let literals = says.into_iter().map(|(says, exact)| literal(whole, says, exact)).collect();
    or_unknown(whole, wanted, NegationNormalForm::All(literals))
}

/// The known literal, or also a missing message if the polarity allows it.
fn or_unknown(whole: &Expression, wanted: Polarity, known: NegationNormalForm) -> NegationNormalForm {
    if !wanted.may_be_unknown() {
        return known;
    }
    let missing = messages(whole).into_iter().map(|message| {
        NegationNormalForm::Is(GuardLiteral {
            atom: Atom::Missing(message),
            messages: Vec::new(),
            is_exact: true,
        })
    });
    NegationNormalForm::Any(std::iter::once(known).chain(missing).collect())
}

/// The messages whose fields an expression reads: their paths without the last name.
pub(crate) fn messages(expression: &Expression) -> Vec<String> {
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
