//! Run-time monitor of a property.

use std::sync::Arc;

use super::clause::{CLAUSES, Clause, Overflow, Scratch, TimedLetter};
use super::compiled_property::CompiledProperty;

/// What is known of a property after some steps of a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum MonitorVerdict {
    /// It does not hold, however the run goes on.
    Violated,
    /// Something that must come has not come yet.
    Awaited,
    /// It holds so far: if the run ended here, it would hold.
    SoFar,
    /// It holds, however the run goes on.
    Satisfied,
    /// There are more ways in which it may come to hold than are followed: nothing is known of it
    /// any more.
    Lost,
}

/// A property along a run. A step takes no memory.
///
/// ```
/// use aseme_verify::properties::{Monitor, MonitorVerdict, bind, parse};
/// use yase::{Source, TypeEnvironment};
///
/// let role = Source::new("walker.srm", "Role: walker\nLiveness:\nwalker = (Look . Walk)~\n");
/// let chart = aseme_models::statechart_of(&role).0.compile(&TypeEnvironment::default()).expect("it is in order");
/// let text = "property \"it walks\": always (entering Look implies eventually entering Walk within 2 s)";
/// let (properties, _) = parse(text);
/// let plan = bind(&properties[0], &chart).expect("its names are known").plan;
/// let (look, walk) = (1, 2); // a bit for each atom, in the order in which they stand in the property
///
/// let second = 1_000_000_000;
/// let mut monitor = Monitor::new(plan);
/// assert_eq!(monitor.step(look, 0), MonitorVerdict::Awaited);
/// assert_eq!(monitor.step(walk, second), MonitorVerdict::SoFar);
/// assert_eq!(monitor.step(look, 2 * second), MonitorVerdict::Awaited);
/// assert_eq!(monitor.pass(4 * second), MonitorVerdict::Awaited, "it may still come at this moment");
/// assert_eq!(monitor.pass(4 * second + 1), MonitorVerdict::Violated);
/// ```
#[derive(Clone, Debug)]
pub struct Monitor {
    plan: Arc<CompiledProperty>,
    clauses: Vec<Clause>,
    stack: Scratch,
    has_begun: bool,
    verdict: MonitorVerdict,
}

impl Monitor {
    /// A property before the first step.
    pub fn new(plan: Arc<CompiledProperty>) -> Monitor {
        let clauses = Vec::with_capacity(CLAUSES);
        Monitor { plan, clauses, stack: Scratch::new(), has_begun: false, verdict: MonitorVerdict::Awaited }
    }

    /// What it follows.
    pub fn plan(&self) -> &CompiledProperty {
        &self.plan
    }

    /// What is known.
    pub fn verdict(&self) -> MonitorVerdict {
        self.verdict
    }

    /// Whether more steps may change what is known.
    pub fn is_open(&self) -> bool {
        matches!(self.verdict, MonitorVerdict::Awaited | MonitorVerdict::SoFar)
    }

    /// A step has happened: which atoms are true of it, and when it was, in nanoseconds.
    pub fn step(&mut self, letter: u64, now: u64) -> MonitorVerdict {
        if self.has_begun && !self.is_open() {
            return self.verdict;
        }
        let at = TimedLetter { letter, now };
        let stepped = match self.has_begun {
            false => self.stack.begin(&self.plan, at),
            true => self.stack.step(&self.plan, &self.clauses, at),
        };
        self.has_begun = true;
        self.verdict = self.taken(stepped);
        self.verdict
    }

    fn taken(&mut self, stepped: Result<(), Overflow>) -> MonitorVerdict {
        if stepped.is_err() || self.stack.clauses().len() > CLAUSES {
            return MonitorVerdict::Lost;
        }
        self.clauses.clear();
        self.clauses.extend_from_slice(self.stack.clauses());
        self.judge()
    }

    /// Time passes without a step.
    pub fn pass(&mut self, now: u64) -> MonitorVerdict {
        if self.has_begun && self.is_open() {
            let plan = &self.plan;
            self.clauses.retain_mut(|clause| match clause.at_time(now, plan) {
                Some(left) => {
                    *clause = left;
                    true
                }
                None => false,
            });
            self.verdict = self.judge();
        }
        self.verdict
    }

    fn judge(&self) -> MonitorVerdict {
        if self.clauses.is_empty() {
            MonitorVerdict::Violated
        } else if self.clauses.iter().any(Clause::is_true) {
            MonitorVerdict::Satisfied
        } else if self.clauses.iter().all(|clause| clause.awaits(&self.plan)) {
            MonitorVerdict::Awaited
        } else {
            MonitorVerdict::SoFar
        }
    }

    /// The last moment at which what is known is surely what [`pass`](Monitor::pass) says: after
    /// it, ask again.
    pub fn deadline(&self) -> Option<u64> {
        let is_asked = self.has_begun && self.is_open();
        let deadlines = self.clauses.iter().filter_map(|clause| clause.first_deadline(&self.plan));
        deadlines.min().filter(|_| is_asked)
    }

    /// Begins anew with the next step, if the property is one that says the same later on: one that
    /// begins with `always`. Says whether it is.
    pub fn try_restart(&mut self) -> bool {
        if self.plan.is_lasting {
            self.has_begun = false;
            self.clauses.clear();
            self.verdict = MonitorVerdict::Awaited;
        }
        self.plan.is_lasting
    }
}
