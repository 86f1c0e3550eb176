//! A path through an exploration, as text, and its replay.
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
//! Each line without indentation is the cause of a step: the start, an event, the return of a
//! state's activity, the expiry of a timer (by the node of its blackboard and its name), the
//! arrival of messages. Below it are the values of conditions in the order in which they were first
//! read in the step, and the options taken where the chart leaves a choice open.

use std::fmt;
use std::sync::Arc;

use super::WriteEffects;
use super::host::ChoosingHost;
use super::search::take_step;
use yase::CompiledChart;
use yase::expression::ScriptId;
use yase::statechart::NodeId;
use yase::{Machine, MachineError};

/// The cause of a step.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum StepCause {
    /// The chart is started.
    Start,
    /// An event occurs.
    Event(String),
    /// The activity of a state returns.
    Return(NodeId),
    /// A timer expires, by its index in [`CompiledChart::timers`].
    Timer(usize),
    /// Messages arrive.
    Messages,
}

/// A step: its cause and the choices made in it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct TraceStep {
    /// Its cause.
    pub cause: StepCause,
    /// The conditions that were read, and their values.
    pub decisions: Vec<(ScriptId, bool)>,
    /// The options that were taken.
    pub choices: Vec<u32>,
}

/// A sequence of steps from the start of a chart.
#[derive(Clone, Debug)]
pub struct Trace {
    chart: Arc<CompiledChart>,
    steps: Vec<TraceStep>,
}

/// Why a text is not a trace of a chart.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct ParseError {
    /// The line, from 1.
    pub line: usize,
    /// The reason.
    pub message: String,
}

impl Trace {
    pub(crate) fn new(chart: Arc<CompiledChart>, steps: Vec<TraceStep>) -> Trace {
        Trace { chart, steps }
    }

    /// The steps.
    pub fn steps(&self) -> &[TraceStep] {
        &self.steps
    }

    /// The text of a step: its cause, and below it the choices.
    pub fn text_of(&self, step: &TraceStep) -> String {
        let chart = &self.chart;
        let cause = match &step.cause {
            StepCause::Start => "start".to_owned(),
            StepCause::Event(name) => format!("event {name}"),
            StepCause::Return(node) => format!("return {}", chart.short_path(*node)),
            StepCause::Timer(timer) => format!("timer {}", timer_name(chart, *timer)),
            StepCause::Messages => "messages".to_owned(),
        };
        let decisions =
            step.decisions.iter().map(|(script, value)| format!("  {value:<5}  {}", chart.script(*script)));
        let choices = step.choices.iter().map(|choice| format!("  choose {choice}"));
        std::iter::once(cause).chain(decisions).chain(choices).map(|line| line + "\n").collect()
    }

    /// Parses a trace of a chart.
    ///
    /// # Errors
    /// The first line that is invalid or contains names that the chart does not have.
    pub fn parse(chart: &Arc<CompiledChart>, text: &str) -> Result<Trace, ParseError> {
        let mut steps: Vec<TraceStep> = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let content = line.trim();
            if content.is_empty() || content.starts_with('#') {
                continue;
            }
            let wrong = |message: String| ParseError { line: index + 1, message };
            match (line.starts_with(char::is_whitespace), steps.last_mut()) {
                (false, _) => {
                    let cause = cause(chart, content).map_err(wrong)?;
                    steps.push(TraceStep { cause, decisions: Vec::new(), choices: Vec::new() });
                }
                (true, Some(step)) => detail(chart, content, step).map_err(wrong)?,
                (true, None) => {
                    return Err(wrong("this line belongs to no step: a trace starts with `start`".into()));
                }
            }
        }
        match steps.first().map(|step| &step.cause) {
            Some(StepCause::Start) => Ok(Trace::new(chart.clone(), steps)),
            _ => Err(ParseError { line: 1, message: "a trace starts with `start`".into() }),
        }
    }
}

fn cause(chart: &CompiledChart, line: &str) -> Result<StepCause, String> {
    let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
    let rest = rest.trim();
    match (word, rest.is_empty()) {
        ("start", true) => Ok(StepCause::Start),
        ("messages", true) => Ok(StepCause::Messages),
        ("event", false) => Ok(StepCause::Event(rest.into())),
        ("return", false) => match chart.activities().find(|entry| chart.short_path(entry.node) == rest) {
            Some(entry) => Ok(StepCause::Return(entry.node)),
            None => Err(format!("no state with an activity has the name `{rest}`")),
        },
        ("timer", false) => match (0..chart.timers().len()).find(|&timer| timer_name(chart, timer) == rest) {
            Some(timer) => Ok(StepCause::Timer(timer)),
            None => Err(format!("the chart has no timer `{rest}`: write its blackboard and its name")),
        },
        _ => Err(format!(
            "`{line}` is not a step: write `start`, `event NAME`, `return STATE`, `timer BLACKBOARD NAME` or `messages`"
        )),
    }
}

fn detail(chart: &CompiledChart, line: &str, step: &mut TraceStep) -> Result<(), String> {
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
            "`{line}` is not part of a step: write `true CONDITION`, `false CONDITION` or `choose NUMBER`"
        )),
    }
}

/// A timer by its blackboard and its name.
fn timer_name(chart: &CompiledChart, timer: usize) -> String {
    let Some((region, name)) = chart.timers().nth(timer) else { return String::new() };
    let node = chart.region_node(region).map_or_else(String::new, |node| chart.short_path(node));
    format!("{node} {name}")
}

impl fmt::Display for Trace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.steps.iter().try_for_each(|step| f.write_str(&self.text_of(step)))
    }
}

/// Replays a trace and passes the machine, the step and its trace lines, one per micro-step, to
/// `observe` after each step.
///
/// Conditions that the trace does not contain are false.
///
/// # Errors
/// The machine stops with an error, as the trace may be intended to show.
pub fn replay(
    trace: &Trace,
    mut observe: impl FnMut(&Machine, &TraceStep, &[String]),
) -> Result<Machine, MachineError> {
    let mut machine = Machine::new(trace.chart.clone());
    let mut allows = |_: ScriptId, _: bool, _: &[(ScriptId, bool)]| true;
    let effects = WriteEffects::default();
    let mut host = ChoosingHost::new(&mut allows, &effects);
    host.notes.lines = Some(Vec::new());
    for step in &trace.steps {
        let values: Vec<bool> = step.decisions.iter().map(|&(_, value)| value).collect();
        host.begin(&values);
        let result = take_step(&mut machine, &step.cause, step.choices.clone(), &mut host);
        observe(&machine, step, host.notes.lines.as_deref().unwrap_or_default());
        result?;
    }
    Ok(machine)
}
