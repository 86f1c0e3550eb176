//! Linear forms over fields, and their comparisons.

use std::collections::BTreeMap;

use yase::expression::{Additive, Comparison, Expression, ExpressionKind, Multiplicative};
use yase::statechart::ConstantValue;

use super::formula::{Atom, ConditionReader};

/// A constant plus multiples of names.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct LinearForm {
    number: f64,
    terms: BTreeMap<String, f64>,
    /// Whether each name is a field, as opposed to the text of an opaque term.
    is_exact: bool,
}

impl LinearForm {
    fn constant(number: f64) -> LinearForm {
        LinearForm { number, terms: BTreeMap::new(), is_exact: true }
    }

    fn name(name: String, is_exact: bool) -> LinearForm {
        LinearForm { number: 0.0, terms: BTreeMap::from([(name, 1.0)]), is_exact }
    }

    /// The linear form of an operand.
    pub(crate) fn of(expression: &Expression, reading: &ConditionReader<'_>) -> LinearForm {
        match &expression.kind {
            ExpressionKind::Integer(number) => LinearForm::constant(*number as f64),
            ExpressionKind::Decimal(number) => LinearForm::constant(*number),
            ExpressionKind::Negative(inner) => LinearForm::of(inner, reading).times(-1.0),
            ExpressionKind::Sum(first, others) => {
                others.iter().fold(LinearForm::of(first, reading), |sum, (sign, other)| match sign {
                    Additive::Plus => sum.plus(&LinearForm::of(other, reading)),
                    Additive::Minus => sum.minus(&LinearForm::of(other, reading)),
                })
            }
            ExpressionKind::Product(first, others) => {
                let product =
                    others.iter().try_fold(LinearForm::of(first, reading), |product, (operator, other)| {
                        product.by(*operator, &LinearForm::of(other, reading))
                    });
                product.unwrap_or_else(|| LinearForm::name(expression.to_string(), false))
            }
            ExpressionKind::Variable(path) => match reading.constant(path) {
                Some(ConstantValue::Number(number)) => LinearForm::constant(*number),
                _ => LinearForm::name(path.text(), path.segments.len() > 1),
            },
            _ => LinearForm::name(expression.to_string(), false),
        }
    }

    fn plus(mut self, other: &LinearForm) -> LinearForm {
        self.number += other.number;
        self.is_exact &= other.is_exact;
        for (name, factor) in &other.terms {
            *self.terms.entry(name.clone()).or_default() += factor;
        }
        self.terms.retain(|_, factor| *factor != 0.0);
        self
    }

    pub(crate) fn minus(self, other: &LinearForm) -> LinearForm {
        self.plus(&other.clone().times(-1.0))
    }

    fn times(mut self, factor: f64) -> LinearForm {
        self.number *= factor;
        self.terms.values_mut().for_each(|it| *it *= factor);
        self.terms.retain(|_, it| *it != 0.0);
        self
    }

    /// A product or quotient, if one operand is a constant.
    fn by(self, operator: Multiplicative, other: &LinearForm) -> Option<LinearForm> {
        match operator {
            Multiplicative::Times if other.terms.is_empty() => Some(self.times(other.number)),
            Multiplicative::Times if self.terms.is_empty() => Some(other.clone().times(self.number)),
            Multiplicative::Over if other.terms.is_empty() && other.number != 0.0 => {
                Some(self.times(1.0 / other.number))
            }
            _ => None,
        }
    }

    /// A comparison of the form with 0: alternatives, each a conjunction of bounds, each bound with
    /// whether it is exact.
    pub(crate) fn bounds(&self, comparison: Comparison) -> Vec<Vec<(Atom, bool)>> {
        if !(self.number.is_finite() && self.terms.values().all(|factor| factor.is_finite())) {
            let says = Atom::Flag(format!("{self:?} {comparison:?}"), true);
            return vec![vec![(says, false)]];
        }
        let below = |strict| self.at_most(strict);
        let above = |strict| self.clone().times(-1.0).at_most(strict);
        match comparison {
            Comparison::Less => vec![vec![below(true)]],
            Comparison::LessOrEqual => vec![vec![below(false)]],
            Comparison::Greater => vec![vec![above(true)]],
            Comparison::GreaterOrEqual => vec![vec![above(false)]],
            Comparison::Equal => vec![vec![below(false), above(false)]],
            Comparison::NotEqual => vec![vec![below(true)], vec![above(true)]],
        }
    }

    /// The bound that the form is at most, or less than, 0.
    fn at_most(&self, strict: bool) -> (Atom, bool) {
        let mut terms = self.terms.iter();
        let (says, is_simple) = match (terms.next(), terms.next(), terms.next()) {
            (None, ..) => (bound(None, None, -self.number, strict), true),
            (Some((name, &factor)), None, _) => (single(name.clone(), factor, -self.number, strict), true),
            (Some((one, &first)), Some((other, &second)), None) if first == -second => {
                let (more, less) = if first > 0.0 { (one, other) } else { (other, one) };
                let limit = -self.number / first.abs();
                (bound(Some(more.clone()), Some(less.clone()), limit, strict), true)
            }
            (Some((_, &first)), ..) => {
                // a sum of several names becomes one name, normalised by scale
                let scaled = self.terms.iter().map(|(name, factor)| format!("{} {name}", factor / first));
                let name = scaled.collect::<Vec<_>>().join(" + ");
                (single(name, first, -self.number, strict), false)
            }
        };
        (says, is_simple && self.is_exact)
    }
}

/// An upper bound on a multiple of a name.
fn single(name: String, factor: f64, limit: f64, strict: bool) -> Atom {
    match factor > 0.0 {
        true => bound(Some(name), None, limit / factor, strict),
        false => bound(None, Some(name), limit / -factor, strict),
    }
}

fn bound(more: Option<String>, less: Option<String>, limit: f64, strict: bool) -> Atom {
    Atom::Bound { more, less, limit, strict }
}
