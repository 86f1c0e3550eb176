//! A way through an exploration, as text, and played again.
//!
//! ```text
//! # a line that begins so is a comment
//! start
//! return Look
//!   true   Ball.found
//!   false  Ball.distance > 2
//! event kick
//!   choose 1
//! timer walker step_timeout
//! messages
//! ```
//!
//! Each line that is not indented is a step's cause: the beginning, an event, the return of a state's activity, the expiry of a timer (by its blackboard's node and
//! its name), the arrival of messages. Below it stand the values that conditions had when they were first read in the step, in that order, and the
//! options that were taken where the chart leaves something open.

use std::fmt;
use std::sync::Arc;

use super::host::Chosen;
use super::search::take;
use crate::chart::Chart;
use crate::expression::ScriptId;
use crate::machine::{Machine, MachineError};
use crate::statechart::NodeId;

/// The cause of a step.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Move {
    /// The chart is started.
    Start,
    /// An event comes.
    Event(String),
    /// The activity of a state returns.
    Return(NodeId),
    /// A timer expires, by its place among [`Chart::timers`].
    Timer(usize),
    /// Messages arrive.
    Messages,
}

/// A step: its cause, and what was chosen in it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Step {
    /// Why it happens.
    pub cause: Move,
    /// The conditions that were read, and their values.
    pub decisions: Vec<(ScriptId, bool)>,
    /// The options that were taken.
    pub choices: Vec<u32>,
}

/// Steps of a chart from its beginning.
#[derive(Clone, Debug)]
pub struct Trace {
    chart: Arc<Chart>,
    steps: Vec<Step>,
}

/// Why a text is no trace of a chart.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct ParseError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

impl Trace {
    pub(super) fn new(chart: Arc<Chart>, steps: Vec<Step>) -> Trace {
        Trace { chart, steps }
    }

    /// The steps.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// A step as it stands in the text: its cause, and below it what was chosen.
    pub fn text_of(&self, step: &Step) -> String {
        let chart = &self.chart;
        let cause = match &step.cause {
            Move::Start => "start".to_owned(),
            Move::Event(name) => format!("event {name}"),
            Move::Return(node) => format!("return {}", chart.short_path(*node)),
            Move::Timer(timer) => format!("timer {}", timer_name(chart, *timer)),
            Move::Messages => "messages".to_owned(),
        };
        let decisions =
            step.decisions.iter().map(|(script, value)| format!("  {value:<5}  {}", chart.script(*script)));
        let choices = step.choices.iter().map(|choice| format!("  choose {choice}"));
        std::iter::once(cause).chain(decisions).chain(choices).map(|line| line + "\n").collect()
    }

    /// Reads a trace of a chart.
    ///
    /// # Errors
    /// The first line that is none, or names what the chart does not have.
    pub fn parse(chart: &Arc<Chart>, text: &str) -> Result<Trace, ParseError> {
        let mut steps: Vec<Step> = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let content = line.trim();
            if content.is_empty() || content.starts_with('#') {
                continue;
            }
            let wrong = |message: String| ParseError { line: index + 1, message };
            match (line.starts_with(char::is_whitespace), steps.last_mut()) {
                (false, _) => {
                    let cause = cause(chart, content).map_err(wrong)?;
                    steps.push(Step { cause, decisions: Vec::new(), choices: Vec::new() });
                }
                (true, Some(step)) => detail(chart, content, step).map_err(wrong)?,
                (true, None) => {
                    return Err(wrong("this belongs to no step: a trace begins with `start`".into()));
                }
            }
        }
        match steps.first().map(|step| &step.cause) {
            Some(Move::Start) => Ok(Trace::new(chart.clone(), steps)),
            _ => Err(ParseError { line: 1, message: "a trace begins with `start`".into() }),
        }
    }
}

fn cause(chart: &Chart, line: &str) -> Result<Move, String> {
    let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
    let rest = rest.trim();
    match (word, rest.is_empty()) {
        ("start", true) => Ok(Move::Start),
        ("messages", true) => Ok(Move::Messages),
        ("event", false) => Ok(Move::Event(rest.into())),
        ("return", false) => match chart.activities().find(|entry| chart.short_path(entry.node) == rest) {
            Some(entry) => Ok(Move::Return(entry.node)),
            None => Err(format!("no state with an activity is called `{rest}`")),
        },
        ("timer", false) => match (0..chart.timers().len()).find(|&timer| timer_name(chart, timer) == rest) {
            Some(timer) => Ok(Move::Timer(timer)),
            None => Err(format!("the chart has no timer `{rest}`: write its blackboard and its name")),
        },
        _ => Err(format!(
            "`{line}` is no step: write `start`, `event NAME`, `return STATE`, `timer BLACKBOARD NAME` or `messages`"
        )),
    }
}

fn detail(chart: &Chart, line: &str, step: &mut Step) -> Result<(), String> {
    let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
    let rest = rest.trim();
    match (word, rest.parse()) {
        ("choose", Ok(choice)) => {
            step.choices.push(choice);
            Ok(())
        }
        ("true" | "false", _) => match chart.scripts().find(|entry| entry.text == rest) {
            Some(entry) => {
                step.decisions.push((entry.id, word == "true"));
                Ok(())
            }
            None => Err(format!("no guard of the chart reads `{rest}`")),
        },
        _ => Err(format!(
            "`{line}` is no part of a step: write `true CONDITION`, `false CONDITION` or `choose NUMBER`"
        )),
    }
}

/// A timer by its blackboard and its name.
fn timer_name(chart: &Chart, timer: usize) -> String {
    let Some((region, name)) = chart.timers().nth(timer) else { return String::new() };
    let node = chart.region_node(region).map_or_else(String::new, |node| chart.short_path(node));
    format!("{node} {name}")
}

impl fmt::Display for Trace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.steps.iter().try_for_each(|step| f.write_str(&self.text_of(step)))
    }
}

/// Plays a trace. After each step `told` gets the machine, the step, and what happened in it, a line for each micro-step.
///
/// Conditions of which the trace says nothing are false.
///
/// # Errors
/// Where the machine stops by itself, as the trace may be meant to show.
pub fn replay(
    trace: &Trace,
    mut told: impl FnMut(&Machine, &Step, &[String]),
) -> Result<Machine, MachineError> {
    let mut machine = Machine::new(trace.chart.clone());
    let mut allows = |_: ScriptId, _: bool, _: &[(ScriptId, bool)]| true;
    let mut host = Chosen::new(&mut allows);
    host.notes.lines = Some(Vec::new());
    for step in &trace.steps {
        let values: Vec<bool> = step.decisions.iter().map(|&(_, value)| value).collect();
        host.begin(&values);
        let result = take(&mut machine, &step.cause, step.choices.clone(), &mut host);
        told(&machine, step, host.notes.lines.as_deref().unwrap_or_default());
        result?;
    }
    Ok(machine)
}
