//! A property with resolved names, as a table of terms in negation normal form.

use std::time::Duration;

use yase::NodeId;
use yase::expression::{EventId, Expression};

use super::syntax::{PropertyFormula, PropertyFormulaKind};

/// Letters have a bit for each atom.
pub(crate) const MAX_ATOMS: usize = 64;
/// A clause has a bit for each temporal term.
pub(crate) const MAX_TEMPORAL_TERMS: usize = 32;
/// A clause has a deadline for each of these.
pub(crate) const MAX_BOUNDED_TERMS: usize = 8;

/// A proposition about one step.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum AtomicProposition {
    /// The state is active after the step.
    In(NodeId),
    /// The state was entered.
    Entering(NodeId),
    /// The state was left.
    Leaving(NodeId),
    /// The event was offered.
    Event(EventId),
    /// The condition held.
    Condition(Expression),
}

/// A property of one chart, ready to be evaluated. Its [atoms](CompiledProperty::atoms) are
/// numbered; a step of the chart is represented by the set of atoms that are true of it, one bit
/// for each.
#[derive(Clone, Debug)]
pub struct CompiledProperty {
    pub(crate) name: String,
    pub(crate) terms: Vec<Subformula>,
    pub(crate) root: usize,
    pub(crate) atoms: Vec<AtomicProposition>,
    /// The terms that are obligations, by index, and the index of their deadline in a clause.
    pub(crate) obligations: Vec<(usize, Option<usize>)>,
    /// Whether the property begins with `always`, so that repeating it adds no obligation.
    pub(crate) is_lasting: bool,
}

/// A term of a property; operands are indices.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Subformula {
    Constant(bool),
    Literal {
        atom: usize,
        holds: bool,
    },
    And(usize, usize),
    Or(usize, usize),
    /// The right operand becomes true, and the left one is true until then.
    Until {
        obligation: usize,
        left: usize,
        right: usize,
        bound: Option<u64>,
    },
    /// The right operand is true up to and including the step in which the left one becomes true.
    Release {
        obligation: usize,
        left: usize,
        right: usize,
        bound: Option<u64>,
    },
}

/// A property exceeds a limit: its name and value.
pub(crate) struct TooLarge(pub(crate) &'static str, pub(crate) usize);

impl CompiledProperty {
    /// The name of the property.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The atomic propositions, in the order of the bits of a letter.
    pub fn atoms(&self) -> &[AtomicProposition] {
        &self.atoms
    }

    /// Whether the property has a time bound.
    pub fn is_bounded(&self) -> bool {
        self.bounds().next().is_some()
    }

    /// The time bounds, in nanoseconds.
    pub(crate) fn bounds(&self) -> impl Iterator<Item = u64> {
        self.terms.iter().filter_map(|term| match term {
            Subformula::Until { bound, .. } | Subformula::Release { bound, .. } => *bound,
            _ => None,
        })
    }

    /// The property with bounds in another unit of time.
    pub(crate) fn in_units(mut self, nanoseconds: u64) -> CompiledProperty {
        for term in &mut self.terms {
            if let Subformula::Until { bound: Some(bound), .. }
            | Subformula::Release { bound: Some(bound), .. } = term
            {
                *bound /= nanoseconds;
            }
        }
        self
    }
}

/// Lowers formulas to tables of terms.
pub(crate) struct Lowering<F> {
    /// Returns the atom of a formula without operands.
    pub(crate) atom: F,
    pub(crate) plan: CompiledProperty,
    bounded: usize,
}

impl<F: FnMut(&PropertyFormula) -> Option<AtomicProposition>> Lowering<F> {
    pub(crate) fn new(name: &str, is_lasting: bool, atom: F) -> Lowering<F> {
        let (terms, atoms, obligations) = (Vec::new(), Vec::new(), Vec::new());
        let plan = CompiledProperty { name: name.into(), terms, root: 0, atoms, obligations, is_lasting };
        Lowering { atom, plan, bounded: 0 }
    }

    /// The table of a formula, or of its negation.
    pub(crate) fn finish(
        mut self,
        formula: &PropertyFormula,
        holds: bool,
    ) -> Result<CompiledProperty, TooLarge> {
        self.plan.root = self.lower(formula, holds)?;
        Ok(self.plan)
    }

    fn lower(&mut self, formula: &PropertyFormula, holds: bool) -> Result<usize, TooLarge> {
        match &formula.kind {
            PropertyFormulaKind::Constant(value) => Ok(self.add(Subformula::Constant(*value == holds))),
            PropertyFormulaKind::Not(inner) => self.lower(inner, !holds),
            PropertyFormulaKind::And(parts) => self.several(parts, holds, holds),
            PropertyFormulaKind::Or(parts) => self.several(parts, holds, !holds),
            PropertyFormulaKind::Implies(one, other) => {
                let (one, other) = (self.lower(one, !holds)?, self.lower(other, holds)?);
                Ok(self.join(one, other, !holds))
            }
            PropertyFormulaKind::Always(inner) => {
                let (left, right) = (self.add(Subformula::Constant(!holds)), self.lower(inner, holds)?);
                self.temporal(left, right, None, !holds)
            }
            PropertyFormulaKind::Eventually(inner, bound) => {
                let (left, right) = (self.add(Subformula::Constant(holds)), self.lower(inner, holds)?);
                self.temporal(left, right, *bound, holds)
            }
            PropertyFormulaKind::Until(one, other, bound) => {
                let (left, right) = (self.lower(one, holds)?, self.lower(other, holds)?);
                self.temporal(left, right, *bound, holds)
            }
            PropertyFormulaKind::In(_)
            | PropertyFormulaKind::Entering(_)
            | PropertyFormulaKind::Leaving(_)
            | PropertyFormulaKind::Event(_)
            | PropertyFormulaKind::Condition(_) => self.literal(formula, holds),
        }
    }

    fn literal(&mut self, formula: &PropertyFormula, holds: bool) -> Result<usize, TooLarge> {
        // the unknown name was reported, and the result is discarded
        let Some(atom) = (self.atom)(formula) else { return Ok(self.add(Subformula::Constant(false))) };
        let known = self.plan.atoms.iter().position(|other| *other == atom);
        let atom = match known {
            Some(index) => index,
            None if self.plan.atoms.len() == MAX_ATOMS => {
                return Err(TooLarge("different things about states, events and messages", MAX_ATOMS));
            }
            None => {
                self.plan.atoms.push(atom);
                self.plan.atoms.len() - 1
            }
        };
        Ok(self.add(Subformula::Literal { atom, holds }))
    }

    fn several(&mut self, parts: &[PropertyFormula], holds: bool, all: bool) -> Result<usize, TooLarge> {
        let mut joined = None;
        for part in parts {
            let part = self.lower(part, holds)?;
            joined = Some(match joined {
                Some(before) => self.join(before, part, all),
                None => part,
            });
        }
        Ok(joined.unwrap_or_else(|| self.add(Subformula::Constant(all))))
    }

    fn join(&mut self, one: usize, other: usize, all: bool) -> usize {
        self.add(if all { Subformula::And(one, other) } else { Subformula::Or(one, other) })
    }

    fn temporal(
        &mut self,
        left: usize,
        right: usize,
        bound: Option<Duration>,
        is_until: bool,
    ) -> Result<usize, TooLarge> {
        let obligation = self.plan.obligations.len();
        if obligation == MAX_TEMPORAL_TERMS {
            return Err(TooLarge("`always`, `eventually` and `until`", MAX_TEMPORAL_TERMS));
        }
        let bound = bound.map(|bound| u64::try_from(bound.as_nanos()).unwrap_or(u64::MAX));
        let deadline = bound.map(|_| self.bounded);
        self.bounded += usize::from(bound.is_some());
        if self.bounded > MAX_BOUNDED_TERMS {
            return Err(TooLarge("`within`", MAX_BOUNDED_TERMS));
        }
        let term = match is_until {
            true => Subformula::Until { obligation, left, right, bound },
            false => Subformula::Release { obligation, left, right, bound },
        };
        let index = self.add(term);
        self.plan.obligations.push((index, deadline));
        Ok(index)
    }

    fn add(&mut self, term: Subformula) -> usize {
        self.plan.terms.push(term);
        self.plan.terms.len() - 1
    }
}
