//! The syntax tree of a property.

use std::time::Duration;

use yase::Span;
use yase::expression::{Expression, Name, Place};

/// A property and its name.
#[derive(Clone, PartialEq, Debug)]
pub struct Property {
    /// What it is called, in the file once.
    pub name: String,
    /// What it says.
    pub formula: Formula,
    /// Where it stands.
    pub place: Place,
}

/// What a property says, or a part of it.
#[derive(Clone, PartialEq, Debug)]
pub struct Formula {
    /// What it says.
    pub kind: FormulaKind,
    /// Where it stands.
    pub place: Place,
}

impl Formula {
    /// The bytes it stands in.
    pub fn span(&self) -> Span {
        self.place.0
    }
}

/// What a [`Formula`] says.
#[derive(Clone, PartialEq, Debug)]
pub enum FormulaKind {
    /// `true`, `false`.
    Constant(bool),
    /// `in S`: the state is active.
    In(Name),
    /// `entering S`: the state was entered in this step.
    Entering(Name),
    /// `leaving S`: the state was left in this step.
    Leaving(Name),
    /// `event e`: the event was offered in this step.
    Event(Name),
    /// `[c]`: what messages say.
    Condition(Expression),
    /// `not p`.
    Not(Box<Formula>),
    /// `p and q and r`, two at least.
    And(Vec<Formula>),
    /// `p or q or r`, two at least.
    Or(Vec<Formula>),
    /// `p implies q`.
    Implies(Box<Formula>, Box<Formula>),
    /// `always p`.
    Always(Box<Formula>),
    /// `eventually p`, or `eventually p within d`.
    Eventually(Box<Formula>, Option<Duration>),
    /// `p until q`, or `p until q within d`.
    Until(Box<Formula>, Box<Formula>, Option<Duration>),
}
