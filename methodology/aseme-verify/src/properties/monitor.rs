//! Run-time monitor of a property.

use std::sync::Arc;

use super::clause::{Clause, MAX_CLAUSES, Overflow, Scratch, TimedLetter};
use super::compiled_property::CompiledProperty;

/// The verdict on a property after a prefix of a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum MonitorVerdict {
    /// Every continuation of the run violates it.
    Violated,
    /// Something required has not happened yet.
    Awaited,
    /// It would hold if the run ended here.
    SoFar,
    /// Every continuation of the run satisfies it.
    Satisfied,
    /// The limit of clauses was exceeded; the property is no longer evaluated.
    Lost,
}

/// Evaluates a property along a run. A step does not allocate.
///
/// ```
/// use aseme_verify::properties::{Monitor, MonitorVerdict, bind, parse};
/// use yase::{Source, TypeEnvironment};
///
/// let role = Source::new("walker.srm", "Role: walker\nLiveness:\nwalker = (Look . Walk)~\n");
/// let chart = aseme_models::statechart_of(&role).0.compile(&TypeEnvironment::default()).expect("it is in order");
/// let text = "property \"it walks\": always (entering Look implies eventually entering Walk within 2 s)";
/// let (properties, _) = parse(text);
/// let plan = bind(&properties[0], &chart, &TypeEnvironment::default()).expect("its names are known").plan;
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
    /// A monitor before the first step.
    pub fn new(plan: Arc<CompiledProperty>) -> Monitor {
        let clauses = Vec::with_capacity(MAX_CLAUSES);
        Monitor { plan, clauses, stack: Scratch::new(), has_begun: false, verdict: MonitorVerdict::Awaited }
    }

    /// The property that it evaluates.
    pub fn plan(&self) -> &CompiledProperty {
        &self.plan
    }

    /// The current verdict.
    pub fn verdict(&self) -> MonitorVerdict {
        self.verdict
    }

    /// Whether more steps may change the verdict.
    pub fn is_open(&self) -> bool {
        matches!(self.verdict, MonitorVerdict::Awaited | MonitorVerdict::SoFar)
    }

    /// Evaluates a step: the atoms that are true of it, and its time in nanoseconds.
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
        if stepped.is_err() || self.stack.clauses().len() > MAX_CLAUSES {
            return MonitorVerdict::Lost;
        }
        self.clauses.clear();
        self.clauses.extend_from_slice(self.stack.clauses());
        self.judge()
    }

    /// Evaluates the passage of time without a step.
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

    /// The last time until which the verdict of [`pass`](Monitor::pass) is unchanged; call it again
    /// after that.
    pub fn deadline(&self) -> Option<u64> {
        let is_asked = self.has_begun && self.is_open();
        let deadlines = self.clauses.iter().filter_map(|clause| clause.first_deadline(&self.plan));
        deadlines.min().filter(|_| is_asked)
    }

    /// Restarts with the next step if the property begins with `always`. Returns whether it does.
    pub fn try_restart(&mut self) -> bool {
        if self.plan.is_lasting {
            self.has_begun = false;
            self.clauses.clear();
            self.verdict = MonitorVerdict::Awaited;
        }
        self.plan.is_lasting
    }
}
