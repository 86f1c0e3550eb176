//! Scenarios: one course of events and the expected behaviour of a chart.
//!
//! A scenario is written like the traces that [`yase_explore::replay`] replays, one step after
//! another, but gives the contents of messages instead of the values of conditions, and the
//! expected behaviour of the chart below each step:
//!
//! ```text
//! # The ball is lost: the robot looks for it.
//! model ../../models/goalie.srm
//! start
//!   GameState.player_state = PLAYING
//!   starts RobotController, LedHandler, MotionController, Stand
//! return Stand
//!   starts SendCalibration
//! wait 100ms
//!   not in SearchBall
//! ```
//!
//! `model` names the file of the chart, `after` another scenario that is run first; both paths are
//! relative to the scenario's file. Then follow steps, each a stimulus with indented lines below
//! it:
//!
//! | cause | what happens |
//! |---|---|
//! | `start` | the chart is started |
//! | `messages` | nothing but that messages come |
//! | `event NAME` | an event comes |
//! | `return STATE`, `ongoing STATE`, `fail STATE` | the state's activity is done, wants to be called again, or fails |
//! | `wait 100ms` | time passes; `timer NAME` waits until that timer expires |
//!
//! | below | what it says |
//! |---|---|
//! | `Ball.found = true; Ball.x = 2` | messages come with the step: the newest ones with these fields changed |
//! | `publish.Kick` | a message comes as it is |
//! | `in A, B`, `not in A` | these states are active when the step is over, or none of them is |
//! | `starts A, B`, `starts nothing` | these activities are started in the step, and no others |
//! | `publishes Goal`, `publishes nothing` | the chart publishes these messages in the step, and no others |
//! | `[Goal.mine == true]` | the newest messages say so when it is over |
//! | `timer NAME: 80ms`, `timer NAME: over`, `timer NAME: unset` | so long is left, it is over, it has not been started |
//!
//! States are referred to by [paths](aseme::path), timers by their names, prefixed with the state
//! whose blackboard holds them if several have one name. An activity runs until the scenario ends
//! it. Values and conditions may use constants of the model.
//!
//! [`ScenarioText::parse`] parses a text, [`ScenarioText::bind`] resolves its names in a chart;
//! `monas::scenario` runs the resulting steps.

mod bind;
mod parse;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::Duration;

use yase::expression::{Effect, Guard};
use yase::{NodeId, Outcome, Source, Span, TopicId};

/// The text of a scenario.
#[derive(Clone, PartialEq, Debug)]
pub struct ScenarioText {
    source: Arc<Source>,
    /// The model that it is about.
    pub model: Option<ScenarioLink>,
    /// The scenario that comes first.
    pub after: Option<ScenarioLink>,
    steps: Vec<StepLines>,
}

/// A file that a scenario names.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ScenarioLink {
    /// The path, as it is written.
    pub path: String,
    /// Its position in the source.
    pub span: Span,
}

/// A cause, and what stands below it.
#[derive(Clone, PartialEq, Debug)]
struct StepLines {
    cause: Span,
    details: Vec<Span>,
}

/// A part of a scenario's text.
#[derive(Clone, PartialEq, Debug)]
pub struct ScenarioPart {
    /// The scenario.
    pub source: Arc<Source>,
    /// Where it stands in it.
    pub span: Span,
}

impl ScenarioPart {
    /// What is written there, without comments.
    pub fn text(&self) -> &str {
        self.source.text.get(self.span.start..self.span.end).unwrap_or_default()
    }

    /// The line it stands on, from 1.
    pub fn line(&self) -> usize {
        self.source.position(self.span.start).0
    }
}

/// A step of a scenario that a chart can be taken through.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct ScenarioStep {
    /// Its position in the source.
    pub passage: ScenarioPart,
    /// Why it happens.
    pub cause: StepStimulus,
    /// What messages come with it: only [`Effect::Assign`] and [`Effect::Publish`], each with where
    /// it stands.
    pub data: Vec<(Effect, ScenarioPart)>,
    /// What is to be so when it is over.
    pub expected: Vec<Expectation>,
}

/// Why a step happens.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum StepStimulus {
    /// The chart is started.
    Start,
    /// Messages come.
    Messages,
    /// An event comes.
    Event(String),
    /// The activity of a state returns.
    Return(NodeId, Outcome),
    /// Time passes.
    Wait(Duration),
    /// Time passes until a timer expires.
    Timer(TimerReference),
}

/// A timer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TimerReference {
    /// The root or the region whose blackboard it lies on.
    pub region: NodeId,
    /// Its name.
    pub name: String,
}

/// Something that is to be so.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Expectation {
    /// Its position in the source.
    pub passage: ScenarioPart,
    /// What it is.
    pub kind: ExpectationKind,
}

/// What is to be so.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum ExpectationKind {
    /// All of these states are active.
    In(Vec<NodeId>),
    /// None of these states is active.
    NotIn(Vec<NodeId>),
    /// The activities of these states are started in the step, and no others.
    Starts(Vec<NodeId>),
    /// Messages are published on these topics by the chart in the step, and on no others.
    Publishes(Vec<TopicId>),
    /// The newest messages say so.
    Holds(Guard),
    /// A timer is as far as that.
    Timer(TimerReference, ExpectedTimer),
}

/// How far a timer is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ExpectedTimer {
    /// It was never started, or is forgotten.
    Unset,
    /// It will be over after so long.
    Runs(Duration),
    /// It is over.
    Over,
}
