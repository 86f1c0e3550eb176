//! Scenarios played: a chart taken through a course of events, and held against what is expected of it.
//!
//! [`aseme::scenario`] has the words. The chart runs as it does in an agent: on blackboards of a hub with the program's topics, with its functions, in simulated time. Only its
//! activities are none: each goes on until the scenario says how it ends. So a scenario is about the chart alone, and plays in a fraction of a millisecond.
//!
//! ```
//! use aseme::scenario::Script;
//! use monas::Registry;
//! use monas::scenario::Player;
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
//! let player = Player::new(&Registry::linked())?;
//! let chart = player.compile(&aseme::statechart_of(&role).0).expect("the role is in order");
//! let (script, _) = Script::parse(&text);
//! let steps = script.bind(&chart, player.vocabulary()).expect("the scenario is in order");
//!
//! let differences = player.play(&chart, &steps, |_| {})?;
//! assert_eq!(differences.len(), 1);
//! assert_eq!(differences[0].to_string(), "expected `in Look`, but active are: Greet");
//! assert_eq!(differences[0].passage.line(), 6);
//! # Ok::<(), monas::Error>(())
//! ```

mod newest;
mod play;
#[cfg(test)]
mod tests;

use std::fmt;
use std::sync::Arc;

use aseme::scenario::{Passage, Step};
use narukom::TOPICS;
use yase::{Chart, Diagnostic, Statechart, Vocabulary};

use crate::error::Error;
use crate::function::FunctionDeclaration;
use crate::registry::Registry;
use crate::vocabulary::vocabulary;

/// Takes charts through scenarios.
pub struct Player {
    functions: Arc<[FunctionDeclaration]>,
    vocabulary: Vocabulary,
}

/// Where a chart does not do what is expected of it.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Difference {
    /// The line that is not met.
    pub passage: Passage,
    /// What was expected, in the words of the scenario if they say it.
    pub expected: String,
    /// What was seen in its place.
    pub seen: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {}, but {}", self.expected, self.seen)
    }
}

/// A step that was played.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Played<'a> {
    /// The step.
    pub step: &'a Step,
    /// What the chart did in it, a line for each micro-step.
    pub records: &'a [String],
    /// The BASIC states that are active when it is over, as briefly as a scenario may name them.
    pub active: Vec<String>,
    /// What of it differs from what is expected.
    pub differences: &'a [Difference],
}

impl Player {
    /// With the topics of the program and the functions of a registry.
    ///
    /// # Errors
    /// Two functions of one name.
    pub fn new(registry: &Registry) -> Result<Player, Error> {
        let functions = registry.functions()?;
        let vocabulary = vocabulary(TOPICS, &functions);
        Ok(Player { functions: functions.into(), vocabulary })
    }

    /// The words that charts and scenarios may use.
    pub fn vocabulary(&self) -> &Vocabulary {
        &self.vocabulary
    }

    /// Makes a chart ready to be played. Which activities there are does not matter.
    ///
    /// # Errors
    /// Everything that keeps it from running.
    pub fn compile(&self, chart: &Statechart) -> Result<Arc<Chart>, Vec<Diagnostic>> {
        chart.compile(&self.vocabulary).map(Arc::new)
    }

    /// Plays the steps of a scenario, and says where the chart does something else. After each step `told` is given what happened. A cause that cannot be, such as the return of
    /// an activity that does not run, ends the play.
    ///
    /// The chart may be a changed one of that in which the names of the scenario were looked up, if it has the same states.
    ///
    /// # Errors
    /// The hub cannot be set up.
    pub fn play(
        &self,
        chart: &Arc<Chart>,
        steps: &[Step],
        told: impl FnMut(Played<'_>),
    ) -> Result<Vec<Difference>, Error> {
        play::Play::new(chart, &self.functions, true)?.all(steps, told)
    }

    /// The first difference that a scenario shows, if it shows any: quicker, since nothing else is told.
    ///
    /// # Errors
    /// The hub cannot be set up.
    pub fn first_difference(&self, chart: &Arc<Chart>, steps: &[Step]) -> Result<Option<Difference>, Error> {
        play::Play::new(chart, &self.functions, false)?.first(steps)
    }
}

impl fmt::Debug for Player {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Player({} topics, {} functions)", self.vocabulary.topics.len(), self.functions.len())
    }
}
