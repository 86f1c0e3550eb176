//! Execution of scenarios: a chart receives a sequence of events, and its reactions are compared
//! with the expected ones.
//!
//! [`aseme_verify::scenario`] defines the language. The chart is executed as in an agent: on
//! blackboards of a hub with the program's topics and functions, in simulated time. Only its
//! activities are stubs: each runs until the scenario specifies its result. A scenario therefore
//! tests the chart alone, and takes a fraction of a millisecond.
//!
//! ```
//! use aseme_verify::scenario::ScenarioText;
//! use monas_core::Registry;
//! use monas_core::scenario::ScenarioRunner;
//! use yase::Source;
//!
//! let role = Source::new("visitor.srm", "
//! Liveness:
//! visitor = Look . Greet
//! Transitions:
//! Look -> Greet : [wait] / StartTimeout(wait, 500ms)
//! ");
//! let text = Source::new("late.scenario", "model visitor.srm
//! start
//!   starts Look
//! return Look
//!   starts Greet
//!   in Look
//! ");
//! let player = ScenarioRunner::new(&Registry::linked())?;
//! let (statechart, _) = aseme_models::statechart_of(&role);
//! let chart = player.compile(&statechart).expect("the role is valid");
//! let (script, _) = ScenarioText::parse(&text);
//! let steps = script.bind(&chart, player.vocabulary()).expect("the scenario is valid");
//!
//! let differences = player.play(&chart, &steps, |_| {})?;
//! assert_eq!(differences.len(), 1);
//! assert_eq!(differences[0].to_string(), "expected `in Look`, but active are: Greet");
//! assert_eq!(differences[0].passage.line(), 6);
//! # Ok::<(), monas_core::Error>(())
//! ```

mod latest_messages;
mod scenario_run;
#[cfg(test)]
mod tests;

use std::fmt;
use std::sync::Arc;

use aseme_verify::scenario::{ScenarioPart, ScenarioStep};
use narukom::TOPICS;
use yase::{CompiledChart, Diagnostic, Statechart, TypeEnvironment};

use crate::error::Error;
use crate::function::FunctionDeclaration;
use crate::registry::Registry;
use crate::vocabulary::vocabulary;

/// Executes scenarios on charts.
pub struct ScenarioRunner {
    functions: Arc<[FunctionDeclaration]>,
    vocabulary: TypeEnvironment,
}

/// A deviation of a chart from the expectations of a scenario.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct ScenarioDifference {
    /// The line of the scenario that is not satisfied.
    pub passage: ScenarioPart,
    /// The expectation, as the scenario states it where it does.
    pub expected: String,
    /// The observation that contradicts it.
    pub seen: String,
}

impl fmt::Display for ScenarioDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {}, but {}", self.expected, self.seen)
    }
}

/// The result of one step of a scenario.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct StepResult<'a> {
    /// The step.
    pub step: &'a ScenarioStep,
    /// The reactions of the chart in this step, one line per micro-step.
    pub records: &'a [String],
    /// The BASIC states that are active after the step, with the shortest names that a scenario
    /// accepts.
    pub active: Vec<String>,
    /// Deviations from the expectations of this step.
    pub differences: &'a [ScenarioDifference],
}

impl ScenarioRunner {
    /// A runner with the topics of the program and the functions of a registry.
    ///
    /// # Errors
    /// Two functions have the same name.
    pub fn new(registry: &Registry) -> Result<ScenarioRunner, Error> {
        let functions = registry.functions()?;
        let vocabulary = vocabulary(TOPICS, &functions);
        Ok(ScenarioRunner { functions: functions.into(), vocabulary })
    }

    /// The type environment of charts and scenarios.
    pub fn vocabulary(&self) -> &TypeEnvironment {
        &self.vocabulary
    }

    /// Compiles a chart for scenarios. Its activities need not be registered.
    ///
    /// # Errors
    /// Every diagnostic that prevents execution.
    pub fn compile(&self, chart: &Statechart) -> Result<Arc<CompiledChart>, Vec<Diagnostic>> {
        chart.compile(&self.vocabulary).map(Arc::new)
    }

    /// Executes the steps of a scenario and returns the deviations of the chart. Calls `observe`
    /// after each step with its result. An impossible stimulus, such as the return of an activity
    /// that is not running, ends the execution.
    ///
    /// The chart may be a mutant of the one in which the names of the scenario were resolved, if
    /// both have the same states.
    ///
    /// # Errors
    /// The hub cannot be set up.
    pub fn play(
        &self,
        chart: &Arc<CompiledChart>,
        steps: &[ScenarioStep],
        observe: impl FnMut(StepResult<'_>),
    ) -> Result<Vec<ScenarioDifference>, Error> {
        scenario_run::ScenarioRun::new(chart, &self.functions, true)?.all(steps, observe)
    }

    /// The first deviation from a scenario, if any. Faster than [`play`](Self::play), since nothing
    /// else is reported.
    ///
    /// # Errors
    /// The hub cannot be set up.
    pub fn first_difference(
        &self,
        chart: &Arc<CompiledChart>,
        steps: &[ScenarioStep],
    ) -> Result<Option<ScenarioDifference>, Error> {
        scenario_run::ScenarioRun::new(chart, &self.functions, false)?.first(steps)
    }
}

impl fmt::Debug for ScenarioRunner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "ScenarioRunner({} topics, {} functions)",
            self.vocabulary.topics.len(),
            self.functions.len()
        )
    }
}
