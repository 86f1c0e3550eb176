//! The syntax tree of a property.

use std::time::Duration;

use yase::Span;
use yase::expression::{Expression, Name, TextPosition};

/// A property and its name.
#[derive(Clone, PartialEq, Debug)]
pub struct Property {
    /// What it is called, in the file once.
    pub name: String,
    /// What it says.
    pub formula: PropertyFormula,
    /// Its position in the source.
    pub place: TextPosition,
}

/// What a property says, or a part of it.
#[derive(Clone, PartialEq, Debug)]
pub struct PropertyFormula {
    /// What it says.
    pub kind: PropertyFormulaKind,
    /// Its position in the source.
    pub place: TextPosition,
}

impl PropertyFormula {
    /// The bytes it stands in.
    pub fn span(&self) -> Span {
        self.place.0
    }
}

/// What a [`PropertyFormula`] says.
#[derive(Clone, PartialEq, Debug)]
pub enum PropertyFormulaKind {
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
    Not(Box<PropertyFormula>),
    /// `p and q and r`, two at least.
    And(Vec<PropertyFormula>),
    /// `p or q or r`, two at least.
    Or(Vec<PropertyFormula>),
    /// `p implies q`.
    Implies(Box<PropertyFormula>, Box<PropertyFormula>),
    /// `always p`.
    Always(Box<PropertyFormula>),
    /// `eventually p`, or `eventually p within d`.
    Eventually(Box<PropertyFormula>, Option<Duration>),
    /// `p until q`, or `p until q within d`.
    Until(Box<PropertyFormula>, Box<PropertyFormula>, Option<Duration>),
}
