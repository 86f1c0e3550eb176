//! Traces of a composition: text form and replay.
//!
//! ```text
//! passer: start
//! receiver: start
//! passer: return Aim
//!   true  Ball.found
//!   # says `Pass`
//! # `Pass` of passer comes to receiver
//! receiver: event passer.news.Signal.Pass
//! ```
//!
//! Each unindented line begins with a robot's name; the rest of it and the indented lines below are
//! a step as in [`yase_explore::Trace`].

use std::sync::Arc;

use yase::CompiledChart;
use yase_explore::{ParseError, Trace, replay};

/// The steps of several robots, in the order in which they happen.
#[derive(Clone, Debug)]
pub struct TeamTrace {
    /// The steps of each robot alone.
    traces: Vec<Trace>,
    /// The robot of each step, in the order of the trace.
    order: Vec<usize>,
}

/// The result of one step of one robot.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct PlayedStep {
    /// The index of the robot.
    pub robot: usize,
    /// The step, as written in the text.
    pub step: String,
    /// A line for each micro-step.
    pub records: Vec<String>,
    /// The states that are active after it.
    pub active: Vec<String>,
}

impl TeamTrace {
    /// Whether a text is a team trace: its first step names one of several robots.
    pub fn is_one(text: &str) -> bool {
        let first = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#'));
        first.is_some_and(|line| line.trim_end().ends_with(": start"))
    }

    /// Parses a trace of robots with these names and charts.
    ///
    /// # Errors
    /// The first line that names no robot or is not a step of its robot.
    pub fn parse(robots: &[(&str, &Arc<CompiledChart>)], text: &str) -> Result<TeamTrace, ParseError> {
        // each part keeps the line numbers of the whole text, for error messages
        let mut parts = vec![String::new(); robots.len()];
        let (mut order, mut last) = (Vec::new(), None);
        for (index, line) in text.lines().enumerate() {
            let is_step = !line.starts_with([' ', '\t', '#']) && !line.trim().is_empty();
            if is_step {
                last = Some(robot_of(robots, line).ok_or_else(|| unknown(robots, line, index + 1))?);
                order.extend(last);
            }
            for (robot, part) in parts.iter_mut().enumerate().filter(|(robot, _)| Some(*robot) == last) {
                let own = if is_step {
                    line.get(robots[robot].0.len() + 1..).unwrap_or_default().trim()
                } else {
                    line
                };
                part.push_str(own);
            }
            parts.iter_mut().for_each(|part| part.push('\n'));
        }
        let traces = robots.iter().zip(&parts).map(|((_, chart), part)| Trace::parse(chart, part));
        Ok(TeamTrace { traces: traces.collect::<Result<_, _>>()?, order })
    }

    /// Replays the steps on the charts and returns what each did, or the error by which a chart
    /// stopped.
    pub fn play(&self) -> (Vec<PlayedStep>, Option<yase::MachineError>) {
        let mut wrong = None;
        let mut steps: Vec<std::collections::VecDeque<PlayedStep>> = Vec::new();
        for (robot, trace) in self.traces.iter().enumerate() {
            let mut own = std::collections::VecDeque::new();
            let result = replay(trace, |machine, step, records| {
                let name = |node| machine.chart().names().name(node).to_owned();
                let active = machine.configuration().into_iter().map(name).collect();
                own.push_back(PlayedStep {
                    robot,
                    step: trace.text_of(step),
                    records: records.to_vec(),
                    active,
                });
            });
            wrong = wrong.or(result.err());
            steps.push(own);
        }
        let played = self.order.iter().filter_map(|&robot| steps[robot].pop_front()).collect();
        (played, wrong)
    }
}

fn robot_of(robots: &[(&str, &Arc<CompiledChart>)], line: &str) -> Option<usize> {
    robots.iter().position(|(name, _)| line.strip_prefix(*name).is_some_and(|rest| rest.starts_with(':')))
}

fn unknown(robots: &[(&str, &Arc<CompiledChart>)], line: &str, number: usize) -> ParseError {
    let names: Vec<String> = robots.iter().map(|(name, _)| format!("`{name}:`")).collect();
    let message = format!("`{}` belongs to no robot: a step starts with {}", line.trim(), names.join(" or "));
    ParseError { line: number, message }
}
