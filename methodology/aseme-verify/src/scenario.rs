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
//! | `messages` | messages arrive and nothing else happens |
//! | `event NAME` | an event arrives, spelled as in a trigger (`kick`, `ready.Signal.Ready`) |
//! | `return STATE`, `ongoing STATE`, `fail STATE` | the state's activity completes, requests another call, or fails |
//! | `wait 100ms` | time passes; `timer NAME` waits until that timer expires |
//!
//! | indented line | meaning |
//! |---|---|
//! | `Ball.found = true; Ball.x = 2` | messages arrive with the step: the newest ones with these fields changed |
//! | `publish.Kick` | a message arrives unchanged |
//! | `in A, B`, `not in A` | these states are active after the step, or none of them is |
//! | `starts A, B`, `starts nothing` | these activities are started in the step, and no others |
//! | `publishes Goal`, `publishes nothing` | the chart publishes these messages in the step, and no others |
//! | `[Goal.mine == true]` | the condition holds for the newest messages after the step |
//! | `timer NAME: 80ms`, `timer NAME: over`, `timer NAME: unset` | the time left, it has expired, it was not started |
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

use yase::expression::{Effect, EventId, Guard};
use yase::{NodeId, Outcome, Source, Span, TopicId};

/// The text of a scenario.
#[derive(Clone, PartialEq, Debug)]
pub struct ScenarioText {
    source: Arc<Source>,
    /// The model whose chart is run.
    pub model: Option<ScenarioLink>,
    /// The scenario that is run first.
    pub after: Option<ScenarioLink>,
    steps: Vec<StepLines>,
}

/// A reference to a file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ScenarioLink {
    /// The path as written.
    pub path: String,
    /// Its position in the source.
    pub span: Span,
}

/// A stimulus and the lines below it.
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
    /// Its span in the source.
    pub span: Span,
}

impl ScenarioPart {
    /// Its text, without comments.
    pub fn text(&self) -> &str {
        self.source.text.get(self.span.start..self.span.end).unwrap_or_default()
    }

    /// Its line, from 1.
    pub fn line(&self) -> usize {
        self.source.position(self.span.start).0
    }
}

/// A step of a scenario with resolved names.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct ScenarioStep {
    /// Its position in the source.
    pub passage: ScenarioPart,
    /// Its stimulus.
    pub cause: StepStimulus,
    /// The messages that arrive with it: only [`Effect::Assign`] and [`Effect::Publish`], each with
    /// its position.
    pub data: Vec<(Effect, ScenarioPart)>,
    /// The expectations after it.
    pub expected: Vec<Expectation>,
}

/// The stimulus of a step.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum StepStimulus {
    /// The chart is started.
    Start,
    /// Messages arrive.
    Messages,
    /// An event arrives. The message of the own host that an event stands for is part of
    /// [`ScenarioStep::data`], with the stimulus [`Messages`](StepStimulus::Messages).
    Event(EventId),
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
    /// The node of the scope whose blackboard holds it.
    pub region: NodeId,
    /// Its name.
    pub name: String,
}

/// An expected property of the state after a step.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Expectation {
    /// Its position in the source.
    pub passage: ScenarioPart,
    /// Its kind.
    pub kind: ExpectationKind,
}

/// The kinds of expectations.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum ExpectationKind {
    /// All of these states are active.
    In(Vec<NodeId>),
    /// None of these states is active.
    NotIn(Vec<NodeId>),
    /// The activities of these states are started in the step, and no others.
    Starts(Vec<NodeId>),
    /// The chart publishes on these topics in the step, and on no others.
    Publishes(Vec<TopicId>),
    /// The condition holds for the newest messages.
    Holds(Guard),
    /// The state of a timer.
    Timer(TimerReference, ExpectedTimer),
}

/// The expected state of a timer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ExpectedTimer {
    /// It was never started, or was discarded.
    Unset,
    /// It expires after this time.
    Runs(Duration),
    /// It has expired.
    Over,
}
