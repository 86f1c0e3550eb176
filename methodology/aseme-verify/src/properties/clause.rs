//! The residual of a property after some steps: clauses of obligations.
//!
//! A step rewrites a formula into what must hold from the next step on (formula progression), in
//! disjunctive form: a [`Clause`] is a set of temporal terms that must all hold from the next step
//! on, each with its deadline if it is bounded; one of the clauses must be fulfilled. The empty set
//! of clauses is *false*, a clause without obligations is *true*.
//!
//! A term occurs at most once in a clause. Two obligations of the same bounded term differ only in
//! their deadlines, and one implies the other: the earlier for `until`, the later for its negation.
//! So a clause has a fixed size, and a step allocates no memory beyond that of the [`Scratch`].

use super::compiled_property::{CompiledProperty, MAX_BOUNDED_TERMS, Subformula};

/// Limit of clauses kept between steps.
pub(crate) const MAX_CLAUSES: usize = 64;
/// Limit of clauses during a step.
const MAX_CLAUSES_IN_STEP: usize = 1_024;

/// Obligations that must all be met.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Clause {
    /// A bit for each obligation.
    pub(crate) obligations: u32,
    /// The deadlines of bounded obligations; 0 for absent ones.
    pub(crate) deadlines: [u64; MAX_BOUNDED_TERMS],
}

impl Clause {
    /// The clause without obligations.
    pub(crate) const TRUE: Clause = Clause { obligations: 0, deadlines: [0; MAX_BOUNDED_TERMS] };

    pub(crate) fn is_true(&self) -> bool {
        self.obligations == 0
    }

    pub(crate) fn has(&self, obligation: usize) -> bool {
        self.obligations & (1 << obligation) != 0
    }

    fn one(plan: &CompiledProperty, obligation: usize, deadline: u64) -> Clause {
        let mut clause = Clause { obligations: 1 << obligation, ..Clause::TRUE };
        if let Some((_, Some(index))) = plan.obligations.get(obligation) {
            clause.deadlines[*index] = deadline;
        }
        clause
    }

    /// The conjunction of two clauses.
    fn and(&self, other: &Clause, plan: &CompiledProperty) -> Clause {
        let mut both = Clause { obligations: self.obligations | other.obligations, ..*self };
        for (obligation, index, is_until) in bounded(plan) {
            both.deadlines[index] = match (self.has(obligation), other.has(obligation)) {
                (true, true) if is_until => self.deadlines[index].min(other.deadlines[index]),
                (true, true) => self.deadlines[index].max(other.deadlines[index]),
                (false, true) => other.deadlines[index],
                _ => self.deadlines[index],
            };
        }
        both
    }

    /// Whether this clause implies the other.
    fn implies(&self, other: &Clause, plan: &CompiledProperty) -> bool {
        other.obligations & !self.obligations == 0
            && bounded(plan).all(|(obligation, index, is_until)| {
                !other.has(obligation)
                    || match is_until {
                        true => self.deadlines[index] <= other.deadlines[index],
                        false => self.deadlines[index] >= other.deadlines[index],
                    }
            })
    }

    /// The clause at a time between steps; `None` if an obligation can no longer be met.
    pub(crate) fn at_time(&self, now: u64, plan: &CompiledProperty) -> Option<Clause> {
        let mut left = *self;
        for (obligation, index, is_until) in bounded(plan) {
            if self.has(obligation) && self.deadlines[index] < now {
                if is_until {
                    return None;
                }
                left.obligations &= !(1 << obligation);
                left.deadlines[index] = 0;
            }
        }
        Some(left)
    }

    /// The deadlines relative to a later time.
    pub(crate) fn shifted(mut self, by: u64, plan: &CompiledProperty) -> Clause {
        for (obligation, index, _) in bounded(plan) {
            if self.has(obligation) {
                self.deadlines[index] = self.deadlines[index].saturating_sub(by);
            }
        }
        self
    }

    /// The first time after which [`at_time`](Clause::at_time) may return another result.
    pub(crate) fn first_deadline(&self, plan: &CompiledProperty) -> Option<u64> {
        bounded(plan)
            .filter(|(obligation, ..)| self.has(*obligation))
            .map(|(_, index, _)| self.deadlines[index])
            .min()
    }

    /// Whether an obligation requires something to happen.
    pub(crate) fn awaits(&self, plan: &CompiledProperty) -> bool {
        plan.obligations.iter().enumerate().any(|(obligation, &(term, _))| {
            self.has(obligation) && matches!(plan.terms[term], Subformula::Until { .. })
        })
    }
}

/// The bounded obligations: index, index of the deadline, and whether it is an `until`.
fn bounded(plan: &CompiledProperty) -> impl Iterator<Item = (usize, usize, bool)> {
    plan.obligations.iter().enumerate().filter_map(|(obligation, &(term, index))| {
        Some((obligation, index?, matches!(plan.terms[term], Subformula::Until { .. })))
    })
}

/// The atoms that are true of a step, and its time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TimedLetter {
    pub(crate) letter: u64,
    pub(crate) now: u64,
}

/// The limit of clauses was exceeded.
#[derive(Debug)]
pub(crate) struct Overflow;

/// The working memory of steps. It does not grow after its construction.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    clauses: Vec<Clause>,
}

impl Scratch {
    pub(crate) fn new() -> Scratch {
        Scratch { clauses: Vec::with_capacity(MAX_CLAUSES_IN_STEP) }
    }

    /// The clauses that the last step left; none implies another.
    pub(crate) fn clauses(&self) -> &[Clause] {
        &self.clauses
    }

    /// The first step.
    pub(crate) fn begin(&mut self, plan: &CompiledProperty, at: TimedLetter) -> Result<(), Overflow> {
        self.clauses.clear();
        self.expand(plan, plan.root, None, at)?;
        self.simplify(0, plan);
        Ok(())
    }

    /// A step that starts from given clauses.
    pub(crate) fn step(
        &mut self,
        plan: &CompiledProperty,
        from: &[Clause],
        at: TimedLetter,
    ) -> Result<(), Overflow> {
        self.clauses.clear();
        for clause in from {
            let begin = self.clauses.len();
            self.push(Clause::TRUE)?;
            for (obligation, &(term, index)) in plan.obligations.iter().enumerate() {
                if clause.has(obligation) {
                    let middle = self.clauses.len();
                    let deadline = index.map_or(u64::MAX, |position| clause.deadlines[position]);
                    self.expand(plan, term, Some(deadline), at)?;
                    self.product(begin, middle, plan)?;
                }
            }
        }
        self.simplify(0, plan);
        Ok(())
    }

    /// Pushes the residual of a term after a step. A temporal term may be older than the step and
    /// has its own deadline then.
    fn expand(
        &mut self,
        plan: &CompiledProperty,
        term: usize,
        deadline: Option<u64>,
        at: TimedLetter,
    ) -> Result<(), Overflow> {
        let begin = self.clauses.len();
        match plan.terms[term] {
            Subformula::Constant(true) => self.push(Clause::TRUE),
            Subformula::Constant(false) => Ok(()),
            Subformula::Literal { atom, holds } => match (at.letter & (1 << atom) != 0) == holds {
                true => self.push(Clause::TRUE),
                false => Ok(()),
            },
            Subformula::Or(one, other) => {
                self.expand(plan, one, None, at)?;
                self.expand(plan, other, None, at)?;
                self.simplify(begin, plan);
                Ok(())
            }
            Subformula::And(one, other) => {
                self.expand(plan, one, None, at)?;
                let middle = self.clauses.len();
                self.expand(plan, other, None, at)?;
                self.product(begin, middle, plan)
            }
            Subformula::Until { obligation, left, right, bound } => {
                let deadline = deadline_of(deadline, bound, at);
                if at.now > deadline {
                    return Ok(());
                }
                self.expand(plan, right, None, at)?;
                let middle = self.clauses.len();
                self.expand(plan, left, None, at)?;
                let goes_on = Clause::one(plan, obligation, deadline);
                self.clauses[middle..].iter_mut().for_each(|clause| *clause = clause.and(&goes_on, plan));
                self.simplify(begin, plan);
                Ok(())
            }
            Subformula::Release { obligation, left, right, bound } => {
                let deadline = deadline_of(deadline, bound, at);
                if at.now > deadline {
                    return self.push(Clause::TRUE);
                }
                self.expand(plan, right, None, at)?;
                let middle = self.clauses.len();
                self.expand(plan, left, None, at)?;
                self.push(Clause::one(plan, obligation, deadline))?;
                self.product(begin, middle, plan)
            }
        }
    }

    /// Replaces the clauses from `begin` and from `middle` by their pairwise conjunctions.
    fn product(&mut self, begin: usize, middle: usize, plan: &CompiledProperty) -> Result<(), Overflow> {
        let end = self.clauses.len();
        for one in begin..middle {
            for other in middle..end {
                self.push(self.clauses[one].and(&self.clauses[other], plan))?;
            }
        }
        self.clauses.copy_within(end.., begin);
        self.clauses.truncate(begin + self.clauses.len() - end);
        self.simplify(begin, plan);
        Ok(())
    }

    /// Removes clauses that are implied by others.
    fn simplify(&mut self, begin: usize, plan: &CompiledProperty) {
        let mut kept = begin;
        for index in begin..self.clauses.len() {
            let clause = self.clauses[index];
            let weaker = |other: &Clause| clause.implies(other, plan);
            // of two equal clauses the first remains
            let is_needless = self.clauses[begin..kept].iter().any(weaker)
                || self.clauses[index + 1..]
                    .iter()
                    .any(|other| weaker(other) && !other.implies(&clause, plan));
            if !is_needless {
                self.clauses[kept] = clause;
                kept += 1;
            }
        }
        self.clauses.truncate(kept);
    }

    fn push(&mut self, clause: Clause) -> Result<(), Overflow> {
        if self.clauses.len() == MAX_CLAUSES_IN_STEP {
            return Err(Overflow);
        }
        self.clauses.push(clause);
        Ok(())
    }
}

fn deadline_of(known: Option<u64>, bound: Option<u64>, at: TimedLetter) -> u64 {
    known.unwrap_or_else(|| bound.map_or(u64::MAX, |bound| at.now.saturating_add(bound)))
}
