//! Replay of a run that an exploration has found, with values for all that it leaves open.
//!
//! An exploration decides the conditions of a chart step by step; whether one set of data satisfies
//! the whole run is still open. A [`RunReplay`] executes the run once more on the machine, and
//! keeps for each condition what it reads there: which delivery of a message, or which assignment.
//! Then it searches for values with which all conditions evaluate as in the run, and checks them by
//! evaluation.
//!
//! A run that cannot be replayed may still be possible: the reason says what is missing.

mod blackboards;
mod evaluation;

use yase::expression::{Expression, Path};
use yase::{Machine, NodeId};
use yase_explore::{StepCause, TraceStep, advance_and_step};

use crate::abstraction::Abstraction;
use crate::logic::{Claim, GuardModel, GuardSolver};
pub(crate) use blackboards::MessageSources;
use blackboards::{ReplayHost, RunClaim};

/// Why a run is not confirmed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Unconfirmed {
    /// The step, from 0, up to which it is already not known to be a run.
    pub(crate) step: usize,
    pub(crate) reason: String,
}

/// A run that is executed again.
pub(crate) struct RunReplay<'a> {
    abstraction: &'a Abstraction,
    machine: Machine,
    host: ReplayHost<'a>,
}

impl<'a> RunReplay<'a> {
    /// A chart before its start; with the blackboards, by index, of regions that the run leaves
    /// out.
    pub(crate) fn new(
        abstraction: &'a Abstraction,
        idle: Vec<bool>,
        sources: MessageSources<'a>,
    ) -> RunReplay<'a> {
        let machine = Machine::new(abstraction.chart.clone());
        RunReplay { abstraction, machine, host: ReplayHost::new(abstraction, idle, sources) }
    }

    /// Executes the next step.
    ///
    /// # Errors
    /// The reason why the machine does not make this step.
    pub(crate) fn step(&mut self, step: &TraceStep) -> Result<(), String> {
        let event = match &step.cause {
            StepCause::Event(name) => Some(name.as_str()),
            _ => None,
        };
        self.host.begin(event, &step.decisions);
        let result = advance_and_step(&mut self.machine, &step.cause, step.choices.clone(), &mut self.host);
        self.machine.postpone_timers();
        match result {
            Err(error) => Err(error.to_string()),
            Ok(()) => self.host.end(),
        }
    }

    /// Lets a message with partially known content arrive before the next step.
    pub(crate) fn receive(&mut self, message: &Path, known: &[Expression]) {
        self.host.receive(message, known);
    }

    /// Adds knowledge about messages before the first step.
    pub(crate) fn assume(&mut self, known: &[Expression]) {
        self.host.assume(known);
    }

    /// The active nodes.
    pub(crate) fn configuration(&self) -> Vec<NodeId> {
        self.machine.configuration()
    }

    /// Records a fact about the newest messages, on the blackboard of the root.
    pub(crate) fn claim(&mut self, condition: &Expression, holds: bool) {
        self.host.claim_of_root(condition, holds);
    }

    /// Whether there are values with which the run so far is possible.
    ///
    /// # Errors
    /// Why none are known.
    pub(crate) fn verdict(&self) -> Result<(), Unconfirmed> {
        let last = self.host.step_number();
        let unknown = |reason: String| Unconfirmed { step: last, reason };
        let mut claims = self.host.claims().map_err(unknown)?;
        let constants = &self.abstraction.constants;
        let value = |claim: &RunClaim, model: Option<&GuardModel>| {
            evaluation::holds(&claim.condition, model, constants)
        };
        for claim in &claims {
            if value(claim, None).is_some_and(|value| value != claim.holds) {
                return Err(impossible(claim));
            }
        }
        claims.retain(|claim| value(claim, None).is_none());
        let wanted: Vec<Claim<'_>> = claims.iter().map(as_claim).collect();
        let model = match GuardSolver::new(constants).candidate(&wanted) {
            (Some(model), _) => model,
            (None, true) => return Err(self.contradiction(&claims)),
            (None, false) => {
                return Err(unknown("no values were found with which its conditions hold".into()));
            }
        };
        match claims.iter().find(|claim| value(claim, Some(&model)) != Some(claim.holds)) {
            None => Ok(()),
            Some(claim) => {
                let reason = format!("no values were found for `{}`", claim.written);
                Err(Unconfirmed { step: claim.step, reason })
            }
        }
    }

    /// The first condition that contradicts those before it.
    fn contradiction(&self, claims: &[RunClaim]) -> Unconfirmed {
        let logic = GuardSolver::new(&self.abstraction.constants);
        let is_possible = |count: usize| {
            let wanted: Vec<Claim<'_>> = claims[..count].iter().map(as_claim).collect();
            !matches!(logic.candidate(&wanted), (None, true))
        };
        // what contradicts part of the claims contradicts more of them
        let (mut possible, mut end) = (0, claims.len());
        while end - possible > 1 {
            let middle = possible + (end - possible) / 2;
            if is_possible(middle) { possible = middle } else { end = middle }
        }
        match claims.get(possible) {
            Some(claim) => impossible(claim),
            None => Unconfirmed { step: 0, reason: String::new() },
        }
    }
}

fn impossible(claim: &RunClaim) -> Unconfirmed {
    let reason = format!("at step {}, `{}` cannot be {}", claim.step + 1, claim.written, claim.holds);
    Unconfirmed { step: claim.step, reason }
}

fn as_claim(claim: &RunClaim) -> Claim<'_> {
    if claim.holds { Claim::Holds(&claim.condition) } else { Claim::DoesNotHold(&claim.condition) }
}
