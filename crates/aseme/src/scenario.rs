//! Scenarios: what a chart does in one course of events, as a person says it.
//!
//! A scenario is written like the traces that [`yase::explore::replay`] plays, a step after the other, but says what messages hold instead of what conditions do,
//! and what is expected of the chart below each step:
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
//! `model` names the file of the chart it is about, `after` another scenario that comes first: both as seen from the scenario's own file. Then come steps, each a cause,
//! with what is said of it indented below:
//!
//! | cause | what happens |
//! |---|---|
//! | `start` | the chart is started |
//! | `messages` | nothing but that messages come |
//! | `event NAME` | an event comes |
//! | `return STATE`, `ongoing STATE`, `fail STATE` | the state's activity is done, wants to be called again, or fails |
//! | `wait 100ms` | time goes by; `timer NAME` lets it go by till that timer is over |
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
//! States are named by [paths](crate::path), timers by their names, with the state whose blackboard they lie on in front if several have one name. An activity goes on until
//! the scenario says how it ends. Constants of the model may stand in values and conditions.
//!
//! [`Script::parse`] reads a text, [`Script::bind`] looks up its names in a chart; `monas::scenario` plays what comes of that.

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
pub struct Script {
    source: Arc<Source>,
    /// The model that it is about.
    pub model: Option<Link>,
    /// The scenario that comes first.
    pub after: Option<Link>,
    steps: Vec<Lines>,
}

/// A file that a scenario names.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Link {
    /// The path, as it is written.
    pub path: String,
    /// Where it stands.
    pub span: Span,
}

/// A cause, and what stands below it.
#[derive(Clone, PartialEq, Debug)]
struct Lines {
    cause: Span,
    details: Vec<Span>,
}

/// A part of a scenario's text.
#[derive(Clone, PartialEq, Debug)]
pub struct Passage {
    /// The scenario.
    pub source: Arc<Source>,
    /// Where it stands in it.
    pub span: Span,
}

impl Passage {
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
pub struct Step {
    /// Where it stands.
    pub passage: Passage,
    /// Why it happens.
    pub cause: Cause,
    /// What messages come with it: only [`Effect::Assign`] and [`Effect::Publish`], each with where it stands.
    pub data: Vec<(Effect, Passage)>,
    /// What is to be so when it is over.
    pub expected: Vec<Expectation>,
}

/// Why a step happens.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Cause {
    /// The chart is started.
    Start,
    /// Messages come.
    Messages,
    /// An event comes.
    Event(String),
    /// The activity of a state returns.
    Return(NodeId, Outcome),
    /// Time goes by.
    Wait(Duration),
    /// Time goes by till a timer is over.
    Timer(Timer),
}

/// A timer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Timer {
    /// The root or the region whose blackboard it lies on.
    pub region: NodeId,
    /// Its name.
    pub name: String,
}

/// Something that is to be so.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct Expectation {
    /// Where it stands.
    pub passage: Passage,
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
    Timer(Timer, TimerLeft),
}

/// How far a timer is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TimerLeft {
    /// It was never started, or is forgotten.
    Unset,
    /// It will be over after so long.
    Runs(Duration),
    /// It is over.
    Over,
}
