//! The syntax tree of a property.

use std::time::Duration;

use yase::Span;
use yase::expression::{Expression, Name, TextPosition};

/// A property and its name.
#[derive(Clone, PartialEq, Debug)]
pub struct Property {
    /// Its name, unique in the file.
    pub name: String,
    /// Its formula.
    pub formula: PropertyFormula,
    /// Its position in the source.
    pub position: TextPosition,
}

/// A formula or a part of it.
#[derive(Clone, PartialEq, Debug)]
pub struct PropertyFormula {
    /// Its kind and operands.
    pub kind: PropertyFormulaKind,
    /// Its position in the source.
    pub position: TextPosition,
}

impl PropertyFormula {
    /// The span of the formula.
    pub fn span(&self) -> Span {
        self.position.0
    }
}

/// The kinds of formulas.
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
    /// `[c]`: a condition on messages.
    Condition(Expression),
    /// `not p`.
    Not(Box<PropertyFormula>),
    /// `p and q and r`, at least two operands.
    And(Vec<PropertyFormula>),
    /// `p or q or r`, at least two operands.
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
