//! Reasoning on guards: can conditions hold together, does one follow from another.
//!
//! A guard is a combination of comparisons without quantifiers. What is asked is brought into its alternatives, one after the other and no more than a
//! bounded number of them, and each is judged by what kinds of values there are: numbers by bounds on their differences, texts and values of enumerations
//! by what they equal, the rest by being true or false. Numbers are real numbers here.
//!
//! What lies outside of this (functions, products and sums of several fields, scripts) is taken for a value of its own, of which nothing is known but that
//! equal text has an equal value. So *no* is an answer to rely on, and where *yes* would rely on such a value, the answer is *unknown*.
//!
//! Guards have three values: one that reads a message that has not arrived is unknown, and does not fire. [`Claim`] says which value is meant.
//!
//! ```
//! use aseme::check::logic::{Answer, Claim, Logic};
//! use yase::expression::parse_condition;
//!
//! let condition = |text| parse_condition(text).0.expect("a condition");
//! let (near, far) = (condition("Ball.distance < 1 && Ball.found"), condition("Ball.distance > 2 || !Ball.found"));
//! let logic = Logic::default();
//! assert_eq!(logic.together(&[Claim::Holds(&near), Claim::Holds(&far)]), Answer::No);
//! let Answer::Yes(example) = logic.together(&[Claim::IsFalse(&near), Claim::IsFalse(&far)]) else { panic!() };
//! assert_eq!(example.to_string(), "`Ball.distance` is 1 and `Ball.found` is true");
//! assert_eq!(logic.together(&[Claim::Holds(&condition("seen(Ball.x)"))]), Answer::Unknown);
//! ```

mod bounds;
mod formula;
mod linear;
mod search;

use std::fmt;

use yase::expression::Expression;
use yase::statechart::Constant;

pub(super) use formula::messages;
use formula::{Formula, Reading, Wanted};
use search::Search;

/// How many alternatives are looked at before the answer is that it is unknown.
const ALTERNATIVES: usize = 500;

/// What is asked of a condition.
#[derive(Clone, Copy, Debug)]
pub enum Claim<'a> {
    /// It is true.
    Holds(&'a Expression),
    /// It is false: all that decides it is known.
    IsFalse(&'a Expression),
    /// It is false or unknown.
    DoesNotHold(&'a Expression),
}

/// Whether something can be.
#[derive(Clone, PartialEq, Debug)]
pub enum Answer {
    /// It can: so.
    Yes(Example),
    /// It cannot.
    No,
    /// It is outside of what can be judged.
    Unknown,
}

impl Answer {
    /// Whether it surely can.
    pub fn is_yes(&self) -> bool {
        matches!(self, Answer::Yes(_))
    }

    /// Whether it surely cannot.
    pub fn is_no(&self) -> bool {
        *self == Answer::No
    }
}

/// Values under which something is so.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Example {
    /// What each is, by its name, in the order of names.
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

/// What is known of the names in conditions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Logic<'a> {
    constants: &'a [Constant],
}

impl<'a> Logic<'a> {
    /// With the constants of a model.
    pub fn new(constants: &'a [Constant]) -> Logic<'a> {
        Logic { constants }
    }

    /// Whether all of this can be so at one moment, on one blackboard.
    pub fn together(&self, claims: &[Claim<'_>]) -> Answer {
        let reading = Reading { constants: self.constants };
        let formulas = claims.iter().map(|claim| match claim {
            Claim::Holds(condition) => reading.formula(condition, Wanted::True),
            Claim::IsFalse(condition) => reading.formula(condition, Wanted::False),
            Claim::DoesNotHold(condition) => reading.formula(condition, Wanted::NotTrue),
        });
        Search::new(ALTERNATIVES).answer(Formula::All(formulas.collect()))
    }

    /// Whether one condition holds only when another does: yes, or it is not known to.
    pub fn implies(&self, one: &Expression, other: &Expression) -> bool {
        self.together(&[Claim::Holds(one), Claim::DoesNotHold(other)]).is_no()
    }
}
