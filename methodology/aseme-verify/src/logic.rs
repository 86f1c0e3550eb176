//! Satisfiability of guards: can conditions hold together, does one imply another.
//!
//! A guard is a quantifier-free combination of comparisons. A query is expanded into its
//! alternatives, up to a bound, and each is decided by the kind of its values: numbers by
//! difference bounds, texts and enumeration values by equality, the rest as booleans. Numbers are
//! real numbers; `abs`, `min` and `max` are one or the other of two operands.
//!
//! Terms outside this theory (other functions, products and sums of several fields, scripts) are
//! treated as opaque values; only terms with equal text are known to be equal. *No* is therefore
//! reliable, and where *yes* would depend on an opaque value, the answer is *unknown*.
//!
//! Guards are three-valued: one that reads a message that has not arrived is unknown and does not
//! fire. A [`Claim`] states which value is meant.
//!
//! ```
//! use aseme_verify::logic::{Claim, GuardSolver, Satisfiability};
//! use yase::expression::parse_condition;
//!
//! let condition = |text| parse_condition(text).0.expect("a condition");
//! let near = condition("Ball.distance < 1 && Ball.found");
//! let far = condition("Ball.distance > 2 || !Ball.found");
//! let logic = GuardSolver::default();
//! assert_eq!(logic.together(&[Claim::Holds(&near), Claim::Holds(&far)]), Satisfiability::No);
//! let neither = logic.together(&[Claim::IsFalse(&near), Claim::IsFalse(&far)]);
//! let Satisfiability::Yes(example) = neither else { panic!() };
//! assert_eq!(example.to_string(), "`Ball.distance` is 1 and `Ball.found` is true");
//! let opaque = condition("seen(Ball.x)");
//! assert_eq!(logic.together(&[Claim::Holds(&opaque)]), Satisfiability::Unknown);
//! ```

mod bounds;
mod formula;
mod linear;
mod search;

use std::fmt;

use yase::expression::Expression;
use yase::statechart::Constant;

pub(crate) use formula::messages;
use formula::{ConditionReader, NegationNormalForm, Polarity};
pub(crate) use search::GuardModel;
use search::SatisfiabilitySearch;

/// Limit of alternatives that are searched before the answer is unknown.
const MAX_ALTERNATIVES: usize = 2_500;

/// The same for the conditions of a whole run.
const MANY_ALTERNATIVES: usize = 20_000;

/// A claim about a condition.
#[derive(Clone, Copy, Debug)]
pub enum Claim<'a> {
    /// It is true.
    Holds(&'a Expression),
    /// It is false, and every value it depends on is known.
    IsFalse(&'a Expression),
    /// It is false or unknown.
    DoesNotHold(&'a Expression),
}

/// Whether claims can hold together.
#[derive(Clone, PartialEq, Debug)]
pub enum Satisfiability {
    /// They can, as the example shows.
    Yes(Example),
    /// They cannot.
    No,
    /// They are outside the decidable theory.
    Unknown,
}

impl Satisfiability {
    /// Whether the claims are satisfiable for certain.
    pub fn is_yes(&self) -> bool {
        matches!(self, Satisfiability::Yes(_))
    }

    /// Whether the claims are unsatisfiable for certain.
    pub fn is_no(&self) -> bool {
        *self == Satisfiability::No
    }
}

/// Values that satisfy the claims.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Example {
    /// The value of each name, ordered by name.
    pub values: Vec<(String, String)>,
}

impl fmt::Display for Example {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.values.iter().enumerate() {
            let between = match index {
                0 => "",
                _ if index + 1 == self.values.len() => " and ",
                _ => ", ",
            };
            write!(f, "{between}`{name}` is {value}")?;
        }
        Ok(())
    }
}

/// Decides the satisfiability of guards.
#[derive(Clone, Copy, Debug, Default)]
pub struct GuardSolver<'a> {
    constants: &'a [Constant],
}

impl<'a> GuardSolver<'a> {
    /// A solver with the constants of a model.
    pub fn new(constants: &'a [Constant]) -> GuardSolver<'a> {
        GuardSolver { constants }
    }

    /// Whether all claims can hold at the same time, on one blackboard.
    pub fn together(&self, claims: &[Claim<'_>]) -> Satisfiability {
        SatisfiabilitySearch::new(MAX_ALTERNATIVES).answer(self.all(claims))
    }

    /// Values with which all of this may hold, where undecidable terms may have any value; or none,
    /// and whether it is certain that there are none.
    pub(crate) fn candidate(&self, claims: &[Claim<'_>]) -> (Option<GuardModel>, bool) {
        SatisfiabilitySearch::new(MANY_ALTERNATIVES).candidate(&self.all(claims))
    }

    fn all(&self, claims: &[Claim<'_>]) -> NegationNormalForm {
        let reading = ConditionReader { constants: self.constants };
        let formulas = claims.iter().map(|claim| match claim {
            Claim::Holds(condition) => reading.formula(condition, Polarity::True),
            Claim::IsFalse(condition) => reading.formula(condition, Polarity::False),
            Claim::DoesNotHold(condition) => reading.formula(condition, Polarity::NotTrue),
        });
        NegationNormalForm::All(formulas.collect())
    }

    /// Whether one condition implies another; `false` if that is not known.
    pub fn implies(&self, one: &Expression, other: &Expression) -> bool {
        self.together(&[Claim::Holds(one), Claim::DoesNotHold(other)]).is_no()
    }
}
