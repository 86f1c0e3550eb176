//! What is left of a property after some steps: clauses of obligations.
//!
//! A step turns a formula into what must hold from the next step on (formula progression), brought into alternatives: a [`Clause`] is a set of temporal terms that
//! must all hold from the next step on, each with its deadline if it has a bound; one of the clauses at hand must be fulfilled. No clause is *false*, the
//! clause without obligations is *true*.
//!
//! A term stands in a clause once. Two obligations of the same bounded term differ only in their deadlines, and one says more than the other: of `until` the earlier,
//! of its contrary the later. So a clause has a fixed size, and a step takes no memory beyond that of the [`Stack`].

use super::plan::{BOUNDED, Plan, Term};

/// So many clauses are kept.
pub(super) const CLAUSES: usize = 64;
/// So many clauses may be at hand in the midst of a step.
const ROOM: usize = 1_024;

/// Obligations that must all be met.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Clause {
    /// A bit for each obligation.
    pub(super) obligations: u32,
    /// When the time of those with a bound is over; 0 for those that are not there.
    pub(super) deadlines: [u64; BOUNDED],
}

impl Clause {
    /// Nothing is left to be met.
    pub(super) const TRUE: Clause = Clause { obligations: 0, deadlines: [0; BOUNDED] };

    pub(super) fn is_true(&self) -> bool {
        self.obligations == 0
    }

    pub(super) fn has(&self, obligation: usize) -> bool {
        self.obligations & (1 << obligation) != 0
    }

    fn one(plan: &Plan, obligation: usize, deadline: u64) -> Clause {
        let mut clause = Clause { obligations: 1 << obligation, ..Clause::TRUE };
        if let Some((_, Some(place))) = plan.obligations.get(obligation) {
            clause.deadlines[*place] = deadline;
        }
        clause
    }

    /// Both.
    fn and(&self, other: &Clause, plan: &Plan) -> Clause {
        let mut both = Clause { obligations: self.obligations | other.obligations, ..*self };
        for (obligation, place, is_until) in bounded(plan) {
            both.deadlines[place] = match (self.has(obligation), other.has(obligation)) {
                (true, true) if is_until => self.deadlines[place].min(other.deadlines[place]),
                (true, true) => self.deadlines[place].max(other.deadlines[place]),
                (false, true) => other.deadlines[place],
                _ => self.deadlines[place],
            };
        }
        both
    }

    /// Whether whatever meets this clause meets the other.
    fn says_at_least(&self, other: &Clause, plan: &Plan) -> bool {
        other.obligations & !self.obligations == 0
            && bounded(plan).all(|(obligation, place, is_until)| {
                !other.has(obligation)
                    || match is_until {
                        true => self.deadlines[place] <= other.deadlines[place],
                        false => self.deadlines[place] >= other.deadlines[place],
                    }
            })
    }

    /// What is left at a time that is not that of a step; nothing if it can no longer be met.
    pub(super) fn after(&self, now: u64, plan: &Plan) -> Option<Clause> {
        let mut left = *self;
        for (obligation, place, is_until) in bounded(plan) {
            if self.has(obligation) && self.deadlines[place] < now {
                if is_until {
                    return None;
                }
                left.obligations &= !(1 << obligation);
                left.deadlines[place] = 0;
            }
        }
        Some(left)
    }

    /// The deadlines counted from a later moment.
    pub(super) fn aged(mut self, by: u64, plan: &Plan) -> Clause {
        for (obligation, place, _) in bounded(plan) {
            if self.has(obligation) {
                self.deadlines[place] = self.deadlines[place].saturating_sub(by);
            }
        }
        self
    }

    /// The first moment after which [`after`](Clause::after) says something else.
    pub(super) fn first_deadline(&self, plan: &Plan) -> Option<u64> {
        bounded(plan)
            .filter(|(obligation, ..)| self.has(*obligation))
            .map(|(_, place, _)| self.deadlines[place])
            .min()
    }

    /// Whether it waits for something that must come.
    pub(super) fn awaits(&self, plan: &Plan) -> bool {
        plan.obligations.iter().enumerate().any(|(obligation, &(term, _))| {
            self.has(obligation) && matches!(plan.terms[term], Term::Until { .. })
        })
    }
}

/// The obligations with a bound: which, the place of its deadline, and whether it is an `until`.
fn bounded(plan: &Plan) -> impl Iterator<Item = (usize, usize, bool)> {
    plan.obligations.iter().enumerate().filter_map(|(obligation, &(term, place))| {
        Some((obligation, place?, matches!(plan.terms[term], Term::Until { .. })))
    })
}

/// What is true of one step, and when it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Position {
    pub(super) letter: u64,
    pub(super) now: u64,
}

/// More clauses than there is room for.
#[derive(Debug)]
pub(super) struct Overflow;

/// Where steps are made. It takes no more memory once it has been made.
#[derive(Clone, Debug)]
pub(super) struct Stack {
    clauses: Vec<Clause>,
}

impl Stack {
    pub(super) fn new() -> Stack {
        Stack { clauses: Vec::with_capacity(ROOM) }
    }

    /// The clauses that the last step left, none of which follows from another.
    pub(super) fn clauses(&self) -> &[Clause] {
        &self.clauses
    }

    /// The first step.
    pub(super) fn begin(&mut self, plan: &Plan, at: Position) -> Result<(), Overflow> {
        self.clauses.clear();
        self.expand(plan, plan.root, None, at)?;
        self.simplify(0, plan);
        Ok(())
    }

    /// A step from clauses on.
    pub(super) fn step(&mut self, plan: &Plan, from: &[Clause], at: Position) -> Result<(), Overflow> {
        self.clauses.clear();
        for clause in from {
            let begin = self.clauses.len();
            self.push(Clause::TRUE)?;
            for (obligation, &(term, place)) in plan.obligations.iter().enumerate() {
                if clause.has(obligation) {
                    let middle = self.clauses.len();
                    let deadline = place.map_or(u64::MAX, |place| clause.deadlines[place]);
                    self.expand(plan, term, Some(deadline), at)?;
                    self.product(begin, middle, plan)?;
                }
            }
        }
        self.simplify(0, plan);
        Ok(())
    }

    /// Puts on top what is left of a term after a step; a temporal one may be older than the step, and have its deadline.
    fn expand(
        &mut self,
        plan: &Plan,
        term: usize,
        deadline: Option<u64>,
        at: Position,
    ) -> Result<(), Overflow> {
        let begin = self.clauses.len();
        match plan.terms[term] {
            Term::Constant(true) => self.push(Clause::TRUE),
            Term::Constant(false) => Ok(()),
            Term::Literal { atom, holds } => match (at.letter & (1 << atom) != 0) == holds {
                true => self.push(Clause::TRUE),
                false => Ok(()),
            },
            Term::Or(one, other) => {
                self.expand(plan, one, None, at)?;
                self.expand(plan, other, None, at)?;
                self.simplify(begin, plan);
                Ok(())
            }
            Term::And(one, other) => {
                self.expand(plan, one, None, at)?;
                let middle = self.clauses.len();
                self.expand(plan, other, None, at)?;
                self.product(begin, middle, plan)
            }
            Term::Until { obligation, left, right, bound } => {
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
            Term::Release { obligation, left, right, bound } => {
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

    /// Takes what stands from `begin` and what stands from `middle`, and leaves what meets one of each.
    fn product(&mut self, begin: usize, middle: usize, plan: &Plan) -> Result<(), Overflow> {
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

    /// Takes away what follows from another.
    fn simplify(&mut self, begin: usize, plan: &Plan) {
        let mut kept = begin;
        for index in begin..self.clauses.len() {
            let clause = self.clauses[index];
            let weaker = |other: &Clause| clause.says_at_least(other, plan);
            // of two that are equal the first stays
            let is_needless = self.clauses[begin..kept].iter().any(weaker)
                || self.clauses[index + 1..]
                    .iter()
                    .any(|other| weaker(other) && !other.says_at_least(&clause, plan));
            if !is_needless {
                self.clauses[kept] = clause;
                kept += 1;
            }
        }
        self.clauses.truncate(kept);
    }

    fn push(&mut self, clause: Clause) -> Result<(), Overflow> {
        if self.clauses.len() == ROOM {
            return Err(Overflow);
        }
        self.clauses.push(clause);
        Ok(())
    }
}

fn deadline_of(known: Option<u64>, bound: Option<u64>, at: Position) -> u64 {
    known.unwrap_or_else(|| bound.map_or(u64::MAX, |bound| at.now.saturating_add(bound)))
}
